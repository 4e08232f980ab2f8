// A log through a foreign localisation, looked at at the same moments and by the same rules as
// localize_offline looks at ours.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <iostream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/ros/bag_tool.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "localization_score.hpp"
#include "peer.hpp"

namespace peers {

bool isSure(double cluster_weight, double xx, double xy, double yy) {
  const double widest = 0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), xy);
  return cluster_weight >= 0.9 && std::sqrt(std::max(0.0, widest)) <= 0.75;
}

}  // namespace peers

namespace {

using hyselam::Pose2;

struct Options {
  std::string map, log, reference;
  peers::Settings settings;
  double start = 0.0, distance = 0.0;
  bool start_known = false;
};

// Ours looks at its pose so often (its update_min_d and update_min_a).
constexpr double kLookDistance = 0.1;
const double kLookTurn = hyselam::radians(10.0);

double secondsOfCpu() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// The pose and whether it is trusted, as an entry of the score of ours. A peer has no phases: it
/// tracks while it is sure, and is lost when it is not sure any more.
fsd_localization::LocalizationResult resultOf(const peers::Peer& peer, const Pose2& odom,
                                              double stamp, double travelled, bool was_sure) {
  fsd_localization::LocalizationResult r;
  r.stamp = stamp;
  r.base_in_map = peer.estimate().base_in_map * (peer.odometryOfEstimate().inverse() * odom);
  r.converged = peer.estimate().converged;
  r.phase = r.converged ? fsd_localization::Phase::kTracking
            : was_sure  ? fsd_localization::Phase::kLost
                        : fsd_localization::Phase::kGlobal;
  r.particles = peer.estimate().particles;
  r.travelled = travelled;
  return r;
}

nlohmann::json run(const Options& o) {
  const hyselam::OccupancyGrid map = hyselam::loadMap(o.map);
  const hyselam::RobotLog log = hyselam::readRobotLog(o.log);
  const auto truth = hyselam::readPoses(o.reference).poses;
  const double begin = log.scans.front().stamp + o.start;
  const auto peer = peers::makePeer(map, o.settings);
  if (o.start_known) {
    const auto scan = std::find_if(log.scans.begin(), log.scans.end(),
                                   [&](const auto& s) { return s.stamp >= begin; });
    const auto at =
        scan == log.scans.end() ? std::nullopt : hyselam::poseAt(truth, scan->stamp, 1.0);
    if (!at) throw hyselam::InputError(o.log, "--start-known", "no true pose at the first scan");
    peer->startAt(*at, {0.5, 0.5, hyselam::radians(15.0)});
  } else {
    peer->startAnywhere();
  }

  fsd_localization::LocalizationScore score({});
  nlohmann::json converged_at = nullptr;
  std::optional<Pose2> looked;
  double travelled = 0.0, cpu_s = 0.0, particles = 0.0;
  std::size_t updates = 0;
  bool was_sure = false;
  for (const hyselam::LaserScan& scan : log.scans) {
    if (scan.stamp < begin) continue;
    if (o.distance > 0.0 && travelled > o.distance) break;
    const auto odom = hyselam::poseAt(log.odometry, scan.stamp, 0.2);
    if (!odom) continue;
    const double cpu = secondsOfCpu();
    const bool updated = peer->update(scan, *odom);
    cpu_s += secondsOfCpu() - cpu;
    if (updated) {
      ++updates;
      particles += static_cast<double>(peer->estimate().particles);
    }
    if (looked) {
      const double way = hyselam::distance(*looked, *odom);
      const double turn = std::abs(hyselam::normalizeAngle(odom->theta - looked->theta));
      if (way < kLookDistance && turn < kLookTurn) continue;
      travelled += way;
    }
    looked = *odom;
    const auto result = resultOf(*peer, *odom, scan.stamp, travelled, was_sure);
    was_sure = was_sure || result.converged;
    if (result.converged && converged_at.is_null()) converged_at = travelled;
    if (const auto at = hyselam::poseAt(truth, scan.stamp, 0.05)) score.add(result, *at);
  }
  if (updates == 0) throw hyselam::InputError(o.log, "", "no scan could be used for an update");
  nlohmann::json j = {{"peer", peers::nameOfPeer()},
                      {"seed", o.settings.seed},
                      {"updates", updates},
                      {"mean_particles", particles / static_cast<double>(updates)},
                      {"cpu_s", cpu_s},
                      {"travelled_m", travelled},
                      {"converged_at_m", converged_at}};
  if (!score.empty()) j["against_reference"] = score.report();
  std::cout << j.dump(2) << "\n";
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Localises a recorded run with a foreign localisation.", "replay_peer");
  Options o;
  app.add_option("--map", o.map, "map (map_server YAML)")->required();
  app.add_option("--bag", o.log, "bag or CARMEN log, plain or gzip")->required();
  app.add_option("--reference", o.reference, "true poses")->required();
  app.add_option("--particles", o.settings.max_particles, "most particles; 0: the peer's default");
  app.add_flag("--expert", o.settings.expert, "as those set it up who know it");
  app.add_option("--seed", o.settings.seed, "equal seeds give equal results");
  app.add_option("--start", o.start, "seconds to skip at the beginning");
  app.add_option("--distance", o.distance, "metres of travel to use; 0: to the end");
  app.add_flag("--start-known", o.start_known, "the first pose is told, to 0.5 m and 15 degrees");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
