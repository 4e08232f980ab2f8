// train_semantic: learns the classes of regions in simulated buildings.
#include <algorithm>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/checksum.hpp"
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
  std::string from, out, examples;
};

constexpr std::uint32_t kBorderTolerance = 10;  // [observations]

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
    const SemanticPrediction prediction = classifier.classify(r.features);
    r.semantic_class = prediction.semantic_class;
    r.confidence = prediction.confidence;
  }
}

/// The regions of a run whose class is known.
void appendExamples(const SemanticRun& run, std::vector<SemanticExample>* examples) {
  for (const SemanticRegion& r : run.regions) {
    if (const auto c = classOf(r, run)) examples->push_back({r.features, *c});
  }
}

/// Share of the examples that get their class; 0 without any.
double shareRight(const SemanticClassifier& classifier,
                  const std::vector<SemanticExample>& examples) {
  std::size_t right = 0;
  for (const SemanticExample& e : examples) {
    right += classifier.classify(e.features).semantic_class == e.semantic_class ? 1 : 0;
  }
  return examples.empty() ? 0.0 : static_cast<double>(right) / static_cast<double>(examples.size());
}

/// Forest and decision tree in buildings that neither has learned from.
struct HeldOut {
  std::vector<SemanticExample> examples;
  SemanticConfusion forest, tree;
};

HeldOut driveHeldOut(const Options& o, const SemanticForest& forest, hyselam::Progress* progress) {
  HeldOut held_out;
  for (int i = 0; i < o.held_out; ++i) {
    SemanticRun run = drive(o, o.buildings + i);
    appendExamples(run, &held_out.examples);
    held_out.tree.add(
        compareClasses(run.truth, classesOf(run), kBorderTolerance, BorderRule::kStrict));
    classify(run, forest);
    held_out.forest.add(
        compareClasses(run.truth, classesOf(run), kBorderTolerance, BorderRule::kStrict));
    progress->update(static_cast<std::size_t>(o.buildings + i + 1));
  }
  return held_out;
}

std::vector<SemanticExample> examplesToLearn(const Options& o, hyselam::Progress* progress) {
  if (!o.from.empty()) return readExamples(o.from);
  std::vector<SemanticExample> examples;
  for (int i = 0; i < o.buildings; ++i) {
    appendExamples(drive(o, i), &examples);
    progress->update(static_cast<std::size_t>(i + 1));
  }
  return examples;
}

/// What the file of the forest says about where it comes from.
ForestOrigin originOf(const Options& o, const std::string& command,
                      const std::vector<SemanticExample>& examples, const SemanticForest& forest,
                      const HeldOut& held_out) {
  const auto shareText = [&](const std::vector<SemanticExample>& of) {
    std::ostringstream out;
    out << std::fixed << std::setprecision(4) << shareRight(forest, of) << " of " << of.size()
        << " regions right";
    return out.str();
  };
  ForestOrigin origin;
  origin.command = command;
  origin.data = std::to_string(examples.size()) + " regions, " +
                (o.from.empty() ? "simulated buildings: " + std::to_string(o.buildings)
                                : std::string("from a table")) +
                ", crc32 " + hyselam::crc32Text(textOf(examples));
  origin.in_sample = shareText(examples);
  if (o.held_out > 0) {
    std::ostringstream out;
    out << shareText(held_out.examples) << ", other simulated buildings: " << o.held_out
        << "; share of their observations right " << std::fixed << std::setprecision(4)
        << held_out.forest.accuracy() << ", mean precision " << held_out.forest.averagePrecision()
        << ", mean recall " << held_out.forest.averageRecall() << ", strict borders";
    origin.out_of_sample = out.str();
  } else {
    origin.out_of_sample = "not scored";
  }
  return origin;
}

nlohmann::json train(const Options& o, const std::string& command) {
  o.run.semantics.validate();
  o.forest.validate();
  if (o.buildings < 1 || o.buildings > 100000) {
    throw hyselam::ParameterError("--buildings", o.buildings, "in 1 .. 100000");
  }
  if (o.held_out < 0 || o.held_out > 100000) {
    throw hyselam::ParameterError("--held-out", o.held_out, "in 0 .. 100000");
  }
  hyselam::Progress progress("buildings", static_cast<std::size_t>(o.buildings + o.held_out));
  const std::vector<SemanticExample> examples = examplesToLearn(o, &progress);
  if (!o.examples.empty()) {
    hyselam::writeFileAtomically(o.examples, [&](std::ostream& out) { out << textOf(examples); });
  }
  SemanticForest forest = SemanticForest::train(examples, o.forest);
  const HeldOut held_out = driveHeldOut(o, forest, &progress);
  forest.setOrigin(originOf(o, command, examples, forest, held_out));
  if (!o.out.empty()) forest.save(o.out);

  nlohmann::json j = {{"buildings", o.buildings},
                      {"examples", examples.size()},
                      {"seed", o.seed},
                      {"in_sample", shareRight(forest, examples)}};
  if (o.held_out > 0) {
    j["held_out"] = {{"buildings", o.held_out},
                     {"regions_right", shareRight(forest, held_out.examples)},
                     {"forest", toJson(held_out.forest)},
                     {"tree", toJson(held_out.tree)}};
  }
  std::cout << j.dump(2) << "\n";
  return j;
}

/// The command line, without the files that it writes.
std::string commandOf(const CLI::App& app) {
  std::string command = app.get_name();
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || name == "--out" || name == "--examples" || name == "--json") {
      continue;
    }
    command += " " + name;
    for (const std::string& value : option->results()) command += " " + value;
  }
  return command;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Simulates runs through made-up corridor networks, learns a random forest of the classes of "
      "regions from them, and scores it and the decision tree on others.",
      "train_semantic");
  Options o;
  o.run.addTo(app);
  app.add_option("--out", o.out, "file for the forest, with this command and its scores");
  app.add_option("--from", o.from, "table of examples to learn from, in place of buildings");
  app.add_option("--examples", o.examples, "table to write of the examples learned from (CSV)");
  app.add_option("--buildings", o.buildings, "to learn from");
  app.add_option("--held-out", o.held_out, "further ones to score with");
  app.add_option("--seed", o.seed, "of the buildings and of all noise");
  app.add_option("--trees", o.forest.trees, "of the forest");
  app.add_option("--depth", o.forest.depth, "of a tree at most");
  return hyselam::runTool(argc, argv, app, [&] { return train(o, commandOf(app)); });
}
