#include "ngram_slam/slam/far_loops.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "ngram_slam/slam/loop_candidates.hpp"
#include "ngram_slam/slam/loop_confidence.hpp"

namespace ngram_slam {

namespace {

/// The accepted loops, and those that wait.
class Judge {
 public:
  Judge(const std::vector<SlamLoop>& accepted, const std::vector<SlamKeyframe>& keyframes,
        const RunConnections& connections, const LoopParams& params)
      : keyframes_(keyframes), connections_(connections), params_(params), accepted_(accepted) {}

  const std::vector<SlamLoop>& accepted() const { return accepted_; }
  double pathLengthAt(const SlamLoop& l) const {
    return keyframes_[static_cast<std::size_t>(l.newer)].path_length;
  }
  bool areConsistent(const SlamLoop& a, const SlamLoop& b) const {
    return !consistentLoops(a, {b}, keyframes_, connections_, params_).empty();
  }
  void accept(const SlamLoop& loop) { accepted_.push_back(loop); }

  bool isBelieved(const SlamLoop& loop, const std::vector<SlamLoop>& waiting) const {
    if (!isPlausible(loop, waiting)) return false;
    if (!consistentLoops(loop, accepted_, keyframes_, connections_, params_).empty()) return true;
    std::vector<const SlamLoop*> others;
    for (const std::size_t i : consistentLoops(loop, waiting, keyframes_, connections_, params_)) {
      if (!isSamePair(loop, waiting[i]) && isPlausible(waiting[i], waiting)) {
        others.push_back(&waiting[i]);
      }
    }
    for (std::size_t i = 0; i < others.size(); ++i) {
      if (isGroup(loop, others, i)) return true;
    }
    return false;
  }

 private:
  /// Whether a loop and pairwise consistent ones of the others, taken in turn from one of them on,
  /// are enough.
  bool isGroup(const SlamLoop& loop, const std::vector<const SlamLoop*>& others,
               std::size_t begin) const {
    std::vector<const SlamLoop*> group{&loop};
    for (std::size_t i = 0; i < others.size(); ++i) {
      const SlamLoop& other = *others[(begin + i) % others.size()];
      const bool fits = std::all_of(group.begin() + 1, group.end(), [&](const SlamLoop* l) {
        return !isSamePair(*l, other) && areConsistent(*l, other);
      });
      if (fits) group.push_back(&other);
    }
    double first = pathLengthAt(loop), last = first;
    bool with_words = false;
    for (const SlamLoop* l : group) {
      with_words = with_words || l->source == LoopSource::kNgram;
      first = std::min(first, pathLengthAt(*l));
      last = std::max(last, pathLengthAt(*l));
    }
    // Loops from one spot are one opinion.
    const int min_loops = isTie(loop)  ? params_.min_tie_loops
                          : with_words ? params_.min_consistent_loops
                                       : params_.min_consistent_signature_loops;
    return static_cast<int>(group.size()) >= min_loops &&
           last - first >= (isTie(loop) ? params_.tie_min_span : params_.consistency_min_span);
  }

  /// Whether it joins two maps.
  bool isTie(const SlamLoop& loop) const {
    return !connections_.connected(keyframes_[static_cast<std::size_t>(loop.older)].run,
                                   keyframes_[static_cast<std::size_t>(loop.newer)].run);
  }
  bool isPlausible(const SlamLoop& loop, const std::vector<SlamLoop>& waiting) const {
    LoopCompany company = companyOf(loop, accepted_, keyframes_, connections_, params_);
    const LoopCompany more = companyOf(loop, waiting, keyframes_, connections_, params_);
    company.support += more.support - loop.inlier_ratio;  // which both count
    company.contradiction += more.contradiction;
    return company.isTrusted(params_) &&
           ((loop.source != LoopSource::kSignature && !isTie(loop)) ||
            loopProbability(loop, company) >= params_.min_signature_probability);
  }

  const std::vector<SlamKeyframe>& keyframes_;
  const RunConnections& connections_;
  const LoopParams& params_;
  std::vector<SlamLoop> accepted_;
};

}  // namespace

std::vector<SlamLoop> believeFarLoops(const SlamLoop& loop, const std::vector<SlamLoop>& accepted,
                                      const std::vector<SlamKeyframe>& keyframes,
                                      const RunConnections& connections, const LoopParams& params,
                                      std::vector<SlamLoop>* waiting, std::size_t max_waiting) {
  Judge judge(accepted, keyframes, connections, params);
  // What is known already is no further opinion.
  for (const std::vector<SlamLoop>* known :
       {&accepted, static_cast<const std::vector<SlamLoop>*>(waiting)}) {
    for (const SlamLoop& l : *known) {
      if (isSamePair(l, loop) && judge.areConsistent(l, loop)) return {};
    }
  }
  while (waiting->size() >= std::max<std::size_t>(max_waiting, 1)) waiting->erase(waiting->begin());
  waiting->push_back(loop);
  // What the new loop, or one believed since, may have changed.
  const double reach = params.company_half_length + params.consistency_max_path_length;
  std::vector<double> changed{judge.pathLengthAt(loop)};
  const auto mayHaveChanged = [&](const SlamLoop& l) {
    return std::any_of(changed.begin(), changed.end(), [&](double path_length) {
      return std::abs(judge.pathLengthAt(l) - path_length) <= reach;
    });
  };
  std::vector<SlamLoop> believed;
  for (bool found = true; found;) {
    found = false;
    // The newest first. Their order in the graph moves a map's error by about a hundredth of it.
    for (auto i = waiting->rbegin(); i != waiting->rend(); ++i) {
      if (!mayHaveChanged(*i) || !judge.isBelieved(*i, *waiting)) continue;
      changed.push_back(judge.pathLengthAt(*i));
      believed.push_back(*i);
      judge.accept(*i);
      waiting->erase(std::next(i).base());
      found = true;
      break;
    }
  }
  return believed;
}

}  // namespace ngram_slam
