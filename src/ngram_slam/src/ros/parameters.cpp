#include "ngram_slam/ros/parameters.hpp"

#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"

namespace ngram_slam {

using hyselam::ParameterError;
using hyselam::Range;

namespace {

/// Beyond the kernel's radius: how far the robot drives before full densities, by default [m].
constexpr double kLookBackMargin = 0.5;

}  // namespace

void WordsServerParams::describe(hyselam::ParameterVisitor& visit) {
  const WordsPreset before = preset;
  visit("preset", preset, {{"thesis", WordsPreset::kThesis}, {"improved", WordsPreset::kImproved}},
        "defaults of the recognition; improved needs input scan");
  const bool to_improved = preset == WordsPreset::kImproved && before != WordsPreset::kImproved;
  if (to_improved) recognizer = NgramRecognizerParams::improved();
  visit("input", input_topic,
        {{"fsd_observation", WordsInput::kFsdObservation}, {"scan", WordsInput::kScan}},
        "topic that observations are made from");
  visit.group("", input);
  sensor.describeObservations(visit);
  if (to_improved) sensor.look_back = sensor.bandwidth + kLookBackMargin;
  sensor.describeLookBack(visit);
  visit.group("", recognizer);
  visit("semantics", semantics, "classify semantic regions");
  visit("semantic_classifier", semantic_classifier,
        {{"tree", SemanticClassifierKind::kTree}, {"forest", SemanticClassifierKind::kForest}},
        "decision tree of the thesis, or random forest");
  visit("semantic_forest", semantic_forest, "file of the forest; empty: the shipped one");
  visit("corpus", corpus, "file loaded at the start and saved; empty: none");
  visit("save_period", save_period, Range::between(0.0, 1e6), "s",
        "wall time between savings; 0: only at the end and when requested");
  visit("gui_publish_rate", gui_publish_rate, Range::aboveUpTo(0.0, 1000.0).orValue(-1.0), "Hz",
        "of word_markers; -1: no limit");
  visit("shown_words", shown_words, Range::between(1, 100000), "", "in word_markers, the newest");
  visit("diagnostic_period", diagnostic_period, Range::between(0.05, 60.0), "s",
        "between messages on /diagnostics");
}

void WordsServerParams::validate() const {
  hyselam::checkParameters(*this);
  if (preset == WordsPreset::kImproved && !fromScan()) {
    throw ParameterError("preset", "'improved'", "'thesis' unless input is scan");
  }
  if (!fromScan() && sensor.look_back > 0.0) {
    throw ParameterError("look_back", sensor.look_back, "0 unless input is scan");
  }
  hyselam::checkFolderOfState("corpus", corpus);
  input.validate();
  recognizer.validate();
  semantic.validate();
}

WordsServerParams loadWordsParams(hyselam::ParamLoader& loader) {
  return hyselam::loadDescribed<WordsServerParams>(loader);
}

}  // namespace ngram_slam
