// train_semantic: learns the classes of regions in simulated buildings.
#include <iostream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_sim/generate_corridors.hpp"
#include "hyselam_sim/simulation.hpp"
#include "ngram_slam/semantics/semantic_forest.hpp"
#include "semantic_runs.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header

struct Options {
  SemanticRunOptions run;
  ForestParams forest;
  std::uint64_t seed = 1;
  int buildings = 100, held_out = 30;
  std::string out;
};

/// Simulates the building of that number. Seeds of training and testing never meet.
SemanticRun drive(const Options& o, int number) {
  const std::uint64_t seed = hyselam::mix(o.seed, static_cast<std::uint64_t>(number));
  const hyselam_sim::CorridorBuilding building = hyselam_sim::generateCorridors(seed);
  hyselam_sim::SimulationParams params;
  const auto log = hyselam_sim::simulate(building.plan, building.route, seed, params).log;
  return semanticRun(log, o.run, nullptr, &building.plan);
}

/// The class of the place that lies in a region with at least half of its observations, the largest
/// of several; regions are longer than the corners and bifurcations in them. Without such a place
/// the class that most observations have.
std::optional<SemanticClass> classOf(const SemanticRegion& region, const SemanticRun& run) {
  std::array<std::uint32_t, kSemanticClasses> counts{};
  std::optional<SemanticClass> place_class;
  std::uint32_t largest = 0;
  for (std::uint32_t i = region.first; i <= region.last; ++i) {
    const auto& truth = run.truth[i];
    if (!truth) continue;
    ++counts[indexOf(*truth)];
    const bool begins = i == region.first || run.truth[i - 1] != truth;
    if (!begins || truth == SemanticClass::kCorridor) continue;
    std::uint32_t first = i, last = i;
    while (first > 0 && run.truth[first - 1] == truth) --first;
    while (last + 1 < run.truth.size() && run.truth[last + 1] == truth) ++last;
    const std::uint32_t inside = std::min(last, region.last) - i + 1;
    if (2 * inside >= last - first + 1 && inside > largest) {
      largest = inside;
      place_class = truth;
    }
  }
  if (place_class) return place_class;
  const auto most = std::max_element(counts.begin(), counts.end());
  if (*most == 0) return std::nullopt;
  return kAllSemanticClasses[static_cast<std::size_t>(most - counts.begin())];
}

void classify(SemanticRun& run, const SemanticClassifier& classifier) {
  for (SemanticRegion& r : run.regions) {
    const SemanticVerdict verdict = classifier.classify(r.features);
    r.semantic_class = verdict.semantic_class;
    r.confidence = verdict.confidence;
  }
}

nlohmann::json train(const Options& o) {
  o.run.semantics.validate();
  o.forest.validate();
  if (o.buildings < 1 || o.buildings > 100000)
    throw hyselam::ParameterError("--buildings", o.buildings, "in 1 .. 100000");
  if (o.held_out < 0 || o.held_out > 100000)
    throw hyselam::ParameterError("--held-out", o.held_out, "in 0 .. 100000");
  hyselam::Progress progress("buildings", static_cast<std::size_t>(o.buildings + o.held_out));
  std::vector<SemanticExample> examples;
  for (int i = 0; i < o.buildings; ++i) {
    const SemanticRun run = drive(o, i);
    for (const SemanticRegion& r : run.regions)
      if (const auto c = classOf(r, run)) examples.push_back({r.features, *c});
    progress.update(static_cast<std::size_t>(i + 1));
  }
  const SemanticForest forest = SemanticForest::train(examples, o.forest);
  if (!o.out.empty()) forest.save(o.out);

  SemanticConfusion by_forest, by_tree;
  for (int i = 0; i < o.held_out; ++i) {
    SemanticRun run = drive(o, o.buildings + i);
    by_tree.add(compareClasses(run.truth, classesOf(run), 10, BorderRule::kStrict));
    classify(run, forest);
    by_forest.add(compareClasses(run.truth, classesOf(run), 10, BorderRule::kStrict));
    progress.update(static_cast<std::size_t>(o.buildings + i + 1));
  }
  nlohmann::json j = {{"buildings", o.buildings}, {"examples", examples.size()}, {"seed", o.seed}};
  if (o.held_out > 0)
    j["held_out"] = {
        {"buildings", o.held_out}, {"forest", toJson(by_forest)}, {"tree", toJson(by_tree)}};
  std::cout << j.dump(2) << "\n";
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Simulates runs through made-up corridor networks, learns a random forest of the classes of "
      "regions from them, and measures it and the decision tree on others.",
      "train_semantic");
  Options o;
  o.run.addTo(app);
  app.add_option("--out", o.out, "file for the forest");
  app.add_option("--buildings", o.buildings, "to learn from");
  app.add_option("--held-out", o.held_out, "further ones to measure with");
  app.add_option("--seed", o.seed, "of the buildings and of all noise");
  app.add_option("--trees", o.forest.trees, "of the forest");
  app.add_option("--depth", o.forest.depth, "of a tree at most");
  return hyselam::runTool(argc, argv, app, [&] { return train(o); });
}
