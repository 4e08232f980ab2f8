#include "ngram_slam/slam/far_loops.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "ngram_slam/slam/loop_candidates.hpp"
#include "ngram_slam/slam/loop_confidence.hpp"

namespace ngram_slam {

namespace {

bool isSamePair(const SlamLoop& a, const SlamLoop& b) {
  return a.older == b.older && a.newer == b.newer;
}

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
  void accept(const SlamLoop& loop) { accepted_.push_back(loop); }

  bool isBelieved(const SlamLoop& loop, const std::vector<SlamLoop>& waiting) const {
    if (!isPlausible(loop, waiting)) return false;
    if (!consistentLoops(loop, accepted_, keyframes_, connections_, params_).empty()) return true;
    double first = pathLengthAt(loop), last = first;
    bool only_signatures = loop.source == LoopSource::kSignature;
    int group = 1;
    for (const std::size_t i : consistentLoops(loop, waiting, keyframes_, connections_, params_)) {
      const SlamLoop& other = waiting[i];
      if (isSamePair(loop, other) || !isPlausible(other, waiting)) continue;
      ++group;
      only_signatures = only_signatures && other.source == LoopSource::kSignature;
      first = std::min(first, pathLengthAt(other));
      last = std::max(last, pathLengthAt(other));
    }
    // Loops from one spot are one opinion.
    const int min_loops = isTie(loop)       ? params_.min_tie_loops
                          : only_signatures ? params_.min_consistent_signature_loops
                                            : params_.min_consistent_loops;
    return group >= min_loops &&
           last - first >= (isTie(loop) ? params_.tie_min_span : params_.consistency_min_span);
  }

 private:
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
                                      std::vector<SlamLoop>* waiting) {
  Judge judge(accepted, keyframes, connections, params);
  waiting->push_back(loop);
  // What the new loop may have changed.
  const double reach = std::max(params.company_half_length, params.consistency_max_path_length);
  std::vector<SlamLoop> believed;
  for (bool found = true; found;) {
    found = false;
    // The newest first. Their order in the graph moves a map's error by about a hundredth of it.
    for (auto i = waiting->rbegin(); i != waiting->rend(); ++i) {
      if (std::abs(judge.pathLengthAt(*i) - judge.pathLengthAt(loop)) > reach ||
          !judge.isBelieved(*i, *waiting)) {
        continue;
      }
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
