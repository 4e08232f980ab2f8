#include "hyselam_language/reader/tour_match.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "annealing.hpp"
#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// Scores of names at slots, as logarithms of how many times likelier the words are there than
/// anywhere.
class Scores {
 public:
  Scores(const TourEvidence& e, const std::vector<TourSlot>& slots, const TourMatchParams& params)
      : names_(e.rooms), slots_(slots.size()), absent_(-params.absent) {
    const std::vector<Row> rows = rowsOf(slots);
    const double all = static_cast<double>(slots.size());
    const double left = static_cast<double>(
        std::count_if(slots.begin(), slots.end(), [](const TourSlot& s) { return s.is_left; }));
    const double chance_left = (left + 1.0) / (all + 2.0);
    double first = 0.0, last = 0.0;
    for (const Row& row : rows) {
      first += row == Row::kFirst ? 1.0 : 0.0;
      last += row == Row::kLast ? 1.0 : 0.0;
    }
    const auto chance = [&](double count) { return (count + 1.0) / (all + 3.0); };
    for (std::size_t name = 0; name < names_; ++name) {
      for (std::size_t slot = 0; slot < slots_; ++slot) {
        const double side = slots[slot].is_left
                                ? e.left[name] - e.side_weight[name] * std::log(chance_left)
                                : e.right[name] - e.side_weight[name] * std::log(1.0 - chance_left);
        const double count = rows[slot] == Row::kFirst  ? first
                             : rows[slot] == Row::kLast ? last
                                                        : all - first - last;
        const double place = rows[slot] == Row::kFirst  ? e.first[name]
                             : rows[slot] == Row::kLast ? e.last[name]
                                                        : e.inner[name];
        own_.push_back(side + place - e.position_weight[name] * std::log(chance(count)));
      }
    }
    listPairs(e, slots, params.facing);
  }

  double own(std::size_t name, std::size_t slot) const {
    return slot == kNone ? absent_ : own_[name * slots_ + slot];
  }
  double pair(std::size_t a, std::size_t slot_a, std::size_t b, std::size_t slot_b) const {
    if (slot_a == kNone || slot_b == kNone) return 0.0;
    const int how = relation_[slot_a * slots_ + slot_b];
    const std::size_t at = how == kBehind ? b * names_ + a : a * names_ + b;
    return pairs_[static_cast<std::size_t>(how == kBehind ? kBefore : how)][at];
  }
  double of(std::size_t name, const std::vector<std::size_t>& slot_of) const {
    double sum = own(name, slot_of[name]);
    if (slot_of[name] == kNone) return sum;
    for (std::size_t other = 0; other < names_; ++other)
      if (other != name) sum += pair(name, slot_of[name], other, slot_of[other]);
    return sum;
  }
  double ofAll(const std::vector<std::size_t>& slot_of) const {
    double sum = 0.0;
    for (std::size_t a = 0; a < names_; ++a) {
      sum += own(a, slot_of[a]);
      for (std::size_t b = a + 1; b < names_; ++b) sum += pair(a, slot_of[a], b, slot_of[b]);
    }
    return sum;
  }

 private:
  enum class Row { kFirst, kLast, kInner };
  enum Relation { kBefore = 0, kFacing = 1, kApart = 2, kBehind = 3 };

  static std::vector<Row> rowsOf(const std::vector<TourSlot>& slots) {
    std::vector<Row> rows;
    for (const TourSlot& slot : slots) {
      bool first = true, last = true;
      for (const TourSlot& other : slots) {
        if (other.is_left != slot.is_left) continue;
        first = first && other.along >= slot.along;
        last = last && other.along <= slot.along;
      }
      rows.push_back(first ? Row::kFirst : last ? Row::kLast : Row::kInner);
    }
    return rows;
  }

  void listPairs(const TourEvidence& e, const std::vector<TourSlot>& slots, double facing) {
    double counts[3] = {0.0, 0.0, 0.0};
    for (std::size_t s = 0; s < slots_; ++s) {
      for (std::size_t t = 0; t < slots_; ++t) {
        const double off = slots[t].along - slots[s].along;
        const int how = slots[s].is_left == slots[t].is_left ? (off > 0.0 ? kBefore : kBehind)
                        : std::abs(off) < facing             ? kFacing
                                                             : kApart;
        relation_.push_back(static_cast<char>(how));
        if (s != t) counts[how == kBehind ? kBefore : how] += how == kBehind ? 0.0 : 1.0;
      }
    }
    // Of two doors taken anywhere; each kind is there once more, so that none is impossible.
    const double all = 2.0 * counts[kBefore] + counts[kFacing] + counts[kApart] + 4.0;
    const std::vector<double>* told[3] = {&e.before, &e.facing, &e.apart};
    for (int how = 0; how < 3; ++how) {
      const double chance = std::log((counts[how] + 1.0) / all);
      for (std::size_t at = 0; at < e.pair_weight.size(); ++at)
        pairs_[static_cast<std::size_t>(how)].push_back((*told[how])[at] -
                                                        e.pair_weight[at] * chance);
    }
  }

  std::size_t names_, slots_;
  double absent_;
  std::vector<double> own_;       ///< names x slots
  std::vector<char> relation_;    ///< slots x slots
  std::vector<double> pairs_[3];  ///< names x names: before, facing, apart
};

class Matcher {
 public:
  Matcher(const TourEvidence& evidence, const std::vector<TourSlot>& slots,
          const TourMatchParams& params, const TourConstraints& constraints)
      : names_(evidence.rooms),
        slots_(slots.size()),
        params_(params),
        scores_(evidence, slots, params),
        dice_(params.seed),
        allowed_(names_ * slots_, 1),
        fixed_(names_, kNone) {
    restrict(constraints);
    for (std::size_t slot = 0; slot < slots_; ++slot)
      row_[slots[slot].is_left ? 1 : 0].push_back(slot);
    for (auto& row : row_) {
      std::sort(row.begin(), row.end(),
                [&](std::size_t a, std::size_t b) { return slots[a].along < slots[b].along; });
    }
  }

  TourMatch run() {
    std::vector<double> seen(slots_ * names_, 0.0);
    double count = 0.0;
    for (std::size_t start = 0; start < params_.starts; ++start) sample(&seen, &count);
    TourMatch match;
    match.names = names_;
    for (const double times : seen) match.probability.push_back(count > 0.0 ? times / count : 0.0);
    match.best.assign(slots_, std::nullopt);
    for (std::size_t name = 0; name < best_.size(); ++name)
      if (best_[name] != kNone) match.best[best_[name]] = name;
    return match;
  }

 private:
  void restrict(const TourConstraints& constraints) {
    const auto fail = [](std::size_t slot, const std::string& reason) {
      throw hyselam::InputError("constraints", "slot " + std::to_string(slot), reason);
    };
    const auto check = [&](std::size_t slot, std::size_t name) {
      if (slot >= slots_ || name >= names_) fail(slot, "is not there, or has no such name");
    };
    for (const auto& [slot, name] : constraints.excluded) {
      check(slot, name);
      allowed_[name * slots_ + slot] = 0;
    }
    for (const std::size_t slot : constraints.unnamed) {
      if (slot >= slots_) fail(slot, "is not there");
      for (std::size_t name = 0; name < names_; ++name) allowed_[name * slots_ + slot] = 0;
    }
    for (const auto& [slot, name] : constraints.confirmed) {
      check(slot, name);
      if (allowed_[name * slots_ + slot] == 0 || fixed_[name] != kNone)
        fail(slot, "a name is both confirmed and excluded, or confirmed twice");
      fixed_[name] = slot;
      for (std::size_t other = 0; other < names_; ++other)
        if (other != name) allowed_[other * slots_ + slot] = 0;
    }
  }

  void sample(std::vector<double>* seen, double* count) {
    std::vector<std::size_t> slot_of = fixed_;
    double score = scores_.ofAll(slot_of);
    keep(slot_of, score);
    const language::Cooling cooling{params_.sweeps * names_, params_.first_temperature};
    for (std::size_t step = 0; step < cooling.steps; ++step) {
      std::vector<std::size_t> next = slot_of;
      if (dice_.real() < 0.85 ? !moveOne(&next) : !rotate(&next)) continue;
      const double changed = difference(slot_of, next);
      if (dice_.accepts(changed, cooling.temperature(step))) {
        slot_of = std::move(next);
        score += changed;
        keep(slot_of, score);
      }
      if (cooling.isOver(step) && step % names_ == 0) {
        ++*count;
        for (std::size_t name = 0; name < names_; ++name)
          if (slot_of[name] != kNone) ++(*seen)[slot_of[name] * names_ + name];
      }
    }
  }

  /// A name goes to another slot or to none; who is there gets its slot.
  bool moveOne(std::vector<std::size_t>* slot_of) {
    const std::size_t name = dice_.below(names_), to = dice_.below(slots_ + 1);
    const std::size_t slot = to == slots_ ? kNone : to, from = (*slot_of)[name];
    if (fixed_[name] != kNone || slot == from) return false;
    if (slot != kNone && allowed_[name * slots_ + slot] == 0) return false;
    if (slot != kNone) {
      for (std::size_t other = 0; other < names_; ++other) {
        if ((*slot_of)[other] != slot) continue;
        if (from != kNone && allowed_[other * slots_ + from] == 0) return false;
        (*slot_of)[other] = from;
      }
    }
    (*slot_of)[name] = slot;
    return true;
  }

  /// All names between two doors of a row go one door on; the last comes first.
  bool rotate(std::vector<std::size_t>* slot_of) {
    const auto& row = row_[dice_.below(2)];
    if (row.size() < 2) return false;
    std::size_t begin = dice_.below(row.size()), end = dice_.below(row.size());
    if (begin == end) return false;
    if (begin > end) std::swap(begin, end);
    const bool forth = dice_.below(2) == 0;
    std::vector<std::size_t> name_at(slots_, kNone);
    for (std::size_t name = 0; name < names_; ++name)
      if ((*slot_of)[name] != kNone) name_at[(*slot_of)[name]] = name;
    for (std::size_t k = begin; k <= end; ++k) {
      const std::size_t name = name_at[row[k]];
      if (name == kNone) continue;
      const std::size_t to = forth ? (k == end ? begin : k + 1) : (k == begin ? end : k - 1);
      if (fixed_[name] != kNone || allowed_[name * slots_ + row[to]] == 0) return false;
      (*slot_of)[name] = row[to];
    }
    return true;
  }

  double difference(const std::vector<std::size_t>& before,
                    const std::vector<std::size_t>& after) const {
    std::vector<std::size_t> changed;
    for (std::size_t name = 0; name < names_; ++name)
      if (before[name] != after[name]) changed.push_back(name);
    const auto sum = [&](const std::vector<std::size_t>& slot_of) {
      double all = 0.0;
      for (std::size_t k = 0; k < changed.size(); ++k) {
        all += scores_.of(changed[k], slot_of);
        // Pairs of two that moved were counted twice.
        for (std::size_t j = k + 1; j < changed.size(); ++j)
          all -= scores_.pair(changed[k], slot_of[changed[k]], changed[j], slot_of[changed[j]]);
      }
      return all;
    };
    return sum(after) - sum(before);
  }

  void keep(const std::vector<std::size_t>& slot_of, double score) {
    if (!best_.empty() && score <= best_score_ + 1e-9) return;
    best_ = slot_of;
    best_score_ = score;
  }

  std::size_t names_, slots_;
  TourMatchParams params_;
  Scores scores_;
  language::Dice dice_;
  std::vector<char> allowed_;        ///< names x slots
  std::vector<std::size_t> fixed_;   ///< slot of each name that is confirmed
  std::vector<std::size_t> row_[2];  ///< slots of the right and the left, by the way
  std::vector<std::size_t> best_;
  double best_score_ = 0.0;
};

}  // namespace

double TourMatch::entropy(std::size_t slot) const {
  double none = 1.0, bits = 0.0;
  const auto add = [&](double p) {
    if (p > 0.0) bits -= p * std::log2(p);
  };
  for (std::size_t name = 0; name < names; ++name) {
    add(of(slot, name));
    none -= of(slot, name);
  }
  add(none);
  return bits;
}

std::optional<std::size_t> TourMatch::question(double least) const {
  std::optional<std::size_t> asked;
  double most = least;
  for (std::size_t slot = 0; slot < best.size(); ++slot) {
    const double bits = entropy(slot);
    if (bits <= most) continue;
    most = bits;
    asked = slot;
  }
  return asked;
}

TourMatch matchTour(const TourEvidence& evidence, const std::vector<TourSlot>& slots,
                    const TourMatchParams& params, const TourConstraints& constraints) {
  Matcher matcher(evidence, slots, params, constraints);
  if (evidence.rooms == 0 || slots.empty())
    return {evidence.rooms, {}, std::vector<std::optional<std::size_t>>(slots.size())};
  return matcher.run();
}

}  // namespace hyselam_topo
