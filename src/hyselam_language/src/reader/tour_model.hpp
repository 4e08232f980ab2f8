// What the reader of tours has learnt: which words name the rooms, and what the words around them
// say of sides and order.
#pragma once

#include <string>

#include "linear_classifier.hpp"
#include "model_text.hpp"
#include "odds.hpp"

namespace hyselam_topo {
namespace language {

/// Labels of the classifiers.
constexpr const char* kTourLeft = "left";
constexpr const char* kTourRight = "right";
constexpr const char* kTourBefore =
    "before";  ///< of a pair: on the same side, told first and nearer
constexpr const char* kTourBehind = "behind";      ///< on the same side, told first and farther
constexpr const char* kTourOpposite = "opposite";  ///< on different sides, doors near each other
constexpr const char* kTourApart = "apart";        ///< on different sides
constexpr const char* kTourFirst = "first";
constexpr const char* kTourLast = "last";
constexpr const char* kTourInner = "inner";

/// How much of its logarithm each kind of statement counts: mentions that stand near each other are
/// read with the same words, so that they are surer together than they should be.
struct TourWeights {
  double own_side = 1.0;  ///< of a mention with a word for a side of its own
  double side = 0.3;
  double pair = 1.0;
  double far_pair = 0.5;  ///< of two with one between them
  double position = 0.7;
  double name = 0.6;  ///< nats by which a word counts more as part of a name
};

struct TourModel {
  ModelOrigin origin;
  LinearClassifier tagger;       ///< of words: which name rooms ("B-thing", "I-thing", "O")
  LinearClassifier of_side;      ///< of a mention
  LinearClassifier of_pair;      ///< of two mentions
  LinearClassifier of_position;  ///< of a mention: where in its row it is
  TourWeights weights;
  /// What the share of layouts in which a side, or the order of neighbours, holds is worth on
  /// writers that the model has not been trained with.
  Odds of_sides, of_orders;

  /// Throws hyselam::InputError.
  static TourModel fromText(const std::string& source, const std::string& text);
  std::string toText() const;
};

}  // namespace language
}  // namespace hyselam_topo
