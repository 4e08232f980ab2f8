// evaluate_restarts: SLAM goes on in the map of a log's first half, from many places of its second
// half and with starts that are right, wrong, or unknown. When is the run tied to the map, and is
// that right?
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <iostream>
#include <limits>
#include <optional>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/robot_log.hpp"
#include "hyselam_common/tool.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "ngram_slam/slam/slam_score.hpp"
#include "place_logs.hpp"
#include "reference_poses.hpp"
#include "restart_questions.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header
using hyselam::Pose2;

const std::vector<std::string> kModes = {"right",  "3m",      "10m",  "90deg",
                                         "180deg", "unknown", "moved"};
const std::string kElsewhere = "elsewhere";  // the map of another log

struct Options {
  std::vector<std::string> logs;
  ReferenceFiles references;
  std::vector<std::string> modes = kModes;
  int starts = 20;
  double path = 60.0;
  std::uint64_t seed = 1;
  std::string questions;
  bool without_places = false;

  SlamParams params() const {
    SlamParams p;
    if (without_places) p.run_start.place_interval = 0.0;
    return p;
  }
};

constexpr double kMoved = 25.0;      // [m] driven while SLAM was off
constexpr double kKnownPlace = 2.0;  // [m] from a keyframe of the first half
constexpr double kTolerance = 0.5;   // [s] between a scan and its true pose

struct Step {
  const hyselam::LaserScan* scan;
  Pose2 odometry;
  std::optional<Pose2> truth;
  double way;  // [m] by odometry
};

struct Log {
  std::string name;
  hyselam::RobotLog log;
  Reference told;
  std::vector<hyselam::StampedPose2> reference;  // with headings as scans tell them
  std::vector<Step> steps;
};

Log readLog(const std::string& path, const ReferenceFiles& references, std::size_t i) {
  Log out;
  out.name = nameOfLog(path);
  out.log = hyselam::readRobotLog(path);
  out.told = references.read(i, out.log);
  double way = 0.0;
  for (const hyselam::LaserScan& scan : out.log.scans) {
    const auto odometry = hyselam::poseAt(out.log.odometry, scan.stamp, 0.2);
    if (!odometry) continue;
    if (!out.steps.empty()) way += distance(out.steps.back().odometry, *odometry);
    out.steps.push_back({&scan, *odometry, std::nullopt, way});
  }
  if (out.steps.empty()) throw hyselam::InputError(path, "", "has no scan with odometry");
  if (out.told.poses.empty()) {
    throw hyselam::InputError(path, "", "has no true poses: give --reference");
  }
  return out;
}

/// What was asked of the scans, and what they answered.
using Watch = std::function<void(const SlamJobResult&)>;

void add(SlamEngine* engine, const Step& step, const Watch& watch = {}) {
  try {
    engine->add(*step.scan, step.odometry);
  } catch (const hyselam::InputError&) {  // of one scan
  }
  while (const auto job = engine->takeJob()) {
    const SlamJobResult result = runJob(*job);
    if (watch) watch(result);
    engine->apply(result);
  }
}

/// The keyframes of the first half, by where they truly were taken.
class TrueKeyframes {
 public:
  TrueKeyframes() = default;
  TrueKeyframes(const std::vector<SlamKeyframe>& keyframes, const Log& log) {
    for (const SlamKeyframe& k : keyframes) {
      truths_.push_back(hyselam::poseAt(log.reference, k.stamp, kTolerance));
    }
  }
  /// The nearest one.
  std::size_t nearest(const Pose2& truth) const {
    std::optional<std::size_t> found;
    for (std::size_t k = 0; k < truths_.size(); ++k) {
      if (truths_[k] &&
          (!found || distance(*truths_[k], truth) < distance(*truths_[*found], truth))) {
        found = k;
      }
    }
    if (!found) throw hyselam::InputError("reference", "", "has no pose of the first half");
    return *found;
  }
  /// A true pose in a map of these keyframes, first in it.
  Pose2 inMap(const Pose2& truth, const std::vector<SlamKeyframe>& keyframes) const {
    const std::size_t k = nearest(truth);
    return keyframes[k].pose * between(*truths_[k], truth);
  }
  Pose2 inMap(const Pose2& truth, const std::vector<Pose2>& keyframes) const {
    const std::size_t k = nearest(truth);
    return keyframes[k] * between(*truths_[k], truth);
  }
  double distanceTo(const Pose2& truth) const { return distance(*truths_[nearest(truth)], truth); }

 private:
  std::vector<std::optional<Pose2>> truths_;
};

/// The first half, and the whole log without a break.
struct Mapped {
  SlamState state;                     // after the first half
  TrueKeyframes truths;                // of it
  std::size_t half = 0;                // step
  std::vector<SlamKeyframe> unbroken;  // all keyframes
  std::vector<hyselam::StampedPose2> unbroken_path;
  std::vector<std::optional<double>> live;  // error of the run without a break, by step [m]
};

/// Poses as they were while the robot drove, with those of the first half's keyframes then.
class LivePoses {
 public:
  void note(const SlamEngine& engine, std::size_t keyframes) {
    if (maps_.empty() || engine.revision() != revision_) {
      revision_ = engine.revision();
      maps_.emplace_back();
      for (std::size_t k = 0; k < keyframes; ++k)
        maps_.back().push_back(engine.keyframes()[k].pose);
    }
    poses_.emplace_back(engine.pose(), maps_.size() - 1);
  }
  const Pose2& pose(std::size_t i) const { return poses_[i].first; }
  const std::vector<Pose2>& map(std::size_t i) const { return maps_[poses_[i].second]; }

 private:
  std::vector<std::vector<Pose2>> maps_;
  std::vector<std::pair<Pose2, std::size_t>> poses_;
  int revision_ = 0;
};

/// Maps the log, and puts the true poses into its steps.
Mapped mapOf(Log* mapped) {
  Log& log = *mapped;
  Mapped out;
  LivePoses live;  // from the half on
  while (log.steps[out.half].way < 0.5 * log.steps.back().way) ++out.half;
  SlamEngine engine;
  hyselam::Progress progress("map of " + log.name, log.steps.size());
  for (std::size_t i = 0; i < log.steps.size(); ++i) {
    progress.update(i + 1);
    if (i == out.half) {
      out.state = engine.state();
    }
    add(&engine, log.steps[i]);
    if (i >= out.half) live.note(engine, out.state.keyframes.size());
  }
  engine.endRun();
  while (const auto job = engine.takeFinalJob()) engine.apply(runJob(*job));
  out.unbroken = engine.keyframes();
  out.unbroken_path = engine.trajectory();
  log.reference = withTurnsOf(out.unbroken_path, log.told);
  out.truths = TrueKeyframes(out.state.keyframes, log);
  out.live.resize(log.steps.size());
  for (std::size_t i = 0; i < log.steps.size(); ++i) {
    Step& step = log.steps[i];
    step.truth = hyselam::poseAt(log.reference, step.scan->stamp, kTolerance);
    if (!step.truth || i < out.half) continue;
    const std::size_t n = i - out.half;
    out.live[i] = distance(live.pose(n), out.truths.inMap(*step.truth, live.map(n)));
  }
  return out;
}

struct Outcome {
  bool tied = false, right = false, wrong = false;
  double until_tied = 0.0;        // [m]
  double known_until_tied = 0.0;  // of it, where the first half had been [m]
  // Means over the scans after it was tied, in known places [m]: as the robot drove, and of the
  // paths that both runs have at their ends.
  double error = 0.0, unbroken = 0.0;
  double end_error = 0.0, end_unbroken = 0.0;
  int withdrawn = 0;
};

void begin(const std::string& mode, const Pose2& right, const Pose2& before, hyselam::Rng* rng,
           SlamEngine* engine) {
  const auto beside = [&](double distance) {
    const double angle = rng->uniform(-hyselam::kPi, hyselam::kPi);
    return Pose2{right.x + distance * std::cos(angle), right.y + distance * std::sin(angle),
                 right.theta};
  };
  const double turn = rng->uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
  if (mode == "unknown") return engine->startRunAnywhere();
  if (mode == "moved") return engine->startRun(before);
  if (mode == "3m") return engine->startRun(beside(3.0));
  if (mode == "10m") return engine->startRun(beside(10.0));
  if (mode == "90deg") return engine->startRun(right * Pose2{0.0, 0.0, turn * hyselam::kPi / 2.0});
  if (mode == "180deg") return engine->startRun(right * Pose2{0.0, 0.0, hyselam::kPi});
  return engine->startRun(right);
}

bool isTiedWrongly(const SlamEngine& engine, const Log& log, std::uint32_t run) {
  return std::any_of(engine.loops().begin(), engine.loops().end(), [&](const SlamLoop& l) {
    const SlamKeyframe& older = engine.keyframes()[static_cast<std::size_t>(l.older)];
    const SlamKeyframe& newer = engine.keyframes()[static_cast<std::size_t>(l.newer)];
    if (!l.far || !isUsed(l) || (older.run == run) == (newer.run == run)) return false;
    const auto error = loopError(older, newer, l.measured, log.reference);
    return error && error->isFalse();
  });
}

Outcome restart(const Log& log, const Mapped& mapped, const std::string& mode, std::size_t first,
                const Options& o, const std::string& start, RestartQuestions* questions,
                hyselam::Rng* rng) {
  SlamEngine engine(o.params(), mapped.state);
  const std::uint32_t run = engine.keyframes().back().run + 1;
  std::size_t before = first;
  while (before > 0 && log.steps[first].way - log.steps[before].way < kMoved) --before;
  const auto& saved = mapped.state.keyframes;
  const auto inMap = [&](const std::optional<Pose2>& truth) {
    return mapped.truths.inMap(truth.value_or(*log.steps[first].truth), saved);
  };
  begin(mode, inMap(log.steps[first].truth), inMap(log.steps[before].truth), rng, &engine);
  Watch watch;
  if (questions->wanted()) {
    watch = [&](const SlamJobResult& r) { questions->note(start, engine, &log.reference, r); };
  }
  Outcome out;
  std::vector<const Step*> compared;
  std::size_t loops = 0;
  for (std::size_t i = first;
       i < log.steps.size() && log.steps[i].way - log.steps[first].way < o.path; ++i) {
    const Step& step = log.steps[i];
    add(&engine, step, watch);
    out.tied = engine.runPlace() == RunPlace::kTied;
    if (!step.truth) continue;
    if (!out.tied) {
      out.until_tied = step.way - log.steps[first].way;
      if (i > first && mapped.truths.distanceTo(*step.truth) < kKnownPlace) {
        out.known_until_tied += step.way - log.steps[i - 1].way;
      }
      continue;
    }
    if (loops != engine.loops().size()) out.wrong = out.wrong || isTiedWrongly(engine, log, run);
    loops = engine.loops().size();
    if (mapped.truths.distanceTo(*step.truth) >= kKnownPlace) continue;
    const Pose2 right = mapped.truths.inMap(*step.truth, engine.keyframes());
    const double error = distance(engine.pose(), right);
    out.error += error;
    out.unbroken += *mapped.live[i];
    out.right =
        error < 1.0 && std::abs(hyselam::normalizeAngle(engine.pose().theta - right.theta)) < 0.35;
    compared.push_back(&step);
  }
  out.right = out.right && out.tied;
  out.withdrawn = engine.tiesWithdrawn();
  if (compared.empty()) return out;
  const auto n = static_cast<double>(compared.size());
  out.error /= n;
  out.unbroken /= n;
  engine.endRun();
  while (const auto job = engine.takeFinalJob()) engine.apply(runJob(*job));
  const auto meanError = [&](const std::vector<hyselam::StampedPose2>& trajectory,
                             const std::vector<SlamKeyframe>& keyframes) {
    double sum = 0.0;
    int summed = 0;
    for (const Step* s : compared) {
      const auto pose = hyselam::poseAt(trajectory, s->scan->stamp, 0.1);
      if (!pose) continue;
      sum += distance(*pose, mapped.truths.inMap(*s->truth, keyframes));
      ++summed;
    }
    return summed > 0 ? sum / summed : std::numeric_limits<double>::quiet_NaN();
  };
  out.end_error = meanError(engine.trajectory(), engine.keyframes());
  out.end_unbroken = meanError(mapped.unbroken_path, mapped.unbroken);
  return out;
}

/// The scans of the second half from which the robot drives on in places of the first: half of the
/// next metres, at least.
std::vector<std::size_t> knownStarts(const Log& log, const Mapped& mapped) {
  constexpr double kAhead = 20.0;  // [m]
  std::vector<bool> known;
  for (const Step& step : log.steps) {
    known.push_back(step.truth && mapped.truths.distanceTo(*step.truth) < kKnownPlace);
  }
  std::vector<std::size_t> starts;
  for (std::size_t i = mapped.half; i < log.steps.size(); ++i) {
    if (!known[i] || log.steps[i].way + kAhead > log.steps.back().way) continue;
    double ahead = 0.0, in_known = 0.0;
    for (std::size_t k = i + 1; k < log.steps.size() && ahead < kAhead; ++k) {
      const double step = log.steps[k].way - log.steps[k - 1].way;
      ahead += step;
      if (known[k]) in_known += step;
    }
    if (in_known >= 0.5 * ahead) starts.push_back(i);
  }
  return starts;
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(q * static_cast<double>(values.size())))];
}

nlohmann::json figuresOf(const std::vector<Outcome>& all) {
  nlohmann::json each = nlohmann::json::array();
  std::vector<double> ways, known;
  int right = 0, wrong = 0, withdrawn = 0, tied = 0;
  double error = 0.0, unbroken = 0.0, end_error = 0.0, end_unbroken = 0.0;
  for (const Outcome& o : all) {
    ways.push_back(o.until_tied);
    known.push_back(o.known_until_tied);
    right += o.right;
    wrong += o.wrong;
    withdrawn += o.withdrawn;
    each.push_back({{"right", o.right},
                    {"wrong_tie", o.wrong},
                    {"until_tied_m", o.until_tied},
                    {"known_until_tied_m", o.known_until_tied},
                    {"error_m", o.error},
                    {"unbroken_error_m", o.unbroken},
                    {"end_error_m", o.end_error},
                    {"end_unbroken_error_m", o.end_unbroken}});
    if (!o.right) continue;
    ++tied;
    error += o.error;
    unbroken += o.unbroken;
    end_error += o.end_error;
    end_unbroken += o.end_unbroken;
  }
  const double n = std::max(1, tied);
  return {{"starts", all.size()},
          {"right", right},
          {"wrong_ties", wrong},
          {"withdrawn", withdrawn},
          {"median_m", quantile(ways, 0.5)},
          {"p90_m", quantile(ways, 0.9)},
          {"known_median_m", quantile(known, 0.5)},
          {"known_p90_m", quantile(known, 0.9)},
          {"worst_m", quantile(ways, 1.0)},
          {"error_m", error / n},
          {"unbroken_error_m", unbroken / n},
          {"end_error_m", end_error / n},
          {"end_unbroken_error_m", end_unbroken / n},
          {"each", each}};
}

/// Runs of a log in the map of another building: how many are tied to it.
nlohmann::json elsewhere(const Log& log, const Mapped& mapped, const Log& other, const Options& o,
                         RestartQuestions* questions) {
  int tied = 0;
  hyselam::Rng rng(o.seed);
  hyselam::Progress progress(log.name + " in " + other.name, static_cast<std::size_t>(o.starts));
  for (int s = 0; s < o.starts; ++s) {
    progress.update(static_cast<std::size_t>(s) + 1);
    const double from = (s + rng.uniform(0.0, 1.0)) / o.starts * log.steps.back().way;
    std::size_t first = 0;
    while (log.steps[first].way < from) ++first;
    SlamEngine engine(o.params(), mapped.state);
    engine.startRunAnywhere();
    const std::string start = log.name + "," + kElsewhere + "," + std::to_string(s);
    Watch watch;
    if (questions->wanted()) {
      watch = [&](const SlamJobResult& r) { questions->note(start, engine, nullptr, r); };
    }
    for (std::size_t i = first;
         i < log.steps.size() && log.steps[i].way - log.steps[first].way < o.path; ++i) {
      add(&engine, log.steps[i], watch);
      if (engine.runPlace() != RunPlace::kTied) continue;
      ++tied;
      break;
    }
  }
  std::cout << "| " << log.name << " | in " << other.name << " | " << o.starts - tied << "/"
            << o.starts << " | | | | | " << tied << " | | | |\n"
            << std::flush;
  return {{"starts", o.starts}, {"wrong_ties", tied}};
}

nlohmann::json run(const Options& o) {
  if (o.starts < 1) throw hyselam::ParameterError("starts", o.starts, "at least 1");
  if (!(o.path > 0.0)) throw hyselam::ParameterError("path", o.path, "above 0 m");
  for (const std::string& mode : o.modes) {
    if (mode != kElsewhere && std::find(kModes.begin(), kModes.end(), mode) == kModes.end()) {
      throw hyselam::ParameterError("modes", mode,
                                    "right, 3m, 10m, 90deg, 180deg, unknown, moved, elsewhere");
    }
  }
  o.references.check(o.logs.size());
  RestartQuestions questions(o.questions);
  nlohmann::json json;
  std::cout << "| log | start | right | median until tied [m] | 90 % [m] | of it in known places: "
               "median | 90 % | wrong ties | withdrawn | "
               "error [m] | unbroken [m] | at the end: error [m] | unbroken [m] |\n"
               "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  std::vector<Log> logs;
  std::vector<Mapped> maps;
  for (std::size_t l = 0; l < o.logs.size(); ++l) {
    logs.push_back(readLog(o.logs[l], o.references, l));
    maps.push_back(mapOf(&logs.back()));
  }
  for (std::size_t l = 0; l < o.logs.size(); ++l) {
    const Log& log = logs[l];
    const Mapped& mapped = maps[l];
    const std::vector<std::size_t> known = knownStarts(log, mapped);
    if (known.empty()) {
      std::cerr << log.name << ": its second half does not drive where the first had been"
                << ": only runs elsewhere\n";
    }
    for (const std::string& mode : o.modes) {
      if (mode == kElsewhere) {
        for (std::size_t m = 0; m < logs.size(); ++m) {
          if (m == l) continue;
          json[log.name][mode][logs[m].name] = elsewhere(log, maps[m], logs[m], o, &questions);
        }
        continue;
      }
      if (known.empty()) continue;
      hyselam::Rng rng(o.seed);
      std::vector<Outcome> outcomes;
      hyselam::Progress progress(log.name + " " + mode, static_cast<std::size_t>(o.starts));
      for (int s = 0; s < o.starts; ++s) {
        progress.update(static_cast<std::size_t>(s) + 1);
        const double part = (s + rng.uniform(0.0, 1.0)) / o.starts;
        const std::size_t first =
            known[static_cast<std::size_t>(part * static_cast<double>(known.size()))];
        const std::string start = log.name + "," + mode + "," + std::to_string(s);
        outcomes.push_back(restart(log, mapped, mode, first, o, start, &questions, &rng));
      }
      const nlohmann::json f = figuresOf(outcomes);
      std::cout << std::fixed << std::setprecision(1) << "| " << log.name << " | " << mode << " | "
                << f["right"] << "/" << f["starts"] << " | " << f["median_m"].get<double>() << " | "
                << f["p90_m"].get<double>() << " | " << f["known_median_m"].get<double>() << " | "
                << f["known_p90_m"].get<double>() << " | " << f["wrong_ties"] << " | "
                << f["withdrawn"] << " | " << std::setprecision(3) << f["error_m"].get<double>()
                << " | " << f["unbroken_error_m"].get<double>() << " | "
                << f["end_error_m"].get<double>() << " | "
                << f["end_unbroken_error_m"].get<double>() << " |\n"
                << std::flush;
      json[log.name][mode] = f;
    }
  }
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Restarts of SLAM in the map of each log's first half, from places of its second half.",
      "evaluate_restarts");
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("logs", o.logs, "CARMEN logs or bags, plain or gzip")->required();
  o.references.addTo(app);
  app.add_option(
      "--modes", o.modes,
      "what is told of the start: right, 3m, 10m, 90deg, 180deg (off by so much), "
      "unknown, moved (25 m since); elsewhere: runs of each log in the maps of the others");
  app.add_option("--starts", o.starts, "of each mode");
  app.add_option("--path", o.path, "driven after each start [m]");
  app.add_option("--seed", o.seed, "of the starts");
  app.add_option("--questions", o.questions,
                 "CSV file of all places of the drawn map and all far loops between runs and map "
                 "that were asked for, with their true errors");
  app.add_flag("--without-places", o.without_places,
               "do not search the drawn map for the last metres: far loops alone tie a run");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
