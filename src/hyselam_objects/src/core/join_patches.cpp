#include "join_patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>

namespace hyselam_objects {
namespace {

constexpr int kNone = Patches::kNone;
// Of its contour that a splinter has in common with its host.
constexpr double kSplinterShare = 0.2;

/// Disjoint sets of patches.
class Joined {
 public:
  explicit Joined(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int i) {
    while (parent_[at(i)] != i) i = parent_[at(i)] = parent_[at(parent_[at(i)])];
    return i;
  }
  void join(int a, int b) {
    a = root(a);
    b = root(b);
    parent_[at(std::max(a, b))] = std::min(a, b);
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  std::vector<int> parent_;
};

class Joiner {
 public:
  Joiner(const SurfaceGrid& grid, const Patches& patches, const SegmentParams& params)
      : grid_(grid), patches_(patches), params_(params) {}

  std::vector<int> run() {
    Joined joined(patches_.count());
    joinConvex(joined);
    joinHollow(joined);
    joinBehind(joined);
    return objects(joined);
  }

 private:
  using Patch = Patches::Patch;

  struct Border {
    int all = 0;      // pixels where two patches touch in the picture
    int convex = 0;   // where their surfaces meet and bend outwards, or not at all
    int concave = 0;  // where they meet and bend inwards
  };

  // How far a surface goes from one pixel to the next beyond what a pixel measures across: much
  // where it is seen at a flat angle. [m]
  float pixelLength(std::size_t i, int dx, int dy) const {
    const std::optional<std::size_t> next = grid_.shifted(i, dx, dy);
    if (!next || patches_[*next] != patches_[i]) return 0.0f;
    const Point way = grid_.point(*next) - grid_.point(i);
    return std::clamp(std::abs(way.z()) - way.head<2>().norm(), 0.0f, 0.03f);
  }

  void joinConvex(Joined& joined) const {
    std::map<std::pair<int, int>, Border> borders;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patches_[i] == kNone) continue;
      for (const auto& [dx, dy] : {std::pair<int, int>{1, 0}, {0, 1}}) {
        const std::optional<std::size_t> j = grid_.shifted(i, dx, dy);
        if (!j || patches_[*j] == kNone || patches_[*j] == patches_[i] || !grid_.touch(i, *j))
          continue;
        const std::size_t a = patches_.inside(i, -dx, -dy), b = patches_.inside(*j, dx, dy);
        if (!grid_.hasNormal(a) || !grid_.hasNormal(b)) continue;
        Border& border = borders[std::minmax(patches_[i], patches_[*j])];
        const Point way = (grid_.point(a) - grid_.point(b)).normalized();
        const float bend = way.dot(grid_.normal(a) - grid_.normal(b));
        const float turn = std::acos(std::clamp(grid_.normal(a).dot(grid_.normal(b)), -1.0f, 1.0f));
        // Two faces of one thing meet: the last pixel of each lies on the other. At a step it does
        // not.
        const float tolerance = static_cast<float>(params_.step) + 2.0f * grid_.sigma(i);
        const bool meet = std::abs(grid_.normal(b).dot(grid_.point(i) - grid_.point(b))) <
                              tolerance + pixelLength(i, -dx, -dy) &&
                          std::abs(grid_.normal(a).dot(grid_.point(*j) - grid_.point(a))) <
                              tolerance + pixelLength(*j, dx, dy);
        ++border.all;
        if (!meet) continue;
        const bool convex = bend > 0.0f || turn < static_cast<float>(params_.concave_tolerance);
        ++(convex ? border.convex : border.concave);
      }
    }
    for (const auto& [pair, border] : borders) {
      const int meeting = border.convex + border.concave;
      const int smaller =
          std::min(patches_.patch(pair.first).size, patches_.patch(pair.second).size);
      const bool long_enough = border.convex >= params_.border_share * std::sqrt(smaller);
      if (meeting >= 3 && long_enough && meeting >= params_.meeting_share * border.all &&
          border.convex >= params_.convex_share * meeting) {
        joined.join(pair.first, pair.second);
      }
    }
  }

  // The inside of a cup or bowl: a hollow patch whose lower part hides behind the patch below it in
  // the picture, over most of its width.
  void joinHollow(Joined& joined) const {
    std::map<std::pair<int, int>, int> below;  // columns in which the second hides the first's end
    std::vector<int> columns(patches_.count(), 0);
    std::map<int, std::size_t> last;  // of the column: the lowest pixel of each patch
    for (int x = 0; x < grid_.width(); ++x) {
      last.clear();
      std::set<std::pair<int, int>> seen;
      for (int y = 0; y < grid_.height(); ++y) {
        const std::size_t i = grid_.index(x, y);
        if (patches_[i] == kNone) continue;
        for (const auto& [upper, end] : last) {
          if (upper != patches_[i] && grid_.point(i).z() < grid_.point(end).z() &&
              (grid_.point(i) - grid_.point(end)).norm() <
                  static_cast<float>(params_.bridge_length)) {
            seen.insert({upper, patches_[i]});
          }
        }
        last[patches_[i]] = i;
      }
      for (const auto& entry : last) ++columns[static_cast<std::size_t>(entry.first)];
      for (const auto& pair : seen) ++below[pair];
    }
    for (const auto& [pair, count] : below) {
      const Patch& inner = patches_.patch(pair.first);
      const Patch& outer = patches_.patch(pair.second);
      if (inner.bend < -static_cast<float>(params_.hollow) && outer.bend > 0.0f &&
          count > params_.hollow_share * columns[static_cast<std::size_t>(pair.first)]) {
        joined.join(pair.first, pair.second);
      }
    }
  }

  // Along rows and columns: a surface that ends at something nearer and goes on beyond it.
  void joinBehind(Joined& joined) const {
    std::map<std::pair<int, int>, Border> bridges;
    std::vector<std::size_t> ends;  // where each object was left, in the order of the line
    const auto scan = [&](std::size_t start, int dx, int dy) {
      ends.clear();
      int before = kNone;
      std::size_t previous = start;
      for (std::optional<std::size_t> i = start; i; i = grid_.shifted(*i, dx, dy)) {
        if (!grid_.isValid(*i)) continue;
        const int now = patches_[*i] == kNone ? kNone : joined.root(patches_[*i]);
        if (now != before) {
          if (before != kNone) ends.push_back(previous);
          if (now != kNone) {
            for (const std::size_t a : ends) {
              if (joined.root(patches_[a]) != now && isHidden(a, *i, dx, dy)) {
                compare(joined, a, *i, dx, dy, bridges);
              }
            }
          }
        }
        before = now;
        previous = *i;
      }
    };
    for (int y = 0; y < grid_.height(); ++y) scan(grid_.index(0, y), 1, 0);
    for (int x = 0; x < grid_.width(); ++x) scan(grid_.index(x, 0), 0, 1);
    for (const auto& [pair, bridge] : bridges) {
      const int all = bridge.convex + bridge.concave;
      if (all >= 5 && bridge.convex > 0.6 * all) joined.join(pair.first, pair.second);
    }
  }

  // Whether everything between two pixels of a line lies in front of the way from one to the other.
  bool isHidden(std::size_t a, std::size_t b, int dx, int dy) const {
    const float way = (grid_.point(b) - grid_.point(a)).norm();
    if (way > static_cast<float>(params_.bridge_length)) return false;
    const auto steps =
        static_cast<float>(dx != 0 ? b - a : (b - a) / static_cast<std::size_t>(grid_.width()));
    float k = 1.0f;
    bool any = false;
    for (std::optional<std::size_t> i = grid_.shifted(a, dx, dy); i && *i != b;
         i = grid_.shifted(*i, dx, dy), k += 1.0f) {
      if (!grid_.isValid(*i)) continue;
      const float line = grid_.point(a).z() + k / steps * (grid_.point(b).z() - grid_.point(a).z());
      if (grid_.point(*i).z() > line + 2.0f * grid_.sigma(*i)) return false;
      any = true;
    }
    return any;
  }

  void compare(Joined& joined, std::size_t a, std::size_t b, int dx, int dy,
               std::map<std::pair<int, int>, Border>& bridges) const {
    a = patches_.inside(a, -dx, -dy);
    b = patches_.inside(b, dx, dy);
    if (joined.root(patches_[a]) == joined.root(patches_[b]) || !grid_.hasNormal(a) ||
        !grid_.hasNormal(b))
      return;
    const Point way = grid_.point(b) - grid_.point(a);
    const auto off = static_cast<float>(params_.bridge_distance) + grid_.sigma(a);
    const bool on =
        grid_.normal(a).dot(grid_.normal(b)) > static_cast<float>(std::cos(params_.bridge_angle)) &&
        std::abs(way.dot(grid_.normal(a))) < off && std::abs(way.dot(grid_.normal(b))) < off;
    Border& bridge = bridges[std::minmax(patches_[a], patches_[b])];
    ++(on ? bridge.convex : bridge.concave);
  }

  // Small pieces, such as a top seen at a flat angle, join the object that they are nearest to
  // along most of their contour.
  void joinSplinters(Joined& joined) const {
    constexpr int kRounds = 4;  // splinters of splinters
    for (int round = 0; round < kRounds && joinSplintersOnce(joined); ++round) {
    }
  }

  bool joinSplintersOnce(Joined& joined) const {
    std::vector<int> size(patches_.count(), 0);
    for (const int patch : patches_.all()) {
      if (patch != kNone) ++size[static_cast<std::size_t>(joined.root(patch))];
    }
    std::map<std::pair<int, int>, int> contacts;
    std::vector<int> contour(patches_.count(), 0);
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patches_[i] == kNone) continue;
      const int a = joined.root(patches_[i]);
      if (size[static_cast<std::size_t>(a)] >= params_.splinter) continue;
      grid_.forNeighbours(i, [&](std::size_t j) {
        const int b = patches_[j] == kNone ? kNone : joined.root(patches_[j]);
        if (a == b) return;
        ++contour[static_cast<std::size_t>(a)];
        const bool near = b != kNone && (grid_.point(i) - grid_.point(j)).norm() <
                                            static_cast<float>(params_.splinter_gap);
        if (near) ++contacts[{a, b}];
      });
    }
    std::vector<std::pair<int, int>> joins;
    for (std::size_t p = 0; p < patches_.count(); ++p) {
      int most = 0, host = kNone;
      for (auto it = contacts.lower_bound({static_cast<int>(p), 0});
           it != contacts.end() && it->first.first == static_cast<int>(p); ++it) {
        if (it->second <= most || size[static_cast<std::size_t>(it->first.second)] <= size[p]) {
          continue;
        }
        most = it->second;
        host = it->first.second;
      }
      const bool tiny = size[p] < params_.smallest;
      if (host != kNone && (tiny || most > kSplinterShare * contour[p])) {
        joins.emplace_back(static_cast<int>(p), host);
      }
    }
    for (const auto& [piece, host] : joins) joined.join(piece, host);
    return !joins.empty();
  }

  std::vector<int> objects(Joined& joined) const {
    joinSplinters(joined);
    std::vector<int> total(patches_.count(), 0);
    std::vector<float> nearest(patches_.count(), std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patches_[i] == kNone) continue;
      const auto root = static_cast<std::size_t>(joined.root(patches_[i]));
      ++total[root];
      nearest[root] = std::min(nearest[root], grid_.point(i).norm());
    }
    std::vector<int> order;
    for (std::size_t p = 0; p < patches_.count(); ++p) {
      if (total[p] >= params_.smallest) order.push_back(static_cast<int>(p));
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return nearest[static_cast<std::size_t>(a)] < nearest[static_cast<std::size_t>(b)];
    });
    std::vector<int> number(patches_.count(), kNone);
    for (std::size_t k = 0; k < order.size(); ++k) {
      number[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
    }
    std::vector<int> out(grid_.size(), kNone);
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patches_[i] != kNone) out[i] = number[static_cast<std::size_t>(joined.root(patches_[i]))];
    }
    return out;
  }

  const SurfaceGrid& grid_;
  const Patches& patches_;
  const SegmentParams& params_;
};

}  // namespace

std::vector<int> joinPatches(const SurfaceGrid& grid, const Patches& patches,
                             const SegmentParams& params) {
  return Joiner(grid, patches, params).run();
}

}  // namespace hyselam_objects
