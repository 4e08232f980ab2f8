// The search of whole maps without the filter: what each brings is told by leaving one out.
#pragma once

#include <optional>

#include "fsd_localization/localizer.hpp"

namespace fsd_localization {

/// Each half metre the scans of the last metres are searched on the whole map, at once; between,
/// the pose goes on with the refined odometry. It is sure by the same odds as the localizer.
class SearchAlone {
 public:
  SearchAlone(const hyselam::OccupancyGrid& map, const LocalizerParams& params);
  /// As Localizer::update.
  std::optional<LocalizationResult> update(const hyselam::LaserScan& scan,
                                           const hyselam::Pose2& base_in_odom);

 private:
  void search(const hyselam::Pose2& smooth);

  LocalizerParams params_;
  hyselam::Pose2 origin_;
  PlaceSearch places_;
  hyselam_scan_matching::ScanOdometry odometry_;
  SubmapBuilder submap_;
  std::optional<hyselam::Pose2> last_odom_, updated_, asked_, base_;  // base_: in the grid's frame
  double travelled_ = 0.0;
  bool sure_ = false, was_sure_ = false;
  std::optional<double> probability_;
};

}  // namespace fsd_localization
