// The learnt odds that two patches belong to one object, as a data file: logistic regression over
// the features of their relation. The file that comes with the package (models/patch_relations.txt)
// is made by `rosrun hyselam_objects train_segmentation`.
#pragma once

#include <array>
#include <string>

#include "patch_relations.hpp"

namespace hyselam_objects {

/// Where a model comes from, as stands in its file; a line each.
struct RelationModelOrigin {
  std::string command;    ///< that trained it
  std::string data;       ///< what it was trained on
  std::string in_sample;  ///< scores on the clouds that it was trained on
  std::string left_out;   ///< scores on clouds that were left out of the training
};

/// Weights of features.
struct RelationWeights {
  std::array<double, kContactFeatureCount> contact{};
  std::array<double, kBridgeFeatureCount> bridge{};
};

struct RelationModel {
  RelationWeights with_colors, without_colors;
  RelationModelOrigin origin;

  /// Log-odds that both are parts of one object: what their contact and what their bridge says.
  double oddsOfOneObject(const PatchRelation& relation, bool has_colors) const;

  /// Reads a text as toText() gives it.
  /// @throws hyselam::InputError with the line: another format or version, other features or in
  ///         another order, missing or surplus lines, a wrong checksum.
  static RelationModel fromText(const std::string& text, const std::string& source);
  /// The one that comes with the package.
  static const RelationModel& shipped();
  /// Numbers with six digits; the text of what was read is the same again.
  std::string toText() const;
};

}  // namespace hyselam_objects
