#include "selovis/recognition/reliability_memory.hpp"

#include <algorithm>
#include <cmath>

namespace selovis {

ReliabilityMemory::Key ReliabilityMemory::keyOf(const hyselam::Pose2& pose) {
  const auto cell = [](double at) {
    return static_cast<int>(std::floor(std::clamp(at / kCell, -1e9, 1e9)));
  };
  const double turn = hyselam::normalizeAngle(pose.theta) / (2.0 * hyselam::kPi) * kHeadings;
  return {cell(pose.x), cell(pose.y),
          (static_cast<int>(std::lround(turn)) + kHeadings) % kHeadings};
}

void ReliabilityMemory::add(const hyselam::Pose2& pose, const std::vector<int>& places,
                            double looks) {
  const Key key = keyOf(pose);
  if (present_ && *present_ != key) {
    visits_[*present_] += 1.0;
    for (const auto& [place, spoken] : spoken_for_) {
      if (spoken >= kErringLooks) errors_[{*present_, place}] += 1.0;
    }
    spoken_for_.clear();
  }
  present_ = key;
  for (const int place : places) spoken_for_[place] += looks;
}

double ReliabilityMemory::errorRate(const hyselam::Pose2& pose, int place) const {
  const Key key = keyOf(pose);
  const auto visits = visits_.find(key);
  if (visits == visits_.end()) return kPriorErrors;
  const auto errors = errors_.find({key, place});
  const double wrong = errors == errors_.end() ? 0.0 : errors->second;
  return (wrong + kPriorErrors * kPriorVisits) / (visits->second + kPriorVisits);
}

}  // namespace selovis
