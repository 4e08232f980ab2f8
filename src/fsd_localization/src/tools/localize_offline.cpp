// localize_offline: a bag or CARMEN log through the same localiser as the nodelet, without a
// master.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>

#include "fsd_localization/localizer.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/ros/bag_tool.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_common/trajectory_io.hpp"

namespace {

using fsd_localization::KernelProfile;
using hyselam::Pose2;

struct Options {
  std::string map, log, model = "hybrid", kernel = "uniform", trajectory, reference;
  std::vector<double> bandwidths{1.5, 3.0, 5.0};
  std::size_t particles = 20000;
  std::uint64_t seed = 1;
  double start = 0.0, duration = 0.0, distance = 0.0, success_m = 0.5, success_deg = 15.0;
  bool cache = false;
  hyselam::BagOptions bag_options;
};

/// The estimates against the reference, if there is one.
class Score {
 public:
  explicit Score(const Options& o) : success_m_(o.success_m), success_deg_(o.success_deg) {}
  bool empty() const { return entries_.empty(); }

  void add(const Pose2& estimate, const Pose2& truth, double travelled, bool converged) {
    Entry e;
    e.travelled = travelled;
    e.error_m = hyselam::distance(estimate, truth);
    e.error_deg = hyselam::degrees(std::abs(hyselam::normalizeAngle(estimate.theta - truth.theta)));
    e.good = e.error_m < success_m_ && e.error_deg < success_deg_;
    e.converged = converged;
    if (!entries_.empty() &&
        hyselam::distance(truth_, truth) > travelled - entries_.back().travelled + kJump) {
      jumps_.push_back(entries_.size());
    }
    truth_ = truth;
    entries_.push_back(e);
  }

  nlohmann::json report() const {
    const std::size_t held = heldFrom(0, entries_.size());
    const bool success = held < entries_.size();
    nlohmann::json j = {{"success", success},
                        {"held_from_m", nullptr},
                        {"median_error_m", nullptr},
                        {"median_error_deg", nullptr},
                        {"wrongly_converged_m", wronglyConverged()},
                        {"kidnaps", kidnaps()}};
    if (!success) return j;
    j["held_from_m"] = entries_[held].travelled;
    j["median_error_m"] = median(held, &Entry::error_m);
    j["median_error_deg"] = median(held, &Entry::error_deg);
    return j;
  }

 private:
  static constexpr double kJump = 1.0;  // [m] more than was travelled: the robot was carried
  struct Entry {
    double travelled, error_m, error_deg;
    bool good, converged;
  };

  /// The first good estimate of [begin, end) after the last bad one; `end` if the last is bad.
  std::size_t heldFrom(std::size_t begin, std::size_t end) const {
    if (end == begin || !entries_[end - 1].good) return entries_.size();
    while (end > begin && entries_[end - 1].good) --end;
    return end;
  }
  /// Travel with false convergence [m].
  double wronglyConverged() const {
    double sum = 0.0;
    for (std::size_t i = 1; i < entries_.size(); ++i) {
      if (entries_[i].converged && !entries_[i].good) {
        sum += entries_[i].travelled - entries_[i - 1].travelled;
      }
    }
    return sum;
  }
  nlohmann::json kidnaps() const {
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = 0; i < jumps_.size(); ++i) {
      const std::size_t end = i + 1 < jumps_.size() ? jumps_[i + 1] : entries_.size();
      const std::size_t held = heldFrom(jumps_[i], end);
      const double at = entries_[jumps_[i]].travelled;
      nlohmann::json after = nullptr;
      if (held < end) after = entries_[held].travelled - at;
      list.push_back({{"at_m", at}, {"recovered_after_m", after}});
    }
    return list;
  }
  double median(std::size_t from, double Entry::*field) const {
    std::vector<double> v;
    for (std::size_t i = from; i < entries_.size(); ++i) v.push_back(entries_[i].*field);
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
  }

  double success_m_, success_deg_;
  Pose2 truth_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> jumps_;  // first entry after each
};

fsd_localization::LocalizerParams localizerParams(const Options& o) {
  fsd_localization::LocalizerParams p;
  p.model = fsd_localization::observationModelKindFromString(o.model);
  p.seed = o.seed;
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
  nlohmann::json converged_at = nullptr;
  nlohmann::json phases = nlohmann::json::array();

  void add(const fsd_localization::LocalizationResult& result) {
    trajectory.push_back({result.stamp, result.base_in_map});
    if (result.converged && converged_at.is_null()) converged_at = result.travelled;
    const std::string phase = toString(result.phase);
    if (phases.empty() || phases.back()["phase"] != phase) {
      phases.push_back(
          {{"phase", phase}, {"travelled_m", result.travelled}, {"stamp", result.stamp}});
    }
  }
};

Replay replay(fsd_localization::Localizer& localizer, const hyselam::RobotLog& log,
              const std::vector<hyselam::StampedPose2>& truth, const Options& o, Score& score) {
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
      result = localizer.update(scan, *odom);
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
      score.add(result->base_in_map, *at, result->travelled, result->converged);
    }
  }
  return out;
}

nlohmann::json run(const Options& o) {
  const fsd_localization::LocalizerParams params = localizerParams(o);
  const hyselam::OccupancyGrid map = hyselam::loadMap(o.map);
  const hyselam::RobotLog log = hyselam::readRobotLog(o.log, o.bag_options);
  std::vector<hyselam::StampedPose2> truth = log.ground_truth;
  if (!o.reference.empty()) truth = hyselam::readPoses(o.reference).poses;
  if (log.scans.front().stamp + o.start > log.scans.back().stamp) {
    throw hyselam::InputError(o.log, "--start " + std::to_string(o.start),
                              "lies after the last scan");
  }

  const auto localizer = makeLocalizer(map, params, o);
  Score score(o);
  const Replay result = replay(*localizer, log, truth, o, score);
  if (result.trajectory.empty()) {
    throw hyselam::InputError(o.log, "", "no scan could be used for an update");
  }
  if (!o.trajectory.empty()) hyselam::writeTum(o.trajectory, result.trajectory);

  std::vector<double> sorted = result.update_ms;
  std::sort(sorted.begin(), sorted.end());
  nlohmann::json j = {{"model", o.model},
                      {"particles", o.particles},
                      {"seed", o.seed},
                      {"updates", result.trajectory.size()},
                      {"median_update_ms", sorted[sorted.size() / 2]},
                      {"worst_update_ms", sorted.back()},
                      {"converged_at_m", result.converged_at},
                      {"phases", result.phases},
                      {"scans_without_odometry", result.without_odometry},
                      {"scans_refused", result.refused}};
  if (!score.empty()) j["against_reference"] = score.report();
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
  app.add_option("--reference", o.reference,
                 "true poses (TUM, or a reference table); default: the bag's ground truth, if any");
  app.add_option("--trajectory", o.trajectory, "estimated poses to write (TUM), one per update");
  app.add_flag("--cache", o.cache, "keep the density fields beside the map (MAP.yaml.fsd)");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
