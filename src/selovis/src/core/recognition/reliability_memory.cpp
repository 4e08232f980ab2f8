#include "selovis/recognition/reliability_memory.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "hyselam_common/binary_io.hpp"
#include "hyselam_common/errors.hpp"

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

std::string ReliabilityMemory::toBytes() const {
  std::ostringstream bytes;
  hyselam::BinaryWriter out(bytes);
  const auto put = [&](const Key& key) {
    const auto& [column, row, heading] = key;
    for (const int value : {column, row, heading}) out.put(static_cast<std::int32_t>(value));
  };
  out.put(static_cast<std::uint64_t>(visits_.size()));
  for (const auto& [key, visits] : visits_) {
    put(key);
    out.put(visits);
  }
  out.put(static_cast<std::uint64_t>(errors_.size()));
  for (const auto& [at, errors] : errors_) {
    put(at.first);
    out.put(static_cast<std::int32_t>(at.second));
    out.put(errors);
  }
  out.flush();
  return bytes.str();
}

ReliabilityMemory ReliabilityMemory::fromBytes(const std::string& bytes, int places) {
  const auto require = [](bool good, const char* otherwise) {
    if (!good) throw hyselam::InputError("reliability", "", otherwise);
  };
  hyselam::BinaryReader in(bytes, "reliability");
  const auto key = [&] {
    const int column = in.get<std::int32_t>(), row = in.get<std::int32_t>(),
              heading = in.get<std::int32_t>();
    require(heading >= 0 && heading < kHeadings, "has a heading that there is not");
    return Key{column, row, heading};
  };
  ReliabilityMemory memory;
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    const Key at = key();
    const double visits = in.get<double>();
    require(std::isfinite(visits) && visits >= 1.0, "has a pose without visits");
    require(memory.visits_.emplace(at, visits).second, "has a pose twice");
  }
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    const Key at = key();
    const int place = in.get<std::int32_t>();
    const double errors = in.get<double>();
    const auto visits = memory.visits_.find(at);
    require(place >= 0 && place < places, "has an error of a place that is not listed");
    require(visits != memory.visits_.end() && errors >= 1.0 && errors <= visits->second,
            "has more errors than visits");
    require(memory.errors_.emplace(std::make_pair(at, place), errors).second, "has an error twice");
  }
  in.requireEnd();
  return memory;
}

}  // namespace selovis
