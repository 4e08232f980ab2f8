// What rviz shows of the text of a run.
#pragma once

#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include <deque>

#include "ngram_slam/matching/alignment.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/semantics/semantic_segmenter.hpp"

namespace ngram_slam {

/// A match of two observations, to be drawn as a line.
struct MatchLine {
  ObservationPair pair;
  Direction direction = Direction::kSame;
};

/// What is shown of the newest run. Other runs have other odometry frames, in which nothing can be
/// drawn beside this one.
struct ShownRun {
  std::deque<SemanticRegion> regions;
  std::deque<MatchLine> matches;
};

/// Namespaces: "regions", a broad line coloured by semantic class (grey where the class is not yet
/// known); "kinds", their names; "classes", a narrow line coloured by density class; "words", their
/// syllables as text "class.length angle"; "matches", lines between two observations of one place,
/// green in the same direction, magenta in the reverse one. Only the newest `words` words.
/// @param header frame: odometry of the run.
visualization_msgs::MarkerArray wordMarkers(const NgramRecognizer& recognizer,
                                            const ShownRun& shown, int words,
                                            const std_msgs::Header& header);

}  // namespace ngram_slam
