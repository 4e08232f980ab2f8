// The estimates of a run against true poses.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "altered_log.hpp"
#include "fsd_localization/localizer.hpp"

namespace fsd_localization {

class LocalizationScore {
 public:
  /// An estimate with smaller errors is right.
  struct Limits {
    double position = 0.5;  ///< [m]
    double heading = 15.0;  ///< [deg]
  };
  explicit LocalizationScore(const Limits& limits) : limits_(limits) {}

  bool empty() const { return entries_.empty(); }
  void add(const LocalizationResult& result, const hyselam::Pose2& truth);

  nlohmann::json report() const;
  /// What was told of each stand: whether the robot was sure and right before, after how many
  /// seconds it was not sure (null: it was all the time), what it was at the end, and after how
  /// many metres it was sure and right again (null: never).
  nlohmann::json stands(const std::vector<Stand>& stands) const;
  /// All updates, a line each (CSV with a heading); what is not known stays empty.
  void writeTable(std::ostream& out) const;

 private:
  struct Entry {
    double travelled, error_m, error_deg;
    bool good, converged;
    Phase phase;
    LocalizationResult result;
  };

  /// The first good estimate of [begin, end) after the last bad one; the number of all if the last
  /// is bad.
  std::size_t heldFrom(std::size_t begin, std::size_t end) const;
  double wronglyConverged() const;
  double rightShare() const;
  /// Metres after `begin` from which estimates were right for 5 m; null without such.
  nlohmann::json firstRight(std::size_t begin, std::size_t end) const;
  /// Whether the estimates of the last half metre up to an entry were all right: then it is wrong
  /// to say anything else.
  bool wasRight(std::size_t i) const;
  /// Whether a tracked pose has gone elsewhere from one update to the next: found by the search
  /// that gave up the old one.
  bool hasLeapt(std::size_t i) const;
  /// Times that a tracked pose is given up. It is false if the pose was right.
  nlohmann::json alarms() const;
  /// Times that a right pose that was told as sure is told as not sure any more, or left for
  /// another. Unlike alarms, this can be asked of any localisation.
  std::size_t falseDoubts() const;
  nlohmann::json kidnaps() const;
  double median(std::size_t from, double Entry::*field) const;

  Limits limits_;
  hyselam::Pose2 truth_;
  std::vector<Entry> entries_;
  std::vector<std::size_t> jumps_;  // first entry after each
};

}  // namespace fsd_localization
