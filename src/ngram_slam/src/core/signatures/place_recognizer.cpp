#include "ngram_slam/signatures/place_recognizer.hpp"

#include <algorithm>
#include <utility>

namespace ngram_slam {

void PlaceRecognizerParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("half_length", half_length, Range::between(0, 40), "places",
        "before and after a place, compared along with it");
  visit("separation", separation, Range::between(1, 10000), "places",
        "of way between two that are compared, in one run");
  visit("max_candidates", max_candidates, Range::between(1, 100), "",
        "earlier places that are told for one");
  visit("candidate_spacing", candidate_spacing, Range::between(0, 1000), "places",
        "of several candidates this near the best is told");
  visit("shortlist", shortlist, Range::between(1, 10000), "",
        "places looked up for each of five of the way");
  visit("chain_length", chain_length, Range::between(0, 200), "places",
        "of the longest chain before a place that is compared along with it; 0: the mean over "
        "half_length");
  visit("chain_decay", chain_decay, Range::between(0.1, 0.99), "",
        "weight of a place of a chain against the next one");
}

void PlaceRecognizerParams::validate() const {
  hyselam::checkParameters(*this);
}

PlaceRecognizer::PlaceRecognizer(const SignatureModel& model, const PlaceRecognizerParams& params)
    : params_((params.validate(), params)), index_(model) {}

void PlaceRecognizer::endRun() {
  if (run_begins_.back() != index_.size()) run_begins_.push_back(index_.size());
}

std::pair<std::uint32_t, std::uint32_t> PlaceRecognizer::runOf(std::uint32_t place) const {
  const auto after = std::upper_bound(run_begins_.begin(), run_begins_.end(), place);
  return {*(after - 1), after == run_begins_.end() ? index_.size() : *after};
}

std::uint32_t PlaceRecognizer::endOfOlder(std::uint32_t place) const {
  const std::uint32_t begin = runOf(place).first;
  const auto separation = static_cast<std::uint32_t>(params_.separation);
  return std::max(begin, place + 1 > separation ? place + 1 - separation : 0);
}

PlaceRecognizer::Questions PlaceRecognizer::questionsAround(std::uint32_t place) const {
  const auto [begin, end] = runOf(place);
  Questions questions;
  for (int o = -before(); o <= params_.half_length; ++o) {
    const std::int64_t at = static_cast<std::int64_t>(place) + o;
    questions.emplace_back();
    if (at >= begin && at < end) {
      questions.back() = index_.questionOf(index_[static_cast<std::uint32_t>(at)]);
    }
  }
  return questions;
}

double PlaceRecognizer::score(const Questions& questions, std::uint32_t older,
                              Direction direction) const {
  const auto [begin, end] = runOf(older);
  const int step = direction == Direction::kSame ? 1 : -1;
  std::int64_t at = static_cast<std::int64_t>(older) - step * before();
  std::vector<std::optional<double>> pairs;
  double sum = 0.0;
  int count = 0;
  for (const auto& question : questions) {
    pairs.emplace_back();
    if (question && at >= begin && at < end) {
      pairs.back() = static_cast<double>(index_.score(*question, static_cast<std::uint32_t>(at)));
      sum += *pairs.back();
      ++count;
    }
    at += step;
  }
  if (params_.chain_length > 0) return chainScore(pairs);
  return count > 0 ? sum / count : 0.0;
}

double PlaceRecognizer::chainScore(const std::vector<std::optional<double>>& pairs) const {
  const auto middle = static_cast<std::ptrdiff_t>(before());
  const auto side = [&](std::ptrdiff_t step, std::ptrdiff_t length) {
    double gain = 0.0;  // of the chain from the farthest place on
    for (std::ptrdiff_t d = length; d > 0; --d) {
      const auto& pair = pairs[static_cast<std::size_t>(middle + step * d)];
      gain = pair ? std::max(0.0, *pair + params_.chain_decay * gain) : 0.0;
    }
    return params_.chain_decay * gain;
  };
  return pairs[static_cast<std::size_t>(middle)].value_or(0.0) + side(-1, params_.chain_length) +
         side(1, params_.half_length);
}

double PlaceRecognizer::score(std::uint32_t newer, std::uint32_t older, Direction direction) const {
  return score(questionsAround(newer), older, direction);
}

std::vector<PlaceCandidate> PlaceRecognizer::best(std::vector<PlaceCandidate> all) const {
  std::sort(all.begin(), all.end(), [](const PlaceCandidate& a, const PlaceCandidate& b) {
    if (a.score != b.score) return a.score > b.score;
    return std::make_pair(a.older, a.direction) < std::make_pair(b.older, b.direction);
  });
  std::vector<PlaceCandidate> told;
  for (const PlaceCandidate& c : all) {
    if (static_cast<int>(told.size()) == params_.max_candidates) break;
    const bool near = std::any_of(told.begin(), told.end(), [&](const PlaceCandidate& t) {
      const std::uint32_t apart = std::max(t.older, c.older) - std::min(t.older, c.older);
      return apart <= static_cast<std::uint32_t>(params_.candidate_spacing);
    });
    if (!near) told.push_back(c);
  }
  return told;
}

std::vector<PlaceCandidate> PlaceRecognizer::candidates(std::uint32_t place,
                                                        const MayBe& may_be) const {
  const std::uint32_t end = endOfOlder(place);
  const auto [begin, run_end] = runOf(place);
  std::vector<std::pair<std::uint32_t, Direction>> anchors;
  for (int part = -2; part <= 2; ++part) {
    const int offset = part * params_.half_length / 2;
    if (part != 0 && offset == 0) continue;
    const std::int64_t at = static_cast<std::int64_t>(place) + offset;
    if (at < begin || at >= run_end) continue;
    const PlaceSignature& wanted = index_[static_cast<std::uint32_t>(at)];
    for (const PlaceIndex::Found& f :
         index_.search(wanted, static_cast<std::size_t>(params_.shortlist), end)) {
      for (const Direction direction : {Direction::kSame, Direction::kReverse}) {
        const std::int64_t older =
            static_cast<std::int64_t>(f.place) + (direction == Direction::kSame ? -offset : offset);
        if (older >= 0 && older < end && (!may_be || may_be(static_cast<std::uint32_t>(older)))) {
          anchors.emplace_back(static_cast<std::uint32_t>(older), direction);
        }
      }
    }
  }
  std::sort(anchors.begin(), anchors.end());
  anchors.erase(std::unique(anchors.begin(), anchors.end()), anchors.end());
  const auto questions = questionsAround(place);
  std::vector<PlaceCandidate> all;
  for (const auto& [older, direction] : anchors) {
    all.push_back({place, older, direction, score(questions, older, direction)});
  }
  return best(std::move(all));
}

std::vector<PlaceCandidate> PlaceRecognizer::candidatesOfAll(std::uint32_t place,
                                                             const MayBe& may_be) const {
  const auto questions = questionsAround(place);
  std::vector<PlaceCandidate> all;
  for (std::uint32_t older = 0; older < endOfOlder(place); ++older) {
    if (may_be && !may_be(older)) continue;
    for (const Direction direction : {Direction::kSame, Direction::kReverse}) {
      all.push_back({place, older, direction, score(questions, older, direction)});
    }
  }
  return best(std::move(all));
}

}  // namespace ngram_slam
