#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "selovis/learning/labeled_frames.hpp"
#include "selovis/learning/place_model.hpp"
#include "selovis/places/place_transitions.hpp"

namespace selovis {
namespace {

using hyselam::testing::FuzzFolder;
using hyselam::testing::require;

/// Longer signatures make an input slow without covering more.
constexpr int kMaxSignature = 100000;

/// The text up to the next mark, which is taken off with it.
std::string nextPart(std::string& text) {
  const std::string mark = "\n===\n";
  const std::size_t at = std::min(text.find(mark), text.size());
  std::string part = text.substr(0, at);
  text.erase(0, std::min(text.size(), at + mark.size()));
  return part;
}

/// Writes a data file of the model, with the header of its format, and names it in the manifest.
void putData(const FuzzFolder& folder, nlohmann::json& manifest, const std::string& kind,
             const std::string& content) {
  const std::string bytes = (manifest.count("format") && manifest["format"] == "selovis model 2"
                                 ? "selovis " + kind + " 2\n"
                                 : "") +
                            content;
  const std::string sum = hyselam::crc32Text(bytes);
  const std::string name = kind + "-" + sum + ".bin";
  folder.put(name, bytes);
  manifest[kind] = {{"file", name}, {"bytes", bytes.size()}, {"crc32", sum}};
}

/// Files of the input before are of no use to the next.
void clear(const std::string& folder) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::filesystem::remove_all(entry.path());
  }
}

void requireProbabilities(const PlaceModel& model) {
  const std::vector<float> signature(model.samples.size, 0.5f);
  std::vector<double> p(model.transitions.places.size());
  model.makeClassifier()->predict(signature.data(), p.data());
  double sum = 0.0;
  for (const double each : p) {
    require(each >= 0.0 && each <= 1.0);
    sum += each;
  }
  require(std::abs(sum - 1.0) < 1e-6);
}

/// A model's model.json, its signatures and its SVM, separated by "\n===\n"; names, lengths and
/// checksums of the parts are corrected first. Refused, or it gives probabilities, and is written
/// and read back equal.
void placeModel(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  clear(folder.path(""));
  std::string text = hyselam::testing::textOf(data, size);
  std::string manifest = nextPart(text);
  nlohmann::json j = nlohmann::json::parse(manifest, nullptr, false);
  if (j.is_object()) {
    putData(folder, j, "signatures", nextPart(text));
    if (!text.empty()) putData(folder, j, "svm", text);
    manifest = j.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  folder.put("model.json", manifest);
  PlaceModel model;
  try {
    model = loadPlaceModel(folder.path(""));
  } catch (const hyselam::InputError&) {
    return;
  }
  if (model.samples.size > kMaxSignature) return;
  requireProbabilities(model);
  const std::string again = folder.path("again");
  savePlaceModel(model, again);
  const PlaceModel same = loadPlaceModel(again);
  require(
      same.descriptor == model.descriptor && same.transitions.places == model.transitions.places &&
      same.transitions.pairs == model.transitions.pairs && same.dictionary == model.dictionary &&
      same.samples.values == model.samples.values && same.svm == model.svm);
}

/// A list of images and places: refused, or each frame has an image and a place.
void placeLabels(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  std::vector<LabeledFrame> frames;
  try {
    frames = readLabeledFrames(folder.put("labels.csv", hyselam::testing::textOf(data, size)));
  } catch (const hyselam::InputError&) {
    return;
  }
  require(!frames.empty());
  for (const LabeledFrame& frame : frames) {
    require(!frame.place.empty() && !frame.image.empty());
    require(frame.pose.isFinite() ||
            !std::isfinite(frame.pose.x + frame.pose.y + frame.pose.theta));
  }
}

/// Transitions between places: refused, or they join places that it has, and paths lead along
/// them.
void placeGraph(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  PlaceTransitions transitions;
  try {
    transitions = readPlaceTransitions(folder.put("graph", hyselam::testing::textOf(data, size)));
  } catch (const hyselam::InputError&) {
    return;
  }
  const int places = static_cast<int>(transitions.places.size());
  require(places > 0);
  for (const auto& [a, b] : transitions.pairs) require(a >= 0 && a < b && b < places);
  constexpr int kManyPlaces = 200;  // the paths between more of them make an input slow
  if (places > kManyPlaces) return;
  const PlaceDistances paths = shortestPaths(transitions);
  for (const auto& [a, b] : transitions.pairs) {
    require(
        paths.distance[paths.size * static_cast<std::size_t>(a) + static_cast<std::size_t>(b)] ==
        1);
  }
}

}  // namespace
}  // namespace selovis

std::vector<hyselam::testing::FuzzTarget> hyselam::testing::fuzzTargets() {
  using namespace selovis;  // NOLINT: its own targets
  return {{"placeModel", placeModel}, {"placeLabels", placeLabels}, {"placeGraph", placeGraph}};
}
