// One run of the robot through a building.
#pragma once

#include <cstdint>
#include <functional>

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/robot_log.hpp"
#include "hyselam_sim/floor_plan.hpp"
#include "hyselam_sim/laser.hpp"
#include "hyselam_sim/path_follower.hpp"
#include "hyselam_sim/path_planner.hpp"
#include "hyselam_sim/robot.hpp"
#include "hyselam_sim/route.hpp"

namespace hyselam_sim {

struct SimulationParams {
  RobotParams robot;
  OdometryParams odometry;
  LaserParams laser;
  FollowerParams follower;
  PlannerParams planner;
  double odometry_rate = 20.0;        ///< [Hz]; also the rate of control and ground truth
  double scan_rate = 10.0;            ///< [Hz], <= odometry_rate
  double start_time = 1.0;            ///< stamp of the first sample [s], > 0
  double max_duration = 86400.0;      ///< a longer run is refused [s]
  double stand_after_teleport = 1.0;  ///< [s]

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// When the robot was at the end of a step of the route.
struct Visit {
  std::size_t step = 0;  ///< index into Route::steps
  double stamp = 0.0;    ///< [s], on the log's clock
};

struct Simulation {
  hyselam::RobotLog log;      ///< ground truth in the plan frame; odometry starts at the identity
  std::vector<Visit> visits;  ///< one per step, in order
  std::vector<double> teleport_stamps;  ///< first sample after each teleport [s]
  double distance = 0.0;                ///< driven, teleports not counted [m]
  double duration = 0.0;                ///< [s]
};

/// Runs the route. The same arguments give the same result, on any number of threads.
///
/// @throws hyselam::InputError naming the route's file and step when a place is unknown, a leg is
/// blocked (by which wall, door or furniture), or a person would walk through a wall;
/// hyselam::ParameterError for a parameter out of range. `progress` gets the number of steps done.
Simulation simulate(const FloorPlan& plan, const Route& route, std::uint64_t seed,
                    const SimulationParams& params = {},
                    const std::function<void(std::size_t)>& progress = {});

}  // namespace hyselam_sim
