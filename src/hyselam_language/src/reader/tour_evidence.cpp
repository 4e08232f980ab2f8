#include "tour_evidence.hpp"

#include <algorithm>
#include <map>
#include <string>

namespace hyselam_topo {
namespace language {
namespace {

using Probabilities = std::map<std::string, double>;

Probabilities told(const LinearClassifier& classifier, const Features& features) {
  const std::vector<double> all = classifier.probabilities(features);
  Probabilities by_label;
  for (std::size_t k = 0; k < all.size(); ++k) by_label[classifier.classes()[k]] = all[k];
  return by_label;
}

}  // namespace

TourEvidence evidenceOf(const TourModel& model, const TourContext& context,
                        const std::vector<std::size_t>& room_of, std::size_t rooms) {
  TourEvidence evidence(rooms);
  const TourWeights& weights = model.weights;
  for (std::size_t mention = 0; mention < room_of.size(); ++mention) {
    const std::size_t room = room_of[mention];
    const Features side = context.ofSide(mention);
    if (!side.empty() && !context.isKnown(mention)) {
      const Probabilities p = told(model.of_side, side);
      evidence.addSide(room, context.hasOwnSide(mention) ? weights.own_side : weights.side,
                       p.at(kTourLeft), p.at(kTourRight));
    }
    // Of several mentions the place in the row is told once.
    const double share =
        1.0 / static_cast<double>(std::count(room_of.begin(), room_of.end(), room));
    const Probabilities p = told(model.of_position, context.ofPosition(mention));
    evidence.addPosition(room, share * weights.position, p.at(kTourFirst), p.at(kTourLast),
                         p.at(kTourInner));
  }
  for (const auto& [first, second] : context.pairs()) {
    const std::size_t a = room_of[first], b = room_of[second];
    if (a == b) continue;
    const Probabilities p = told(model.of_pair, context.ofPair(first, second));
    evidence.addPair(a, b, second == first + 1 ? weights.pair : weights.far_pair,
                     {p.at(kTourBefore), p.at(kTourBehind), p.at(kTourOpposite), p.at(kTourApart)});
  }
  return evidence;
}

}  // namespace language
}  // namespace hyselam_topo
