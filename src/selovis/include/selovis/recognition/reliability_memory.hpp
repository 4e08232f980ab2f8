// Where the camera errs: what it called wrong at poses that proved right.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "hyselam_common/pose2.hpp"

namespace selovis {

/// Counts visits by pose (square cells of 1 m, eight headings), and those at which the camera spoke
/// for some other place, by that place. A view that was never learned errs at each visit, in the
/// same way: a second time it is expected.
class ReliabilityMemory {
 public:
  static constexpr double kCell = 1.0;  ///< [m]
  static constexpr int kHeadings = 8;
  /// Share of visits that err where nothing is known, and how many visits it is worth.
  static constexpr double kPriorErrors = 0.01, kPriorVisits = 2.0;
  static constexpr double kErringLooks = 0.5;  ///< of a visit for one place: an error

  /// A look, or a part of one (`looks`, 0 to 1), from a pose that was right, in order of time;
  /// `places`: the others that it spoke for. Looks from one cell and heading on end are a visit,
  /// which counts when it is over.
  void add(const hyselam::Pose2& pose, const std::vector<int>& places, double looks);
  /// Share of the visits there that speak for `place` though the pose is right; 0 to 1.
  double errorRate(const hyselam::Pose2& pose, int place) const;
  /// Poses that were visited.
  std::size_t size() const { return visits_.size(); }

  /// The visits that are over, as bytes that are the same on all machines.
  std::string toBytes() const;
  /// What toBytes() gave. @param places so many there are. @throws hyselam::InputError.
  static ReliabilityMemory fromBytes(const std::string& bytes, int places);

 private:
  using Key = std::tuple<int, int, int>;  // column, row, heading
  static Key keyOf(const hyselam::Pose2& pose);

  std::map<Key, double> visits_;
  std::map<std::pair<Key, int>, double> errors_;
  std::optional<Key> present_;
  std::map<int, double> spoken_for_;  // looks of the present visit, by place
};

}  // namespace selovis
