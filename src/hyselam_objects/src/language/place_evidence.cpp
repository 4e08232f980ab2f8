#include "hyselam_objects/language/place_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "hyselam_language/building/place_names.hpp"
#include "hyselam_objects/mapping/object_relations.hpp"

namespace hyselam_objects {
namespace {

struct KindCounts {
  std::map<std::string, int> count;
  std::map<std::string, double> weight;  ///< of the least movable object of a kind
};

enum class Source { kDescribed, kDetected };

KindCounts kindsAt(const ObjectMap& map, Id place, Source source) {
  constexpr double kWeightOfMovable = 0.3;
  KindCounts kinds;
  for (const ObjectInstance& object : map.objects) {
    const bool counts = source == Source::kDescribed
                            ? object.described
                            : object.pose.has_value() && object.existence > 0.5;
    const bool is_part = object.properties.count("structure") != 0;  // every place has walls
    if (!counts || is_part || map.placeOf(object.id) != place) continue;
    ++kinds.count[object.kind];
    const double fixed = std::min(1.0, 1.0 - movability(map, object.id) + kWeightOfMovable);
    double& weight = kinds.weight[object.kind];
    weight = std::max(weight, fixed);
  }
  return kinds;
}

/// Log likelihood ratio of "the same place" against "some place".
double logRatio(const KindCounts& described, const KindCounts& detected, const EvidenceParams& p) {
  constexpr double kWeightOfSurplus = 0.1;  // described or not, it is there: weak evidence against
  double sum = 0.0;
  for (const auto& [kind, count] : described.count) {
    const auto found = detected.count.find(kind);
    const int there = found == detected.count.end() ? 0 : found->second;
    const int agree = std::min(count, there);
    const double weight =
        there > 0 ? std::min(1.0, std::max(described.weight.at(kind), detected.weight.at(kind)))
                  : described.weight.at(kind);
    sum += weight * agree * std::log((1.0 - p.p_missed) / p.p_chance);
    sum += weight * (count - agree) * std::log(p.p_missed / (1.0 - p.p_chance));
  }
  for (const auto& [kind, count] : detected.count) {
    const auto found = described.count.find(kind);
    const int surplus = count - (found == described.count.end() ? 0 : found->second);
    if (surplus > 0) sum += kWeightOfSurplus * surplus * std::log(p.p_not_described);
  }
  return sum;
}

}  // namespace

void EvidenceParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("p_missed", p_missed, Range::inside(0.0, 1.0), "",
        "probability that a described object is not detected in a place that was observed");
  visit("p_not_described", p_not_described, Range::inside(0.0, 1.0), "",
        "probability that a detected object was not described");
  visit("p_chance", p_chance, Range::inside(0.0, 1.0), "",
        "probability that a kind of object is in any one place");
}

void EvidenceParams::validate() const {
  hyselam::checkParameters(*this);
}

std::vector<hyselam_topo::MatchEvidence> placeEvidence(
    const ObjectMap& described, const ObjectMap& detected,
    const hyselam_topo::DescribedBuilding& building, const EvidenceParams& params) {
  params.validate();
  std::vector<hyselam_topo::Grammar> grammars;
  for (const std::string& language : hyselam_topo::Grammar::shippedLanguages()) {
    grammars.push_back(hyselam_topo::Grammar::shipped(language));
  }
  const hyselam_topo::PlaceNames names(std::move(grammars));
  std::vector<std::vector<std::string>> words;
  for (const hyselam_topo::DescribedPlace& place : building.places) {
    words.push_back(place.aliases);
    words.back().push_back(place.name);
  }
  std::vector<hyselam_topo::MatchEvidence> out;
  for (const ObjectPlace& place : described.places) {
    const KindCounts of_name = kindsAt(described, place.id, Source::kDescribed);
    const auto found = names.find(place.name, words);
    if (of_name.count.empty() || found.size() != 1) continue;
    for (const ObjectPlace& vertex : detected.places) {
      if (vertex.topological == 0) continue;
      const double ratio =
          logRatio(of_name, kindsAt(detected, vertex.id, Source::kDetected), params);
      out.push_back({vertex.topological, building.places[found.front()].id,
                     1.0 / (1.0 + std::exp(-std::clamp(ratio, -30.0, 30.0)))});
    }
  }
  return out;
}

}  // namespace hyselam_objects
