#include "localization_score.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <utility>

namespace fsd_localization {

namespace {
constexpr double kJump = 1.0;             // [m] more than was travelled: the robot was carried
constexpr double kRightWay = 5.0;         // [m] right for so long: found
constexpr double kStampTolerance = 1e-3;  // [s]
constexpr double kAlarmLook = 0.5;        // [m] before an alarm or doubt: was the pose right?
}  // namespace

void LocalizationScore::add(const LocalizationResult& result, const hyselam::Pose2& truth) {
  Entry e;
  e.travelled = result.travelled;
  e.error_m = hyselam::distance(result.base_in_map, truth);
  e.error_deg =
      hyselam::degrees(std::abs(hyselam::normalizeAngle(result.base_in_map.theta - truth.theta)));
  e.good = e.error_m < limits_.position && e.error_deg < limits_.heading;
  e.converged = result.converged;
  e.phase = result.phase;
  e.result = result;
  if (!entries_.empty() &&
      hyselam::distance(truth_, truth) > e.travelled - entries_.back().travelled + kJump) {
    jumps_.push_back(entries_.size());
  }
  truth_ = truth;
  entries_.push_back(e);
}

nlohmann::json LocalizationScore::report() const {
  const std::size_t held = heldFrom(0, entries_.size());
  const bool success = held < entries_.size();
  nlohmann::json j = {{"success", success},
                      {"held_from_m", nullptr},
                      {"kept_m", 0.0},
                      {"right_share", rightShare()},
                      {"median_error_m", nullptr},
                      {"median_error_deg", nullptr},
                      {"wrongly_converged_m", wronglyConverged()},
                      {"alarms", alarms()},
                      {"false_doubts", falseDoubts()},
                      {"kidnaps", kidnaps()}};
  if (!success) return j;
  j["held_from_m"] = entries_[held].travelled;
  j["kept_m"] = entries_.back().travelled - entries_[held].travelled;
  j["median_error_m"] = median(held, &Entry::error_m);
  j["median_error_deg"] = median(held, &Entry::error_deg);
  return j;
}

void LocalizationScore::writeTable(std::ostream& out) const {
  out << "stamp,travelled_m,phase,converged,right,error_m,error_deg,cluster_weight,deviation_m,"
         "particles,inlier_ratio,place_probability,places\n";
  const auto orNothing = [&](const std::optional<double>& value) {
    if (value) out << *value;
  };
  for (const Entry& e : entries_) {
    const LocalizationResult& r = e.result;
    out << std::fixed << std::setprecision(3) << r.stamp << ',' << e.travelled << ','
        << toString(e.phase) << ',' << e.converged << ',' << e.good << ',' << e.error_m << ','
        << e.error_deg << ',' << r.cluster_weight << ','
        << std::sqrt(std::max(r.covariance(0, 0), r.covariance(1, 1))) << ',' << r.particles << ',';
    orNothing(r.inlier_ratio);
    out << ',';
    orNothing(r.place_probability);
    out << ',' << r.places << '\n';
  }
}

std::size_t LocalizationScore::heldFrom(std::size_t begin, std::size_t end) const {
  if (end == begin || !entries_[end - 1].good) return entries_.size();
  while (end > begin && entries_[end - 1].good) --end;
  return end;
}

double LocalizationScore::wronglyConverged() const {
  double sum = 0.0;
  for (std::size_t i = 1; i < entries_.size(); ++i) {
    if (entries_[i].converged && !entries_[i].good) {
      sum += entries_[i].travelled - entries_[i - 1].travelled;
    }
  }
  return sum;
}

double LocalizationScore::rightShare() const {
  double right = 0.0;
  for (std::size_t i = 1; i < entries_.size(); ++i) {
    if (entries_[i].good) right += entries_[i].travelled - entries_[i - 1].travelled;
  }
  const double way = entries_.back().travelled - entries_.front().travelled;
  return way > 0.0 ? right / way : (entries_.back().good ? 1.0 : 0.0);
}

nlohmann::json LocalizationScore::firstRight(std::size_t begin, std::size_t end) const {
  std::size_t from = begin;
  for (std::size_t i = begin; i < end; ++i) {
    if (!entries_[i].good) {
      from = i + 1;
    } else if (entries_[i].travelled - entries_[from].travelled >= kRightWay) {
      return entries_[from].travelled - entries_[begin].travelled;
    }
  }
  return nullptr;
}

bool LocalizationScore::wasRight(std::size_t i) const {
  bool right = entries_[i].good;
  for (std::size_t k = i; k-- > 0 && entries_[i].travelled - entries_[k].travelled < kAlarmLook;) {
    right = right && entries_[k].good;
  }
  return right;
}

bool LocalizationScore::hasLeapt(std::size_t i) const {
  const Entry &before = entries_[i - 1], &now = entries_[i];
  return before.phase == Phase::kTracking && now.phase == Phase::kTracking &&
         hyselam::distance(before.result.base_in_map, now.result.base_in_map) >
             now.travelled - before.travelled + kJump;
}

nlohmann::json LocalizationScore::alarms() const {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 1; i < entries_.size(); ++i) {
    const bool leapt = hasLeapt(i);
    const bool lost =
        entries_[i].phase == Phase::kLost && entries_[i - 1].phase == Phase::kTracking;
    if (!lost && !leapt) continue;
    list.push_back({{"at_m", entries_[i].travelled}, {"false", wasRight(leapt ? i - 1 : i)}});
  }
  return list;
}

std::size_t LocalizationScore::falseDoubts() const {
  std::size_t count = 0;
  for (std::size_t i = 1; i < entries_.size(); ++i) {
    if (!entries_[i - 1].converged) continue;
    count += hasLeapt(i) ? wasRight(i - 1) : !entries_[i].converged && wasRight(i);
  }
  return count;
}

nlohmann::json LocalizationScore::kidnaps() const {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < jumps_.size(); ++i) {
    const std::size_t first = jumps_[i];
    const std::size_t end = i + 1 < jumps_.size() ? jumps_[i + 1] : entries_.size();
    const std::size_t held = heldFrom(first, end);
    const double at = entries_[first].travelled;
    const auto sinceJump = [&](std::size_t k) -> nlohmann::json {
      if (k >= end) return nullptr;
      return entries_[k].travelled - at;
    };
    std::size_t noticed = first;
    while (noticed < end && entries_[noticed].phase == Phase::kTracking &&
           !entries_[noticed].good) {
      ++noticed;
    }
    double wrong = 0.0;
    for (std::size_t k = first + 1; k < end; ++k) {
      if (entries_[k].converged && !entries_[k].good) {
        wrong += entries_[k].travelled - entries_[k - 1].travelled;
      }
    }
    list.push_back({{"at_m", at},
                    {"was_tracking", first > 0 && entries_[first - 1].phase == Phase::kTracking},
                    {"noticed_after_m", sinceJump(noticed)},
                    {"right_after_m", firstRight(first, end)},
                    {"recovered_after_m", sinceJump(held)},
                    {"wrongly_converged_m", wrong}});
  }
  return list;
}

nlohmann::json LocalizationScore::stands(const std::vector<Stand>& stands) const {
  nlohmann::json list = nlohmann::json::array();
  const auto after = [&](double stamp) {
    return std::find_if(entries_.begin(), entries_.end(),
                        [&](const Entry& e) { return e.result.stamp > stamp; });
  };
  for (const Stand& stand : stands) {
    // The first scan after a jump is already one of the new place.
    const auto first = after(stand.begin + (stand.carried ? -kStampTolerance : kStampTolerance));
    const auto end = after(stand.end + kStampTolerance);
    if (first == entries_.begin()) continue;
    const Entry &before = *(first - 1), &last = *(end - 1);
    const auto unsure = std::find_if(first, end, [](const Entry& e) { return !e.converged; });
    const bool was_lost =
        std::any_of(first, end, [](const Entry& e) { return e.phase != Phase::kTracking; });
    const auto again =
        std::find_if(end, entries_.end(), [](const Entry& e) { return e.converged && e.good; });
    nlohmann::json j = {{"begin_s", stand.begin},
                        {"carried", stand.carried},
                        {"was_sure", before.converged},
                        {"was_right", before.good},
                        {"unsure_after_s", nullptr},
                        {"was_lost", was_lost},
                        {"sure_at_end", last.converged},
                        {"right_at_end", last.good && !(stand.carried && first == end)},
                        {"sure_again_after_m", nullptr}};
    if (unsure != end) j["unsure_after_s"] = unsure->result.stamp - stand.begin;
    if (again != entries_.end()) j["sure_again_after_m"] = again->travelled - last.travelled;
    list.push_back(std::move(j));
  }
  return list;
}

double LocalizationScore::median(std::size_t from, double Entry::*field) const {
  std::vector<double> v;
  for (std::size_t i = from; i < entries_.size(); ++i) v.push_back(entries_[i].*field);
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

}  // namespace fsd_localization
