#include "hyselam_topo/dialogue/change_history.hpp"

#include <algorithm>
#include <utility>

namespace hyselam_topo {
namespace {

/// So many changes can be taken back.
constexpr std::size_t kLongest = 16;

bool has(const std::vector<Id>& all, Id id) {
  return std::find(all.begin(), all.end(), id) != all.end();
}

/// What people have said of the names of these places.
PlaceMan::Names namesOf(const std::vector<Id>& places, const PlaceMan::Names& names) {
  PlaceMan::Names some;
  for (const auto& each : names.words) {
    if (has(places, each.first)) some.words.insert(each);
  }
  for (const auto& each : names.rejected) {
    if (has(places, each.first)) some.rejected.push_back(each);
  }
  return some;
}

}  // namespace

bool haveSameNames(const PlaceMan::Names& a, const PlaceMan::Names& b) {
  return a.rejected == b.rejected && a.words.size() == b.words.size() &&
         std::equal(a.words.begin(), a.words.end(), b.words.begin(), b.words.end(),
                    [](const auto& one, const auto& other) {
                      return one.first == other.first &&
                             confirmedOf(one.second) == confirmedOf(other.second);
                    });
}

void ChangeHistory::add(KnownBefore before) {
  changes_.push_back(std::move(before));
  if (changes_.size() > kLongest) bar(1, KnownBefore::Barrier::kTooLongAgo);
}

bool ChangeHistory::isStatementLast(std::size_t statements) const {
  if (changes_.empty()) return true;
  const KnownBefore& last = changes_.back();
  return statements > (last.told ? last.after : last.statements);
}

KnownBefore::Barrier ChangeHistory::barrier(std::size_t statements) const {
  if (changes_.empty() || statements > changes_.back().after) return KnownBefore::Barrier::kNone;
  return changes_.back().barrier;
}

void ChangeHistory::bar(std::size_t change, KnownBefore::Barrier why) {
  KnownBefore barrier;
  barrier.barrier = why;
  barrier.statements = barrier.after = changes_[change].after;
  changes_.erase(changes_.begin(), changes_.begin() + static_cast<std::ptrdiff_t>(change) + 1);
  changes_.insert(changes_.begin(), std::move(barrier));
}

void ChangeHistory::forgetPlaces(const std::vector<Id>& lost, const KnownBefore& now) {
  if (lost.empty()) return;
  auto& all = changes_;
  for (std::size_t i = all.size(); i-- > 0 && all[i].barrier == KnownBefore::Barrier::kNone;) {
    const KnownBefore& next = i + 1 < all.size() ? all[i + 1] : now;
    const auto had = [&](const KnownBefore& each, Id id) { return has(each.virtual_places, id); };
    const bool is_of_lost =
        !haveSameNames(namesOf(lost, all[i].names), namesOf(lost, next.names)) ||
        std::any_of(lost.begin(), lost.end(),
                    [&](Id id) { return had(all[i], id) != had(next, id); });
    if (!is_of_lost) continue;
    bar(i, KnownBefore::Barrier::kPlaceGone);
    break;
  }
  // Another map may have other places under their ids.
  for (KnownBefore& each : all) {
    for (const Id id : lost) each.names.words.erase(id);
    auto& rejected = each.names.rejected;
    rejected.erase(std::remove_if(rejected.begin(), rejected.end(),
                                  [&](const auto& pair) { return has(lost, pair.first); }),
                   rejected.end());
    auto& virtuals = each.virtual_places;
    virtuals.erase(
        std::remove_if(virtuals.begin(), virtuals.end(), [&](Id id) { return has(lost, id); }),
        virtuals.end());
    if (has(lost, each.told_at)) each.told_at = 0;
  }
}

}  // namespace hyselam_topo
