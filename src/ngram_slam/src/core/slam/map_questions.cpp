#include "ngram_slam/slam/map_questions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ngram_slam {

using hyselam::Pose2;

namespace {

// Up to so many places all are compared; of more, those that the index finds.
constexpr std::uint32_t kMaxCompared = 20000;
constexpr int kMostCandidates = 20;

SignaturePlacesParams paramsOfAll(SignaturePlacesParams params) {
  params.recognizer.max_candidates = kMostCandidates;
  return params;
}

}  // namespace

MapQuestions::MapQuestions(const SlamState& state, const SignaturePlacesParams& params)
    : places_(paramsOfAll(params)), spacing_(params.sensor.spacing) {
  std::vector<const Pose2*> motions(state.keyframes.size(), nullptr);
  for (const auto& e : state.odometry) {
    if (e.from + 1 == e.to) motions[static_cast<std::size_t>(e.to)] = &e.measured;
  }
  places_.askFrom(std::numeric_limits<int>::max());  // not yet
  for (std::size_t k = 0; k < state.keyframes.size(); ++k) {
    const bool begins = motions[k] == nullptr;
    places_.add(
        {static_cast<int>(k), begins, begins ? Pose2{} : *motions[k], state.keyframes[k].scan});
  }
  places_.endRun();
}

std::vector<SignatureCandidate> MapQuestions::ask(double interval, int candidates,
                                                  const IsAsked& is_asked, const IsOpen& is_open,
                                                  int* asked) {
  const PlaceRecognizer& recognizer = places_.recognizer();
  const std::uint32_t size = recognizer.index().size();
  const auto step = static_cast<std::uint32_t>(std::max(1.0, std::round(interval / spacing_)));
  std::vector<SignatureCandidate> out;
  for (std::uint32_t place = 0; place < size; ++place) {
    const auto [begin, end] = recognizer.runOf(place);
    // In the middle of a run that is shorter than the interval.
    const std::uint32_t first = std::min(step / 2, (end - begin) / 2);
    const int newer = places_.keyframeOf(place);
    if ((place - begin) % step != first || !is_asked(newer)) continue;
    ++*asked;
    const auto may_be = [&](std::uint32_t older) {
      const int k = places_.keyframeOf(older);
      return k < newer && is_open(k, newer);
    };
    int told = 0;
    for (const PlaceCandidate& c : size <= kMaxCompared ? recognizer.candidatesOfAll(place, may_be)
                                                        : recognizer.candidates(place, may_be)) {
      if (told++ == candidates) break;
      const int older = places_.keyframeOf(c.older);
      if (told_.insert({older, newer}).second) out.push_back({newer, older, c.direction, c.score});
    }
  }
  return out;
}

}  // namespace ngram_slam
