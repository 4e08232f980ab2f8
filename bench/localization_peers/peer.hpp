// What every foreign localisation looks like to the bench: scans and odometry in, a pose out.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "hyselam_common/laser_scan.hpp"
#include "hyselam_common/occupancy_grid.hpp"
#include "hyselam_common/pose2.hpp"

namespace peers {

/// What a peer holds to be true after an update of its filter.
struct Estimate {
  hyselam::Pose2 base_in_map;
  /// The heaviest cluster holds at least 0.9 of the weight and deviates by at most 0.75 m along its
  /// widest axis. Neither amcl nor Beluga says whether it is sure: this is our rule for ourselves.
  bool converged = false;
  std::size_t particles = 0;
};

bool isSure(double cluster_weight, double xx, double xy, double yy);

struct Settings {
  std::size_t max_particles = 0;  ///< 0: the peer's default
  bool expert = false;            ///< else everything as the peer's node has it without parameters
  std::uint64_t seed = 1;
};

class Peer {
 public:
  virtual ~Peer() = default;
  /// Nothing is known: particles over all of the free space.
  virtual void startAnywhere() = 0;
  virtual void startAt(const hyselam::Pose2& base_in_map, const hyselam::Pose2& stddev) = 0;
  /// @returns whether the filter was updated.
  virtual bool update(const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom) = 0;
  /// The last pose that it would have published, and the odometry of that moment.
  virtual const Estimate& estimate() const = 0;
  virtual const hyselam::Pose2& odometryOfEstimate() const = 0;
};

/// One of them is linked into each driver.
std::unique_ptr<Peer> makePeer(const hyselam::OccupancyGrid& map, const Settings& settings);
/// Its name, for the records.
std::string nameOfPeer();

}  // namespace peers
