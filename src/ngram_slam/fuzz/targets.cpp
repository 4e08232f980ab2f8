#include <cmath>
#include <optional>
#include <sstream>

#include "hyselam_common/binary_io.hpp"
#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "ngram_slam/semantics/semantic_forest.hpp"
#include "ngram_slam/semantics/way_forest.hpp"
#include "ngram_slam/signatures/place_signature.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "ngram_slam/words/corpus.hpp"

namespace ngram_slam {
namespace {

using hyselam::testing::require;

void putSum(std::string& text, std::size_t at, std::size_t begin, std::size_t end) {
  const std::uint32_t sum = hyselam::checksumOf(text, begin, end);
  for (int i = 0; i < 4; ++i) text[at + i] = static_cast<char>(sum >> 8 * i & 0xff);
}

/// Puts the checksum of the `header` bytes behind them, and that of the rest into the last four.
void putSums(std::string& text, std::size_t header) {
  if (text.size() < header + 8) return;
  putSum(text, header, 0, header);
  putSum(text, text.size() - 4, header + 4, text.size() - 4);
}

/// The corpus within a state is a file of its own: where it begins, its sums are put right as well.
void putSumsOfPart(std::string& text) {
  const std::size_t begin = text.find("NGRAMTXT");
  if (begin == std::string::npos || text.size() < begin + 4) return;
  std::string part = text.substr(begin, text.size() - 4 - begin);
  putSums(part, 28);
  text.replace(begin, part.size(), part);
}

/// A corpus of words: refused, or written to the same bytes.
void corpus(const std::uint8_t* data, std::size_t size) {
  std::string text = hyselam::testing::textOf(data, size);
  putSums(text, 28);
  Corpus read;
  try {
    read = CorpusFile::parse(text, "fuzz");
  } catch (const hyselam::InputError&) {
    return;
  }
  std::ostringstream out;
  CorpusFile::write(out, read.observations, read.classes, read.histogram);
  require(out.str() == text);
}

/// The state of SLAM: refused, or sound, and written and read as the same.
void slamState(const std::uint8_t* data, std::size_t size) {
  static const hyselam::testing::FuzzFolder folder;
  const hyselam_scan_matching::SurfacePointParams surface;
  std::string text = hyselam::testing::textOf(data, size);
  putSumsOfPart(text);
  putSums(text, 20);
  SlamState state;
  try {
    state = SlamStateFile::load(folder.put("slam.state", text), surface);
  } catch (const hyselam::InputError&) {
    return;
  }
  const std::string again = folder.path("again.state");
  SlamStateFile::save(again, state);
  const SlamState same = SlamStateFile::load(again, surface);
  require(same.keyframes.size() == state.keyframes.size() &&
          same.scans.size() == state.scans.size() && same.loops.size() == state.loops.size() &&
          same.matches.size() == state.matches.size());
}

/// A file of trees: its head, the trees, and the checksum put right.
std::string forestText(const char* format, const std::vector<std::string>& features,
                       const std::string& trees) {
  std::string text =
      std::string(format) + "\ncommand: \ndata: \nin sample: \nout of sample: \nfeatures:";
  for (const std::string& feature : features) text += " " + feature;
  text += "\n" + trees;
  return text + "crc32 " + hyselam::crc32Text(text) + "\n";
}

/// The trees of a forest of semantic classes, whose head and checksum are put right: refused, or a
/// class for any features, and saved and loaded as the same.
void semanticForest(const std::uint8_t* data, std::size_t size) {
  static const hyselam::testing::FuzzFolder folder;
  std::vector<std::string> names;
  for (const SemanticFeature& feature : kSemanticFeatureList) names.emplace_back(feature.name);
  const std::string text =
      forestText("ngram_slam semantic forest 3", names, hyselam::testing::textOf(data, size));
  const auto predictionsOf = [](const SemanticForest& forest) {
    std::vector<SemanticPrediction> predictions;
    for (const double value : {0.0, -1.0, 0.5, 1e6}) {
      SemanticFeatures features{};
      features.length = value;
      predictions.push_back(forest.classify(features));
    }
    return predictions;
  };
  std::optional<SemanticForest> forest;
  try {
    forest = SemanticForest::load(folder.put("forest.txt", text));
  } catch (const hyselam::InputError&) {
    return;
  }
  const auto predictions = predictionsOf(*forest);
  for (const SemanticPrediction& prediction : predictions) {
    require(prediction.confidence >= 0.0 && prediction.confidence <= 1.0);
  }
  forest->save(folder.path("again.txt"));
  const auto again = predictionsOf(SemanticForest::load(folder.path("again.txt")));
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    require(again[i].semantic_class == predictions[i].semantic_class &&
            again[i].confidence == predictions[i].confidence);
  }
}

/// The trees of a forest of kinds along ways, in the same manner.
void wayForest(const std::uint8_t* data, std::size_t size) {
  const std::string text = forestText("ngram_slam way forest 1", wayFeatureNames(),
                                      hyselam::testing::textOf(data, size));
  const auto sharesOf = [](const WayForest& forest) {
    std::vector<ClassShares> shares;
    for (const float value : {0.0F, -1.0F, 0.5F, 1e6F}) {
      shares.push_back(forest.sharesOf(std::vector<float>(wayFeatureNames().size(), value)));
    }
    return shares;
  };
  std::optional<WayForest> forest;
  try {
    forest = WayForest::parse(text, "fuzz");
  } catch (const hyselam::InputError&) {
    return;
  }
  require(sharesOf(WayForest::parse(forest->text(), "again")) == sharesOf(*forest));
}

/// The rows of a model of place signatures, whose head and checksum are put right: refused, or
/// written to what is read as the same.
void signatureModel(const std::uint8_t* data, std::size_t size) {
  std::string text =
      "ngram_slam place signatures 2\ncommand: \ndata: \nin sample: \nout of sample: \n"
      "sensor: spacing 0.5 half_window 5 resolution 0.2 range 20 kernels 1 1.5 2.5 4\nfeatures: " +
      std::to_string(SignatureFeatures::kSize) +
      " values: " + std::to_string(PlaceSignature::kSize) + "\n" +
      hyselam::testing::textOf(data, size);
  text += "crc32 " + hyselam::crc32Text(text) + "\n";
  std::optional<SignatureModel> model;
  try {
    model = SignatureModel::parse(text, "fuzz");
  } catch (const hyselam::InputError&) {
    return;
  }
  const std::string again = model->text();
  require(SignatureModel::parse(again, "again").text() == again);
  require(std::isfinite(model->logRatio({}, {})));
}

}  // namespace
}  // namespace ngram_slam

std::vector<hyselam::testing::FuzzTarget> hyselam::testing::fuzzTargets() {
  using namespace ngram_slam;  // NOLINT: its own targets
  return {{"corpus", corpus},
          {"slamState", slamState},
          {"semanticForest", semanticForest},
          {"signatureModel", signatureModel},
          {"wayForest", wayForest}};
}
