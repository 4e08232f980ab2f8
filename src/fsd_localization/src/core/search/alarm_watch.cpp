#include "fsd_localization/search/alarm_watch.hpp"

#include <algorithm>

namespace fsd_localization {

namespace {
constexpr double kBrokenWay = 3.0;     // [m] that a break of the motion is looked into
constexpr double kUnmatchedWay = 1.0;  // [m] that a scan is which did not fit the one before
constexpr double kSameAlarm = 1.0;     // [m] what comes and goes within it is one alarm
}  // namespace

bool AlarmWatch::add(double way, const Signs& signs) {
  if (signs.broken) suspicious_until_ = std::max(suspicious_until_, way + kBrokenWay);
  if (signs.unmatched) suspicious_until_ = std::max(suspicious_until_, way + kUnmatchedWay);
  const bool suspicious = way < suspicious_until_;
  const bool strange = suspicious && signs.unusual;
  const bool misfit = signs.odd || signs.low || signs.broken;
  if (signs.broken || signs.unmatched) unmatched_at_ = way;
  // The second scan that does not fit goes on with the alarm of the first: what is asked about was
  // seen since the scans do not fit each other, and need not be asked again.
  const bool goes_on = from_ && sharp_ && !confirmed_ && *from_ >= unmatched_at_;
  const bool begins =
      (strange && way >= strange_until_ && !goes_on) || (misfit && from_ && !sharp_);
  if (strange) strange_until_ = way + kSameAlarm;
  const bool reason = suspicious || signs.odd || signs.low || signs.worse;
  const bool opened = begins || (reason && !from_);
  if (opened) {
    from_ = way;
    step_ = kFirstStep;
    confirmed_ = carried_ = sharp_ = false;
  }
  if (confirmed_ && !reason) from_.reset();
  carried_ = from_ && (carried_ || strange);
  sharp_ = from_ && (sharp_ || misfit);
  doubtful_ = from_ && !confirmed_ && (doubtful_ || strange || signs.very_low);
  return opened;
}

void AlarmWatch::confirm() {
  confirmed_ = from_.has_value();
  doubtful_ = false;
}

void AlarmWatch::answered(bool is_against) {
  if (!is_against) step_ = std::min(2.0 * step_, doubtful_ ? kLargestDoubtfulStep : kLargestStep);
}

std::optional<double> AlarmWatch::length(double way) const {
  if (!from_) return std::nullopt;
  return way - *from_;
}

}  // namespace fsd_localization
