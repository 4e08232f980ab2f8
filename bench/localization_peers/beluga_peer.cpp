// Beluga's amcl of its header-only core, set up and driven as beluga_ros::Amcl does (amcl.cpp of
// Ekumen-OS/beluga).
#include <algorithm>
#include <beluga/algorithm/amcl_core.hpp>
#include <beluga/beluga.hpp>
#include <cmath>
#include <optional>
#include <range/v3/all.hpp>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "peer.hpp"

namespace peers {

namespace {

using hyselam::Pose2;

Sophus::SE2d toSophus(const Pose2& p) {
  return {Sophus::SO2d{p.theta}, Eigen::Vector2d{p.x, p.y}};
}

Pose2 fromSophus(const Sophus::SE2d& p) {
  return {p.translation().x(), p.translation().y(), p.so2().log()};
}

/// A map with the trinary values of ROS, as beluga_ros::OccupancyGrid.
class Grid : public beluga::BaseOccupancyGrid2<Grid> {
 public:
  struct ValueTraits {
    static bool is_free(std::int8_t value) { return value == 0; }
    static bool is_unknown(std::int8_t value) { return value == -1; }
    static bool is_occupied(std::int8_t value) { return value == 100; }
  };

  explicit Grid(const hyselam::OccupancyGrid& grid)
      : grid_(std::make_shared<const hyselam::OccupancyGrid>(grid)),
        origin_(toSophus(grid.geometry.origin)) {}

  const Sophus::SE2d& origin() const { return origin_; }
  std::size_t size() const { return grid_->cells.size(); }
  const auto& data() const { return grid_->cells; }
  std::size_t width() const { return static_cast<std::size_t>(grid_->geometry.width); }
  std::size_t height() const { return static_cast<std::size_t>(grid_->geometry.height); }
  double resolution() const { return grid_->geometry.resolution; }
  static auto value_traits() { return ValueTraits{}; }

 private:
  std::shared_ptr<const hyselam::OccupancyGrid> grid_;
  Sophus::SE2d origin_;
};

using Motion = beluga::DifferentialDriveModel2d;
using Sensor = beluga::LikelihoodFieldModel<Grid>;
using Anywhere = beluga::MultivariateUniformDistribution<Sophus::SE2d, Grid>;

beluga::AmclParams filterParams(const Settings& s) {
  beluga::AmclParams p;  // 500 to 2000 particles, 0.25 m or 0.2 rad, resampled each time
  p.kld_z = s.expert ? 3.0 : 0.99;
  // The node's default is without recovery; the core's, which experts take, is with it.
  p.alpha_slow = s.expert ? 0.001 : 0.0;
  p.alpha_fast = s.expert ? 0.1 : 0.0;
  if (s.max_particles > 0) p.max_particles = s.max_particles;
  return p;
}

beluga::LikelihoodFieldModelParam sensorParams(const Settings& s) {
  beluga::LikelihoodFieldModelParam p;
  p.max_obstacle_distance = 2.0;
  p.max_laser_distance = 100.0;
  p.z_hit = s.expert ? 0.95 : 0.5;
  p.z_random = s.expert ? 0.05 : 0.5;
  p.sigma_hit = 0.2;
  p.only_obstacle_boundaries = !s.expert;
  return p;
}

class BelugaPeer : public Peer {
 public:
  BelugaPeer(const hyselam::OccupancyGrid& map, const Settings& s)
      : grid_(map),
        anywhere_(grid_),
        filter_(Motion{beluga::DifferentialDriveModelParam{0.2, 0.2, 0.2, 0.2}},
                Sensor{sensorParams(s), grid_}, RandomState{&anywhere_},
                beluga::spatial_hash<Sophus::SE2d>{0.5, 0.5, hyselam::radians(10.0)},
                filterParams(s)) {
    ranges::detail::get_random_engine().seed(s.seed);
  }

  void startAnywhere() override { filter_.initialize(std::ref(anywhere_)); }

  void startAt(const Pose2& pose, const Pose2& stddev) override {
    const Eigen::Vector3d variance(stddev.x * stddev.x, stddev.y * stddev.y,
                                   stddev.theta * stddev.theta);
    filter_.initialize(toSophus(pose), Eigen::Matrix3d(variance.asDiagonal()));
  }

  bool update(const hyselam::LaserScan& scan, const Pose2& base_in_odom) override {
    if (!filter_.update(toSophus(base_in_odom), pointsOf(scan))) return false;
    // The node publishes the mean of the heaviest cluster, not that of all particles.
    const auto states = filter_.particles() | beluga::views::states;
    const auto weights = filter_.particles() | beluga::views::weights;
    const auto clusters = beluga::estimate_clusters(
        states, weights, beluga::ParticleClusterizer{{}}(states, weights));
    estimate_.particles = filter_.particles().size();
    estimate_.converged = false;
    odom_ = base_in_odom;
    if (clusters.empty()) {
      estimate_.base_in_map = fromSophus(std::get<0>(beluga::estimate(states, weights)));
      return true;
    }
    const auto best = std::max_element(
        clusters.begin(), clusters.end(),
        [](const auto& a, const auto& b) { return double(a.weight) < double(b.weight); });
    double sum = 0.0;
    for (const auto& w : weights) sum += static_cast<double>(w);
    estimate_.base_in_map = fromSophus(best->mean);
    estimate_.converged = isSure(static_cast<double>(best->weight) / sum, best->covariance(0, 0),
                                 best->covariance(0, 1), best->covariance(1, 1));
    return true;
  }

  const Estimate& estimate() const override { return estimate_; }
  const Pose2& odometryOfEstimate() const override { return odom_; }

 private:
  /// Where the filter's random particles come from.
  struct RandomState {
    Anywhere* anywhere;
    Sophus::SE2d operator()() const { return (*anywhere)(ranges::detail::get_random_engine()); }
  };

  /// 60 beams, evenly, of those with a return (beluga_ros::LaserScan).
  static std::vector<std::pair<double, double>> pointsOf(const hyselam::LaserScan& scan) {
    constexpr std::size_t kBeams = 60;
    std::vector<std::pair<double, double>> points;
    const auto beams =
        ranges::views::iota(std::size_t{0}, scan.ranges.size()) | ranges::to<std::vector>;
    for (const std::size_t i : beams | beluga::views::take_evenly(kBeams)) {
      const double r = scan.ranges[i];
      if (std::isnan(r) || r < scan.range_min || r >= scan.range_max) continue;
      const double bearing = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
      const hyselam::Point2 p =
          scan.laser_in_base * hyselam::Point2{r * std::cos(bearing), r * std::sin(bearing)};
      points.emplace_back(p.x, p.y);
    }
    return points;
  }

  Grid grid_;
  Anywhere anywhere_;
  beluga::Amcl<Motion, Sensor, RandomState> filter_;
  Estimate estimate_;
  Pose2 odom_;
};

}  // namespace

std::unique_ptr<Peer> makePeer(const hyselam::OccupancyGrid& map, const Settings& settings) {
  return std::make_unique<BelugaPeer>(map, settings);
}

std::string nameOfPeer() {
  return "Beluga";
}

}  // namespace peers
