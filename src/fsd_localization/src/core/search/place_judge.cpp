#include "fsd_localization/search/place_judge.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/odds.hpp"

namespace fsd_localization {

namespace {
constexpr double kHypothesisMargin = 0.15;  // of the score, from the best
constexpr std::size_t kMaxHypotheses = 20;
constexpr double kLargestMargin = 0.3;  // beyond it is as sure as it gets
constexpr double kLeastLeft = 0.01;     // of the score: a place never explains everything
}  // namespace

void PlaceOdds::describe(hyselam::ParameterVisitor& visit) {
  const auto range = hyselam::Range::between(-1000.0, 1000.0);
  visit("bias", bias, range, "", "log odds that the best place of a search is right: without more");
  visit("margin", margin, range, "", "by its margin in score to the best other place, 0.3 at most");
  visit("unexplained", unexplained, range, "",
        "by the logarithm of what its score leaves to 1, 0.01 at least");
  visit("length", length, range, "",
        "by log(1 + metres of scans), each radian turned counted as half a metre");
}

double probabilityOfPlace(double score, double rival, double length, const PlaceOdds& odds) {
  const double margin = std::min(score - rival, kLargestMargin);
  const double left = std::log(std::max(1.0 - score, kLeastLeft));
  const double log_odds =
      odds.bias + odds.margin * margin + odds.unexplained * left + odds.length * std::log1p(length);
  return hyselam::probabilityOf(log_odds);
}

std::optional<Verdict> judge(const SearchAnswer& answer, const PlaceOdds& odds) {
  std::vector<Place> places = answer.places;
  if (answer.believed) {
    // The same place may have been found by a better way, or not at all.
    const Place& b = *answer.believed;
    const auto same = std::find_if(places.begin(), places.end(),
                                   [&](const Place& p) { return isSamePlace(p.base, b.base); });
    if (same == places.end()) {
      places.push_back(b);
    } else if (b.seen > same->seen) {
      *same = b;
    }
    std::stable_sort(places.begin(), places.end(),
                     [](const Place& p, const Place& q) { return p.seen > q.seen; });
  }
  if (places.empty()) return std::nullopt;
  Verdict v;
  v.best = places.front();
  v.best_is_believed = answer.believed && isSamePlace(v.best.base, answer.believed->base);
  const double length = lengthWithTurns(answer.length, answer.turned);
  double second = places.size() > 1 ? places[1].seen : 0.0;
  // Nobody has looked at places that are worse than the believed one by so much.
  if (answer.believed) {
    second = std::max(second, answer.believed->seen - PlaceSearch::kMaxDropFromBelieved);
  }
  v.probability = probabilityOfPlace(v.best.seen, std::min(second, v.best.seen), length, odds);
  if (answer.believed) {
    v.believed_probability =
        v.best_is_believed ? v.probability
                           : probabilityOfPlace(answer.believed->seen, v.best.seen, length, odds);
  }
  for (const Place& p : places) {
    if (p.seen < v.best.seen - kHypothesisMargin || v.hypotheses.size() == kMaxHypotheses) break;
    v.hypotheses.push_back(p);
  }
  const auto isTheBelieved = [&](const Place& p) {
    return isSamePlace(p.base, answer.believed->base);
  };
  if (answer.believed && std::none_of(v.hypotheses.begin(), v.hypotheses.end(), isTheBelieved)) {
    v.hypotheses.push_back(*answer.believed);
  }
  return v;
}

}  // namespace fsd_localization
