// A robot in the drawn room whose pose was told, and that may be carried off.
#pragma once

#include <optional>

#include "drawn_room.hpp"
#include "fsd_localization/localizer.hpp"

struct DrivenRobot {
  const hyselam::OccupancyGrid map = room();
  const fsd_localization::GridRayCaster rays{map};
  fsd_localization::Localizer localizer{map, fsd_localization::LocalizerParams{}};
  hyselam::Pose2 at{2.0, 2.0, 0.0}, wheels = at;

  DrivenRobot() { localizer.setInitialPose(at, {0.2, 0.2, 0.1}); }
  void drive(const hyselam::Pose2& step) {
    at = at * step;
    wheels = wheels * step;
  }
  /// To another place, which the wheels do not tell.
  void carryOff() { at = {9.0, 5.0, -2.0}; }
  std::optional<fsd_localization::LocalizationResult> see(double stamp) {
    return localizer.update(look(rays, at, stamp), wheels);
  }
};
