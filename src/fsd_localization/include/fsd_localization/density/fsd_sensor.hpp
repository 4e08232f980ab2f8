// Computes free-space densities (FSD) around the robot from laser scans and odometry (Maffei 2017,
// chapter 3).
#pragma once

#include <optional>
#include <vector>

#include "fsd_localization/density/density_field.hpp"
#include "fsd_localization/density/local_map.hpp"

namespace fsd_localization {

/// Free-space density at the robot with one kernel, its gradient direction and frontiers.
struct FsdReading {
  Density density;
  /// Direction in which the density falls, relative to the robot's heading [rad]; empty where the
  /// density is undefined nearby or the direction is not stable (Eq. 3.5).
  std::optional<double> descent;
  int frontiers = 0;  ///< frontiers of free space (Alg. 6.1)
};

struct FsdObservation {
  double stamp = 0.0;                ///< of the scan [s]
  hyselam::Pose2 base_in_odom;       ///< where the robot was
  std::vector<FsdReading> readings;  ///< one per kernel, in the order of FsdSensorParams::kernels
};

struct FsdSensorParams {
  LocalMapParams local_map;
  std::vector<KernelSpec> kernels = {{KernelProfile::kUniform, 1.5},
                                     {KernelProfile::kUniform, 3.0},
                                     {KernelProfile::kUniform, 5.0}};
  GradientParams gradient;
  bool with_gradient = true;
  bool with_frontiers = true;
  double min_frontier_share = 0.05;  ///< epsilon_f of Alg. 6.1, of the kernel's perimeter

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError; a kernel must fit the local map.
  void validate() const;
};

/// Keeps the local map and computes densities around the robot.
class FsdSensor {
 public:
  explicit FsdSensor(const FsdSensorParams& params = {});

  /// Integrates a scan into the local map; call it with every scan. @throws hyselam::InputError for
  /// a scan or pose that cannot be used; nothing is changed then.
  void integrate(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom);
  /// Throws what integrate() would, and changes nothing.
  void check(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom) const {
    map_.check(scan, base_in_odom);
  }
  /// Computes the densities around the robot. All are undefined before the first scan.
  FsdObservation observe();
  /// Clears the local map (the robot was moved by hand, the clock jumped back).
  void reset();

  const FsdSensorParams& params() const { return params_; }
  const LocalMap& localMap() const { return map_; }

 private:
  std::optional<double> descentAtRobot(const FreeSpaceDensity& kernel) const;

  FsdSensorParams params_;
  LocalMap map_;
  std::vector<FreeSpaceDensity> kernels_;
  int reach_ = 0;  // [cells] half size of the window that the kernels need
  FreeSpaceGrid space_;
  double stamp_ = 0.0;
  hyselam::Pose2 base_in_odom_;
};

}  // namespace fsd_localization
