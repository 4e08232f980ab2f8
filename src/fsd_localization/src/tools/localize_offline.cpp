// localize_offline: a bag or CARMEN log through the same localiser as the nodelet, without a
// master.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <functional>
#include <iostream>
#include <memory>

#include "altered_log.hpp"
#include "fsd_localization/localizer.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/ros/bag_tool.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "localization_score.hpp"
#include "search_alone.hpp"

namespace {

using fsd_localization::LocalizationScore;
using hyselam::Pose2;

struct Options {
  std::string map, log, model = "hybrid", kernel = "uniform", trajectory, reference, updates;
  std::vector<double> bandwidths{1.5, 3.0, 5.0}, place_odds;
  std::size_t particles = 20000;
  std::uint64_t seed = 1;
  double start = 0.0, duration = 0.0, distance = 0.0, success_m = 0.5, success_deg = 15.0;
  fsd_localization::Alterations alterations;
  bool cache = false, start_known = false, raw_odometry = false, without_search = false,
       without_short_term = false, search_alone = false;
  hyselam::BagOptions bag_options;
};

fsd_localization::LocalizerParams localizerParams(const Options& o) {
  fsd_localization::LocalizerParams p;
  p.model = fsd_localization::observationModelKindFromString(o.model);
  p.seed = o.seed;
  p.refine_odometry = !o.raw_odometry;
  p.submap_search = !o.without_search;
  p.short_term_layer = !o.without_short_term;
  if (!o.place_odds.empty()) {
    p.place_odds = {o.place_odds[0], o.place_odds[1], o.place_odds[2], o.place_odds[3]};
  }
  p.filter.max_particles = o.particles;
  p.filter.min_particles = std::min(p.filter.min_particles, o.particles);
  p.map.kernels.clear();
  for (double h : o.bandwidths) {
    p.map.kernels.push_back({fsd_localization::kernelProfileFromString(o.kernel), h});
  }
  p.validate();
  return p;
}

std::unique_ptr<fsd_localization::Localizer> makeLocalizer(
    const hyselam::OccupancyGrid& map, const fsd_localization::LocalizerParams& params,
    const Options& o) {
  hyselam::Progress preparing("density fields", 100);
  auto localizer = std::make_unique<fsd_localization::Localizer>(
      map, params, o.cache ? o.map + ".fsd" : "",
      [&](double share) { preparing.update(static_cast<std::size_t>(100 * share)); });
  if (!localizer->mapCacheProblem().empty()) {
    std::cerr << "warning: the density fields are not kept: " << localizer->mapCacheProblem()
              << "\n";
  }
  return localizer;
}

/// A run through the localiser: one entry per update, and what could not be used.
struct Replay {
  std::vector<hyselam::StampedPose2> trajectory;
  std::vector<double> update_ms;
  std::size_t without_odometry = 0, refused = 0;
  double travelled = 0.0;
  nlohmann::json converged_at = nullptr;
  nlohmann::json phases = nlohmann::json::array();

  void add(const fsd_localization::LocalizationResult& result) {
    trajectory.push_back({result.stamp, result.base_in_map});
    travelled = result.travelled;
    if (result.converged && converged_at.is_null()) converged_at = result.travelled;
    const std::string phase = toString(result.phase);
    if (phases.empty() || phases.back()["phase"] != phase) {
      phases.push_back(
          {{"phase", phase}, {"travelled_m", result.travelled}, {"stamp", result.stamp}});
    }
  }
};

using Update = std::function<std::optional<fsd_localization::LocalizationResult>(
    const hyselam::LaserScan&, const Pose2&)>;

Replay replay(const Update& update, const hyselam::RobotLog& log,
              const std::vector<hyselam::StampedPose2>& truth, const Options& o,
              LocalizationScore& score) {
  const double begin = log.scans.front().stamp + o.start;
  hyselam::Progress progress("localising", log.scans.size());
  Replay out;
  std::size_t index = 0;
  double travelled = 0.0;
  for (const hyselam::LaserScan& scan : log.scans) {
    progress.update(++index);
    if (scan.stamp < begin) continue;
    if (o.duration > 0.0 && scan.stamp > begin + o.duration) break;
    if (o.distance > 0.0 && travelled > o.distance) break;
    const auto odom = hyselam::poseAt(log.odometry, scan.stamp, 0.2);
    if (!odom) {
      ++out.without_odometry;
      continue;
    }
    const auto t0 = std::chrono::steady_clock::now();
    std::optional<fsd_localization::LocalizationResult> result;
    try {
      result = update(scan, *odom);
    } catch (const hyselam::InputError& e) {
      if (out.refused++ == 0) {
        std::cerr << "warning: scan at " << std::fixed << scan.stamp << " s: " << e.what() << "\n";
      }
      continue;
    }
    if (!result) continue;
    out.update_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - t0).count());
    out.add(*result);
    travelled = result->travelled;
    if (const auto at = hyselam::poseAt(truth, scan.stamp, 0.05)) {
      score.add(*result, *at);
    }
  }
  return out;
}

nlohmann::json run(const Options& o) {
  const fsd_localization::LocalizerParams params = localizerParams(o);
  const hyselam::OccupancyGrid map = hyselam::loadMap(o.map);
  hyselam::RobotLog log = hyselam::readRobotLog(o.log, o.bag_options);
  std::vector<hyselam::StampedPose2> truth = log.ground_truth;
  if (!o.reference.empty()) truth = hyselam::readPoses(o.reference).poses;
  if (log.scans.front().stamp + o.start > log.scans.back().stamp) {
    throw hyselam::InputError(o.log, "--start " + std::to_string(o.start),
                              "lies after the last scan");
  }

  std::vector<fsd_localization::Stand> stands;
  if (o.alterations.kidnaps > 0 || o.alterations.stops > 0) {
    fsd_localization::AlteredLog altered = fsd_localization::altered(log, truth, o.alterations);
    log = std::move(altered.log);
    truth = log.ground_truth;
    stands = std::move(altered.stands);
  }
  const auto localizer = makeLocalizer(map, params, o);
  localizer->keepLocalMap(false);
  if (o.start_known) {
    const double begin = log.scans.front().stamp + o.start;
    const auto scan = std::find_if(log.scans.begin(), log.scans.end(),
                                   [&](const auto& s) { return s.stamp >= begin; });
    const auto at = hyselam::poseAt(truth, scan->stamp, 1.0);
    if (!at) throw hyselam::InputError(o.log, "--start-known", "no true pose at the first scan");
    localizer->setInitialPose(*at, {0.5, 0.5, hyselam::radians(15.0)});
  }
  std::optional<fsd_localization::SearchAlone> alone;
  if (o.search_alone) alone.emplace(map, params);
  const Update update = [&](const hyselam::LaserScan& scan, const Pose2& odom) {
    return alone ? alone->update(scan, odom) : localizer->update(scan, odom);
  };
  const std::clock_t cpu = std::clock();
  LocalizationScore score({o.success_m, o.success_deg});
  const Replay result = replay(update, log, truth, o, score);
  const double cpu_s = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  if (result.trajectory.empty()) {
    throw hyselam::InputError(o.log, "", "no scan could be used for an update");
  }
  if (!o.trajectory.empty()) hyselam::writeTum(o.trajectory, result.trajectory);
  if (!o.updates.empty()) {
    hyselam::writeFileAtomically(o.updates, [&](std::ostream& out) { score.writeTable(out); });
  }

  std::vector<double> sorted = result.update_ms;
  std::sort(sorted.begin(), sorted.end());
  nlohmann::json j = {{"model", o.model},
                      {"particles", o.particles},
                      {"seed", o.seed},
                      {"updates", result.trajectory.size()},
                      {"median_update_ms", sorted[sorted.size() / 2]},
                      {"worst_update_ms", sorted.back()},
                      {"cpu_s", cpu_s},
                      {"travelled_m", result.travelled},
                      {"converged_at_m", result.converged_at},
                      {"phases", result.phases},
                      {"scans_without_odometry", result.without_odometry},
                      {"scans_refused", result.refused}};
  if (!score.empty()) {
    j["against_reference"] = score.report();
    if (!stands.empty()) j["against_reference"]["stands"] = score.stands(stands);
  }
  if (result.converged_at.is_null()) {
    std::cerr << "warning: never sure in " << std::lround(result.travelled)
              << " m: is this the right map?\n";
  }
  std::cout << j.dump(2) << "\n";
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Localises a recorded run on a map, offline.", "localize_offline");
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("--map", o.map, "map (map_server YAML)")->required();
  app.add_option("--bag", o.log, "bag or CARMEN log, plain or gzip")->required();
  hyselam::addBagOptions(app, &o.bag_options);
  app.add_option("--model", o.model, "fsd, beam, cosine, likelihood or hybrid");
  app.add_option("--particles", o.particles, "particles of the search");
  app.add_option("--kernel", o.kernel,
                 "profile of the density kernels: uniform, gaussian or inverted");
  app.add_option("--bandwidths", o.bandwidths, "bandwidths of the density kernels [m]")
      ->delimiter(',');
  app.add_option("--seed", o.seed, "equal seeds give equal results");
  app.add_option("--start", o.start, "seconds to skip at the beginning; the robot starts there")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--duration", o.duration, "seconds to use; 0: to the end")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--distance", o.distance, "metres of travel to use; 0: to the end")
      ->check(CLI::NonNegativeNumber);
  auto* kidnaps =
      app.add_option("--kidnaps", o.alterations.kidnaps,
                     "times that the robot is carried off: a part of the log, "
                     "over 30 s long and ending 5 to 25 m away, is cut out, unknown to the wheels");
  app.add_option("--stops", o.alterations.stops, "times that it stops on its way for --stand")
      ->excludes(kidnaps);
  app.add_option("--stand", o.alterations.stand,
                 "seconds that it is left standing where it was carried, or stops: its scan comes "
                 "again, ten times a second")
      ->check(CLI::Range(0.0, 3600.0));
  app.add_option("--crowd", o.alterations.crowd,
                 "share of the beams that people hide meanwhile, 0.6 m before the laser")
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--start-known", o.start_known, "the first pose is told, to 0.5 m and 15 degrees");
  app.add_flag("--raw-odometry", o.raw_odometry, "odometry is not refined by scans");
  app.add_flag("--without-search", o.without_search, "the filter alone, without search by submaps");
  app.add_flag("--without-short-term", o.without_short_term,
               "what only the present has counts in tracking");
  app.add_flag("--cache", o.cache, "keep the density fields beside the map (MAP.yaml.fsd)");
  auto* alone =
      app.add_flag("--search-alone", o.search_alone, "the search by submaps alone, without filter");
  for (const char* without_effect :
       {"--model", "--particles", "--seed", "--kernel", "--bandwidths", "--start-known",
        "--raw-odometry", "--without-search", "--without-short-term", "--cache"}) {
    alone->excludes(without_effect);
  }
  app.add_option("--reference", o.reference,
                 "true poses (TUM, or a reference table); default: the bag's ground truth, if any");
  app.add_option("--trajectory", o.trajectory,
                 "estimated poses to write (TUM), one per update; guesses before converged_at_m");
  app.add_option("--updates", o.updates,
                 "table to write (CSV), one line per update with a true pose");
  app.add_option("--place-odds", o.place_odds,
                 "bias, margin, unexplained and length of the judge of places (bench/place_judge)")
      ->delimiter(',')
      ->expected(4);
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
