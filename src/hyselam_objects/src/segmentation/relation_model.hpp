// The learnt odds that two patches belong to one object, as a data file: logistic regression over
// the features of their relation. The file that comes with the package (models/patch_relations.txt)
// is made by `rosrun hyselam_objects train_segmentation`.
#pragma once

#include <array>
#include <string>

#include "hyselam_common/model_text.hpp"
#include "patch_relations.hpp"

namespace hyselam_objects {

/// Weights of features.
struct RelationWeights {
  std::array<double, kContactFeatureCount> contact{};
  std::array<double, kBridgeFeatureCount> bridge{};
};

struct RelationModel {
  RelationWeights with_colors, without_colors;
  hyselam::ModelOrigin origin;

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
