#include "tour_layout.hpp"

#include <algorithm>
#include <cmath>

#include "annealing.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// Numbers of rooms in the order in which their doors come along the corridor, and their sides.
struct Layout {
  std::vector<std::size_t> order;
  std::vector<char> is_left;
};

double logLikelihood(const TourEvidence& e, const std::vector<double>& apart,
                     const Layout& layout) {
  double sum = 0.0;
  std::size_t count[2] = {0, 0}, seen[2] = {0, 0};
  for (const char left : layout.is_left) ++count[left != 0 ? 1 : 0];
  for (std::size_t k = 0; k < e.rooms; ++k) {
    const std::size_t a = layout.order[k];
    const char side = layout.is_left[a];
    sum += side != 0 ? e.left[a] : e.right[a];
    const std::size_t rank = seen[side != 0 ? 1 : 0]++, of = count[side != 0 ? 1 : 0];
    sum += rank == 0 ? e.first[a] : rank + 1 == of ? e.last[a] : e.inner[a];
    for (std::size_t later = k + 1; later < e.rooms; ++later) {
      const std::size_t b = layout.order[later];
      sum += layout.is_left[b] == side ? e.before[a * e.rooms + b] : apart[a * e.rooms + b];
    }
  }
  return sum;
}

/// Where each holds among the layouts that were looked at.
struct Shares {
  explicit Shares(std::size_t rooms)
      : left(rooms, 0.0), alike(rooms * rooms, 0.0), before(rooms * rooms, 0.0) {}
  void add(const Layout& layout) {
    ++count;
    const std::size_t n = left.size();
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t a = layout.order[k];
      left[a] += layout.is_left[a];
      for (std::size_t later = k + 1; later < n; ++later) {
        const std::size_t b = layout.order[later];
        if (layout.is_left[a] != layout.is_left[b]) continue;
        ++alike[a * n + b];
        ++alike[b * n + a];
        ++before[a * n + b];
      }
    }
  }
  double count = 0.0;
  std::vector<double> left, alike, before;
};

class Sampler {
 public:
  Sampler(const TourEvidence& evidence, const TourLayoutParams& params)
      : evidence_(evidence), params_(params), dice_(params.seed), shares_(evidence.rooms) {
    // Where the doors are along the corridor nobody knows: facing each other or not is the same.
    for (std::size_t pair = 0; pair < evidence.apart.size(); ++pair)
      apart_.push_back(std::log(std::exp(evidence.facing[pair]) + std::exp(evidence.apart[pair])));
  }

  TourLayout run() {
    for (std::size_t start = 0; start < params_.starts; ++start) sample();
    return result();
  }

 private:
  void sample() {
    const std::size_t n = evidence_.rooms;
    Layout now;
    for (std::size_t room = 0; room < n; ++room) {
      now.order.push_back(room);
      now.is_left.push_back(evidence_.left[room] >= evidence_.right[room] ? 1 : 0);
    }
    double likely = logLikelihood(evidence_, apart_, now);
    keep(now, likely);
    const Cooling cooling{params_.sweeps * n, params_.first_temperature};
    for (std::size_t step = 0; step < cooling.steps; ++step) {
      Layout next = now;
      change(&next);
      const double next_likely = logLikelihood(evidence_, apart_, next);
      if (dice_.accepts(next_likely - likely, cooling.temperature(step))) {
        now = std::move(next);
        likely = next_likely;
        keep(now, likely);
      }
      if (cooling.isOver(step) && step % n == 0) shares_.add(now);
    }
  }

  /// One room goes elsewhere, or changes sides, or both; or all of a row behind one do.
  void change(Layout* layout) {
    const double kind = dice_.real();
    const std::size_t room = dice_.below(evidence_.rooms);
    if (kind < 0.7) {
      auto& order = layout->order;
      order.erase(std::find(order.begin(), order.end(), room));
      order.insert(order.begin() + static_cast<std::ptrdiff_t>(dice_.below(evidence_.rooms)), room);
    }
    if (kind < 0.2 || (kind >= 0.7 && kind < 0.9)) layout->is_left[room] ^= 1;
    if (kind >= 0.9) {
      // What was told in a row goes together.
      const std::size_t end = std::min(evidence_.rooms, room + 1 + dice_.below(evidence_.rooms));
      for (std::size_t k = room; k < end; ++k) layout->is_left[k] ^= 1;
    }
  }

  void keep(const Layout& layout, double likely) {
    if (!best_.order.empty() && likely <= best_likely_) return;
    best_ = layout;
    best_likely_ = likely;
  }

  TourLayout result() const {
    TourLayout out;
    const std::size_t n = evidence_.rooms;
    // One layout more of each kind, so that nothing is ever told as quite certain.
    for (const std::size_t room : best_.order) {
      const bool is_left = best_.is_left[room] != 0;
      auto& row = is_left ? out.left : out.right;
      const double left = shares_.left[room];
      TourLayout::Room told{
          room, ((is_left ? left : shares_.count - left) + 1.0) / (shares_.count + 2.0), 1.0};
      if (!row.empty()) {
        const std::size_t pair = row.back().room * n + room;
        told.order_certainty = (shares_.before[pair] + 1.0) / (shares_.alike[pair] + 2.0);
      }
      row.push_back(told);
    }
    return out;
  }

  const TourEvidence& evidence_;
  std::vector<double> apart_;  ///< on different sides
  const TourLayoutParams& params_;
  Dice dice_;
  Shares shares_;
  Layout best_;
  double best_likely_ = 0.0;
};

}  // namespace

TourLayout layOut(const TourEvidence& evidence, const TourLayoutParams& params) {
  if (evidence.rooms == 0) return {};
  return Sampler(evidence, params).run();
}

}  // namespace language
}  // namespace hyselam_topo
