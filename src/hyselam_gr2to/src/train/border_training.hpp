// Trains the border model on maps with known rooms, and measures how well it carries over to
// buildings that it has not seen.
#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "boosting.hpp"
#include "hyselam_gr2to/segmentation/border_model.hpp"
#include "room_scores.hpp"
#include "training_examples.hpp"

namespace hyselam_topo {

struct BorderTrainingOptions {
  /// The borders that the trees themselves lead to are added so many times less one.
  int rounds = 4;
  double robot_weight = 2.0;           ///< of maps built by robots
  double plan_weight = 0.5;            ///< of generated floors
  std::vector<BorderFeature> without;  ///< features that are not used
  std::vector<double> odds_offsets;    ///< tried at the end on the models of buildings left out
  BoostingParams boosting;             ///< its monotone features are set
  bool each = false;                   ///< log the scores of every map
};

/// The model and what it scores after the last round.
struct TrainedBorderModel {
  BoostedTrees trees;
  std::string in_sample;  ///< scores of each kind of maps, one line
  std::string left_out;   ///< the same, the building of each map left out of the training
  std::map<std::string, BoostedTrees> without;  ///< the trees trained without each building
};

/// @throws hyselam::InputError without examples or without borders in them.
TrainedBorderModel trainBorderModel(const std::vector<Example>& examples,
                                    const BorderTrainingOptions& options, std::ostream& log);

}  // namespace hyselam_topo
