#include "hyselam_objects/place_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "hyselam_common/require.hpp"
#include "hyselam_language/building/place_names.hpp"
#include "hyselam_objects/object_relations.hpp"

namespace hyselam_objects {
namespace {

struct Kinds {
  std::map<std::string, int> count;
  std::map<std::string, double> weight;  // the least movable of a kind
};

Kinds kindsAt(const ObjectMap& map, Id place, bool seen) {
  Kinds kinds;
  for (const ObjectInstance& object : map.objects) {
    const bool counts = seen ? object.pose.has_value() && object.existence > 0.5 : object.told;
    if (!counts || map.placeOf(object.id) != place) continue;
    ++kinds.count[object.kind];
    const double fixed = std::min(1.0, 1.0 - movability(map, object.id) + 0.3);
    double& weight = kinds.weight[object.kind];
    weight = std::max(weight, fixed);
  }
  return kinds;
}

double logRatio(const Kinds& told, const Kinds& seen, const EvidenceParams& p) {
  double sum = 0.0;
  for (const auto& [kind, count] : told.count) {
    const auto found = seen.count.find(kind);
    const int there = found == seen.count.end() ? 0 : found->second;
    const int agree = std::min(count, there);
    const double weight = there > 0
                              ? std::min(1.0, std::max(told.weight.at(kind), seen.weight.at(kind)))
                              : told.weight.at(kind);
    sum += weight * agree * std::log((1.0 - p.told_only) / p.by_chance);
    sum += weight * (count - agree) * std::log(p.told_only / (1.0 - p.by_chance));
  }
  for (const auto& [kind, count] : seen.count) {
    const auto found = told.count.find(kind);
    const int surplus = count - (found == told.count.end() ? 0 : found->second);
    // Told or not, it is there: weak evidence against.
    if (surplus > 0) sum += 0.1 * surplus * std::log(p.seen_only);
  }
  return sum;
}

}  // namespace

std::vector<hyselam_topo::MatchEvidence> placeEvidence(
    const ObjectMap& told, const ObjectMap& seen, const hyselam_topo::DescribedBuilding& building,
    const EvidenceParams& params) {
  for (const auto& [name, value] : {std::pair<const char*, double>{"told_only", params.told_only},
                                    {"seen_only", params.seen_only},
                                    {"by_chance", params.by_chance}}) {
    hyselam::require(name, value, value > 0.0 && value < 1.0, "between 0 and 1");
  }
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
  for (const ObjectPlace& place : told.places) {
    const Kinds of_name = kindsAt(told, place.id, false);
    const auto found = names.find(place.name, words);
    if (of_name.count.empty() || found.size() != 1) continue;
    for (const ObjectPlace& vertex : seen.places) {
      if (vertex.topological == 0) continue;
      const double ratio = logRatio(of_name, kindsAt(seen, vertex.id, true), params);
      out.push_back({vertex.topological, building.places[found.front()].id,
                     1.0 / (1.0 + std::exp(-std::clamp(ratio, -30.0, 30.0)))});
    }
  }
  return out;
}

}  // namespace hyselam_objects
