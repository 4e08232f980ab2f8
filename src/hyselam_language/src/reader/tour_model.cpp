#include "tour_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "mention_tagger.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr const char* kFormat = "hyselam_tour_reader 1";
constexpr double kHeaviest = 10.0;  // of the weights: more is a mistake

constexpr std::array<std::pair<const char*, LinearClassifier TourModel::*>, 4> kSections{
    {{"tagger", &TourModel::tagger},
     {"of_side", &TourModel::of_side},
     {"of_pair", &TourModel::of_pair},
     {"of_position", &TourModel::of_position}}};

constexpr std::array<std::pair<const char*, double TourWeights::*>, 6> kWeights{
    {{"own_side", &TourWeights::own_side},
     {"side", &TourWeights::side},
     {"pair", &TourWeights::pair},
     {"far_pair", &TourWeights::far_pair},
     {"position", &TourWeights::position},
     {"name", &TourWeights::name}}};

void requireClasses(const std::string& source, const LinearClassifier& classifier,
                    std::vector<std::string> wanted) {
  std::vector<std::string> classes = classifier.classes();
  std::sort(classes.begin(), classes.end());
  std::sort(wanted.begin(), wanted.end());
  if (classes != wanted) throw hyselam::InputError(source, "classes", "are not those of a tour");
}

}  // namespace

TourModel TourModel::fromText(const std::string& source, const std::string& text) {
  const ModelText read = ModelText::read(source, text, kFormat, "bench/tours --retrain");
  TourModel model;
  model.origin = read.origin;
  for (const auto& [name, classifier] : kSections) {
    model.*classifier = LinearClassifier::fromText(source + " [" + std::string(name) + "]",
                                                   read.section(source, name));
  }
  checkTags(source + " [tagger]", model.tagger);
  requireClasses(source + " [of_side]", model.of_side, {kTourLeft, kTourRight});
  requireClasses(source + " [of_pair]", model.of_pair,
                 {kTourBefore, kTourBehind, kTourOpposite, kTourApart});
  requireClasses(source + " [of_position]", model.of_position, {kTourFirst, kTourLast, kTourInner});
  std::istringstream weights(read.section(source, "weights"));
  for (const auto& [name, weight] : kWeights) {
    double& value = model.weights.*weight;
    std::string said;
    if (!(weights >> said >> value) || said != name || !(value >= 0.0 && value <= kHeaviest)) {
      throw hyselam::InputError(source, "[weights]",
                                "needs '" + std::string(name) + "' and a number from 0 to 10");
    }
  }
  std::istringstream calibration(read.section(source, "calibration"));
  model.of_sides = readOdds(&calibration, source, "sides");
  model.of_orders = readOdds(&calibration, source, "orders");
  return model;
}

std::string TourModel::toText() const {
  std::ostringstream out;
  out << origin.toText(kFormat);
  for (const auto& [name, classifier] : kSections)
    out << '[' << name << "]\n" << (this->*classifier).toText();
  out << "[weights]\n";
  for (const auto& [name, weight] : kWeights) out << name << ' ' << weights.*weight << '\n';
  out << "[calibration]\n";
  for (const auto& [name, odds] : {std::pair{"sides", &of_sides}, {"orders", &of_orders}})
    out << name << ' ' << odds->own << ' ' << odds->whole << ' ' << odds->offset << '\n';
  return out.str();
}

}  // namespace language
}  // namespace hyselam_topo
