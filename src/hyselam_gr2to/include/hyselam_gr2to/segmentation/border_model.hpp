// The learnt decision whether two neighboring regions are one place, as a data file: decision
// trees over the features of their border. The file that comes with the package
// (models/border_trees.txt) is made by `rosrun hyselam_gr2to train_borders`.
#pragma once

#include <string>

#include "hyselam_common/model_text.hpp"
#include "hyselam_gr2to/segmentation/boosted_trees.hpp"
#include "hyselam_gr2to/segmentation/border_features.hpp"

namespace hyselam_topo {

class BorderModel {
 public:
  /// The trees' features are BorderFeature.
  BorderModel(BoostedTrees trees, hyselam::ModelOrigin origin);

  /// Reads a file as toText() gives it.
  /// @throws hyselam::InputError with the line: another format or version, features that are not
  /// those of this version in their order, trees that are none, missing or surplus lines, a wrong
  /// checksum.
  static BorderModel load(const std::string& path);
  /// The same from a text; `source` begins what is thrown.
  static BorderModel fromText(const std::string& text, const std::string& source);
  /// The one that comes with the package.
  static const BorderModel& shipped();

  /// Numbers with six digits; the text of what was read is the same again.
  std::string toText() const;

  /// Log-odds that the two regions are one place: the mean over lengths up to 20 % shorter and
  /// longer and clearances up to 10 % lower and higher, so that a cell more or less, or a building
  /// a tenth larger, does not decide.
  double oddsOfOnePlace(const BorderFeatures& border) const;

  const BoostedTrees& trees() const { return trees_; }
  const hyselam::ModelOrigin& origin() const { return origin_; }

 private:
  BoostedTrees trees_;
  hyselam::ModelOrigin origin_;
};

}  // namespace hyselam_topo
