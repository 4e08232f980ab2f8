// From the values of the core to messages, and back from densities to observations.
#pragma once

#include <hyselam_msgs/FsdObservation.h>
#include <hyselam_msgs/SemanticRegion.h>
#include <hyselam_msgs/Word.h>
#include <hyselam_msgs/WordMatch.h>

#include <string>

#include "ngram_slam/matching/alignment.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/semantics/semantic_segmenter.hpp"

namespace ngram_slam {

/// The reading of the uniform kernel of `bandwidth` [m].
/// @throws hyselam::InputError (beginning with `source`) without such a kernel, for arrays of
/// unequal lengths, and for a pose or density that is not finite.
DensityObservation fromMsg(const hyselam_msgs::FsdObservation& msg, double bandwidth,
                           const std::string& source);

hyselam_msgs::Word wordMsg(const NgramRecognizer& recognizer, WordIndex word);

/// @param place the two observations that stand for the match; see placeOf().
hyselam_msgs::WordMatch matchMsg(const NgramRecognizer& recognizer, const NgramMatch& match,
                                 const ObservationPair& place);

/// @param step path between observations [m].
hyselam_msgs::SemanticRegion regionMsg(const ObservationStore& observations,
                                       const SemanticRegion& region, double step);

}  // namespace ngram_slam
