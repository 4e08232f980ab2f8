#include "ngram_slam/slam/redundant_observations.hpp"

#include <algorithm>
#include <cstdint>
#include <map>

#include "ngram_slam/slam/keyframe_grid.hpp"

namespace ngram_slam {

namespace {

constexpr std::uint32_t kBridged = 10;  // so few known ones do not part a stretch: about a word

/// The observations that stay, by keyframe and by run of observations.
class KeptObservations {
 public:
  KeptObservations(const SlamState& state, const std::vector<int>& components, double radius)
      : state_(state),
        components_(components),
        radius_(radius),
        grid_(state.keyframes, radius),
        of_keyframe_(state.keyframes.size()) {
    const ObservationStore& all = state.corpus.observations;
    for (std::uint32_t run = 0; run < all.runs(); ++run) {
      for (std::uint32_t i = all.runBegin(run); i < all.runEnd(run); ++i) ++at(i)[run];
    }
  }

  void forget(std::uint32_t observation, std::uint32_t run) {
    if (--at(observation)[run] == 0) at(observation).erase(run);
  }

  /// Whether another run of the same part of the graph has some near this one.
  bool others(std::uint32_t observation, std::uint32_t run) const {
    bool found = false;
    const std::size_t here = keyframeOf(observation);
    grid_.forEachNear(state_.keyframes[here].pose, radius_, [&](int k, double) {
      const auto there = static_cast<std::size_t>(k);
      const auto& runs = of_keyframe_[there];
      found = found || (components_[there] == components_[here] &&
                        runs.size() > (runs.count(run) > 0 ? 1U : 0U));
    });
    return found;
  }

  std::size_t keyframeOf(std::uint32_t observation) const {
    return static_cast<std::size_t>(state_.keyframe_of_observation[observation]);
  }

 private:
  std::map<std::uint32_t, int>& at(std::uint32_t observation) {
    return of_keyframe_[keyframeOf(observation)];
  }

  const SlamState& state_;
  const std::vector<int>& components_;
  double radius_;
  KeyframeGrid grid_;
  std::vector<std::map<std::uint32_t, int>> of_keyframe_;  // how many, by run
};

/// Calls `use(begin, end)` for each longest range of `values` that are all `value`.
template <typename Use>
void forEachRange(const std::vector<bool>& values, bool value, Use use) {
  for (std::size_t i = 0, end = 0; i < values.size(); i = end) {
    for (end = i + 1; end < values.size() && values[end] == values[i];) ++end;
    if (values[i] == value) use(i, end);
  }
}

}  // namespace

void ObservationRedundancyParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("observation_radius", observation_radius, Range::above(0.0), "m",
        "observations of density this near are of the same place");
  visit("min_observations", min_observations, Range::between(1, 1e6), "",
        "of density in a row, fewer of which are forgotten where another run has some");
}

std::vector<bool> redundantObservations(const SlamState& state, const std::vector<bool>& dropped,
                                        const std::vector<int>& components,
                                        const ObservationRedundancyParams& params) {
  const ObservationStore& all = state.corpus.observations;
  KeptObservations kept(state, components, params.observation_radius);
  std::vector<bool> forgotten(all.size(), false);
  for (std::uint32_t run = all.runs(); run-- > 0;) {
    const std::uint32_t begin = all.runBegin(run), end = all.runEnd(run);
    std::vector<bool> covered, known;
    for (std::uint32_t i = begin; i < end; ++i) {
      covered.push_back(kept.others(i, run));
      known.push_back(covered.back() && dropped[kept.keyframeOf(i)]);
    }
    if (std::find(known.begin(), known.end(), true) == known.end()) continue;
    const std::vector<bool> each = known;
    forEachRange(each, true, [&](std::size_t a, std::size_t b) {
      const bool parts = a == 0 || b == each.size() || b - a > kBridged;
      if (!parts) std::fill_n(known.begin() + static_cast<std::ptrdiff_t>(a), b - a, false);
    });
    const std::vector<bool> bridged = known;
    forEachRange(bridged, false, [&](std::size_t a, std::size_t b) {
      if (b - a >= static_cast<std::size_t>(params.min_observations)) return;
      for (std::size_t i = a; i < b; ++i) known[i] = covered[i];
    });
    for (std::uint32_t i = begin; i < end; ++i) {
      if (!known[i - begin]) continue;
      forgotten[i] = true;
      kept.forget(i, run);
    }
  }
  return forgotten;
}

}  // namespace ngram_slam
