// amcl's filter, map and sensor models, unchanged, driven as AmclNode::laserReceived drives them
// (amcl_node.cpp of ros-planning/navigation, branch noetic-devel).
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include "amcl/map/map.h"
#include "amcl/pf/pf.h"
#include "amcl/sensors/amcl_laser.h"
#include "amcl/sensors/amcl_odom.h"
#include "hyselam_common/errors.hpp"
#include "peer.hpp"

namespace peers {

namespace {

using hyselam::Pose2;

// The node's parameters without any on the parameter server.
constexpr int kMinParticles = 100, kResampleInterval = 2;
constexpr std::size_t kMaxParticles = 5000;
constexpr double kKldErr = 0.01, kKldZ = 0.99, kAlphaSlow = 0.001, kAlphaFast = 0.1;
constexpr double kUpdateDistance = 0.2, kUpdateTurn = hyselam::kPi / 6.0, kOdomAlpha = 0.2;
constexpr double kZHit = 0.95, kZRand = 0.05, kSigmaHit = 0.2, kLikelihoodMaxDist = 2.0;
constexpr std::size_t kBeams = 30;
// Experts: the motion model whose noise is the one asked for, and more beams.
constexpr std::size_t kExpertBeams = 60;

pf_vector_t toPf(const Pose2& p) {
  pf_vector_t v = pf_vector_zero();
  v.v[0] = p.x;
  v.v[1] = p.y;
  v.v[2] = p.theta;
  return v;
}

Pose2 fromPf(const pf_vector_t& v) {
  return {v.v[0], v.v[1], v.v[2]};
}

struct FreeSpace {
  map_t* map = nullptr;
  std::vector<std::pair<int, int>> cells;
};

pf_vector_t anywhere(void* arg) {
  const auto& free_space = *static_cast<FreeSpace*>(arg);
  const map_t* map = free_space.map;
  const auto cell = free_space.cells[static_cast<std::size_t>(
      drand48() * static_cast<double>(free_space.cells.size()))];
  pf_vector_t p = pf_vector_zero();
  p.v[0] = MAP_WXGX(map, cell.first);
  p.v[1] = MAP_WYGY(map, cell.second);
  p.v[2] = drand48() * 2 * M_PI - M_PI;
  return p;
}

class AmclPeer : public Peer {
 public:
  AmclPeer(const hyselam::OccupancyGrid& grid, const Settings& s) : map_(map_alloc()) {
    convert(grid);
    const auto most = s.max_particles > 0 ? s.max_particles : kMaxParticles;
    pf_ = pf_alloc(kMinParticles, static_cast<int>(most), kAlphaSlow, kAlphaFast, anywhere,
                   &free_space_);
    srand48(static_cast<long>(s.seed));  // pf_alloc() takes the time of day
    pf_->pop_err = kKldErr;
    pf_->pop_z = kKldZ;
    odom_.SetModel(s.expert ? amcl::ODOM_MODEL_DIFF_CORRECTED : amcl::ODOM_MODEL_DIFF, kOdomAlpha,
                   kOdomAlpha, kOdomAlpha, kOdomAlpha, kOdomAlpha);
    laser_ = std::make_unique<amcl::AMCLLaser>(s.expert ? kExpertBeams : kBeams, map_);
    laser_->SetModelLikelihoodField(kZHit, kZRand, kSigmaHit, kLikelihoodMaxDist);
  }
  ~AmclPeer() override {
    pf_free(pf_);
    map_free(map_);
  }
  AmclPeer(const AmclPeer&) = delete;
  AmclPeer& operator=(const AmclPeer&) = delete;

  void startAnywhere() override {
    pf_init_model(pf_, anywhere, &free_space_);
    initialized_ = false;
  }

  void startAt(const Pose2& pose, const Pose2& stddev) override {
    pf_matrix_t cov = pf_matrix_zero();
    cov.m[0][0] = stddev.x * stddev.x;
    cov.m[1][1] = stddev.y * stddev.y;
    cov.m[2][2] = stddev.theta * stddev.theta;
    pf_init(pf_, toPf(pose), cov);
    initialized_ = false;
  }

  bool update(const hyselam::LaserScan& scan, const Pose2& base_in_odom) override {
    const bool first = !initialized_;
    if (first) {
      initialized_ = true;
      resample_count_ = 0;
    } else {
      amcl::AMCLOdomData data;
      data.pose = toPf(base_in_odom);
      data.delta = pf_vector_zero();
      data.delta.v[0] = base_in_odom.x - filter_odom_.x;
      data.delta.v[1] = base_in_odom.y - filter_odom_.y;
      data.delta.v[2] = hyselam::normalizeAngle(base_in_odom.theta - filter_odom_.theta);
      if (std::abs(data.delta.v[0]) <= kUpdateDistance &&
          std::abs(data.delta.v[1]) <= kUpdateDistance &&
          std::abs(data.delta.v[2]) <= kUpdateTurn) {
        return false;
      }
      odom_.UpdateAction(pf_, &data);
    }
    filter_odom_ = base_in_odom;
    weigh(scan);
    const bool resampled = ++resample_count_ % kResampleInterval == 0;
    if (resampled) pf_update_resample(pf_);
    if (resampled || first) publish(base_in_odom);
    return true;
  }

  const Estimate& estimate() const override { return estimate_; }
  const Pose2& odometryOfEstimate() const override { return published_odom_; }

 private:
  /// As AmclNode::convertMap.
  void convert(const hyselam::OccupancyGrid& grid) {
    const hyselam::GridGeometry& g = grid.geometry;
    if (g.origin.theta != 0.0) {
      throw hyselam::InputError("map", "origin", "is turned, which amcl does not know");
    }
    map_->size_x = g.width;
    map_->size_y = g.height;
    map_->scale = g.resolution;
    map_->origin_x = g.origin.x + (map_->size_x / 2) * map_->scale;
    map_->origin_y = g.origin.y + (map_->size_y / 2) * map_->scale;
    map_->cells = static_cast<map_cell_t*>(std::malloc(sizeof(map_cell_t) * g.cellCount()));
    for (std::size_t i = 0; i < g.cellCount(); ++i) {
      map_->cells[i].occ_state = grid.cells[i] == 0 ? -1 : grid.cells[i] == 100 ? 1 : 0;
    }
    free_space_.map = map_;
    for (int x = 0; x < map_->size_x; ++x) {
      for (int y = 0; y < map_->size_y; ++y) {
        if (map_->cells[MAP_INDEX(map_, x, y)].occ_state == -1)
          free_space_.cells.emplace_back(x, y);
      }
    }
    if (free_space_.cells.empty()) throw hyselam::InputError("map", "", "has no free cell");
  }

  void weigh(const hyselam::LaserScan& scan) {
    pf_vector_t laser = toPf(scan.laser_in_base);
    laser.v[2] = 0.0;  // bearings are those in the robot's frame
    laser_->SetLaserPose(laser);
    amcl::AMCLLaserData data;
    data.sensor = laser_.get();
    data.range_count = static_cast<int>(scan.ranges.size());
    data.range_max = scan.range_max;
    data.ranges = new double[scan.ranges.size()][2];  // freed by its destructor
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      const double range = scan.ranges[i];
      data.ranges[i][0] = range <= scan.range_min  ? scan.range_max
                          : range > scan.range_max ? std::numeric_limits<double>::max()
                                                   : range;
      data.ranges[i][1] =
          scan.laser_in_base.theta + scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    }
    laser_->UpdateSensor(pf_, &data);
  }

  void publish(const Pose2& base_in_odom) {
    const pf_sample_set_t& set = pf_->sets[pf_->current_set];
    double heaviest = 0.0;
    pf_vector_t best = pf_vector_zero();
    pf_matrix_t best_cov = pf_matrix_zero();
    for (int i = 0; i < set.cluster_count; ++i) {
      double weight = 0.0;
      pf_vector_t mean;
      pf_matrix_t cov;
      if (!pf_get_cluster_stats(pf_, i, &weight, &mean, &cov)) break;
      if (weight <= heaviest) continue;
      heaviest = weight;
      best = mean;
      best_cov = cov;
    }
    if (heaviest <= 0.0) return;
    estimate_ = {fromPf(best),
                 isSure(heaviest, best_cov.m[0][0], best_cov.m[0][1], best_cov.m[1][1]),
                 static_cast<std::size_t>(set.sample_count)};
    published_odom_ = base_in_odom;
  }

  map_t* map_;
  FreeSpace free_space_;
  pf_t* pf_ = nullptr;
  amcl::AMCLOdom odom_;
  std::unique_ptr<amcl::AMCLLaser> laser_;
  Pose2 filter_odom_, published_odom_;
  Estimate estimate_;
  bool initialized_ = false;
  int resample_count_ = 0;
};

}  // namespace

std::unique_ptr<Peer> makePeer(const hyselam::OccupancyGrid& map, const Settings& settings) {
  return std::make_unique<AmclPeer>(map, settings);
}

std::string nameOfPeer() {
  return "amcl";
}

}  // namespace peers
