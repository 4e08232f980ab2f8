// Parameters of the nodelet Words; README.md holds the table.
#pragma once

#include <string>

#include "hyselam_common/ros/params.hpp"
#include "hyselam_common/ros/scan_input_params.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/semantics/semantic_segmenter.hpp"
#include "ngram_slam/words/observation_sensor.hpp"

namespace ngram_slam {

/// Defaults of the recognition.
enum class WordsPreset {
  kThesis,
  kImproved  ///< NgramRecognizerParams::improved()
};

/// What observations are made from.
enum class WordsInput {
  kFsdObservation,  ///< topic `fsd_observation`
  kScan             ///< topic `scan` and tf
};

enum class SemanticClassifierKind { kTree, kForest };

struct WordsServerParams {
  WordsPreset preset = WordsPreset::kThesis;
  WordsInput input_topic = WordsInput::kFsdObservation;
  hyselam::ScanInputParams input;
  ObservationSensorParams sensor;  ///< with `fsd_observation` only bandwidth and step count
  NgramRecognizerParams recognizer;
  bool semantics = true;
  SemanticParams semantic;
  SemanticClassifierKind semantic_classifier = SemanticClassifierKind::kTree;
  std::string semantic_forest;     ///< file; empty: the shipped forest
  std::string corpus;              ///< file loaded at the start and saved; empty: none
  double save_period = 60.0;       ///< [s] of wall time; 0: only at the end and when requested
  double gui_publish_rate = 1.0;   ///< of word_markers [Hz]; -1: no limit
  int shown_words = 300;           ///< in word_markers, the newest
  double diagnostic_period = 1.0;  ///< [s]

  bool fromScan() const { return input_topic == WordsInput::kScan; }
  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// @throws hyselam::ParameterError naming parameter, value and range. Nothing is logged.
WordsServerParams loadWordsParams(hyselam::ParamLoader& loader);

}  // namespace ngram_slam
