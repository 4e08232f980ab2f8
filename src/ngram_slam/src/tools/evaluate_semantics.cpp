// evaluate_semantics: the classes of regions in recorded runs, against the plan of the building.
#include <iostream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/confusion_csv.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_sim/data.hpp"
#include "ngram_slam/semantics/semantic_forest.hpp"
#include "ngram_slam/semantics/semantic_regions_io.hpp"
#include "reference_poses.hpp"
#include "semantic_runs.hpp"
#include "way_runs.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header

struct Options {
  SemanticRunOptions run;
  DecisionTreeParams tree;
  std::vector<std::string> logs;
  ReferenceFiles references;
  WayDecisionParams decision;
  std::string plan, compared, model, way_model, confusion, regions, places;
  std::uint32_t tolerance = 10;
};

hyselam::ConfusionTable tableOf(const SemanticConfusion& confusion) {
  hyselam::ConfusionTable table;
  for (const SemanticClass truth : kAllSemanticClasses) {
    table.truth.emplace_back(toString(truth));
    table.predicted.emplace_back(toString(truth));
    const auto& row = confusion.counts[indexOf(truth)];
    table.counts.emplace_back(row.begin(), row.end());
  }
  return table;
}

/// A table, not a picture: scripts/plot_confusion draws it.
void requireCsv(const std::string& option, const std::string& path) {
  const std::string ending = ".csv";
  if (path.empty()) return;
  if (path.size() < ending.size() ||
      path.compare(path.size() - ending.size(), ending.size(), ending) != 0) {
    throw hyselam::ParameterError(option, path, "a .csv file; scripts/plot_confusion draws it");
  }
}

hyselam_sim::FloorPlan planOf(const std::string& name) {
  hyselam_sim::FloorPlan plan = hyselam_sim::loadFloorPlan(hyselam_sim::planFile(name));
  if (plan.areas.empty() && plan.floor_kind.empty()) {
    throw hyselam::InputError(plan.source, "keys 'areas', 'floor_kind'",
                              "missing: the plan does not say what its places are");
  }
  return plan;
}

/// Answers of another drawing. Where it says nothing, the truth is taken out too.
std::vector<SemanticClass> drawnClasses(const hyselam::RobotLog& log,
                                        const hyselam_sim::FloorPlan& drawing, SemanticRun* run) {
  std::vector<SemanticClass> classes;
  const auto drawn = truthOf(log, run->stamps, drawing);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (!drawn[i]) run->truth[i] = std::nullopt;
    classes.push_back(drawn[i].value_or(SemanticClass::kCorridor));
  }
  return classes;
}

/// The forest of places along the way, if it is asked for.
std::optional<WayForest> wayForestOf(const Options& o) {
  if (o.way_model.empty()) return std::nullopt;
  const bool other = !o.model.empty() || !o.compared.empty() || !o.regions.empty();
  if (other) {
    throw hyselam::ParameterError("--way-model", o.way_model,
                                  "without --model, --compare-plan and --regions");
  }
  o.decision.validate();
  return o.way_model == "shipped" ? WayForest::shipped() : WayForest::load(o.way_model);
}

std::vector<SemanticClass> wayClasses(const std::string& path, const hyselam::RobotLog& log,
                                      const std::vector<double>& stamps, const WayForest& forest,
                                      const WayDecisionParams& params) {
  const PlaceLog places = placesOf(nameOfLog(path), log, log.ground_truth, waySensorParams());
  return classesAt(stamps, wayRunsOf(places), forest, params);
}

/// Where each observation was made, what the plan says of it and what was answered: for
/// bench/regions/draw.
void writePlaces(const std::string& path, const hyselam::RobotLog& log, const SemanticRun& run,
                 const std::vector<SemanticClass>& classes) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "x,y,truth,class\n";
    for (std::size_t i = 0; i < classes.size(); ++i) {
      const auto pose = hyselam::poseAt(log.ground_truth, run.stamps[i], 0.5);
      if (!pose) continue;
      out << pose->x << "," << pose->y << "," << (run.truth[i] ? toString(*run.truth[i]) : "")
          << "," << toString(classes[i]) << "\n";
    }
  });
}

nlohmann::json evaluate(const Options& o) {
  o.run.semantics.validate();
  requireCsv("--confusion", o.confusion);
  requireCsv("--places", o.places);
  const std::optional<WayForest> way_forest = wayForestOf(o);
  std::shared_ptr<const SemanticClassifier> classifier;
  if (o.model.empty()) {
    classifier = std::make_shared<DecisionTree>(o.tree);
  } else if (o.model == "shipped") {
    classifier = std::make_shared<SemanticForest>(SemanticForest::shipped());
  } else {
    classifier = std::make_shared<SemanticForest>(SemanticForest::load(o.model));
  }
  if (!o.regions.empty() && o.logs.size() != 1) {
    throw hyselam::ParameterError("--regions", o.regions, "used with one log only");
  }
  if (!o.places.empty() && o.logs.size() != 1) {
    throw hyselam::ParameterError("--places", o.places, "used with one log only");
  }
  const hyselam_sim::FloorPlan plan = planOf(o.plan);
  std::optional<hyselam_sim::FloorPlan> drawing;
  if (!o.compared.empty()) drawing = planOf(o.compared);
  o.references.check(o.logs.size());

  SemanticConfusion confusion, strict;
  std::size_t regions = 0, observations = 0;
  for (std::size_t i = 0; i < o.logs.size(); ++i) {
    const std::string& path = o.logs[i];
    hyselam::RobotLog log = hyselam::readRobotLog(path);
    log.ground_truth = o.references.of(i, log);
    if (log.ground_truth.empty()) {
      throw hyselam::InputError(path, "", "has no ground truth to look up in the plan");
    }
    hyselam::Progress progress("densities of " + path, log.scans.size());
    SemanticRun run = semanticRun(log, o.run, classifier, &plan,
                                  [&](std::size_t done) { progress.update(done); });
    const std::vector<SemanticClass> classes =
        way_forest ? wayClasses(path, log, run.stamps, *way_forest, o.decision)
        : drawing  ? drawnClasses(log, *drawing, &run)
                   : classesOf(run);
    confusion.add(compareClasses(run.truth, classes, o.tolerance));
    strict.add(compareClasses(run.truth, classes, o.tolerance, BorderRule::kStrict));
    regions += run.regions.size();
    observations += run.stamps.size();
    if (!o.places.empty()) writePlaces(o.places, log, run, classes);
    if (!o.regions.empty()) writeRegions(o.regions, run.regions, run.stamps);
  }
  if (!o.confusion.empty()) hyselam::writeConfusionCsv(o.confusion, tableOf(confusion));
  nlohmann::json j = toJson(confusion);
  j["strict"] = toJson(strict);
  j["plan"] = plan.name;
  j["classifier"] = way_forest        ? "way forest"
                    : drawing         ? drawing->name
                    : o.model.empty() ? "tree"
                                      : "forest";
  j["observations"] = observations;
  j["regions"] = regions;
  std::cout << j.dump(2) << "\n";
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Cuts recorded runs into regions, classifies them as corridors, corners, bifurcations, dead "
      "ends and halls, and compares with the plan of the building. Counted in observations; a "
      "border may be drawn --tolerance observations too early or late ('strict': only where both "
      "places were found).",
      "evaluate_semantics");
  Options o;
  app.add_option("logs", o.logs, "bags with ground truth, or logs, each a run")->required();
  o.run.addTo(app);
  app.add_option("--plan", o.plan, "floor plan with areas: a .yaml file or a shipped one's name")
      ->required();
  o.references.addTo(app, "true poses of each log in the plan's frame");
  app.add_option("--compare-plan", o.compared,
                 "another drawing of the same building, taken for a classifier's answer: how far "
                 "two drawings agree");
  app.add_option("--model", o.model,
                 "forest of train_semantic, or 'shipped'; without: the decision tree");
  app.add_option(
      "--way-model", o.way_model,
      "forest of train_way_regions, or 'shipped': decides by what is seen around the way "
      "after refined odometry");
  app.add_option("--change-cost", o.decision.change_cost, "of a change of kind, with --way-model");
  app.add_option(
      "--places", o.places,
      "table to write of where observations were made, their kinds and the answers (CSV)");
  app.add_option("--tolerance", o.tolerance, "of borders [observations]");
  app.add_option("--confusion", o.confusion,
                 "confusion matrix to write (CSV), for scripts/plot_confusion");
  app.add_option("--regions", o.regions, "table of the regions to write (CSV)");
  app.add_option("--high-variation", o.tree.high_variation,
                 "of the density, Table 6.4 (there 0.1)");
  app.add_option("--high-density", o.tree.high_density, "Table 6.4");
  app.add_option("--few-frontiers", o.tree.few_frontiers, "Table 6.4");
  app.add_option("--many-frontiers", o.tree.many_frontiers, "Table 6.4");
  app.add_option("--very-long", o.tree.very_long, "length of a region [observations], Table 6.4");
  return hyselam::runTool(argc, argv, app, [&] { return evaluate(o); });
}
