// train_borders DATA --out border_trees.txt: learns which neighboring regions of a map are one
// place, and tells how well that carries over to buildings that were not seen.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "border_training.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/tool.hpp"
#include "training_examples.hpp"

namespace hyselam_topo {
namespace {

struct Options {
  ExampleOptions examples;
  BorderTrainingOptions training;
  std::vector<std::string> without;
  std::string out;
  std::string left_out;
};

void addOptions(CLI::App& app, Options& o) {
  app.add_option("DATA", o.examples.data,
                 "folder with index.csv, maps and rooms; without it generated floors only");
  app.add_option("--out", o.out, "file of the model to write");
  app.add_option("--left-out", o.left_out,
                 "folder for the models trained without each building, BUILDING.txt");
  app.add_option("--rounds", o.training.rounds, "times that the borders met are added, and one");
  app.add_option("--scales", o.examples.scales, "of the maps")->delimiter(',');
  app.add_option("--robot-weight", o.training.robot_weight, "of robot-built maps");
  app.add_option("--plans", o.examples.plans, "generated floors besides");
  app.add_option("--plan-weight", o.training.plan_weight, "of generated floors");
  app.add_option("--without", o.without, "features that are not used")->delimiter(',');
  app.add_option("--odds-offsets", o.training.odds_offsets, "changes of the odds that are tried")
      ->delimiter(',');
  app.add_option("--trees", o.training.boosting.trees);
  app.add_option("--leaves", o.training.boosting.leaves);
  app.add_option("--rate", o.training.boosting.rate);
  app.add_option("--l2", o.training.boosting.l2);
  app.add_option("--min-hessian", o.training.boosting.min_hessian);
  app.add_option("--feature-share", o.training.boosting.feature_share);
  app.add_option("--seed", o.training.boosting.seed);
  app.add_option("--max-clutter-size", o.examples.segmentation.max_clutter_size);
  app.add_flag("--each", o.training.each, "print every map");
}

/// The command with the options that change the model, wherever the data lie.
std::string commandOf(const CLI::App& app) {
  std::string command = "train_borders";
  for (const CLI::Option* option : app.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || name == "--out" || name == "--left-out" || name == "--each" ||
        name == "--json" || name == "--odds-offsets") {
      continue;
    }
    if (name == "DATA") {
      command += " GRIDMAPS";
      continue;
    }
    command += " " + name;
    std::string values;
    for (const std::string& value : option->results())
      values += (values.empty() ? "" : ",") + value;
    command += " " + values;
  }
  return command;
}

int train(int argc, char** argv) {
  Options options;
  CLI::App app("Learns which neighboring regions of a map are one place", "train_borders");
  addOptions(app, options);
  return hyselam::runTool(argc, argv, app, [&]() -> nlohmann::json {
    for (const std::string& name : options.without) {
      const auto feature = borderFeatureFromString(name);
      if (!feature) throw hyselam::ParameterError("without", name, "names of features");
      options.training.without.push_back(*feature);
    }
    const TrainingData data = loadExamples(options.examples);
    TrainedBorderModel trained = trainBorderModel(data.examples, options.training, std::cout);
    if (!options.out.empty()) {
      const BorderModel model(std::move(trained.trees),
                              {commandOf(app), data.summary, trained.in_sample, trained.left_out});
      hyselam::writeFileAtomically(options.out, [&](std::ostream& out) { out << model.toText(); });
    }
    if (!options.left_out.empty()) {
      hyselam::makeFolder(options.left_out);
      for (auto& [building, trees] : trained.without) {
        const BorderModel model(std::move(trees),
                                {commandOf(app) + ", without " + building, data.summary,
                                 trained.in_sample, trained.left_out});
        hyselam::writeFileAtomically(options.left_out + "/" + building + ".txt",
                                     [&](std::ostream& out) { out << model.toText(); });
      }
    }
    return {};
  });
}

}  // namespace
}  // namespace hyselam_topo

int main(int argc, char** argv) {
  return hyselam_topo::train(argc, argv);
}
