#include "ngram_slam/recognition_score.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

void ScoreParams::validate() const {
  if (!(distance > 0.0 && std::isfinite(distance)))
    throw hyselam::ParameterError("distance", distance, "> 0 [m]");
  if (!(heading > 0.0 && heading <= hyselam::kPi))
    throw hyselam::ParameterError("heading", heading, "in (0, pi] [rad]");
}

RecognitionScore::RecognitionScore(std::vector<std::optional<hyselam::Pose2>> reference,
                                   std::vector<std::uint32_t> run, const ScoreParams& params)
    : reference_(std::move(reference)), run_(std::move(run)), params_(params) {
  params.validate();
  if (run_.size() != reference_.size())
    throw std::invalid_argument("RecognitionScore: as many runs as reference poses are needed");
  revisit_.assign(run_.size(), 0);
  revisit_any_ = recognised_ = revisit_;
  findRevisits();
}

bool RecognitionScore::counts(std::uint32_t newer, std::uint32_t older) const {
  return reference_[newer] && reference_[older] &&
         (run_[newer] != run_[older] || newer - older >= params_.separation);
}
bool RecognitionScore::near(std::uint32_t a, std::uint32_t b) const {
  return hyselam::distance(*reference_[a], *reference_[b]) <= params_.distance;
}
bool RecognitionScore::sameWay(std::uint32_t a, std::uint32_t b) const {
  return std::abs(hyselam::normalizeAngle(reference_[a]->theta - reference_[b]->theta)) <=
         params_.heading;
}

void RecognitionScore::findRevisits() {
  // Squares with the distance as side: the neighbours of a square hold all that is near.
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> squares;
  const auto square = [&](double x, double y, int dx, int dy) {
    const auto i = static_cast<std::int32_t>(std::floor(x / params_.distance)) + dx;
    const auto k = static_cast<std::int32_t>(std::floor(y / params_.distance)) + dy;
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32 |
           static_cast<std::uint32_t>(k);
  };
  for (std::uint32_t i = 0; i < reference_.size(); ++i) {
    if (!reference_[i]) continue;
    for (int d = 0; d < 9 && revisit_[i] == 0; ++d) {
      const auto at =
          squares.find(square(reference_[i]->x, reference_[i]->y, d / 3 - 1, d % 3 - 1));
      if (at == squares.end()) continue;
      for (std::uint32_t older : at->second) {
        if (!counts(i, older) || !near(i, older)) continue;
        revisit_any_[i] = 1;
        if (!sameWay(i, older)) continue;
        revisit_[i] = 1;
        break;
      }
    }
    revisits_ += static_cast<std::size_t>(revisit_[i]);
    revisits_any_ += static_cast<std::size_t>(revisit_any_[i]);
    squares[square(reference_[i]->x, reference_[i]->y, 0, 0)].push_back(i);
  }
}

std::optional<bool> RecognitionScore::add(std::uint32_t newer, std::uint32_t older) {
  if (newer < older) std::swap(newer, older);
  if (!counts(newer, older)) return std::nullopt;
  const bool right = near(newer, older) && sameWay(newer, older);
  if (!seen_.insert(static_cast<std::uint64_t>(newer) << 32 | older).second) return right;
  ++pairs_;
  true_pairs_ += right;
  if (right) recognised_[newer] = 1;
  return right;
}

double RecognitionScore::precision() const {
  return pairs_ == 0 ? 1.0 : static_cast<double>(true_pairs_) / static_cast<double>(pairs_);
}

std::size_t RecognitionScore::recognised(const std::vector<char>& revisit,
                                         std::uint32_t reach) const {
  std::size_t count = 0;
  const auto n = static_cast<std::int64_t>(revisit.size());
  std::int64_t last = -static_cast<std::int64_t>(reach) - 1;
  std::vector<char> covered(revisit.size(), 0);
  for (std::int64_t i = 0; i < n; ++i) {
    if (recognised_[static_cast<std::size_t>(i)] != 0) last = i;
    covered[static_cast<std::size_t>(i)] = i - last <= reach;
  }
  last = n + reach;
  for (std::int64_t i = n - 1; i >= 0; --i) {
    const auto at = static_cast<std::size_t>(i);
    if (recognised_[at] != 0) last = i;
    count += revisit[at] != 0 && (covered[at] != 0 || last - i <= reach);
  }
  return count;
}

double RecognitionScore::recall(std::uint32_t reach) const {
  return revisits_ == 0
             ? 0.0
             : static_cast<double>(recognised(revisit_, reach)) / static_cast<double>(revisits_);
}
double RecognitionScore::recallAnyDirection(std::uint32_t reach) const {
  return revisits_any_ == 0 ? 0.0
                            : static_cast<double>(recognised(revisit_any_, reach)) /
                                  static_cast<double>(revisits_any_);
}

}  // namespace ngram_slam
