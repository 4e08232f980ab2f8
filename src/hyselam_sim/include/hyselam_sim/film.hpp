// A run filmed by the robot's camera: one picture after the other along its path.
#pragma once

#include <functional>

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/robot_log.hpp"
#include "hyselam_sim/camera.hpp"

namespace hyselam_sim {

struct FilmParams {
  CameraParams camera;
  LightParams light;
  double rate = 2.0;        ///< pictures per second, 0.01 .. 120
  double start_time = 1.0;  ///< stamp at which doors and people begin to move [s]

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// One picture with its truth.
struct FilmFrame {
  double stamp = 0.0;  ///< [s], on the log's clock
  Pose2 base;          ///< the robot in the plan frame
  int place = -1;      ///< index into FloorPlan::places of where the robot is; -1: none
  CameraFrame picture;
};

/// Films along the ground truth of the log. The same arguments give the same pictures. Throws
/// hyselam::InputError for a log without ground truth, hyselam::ParameterError for a parameter out
/// of range.
void film(const Scene& scene, const hyselam::RobotLog& log, const std::vector<Person>& people,
          std::uint64_t seed, const FilmParams& params,
          const std::function<void(const FilmFrame&)>& take);

/// How many pictures film() takes.
std::size_t filmLength(const hyselam::RobotLog& log, const FilmParams& params);

}  // namespace hyselam_sim
