// train_way_regions: learns the kinds of regions along ways from recorded runs with drawings and in
// simulated buildings.
#include <algorithm>
#include <array>
#include <iostream>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/generate_corridors.hpp"
#include "hyselam_sim/simulation.hpp"
#include "way_runs.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header

struct Options {
  std::vector<std::string> logs, references, plans;
  int buildings = 60;
  std::uint64_t seed = 1;
  double simulated_weight = 0.5;
  WayForestParams forest;
  std::string out, out_without_each;
};

/// What was learnt from one log, or from all simulated buildings.
struct Lesson {
  std::string name;
  std::vector<WayExample> examples;
};

constexpr double kKeyframeStep = 0.25;  // [m]
constexpr double kKeyframeTurn = 0.2;   // [rad]
constexpr int kLegs = 16;

void appendExamples(const std::vector<WayRun>& runs, const hyselam_sim::FloorPlan& plan,
                    std::vector<WayExample>* examples) {
  for (const WayRun& run : runs) {
    const auto features = wayFeaturesOf(run.places);
    for (std::size_t i = 0; i < features.size(); ++i) {
      if (!run.truth[i]) continue;
      const auto kind = semanticClassFromString(plan.kindAt({run.truth[i]->x, run.truth[i]->y}));
      if (kind) examples->push_back({features[i], *kind, 1.0});
    }
  }
}

/// A building of one of four sorts, in turn: bare corridors; offices; furnished halls; offices with
/// more furniture.
hyselam_sim::CorridorParams buildingParams(int number) {
  hyselam_sim::CorridorParams p;
  p.legs = kLegs;
  p.offices = number % 2 == 1 ? 0.7 : 0.0;
  p.furniture = number % 4 > 1 ? 0.15 : 0.05;
  if (number % 4 == 2) {
    p.halls = 0.5;
    p.max_hall = 24.0;
    p.min_spacing = 12.0;
    p.max_spacing = 34.0;
  }
  return p;
}

/// A simulated run with keyframes at its true poses; nothing where things block the way.
std::vector<WayRun> drive(const hyselam_sim::CorridorBuilding& building, std::uint64_t seed) {
  PlaceLog out;
  hyselam::RobotLog log;
  try {
    log = hyselam_sim::simulate(building.plan, building.route, seed).log;
  } catch (const hyselam::InputError&) {
    return {};
  }
  for (const hyselam::LaserScan& scan : log.scans) {
    const auto pose = hyselam::poseAt(log.ground_truth, scan.stamp, 0.5);
    if (!pose) continue;
    if (!out.keyframes.empty()) {
      const hyselam::Pose2& last = out.keyframes.back().pose;
      const double turn = std::abs(hyselam::normalizeAngle(pose->theta - last.theta));
      if (distance(last, *pose) < kKeyframeStep && turn < kKeyframeTurn) continue;
    }
    SlamKeyframe keyframe;
    keyframe.stamp = scan.stamp;
    keyframe.pose = *pose;
    keyframe.scan = std::make_shared<hyselam::LaserScan>(scan);
    out.keyframes.push_back(keyframe);
  }
  SignatureSensor sensor(waySensorParams(), [&](const PlaceOnWay& at, const PlaceFeatures& f) {
    out.places.push_back({at, stampOf(at, out.keyframes), f, at.pose});
  });
  for (std::size_t k = 0; k < out.keyframes.size(); ++k) {
    sensor.add(static_cast<std::int64_t>(k), out.keyframes[k].pose, out.keyframes[k].scan);
  }
  sensor.finish();
  return wayRunsOf(out);
}

/// A lesson of many places counts more than one of few, but not as much more.
void weigh(double factor, Lesson* lesson) {
  const double weight = factor / std::sqrt(static_cast<double>(lesson->examples.size()));
  for (WayExample& e : lesson->examples) e.weight = weight;
}

std::vector<Lesson> lessonsOf(const Options& o) {
  std::vector<Lesson> lessons;
  const std::size_t drawings = o.logs.empty() ? 0 : o.plans.size() / o.logs.size();
  for (std::size_t i = 0; i < o.logs.size(); ++i) {
    const hyselam::RobotLog log = hyselam::readRobotLog(o.logs[i]);
    const PlaceLog places =
        placesOf(nameOfLog(o.logs[i]), log,
                 referenceOf(o.references.empty() ? "" : o.references[i], log), waySensorParams());
    const std::vector<WayRun> runs = wayRunsOf(places);
    Lesson lesson{places.name, {}};
    for (std::size_t d = 0; d < drawings; ++d) {
      const std::string& file = o.plans[d * o.logs.size() + i];
      appendExamples(runs, hyselam_sim::loadFloorPlan(hyselam_sim::planFile(file)),
                     &lesson.examples);
    }
    if (lesson.examples.empty()) {
      throw hyselam::InputError(o.logs[i], "", "has no place within its drawings");
    }
    weigh(1.0, &lesson);
    lessons.push_back(std::move(lesson));
  }
  hyselam::Progress progress("buildings", static_cast<std::size_t>(o.buildings));
  Lesson simulated{"simulated buildings", {}};
  for (int i = 0; i < o.buildings; ++i) {
    const std::uint64_t seed = hyselam::mix(o.seed, static_cast<std::uint64_t>(i));
    const auto building = hyselam_sim::generateCorridors(seed, buildingParams(i));
    appendExamples(drive(building, seed), building.plan, &simulated.examples);
    progress.update(static_cast<std::size_t>(i + 1));
  }
  if (!simulated.examples.empty()) {
    weigh(o.simulated_weight, &simulated);
    lessons.push_back(std::move(simulated));
  }
  return lessons;
}

double shareRight(const WayForest& forest, const std::vector<WayExample>& examples) {
  std::size_t right = 0;
  for (const WayExample& e : examples) {
    const ClassShares shares = forest.sharesOf(e.features);
    const auto best = std::max_element(shares.begin(), shares.end()) - shares.begin();
    right += indexOf(e.semantic_class) == static_cast<std::size_t>(best) ? 1 : 0;
  }
  return static_cast<double>(right) /
         static_cast<double>(std::max<std::size_t>(1, examples.size()));
}

/// The forest of all lessons but one, named for what it comes from.
WayForest learn(const std::vector<Lesson>& lessons, const std::string& left_out, const Options& o,
                nlohmann::json* scores) {
  std::vector<WayExample> examples;
  std::string names;
  std::uint32_t sum = 0;
  for (const Lesson& lesson : lessons) {
    if (lesson.name == left_out) continue;
    examples.insert(examples.end(), lesson.examples.begin(), lesson.examples.end());
    names += (names.empty() ? "" : ", ") + lesson.name;
  }
  for (const WayExample& e : examples) {
    sum = hyselam::crc32Of(
        {reinterpret_cast<const char*>(e.features.data()), e.features.size() * sizeof(float)}, sum);
  }
  char sum_text[16];
  std::snprintf(sum_text, sizeof(sum_text), "%08x", sum);
  WayForest forest = WayForest::train(examples, o.forest);
  const double in_sample = shareRight(forest, examples);
  ForestOrigin origin;
  origin.command = "train_way_regions LOG... --reference FILE... --drawing FILE... --buildings " +
                   std::to_string(o.buildings) + " --seed " + std::to_string(o.seed);
  origin.data = std::to_string(examples.size()) + " places: " + names + "; crc32 " + sum_text;
  origin.in_sample = std::to_string(in_sample) + " of the places right";
  origin.out_of_sample = "bench/semantics --real, docs/algorithms/regions.md";
  forest.setOrigin(origin);
  (*scores)[left_out.empty() ? "all" : "without " + left_out] = {
      {"examples", examples.size()}, {"in_sample", in_sample}, {"features_crc32", sum_text}};
  return forest;
}

nlohmann::json train(const Options& o) {
  o.forest.validate();
  if (o.buildings < 0 || o.buildings > 10000) {
    throw hyselam::ParameterError("--buildings", o.buildings, "0 to 10000");
  }
  if (!(o.simulated_weight > 0.0)) {
    throw hyselam::ParameterError("--simulated-weight", o.simulated_weight, "above 0");
  }
  if (o.logs.empty() && o.buildings == 0) {
    throw hyselam::ParameterError("--buildings", o.buildings, "at least 1 without logs");
  }
  if (!o.references.empty() && o.references.size() != o.logs.size()) {
    throw hyselam::ParameterError("--reference", o.references.size(), "one file for each log");
  }
  if (o.logs.empty() ? !o.plans.empty() : o.plans.empty() || o.plans.size() % o.logs.size() != 0) {
    throw hyselam::ParameterError("--drawing", o.plans.size(),
                                  "one for each log, or several rounds of them");
  }
  if (!o.out_without_each.empty() && o.logs.size() < 2) {
    throw hyselam::ParameterError("--out-without-each", o.logs.size(), "two logs or more");
  }
  const std::vector<Lesson> lessons = lessonsOf(o);
  nlohmann::json scores;
  const WayForest all = learn(lessons, "", o, &scores);
  if (!o.out.empty()) all.save(o.out);
  for (std::size_t i = 0; !o.out_without_each.empty() && i < o.logs.size(); ++i) {
    const std::string& name = lessons[i].name;
    learn(lessons, name, o, &scores).save(o.out_without_each + "/without-" + name + ".txt");
  }
  std::cout << scores.dump(2) << "\n";
  return scores;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Learns the kinds of regions (corridors, corners, bifurcations, dead ends, halls) along "
      "ways, "
      "from recorded runs on whose maps they were drawn, and in simulated furnished buildings. The "
      "same input gives the same bytes.",
      "train_way_regions");
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("logs", o.logs, "CARMEN logs or bags, plain or gzip");
  app.add_option(
      "--reference", o.references,
      "true poses of each log (TUM, a reference table, or a corrected log); default: the "
      "logs' ground truth");
  app.add_option("--drawing", o.plans,
                 "floor plan with areas of each log; all of one drawer, then all of the next one");
  app.add_option("--buildings", o.buildings, "simulated ones to learn from as well");
  app.add_option("--simulated-weight", o.simulated_weight,
                 "of all simulated buildings, where a log has 1, times the root of their places");
  app.add_option("--seed", o.seed, "of the buildings and of all noise");
  app.add_option("--forest-seed", o.forest.forest.seed, "of the draws of examples and features");
  app.add_option("--trees", o.forest.forest.trees, "of the forest");
  app.add_option("--out", o.out, "file for the forest");
  app.add_option("--out-without-each", o.out_without_each,
                 "folder for a forest for each log, without-LOG.txt, learnt from all but it");
  return hyselam::runTool(argc, argv, app, [&] { return train(o); });
}
