#include "patch_rules.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace hyselam_objects {
namespace {

constexpr int kNone = Patches::kNone;

class RuleMerger {
 public:
  RuleMerger(const SurfaceGrid& grid, const Patches& patches, const SegmentParams& params)
      : grid_(grid), patches_(patches), params_(params) {}

  void run(hyselam::UnionFind& sets) const {
    mergeConvex(sets);
    mergeHollow(sets);
    mergeOccluded(sets);
  }

 private:
  using Patch = Patches::Patch;

  struct PatchBorder {
    int all = 0;      // pixels where two patches touch in the image
    int convex = 0;   // where their surfaces meet and bend outwards, or not at all
    int concave = 0;  // where they meet and bend inwards
  };

  // How far a surface goes from one pixel to the next beyond what a pixel measures across: much
  // where it is seen at a flat angle. [m]
  float pixelLength(std::size_t i, int dx, int dy) const {
    const std::optional<std::size_t> next = grid_.neighbor(i, dx, dy);
    if (!next || patches_[*next] != patches_[i]) return 0.0f;
    const Point way = grid_.point(*next) - grid_.point(i);
    return std::clamp(std::abs(way.z()) - way.head<2>().norm(), 0.0f, 0.03f);
  }

  void mergeConvex(hyselam::UnionFind& sets) const {
    std::map<std::pair<int, int>, PatchBorder> borders;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patches_[i] == kNone) continue;
      for (const auto& [dx, dy] : {std::pair<int, int>{1, 0}, {0, 1}}) {
        const std::optional<std::size_t> j = grid_.neighbor(i, dx, dy);
        if (!j || patches_[*j] == kNone || patches_[*j] == patches_[i] ||
            !grid_.areConnected(i, *j)) {
          continue;
        }
        const std::size_t a = patches_.innerPixel(i, -dx, -dy), b = patches_.innerPixel(*j, dx, dy);
        if (!grid_.hasNormal(a) || !grid_.hasNormal(b)) continue;
        PatchBorder& border = borders[std::minmax(patches_[i], patches_[*j])];
        const Point way = (grid_.point(a) - grid_.point(b)).normalized();
        const float bend = way.dot(grid_.normal(a) - grid_.normal(b));
        const float turn = std::acos(std::clamp(grid_.normal(a).dot(grid_.normal(b)), -1.0f, 1.0f));
        // Two faces of one object meet: the last pixel of each lies on the other. At a step it does
        // not.
        const float tolerance = static_cast<float>(params_.max_step) + 2.0f * grid_.sigma(i);
        const bool meet = std::abs(grid_.normal(b).dot(grid_.point(i) - grid_.point(b))) <
                              tolerance + pixelLength(i, -dx, -dy) &&
                          std::abs(grid_.normal(a).dot(grid_.point(*j) - grid_.point(a))) <
                              tolerance + pixelLength(*j, dx, dy);
        ++border.all;
        if (!meet) continue;
        const bool convex = bend > 0.0f || turn < static_cast<float>(params_.concavity_tolerance);
        ++(convex ? border.convex : border.concave);
      }
    }
    for (const auto& [pair, border] : borders) {
      const int meeting = border.convex + border.concave;
      const int smaller =
          std::min(patches_.patch(pair.first).size, patches_.patch(pair.second).size);
      const bool long_enough = border.convex >= params_.min_border_ratio * std::sqrt(smaller);
      if (meeting >= 3 && long_enough && meeting >= params_.min_contact_ratio * border.all &&
          border.convex >= params_.min_convex_ratio * meeting) {
        sets.unite(pair.first, pair.second);
      }
    }
  }

  // The inside of a cup or bowl: a hollow patch whose lower part is hidden behind the patch below
  // it in the image, over most of its width.
  void mergeHollow(hyselam::UnionFind& sets) const {
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
                  static_cast<float>(params_.max_occlusion_length)) {
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
      if (inner.bend < -static_cast<float>(params_.min_hollow_angle) && outer.bend > 0.0f &&
          count > params_.min_hollow_ratio * columns[static_cast<std::size_t>(pair.first)]) {
        sets.unite(pair.first, pair.second);
      }
    }
  }

  // Along rows and columns: a surface that ends at an occluder and continues beyond it.
  void mergeOccluded(hyselam::UnionFind& sets) const {
    std::map<std::pair<int, int>, PatchBorder> bridges;
    std::vector<std::size_t> ends;  // where each object was left, in the order of the line
    const auto scan = [&](std::size_t start, int dx, int dy) {
      ends.clear();
      int before = kNone;
      std::size_t previous = start;
      for (std::optional<std::size_t> i = start; i; i = grid_.neighbor(*i, dx, dy)) {
        if (!grid_.isValid(*i)) continue;
        const int now = patches_[*i] == kNone ? kNone : sets.find(patches_[*i]);
        if (now != before) {
          if (before != kNone) ends.push_back(previous);
          if (now != kNone) {
            for (const std::size_t a : ends) {
              if (sets.find(patches_[a]) != now && isOccluded(a, *i, dx, dy)) {
                compareAcrossOccluder(sets, a, *i, dx, dy, bridges);
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
      if (all >= 5 && bridge.convex > 0.6 * all) sets.unite(pair.first, pair.second);
    }
  }

  // Whether everything between two pixels of a line lies in front of the segment between them.
  bool isOccluded(std::size_t a, std::size_t b, int dx, int dy) const {
    const float way = (grid_.point(b) - grid_.point(a)).norm();
    if (way > static_cast<float>(params_.max_occlusion_length)) return false;
    const auto steps =
        static_cast<float>(dx != 0 ? b - a : (b - a) / static_cast<std::size_t>(grid_.width()));
    float k = 1.0f;
    bool any = false;
    for (std::optional<std::size_t> i = grid_.neighbor(a, dx, dy); i && *i != b;
         i = grid_.neighbor(*i, dx, dy), k += 1.0f) {
      if (!grid_.isValid(*i)) continue;
      const float line = grid_.point(a).z() + k / steps * (grid_.point(b).z() - grid_.point(a).z());
      if (grid_.point(*i).z() > line + 2.0f * grid_.sigma(*i)) return false;
      any = true;
    }
    return any;
  }

  void compareAcrossOccluder(hyselam::UnionFind& sets, std::size_t a, std::size_t b, int dx, int dy,
                             std::map<std::pair<int, int>, PatchBorder>& bridges) const {
    a = patches_.innerPixel(a, -dx, -dy);
    b = patches_.innerPixel(b, dx, dy);
    if (sets.find(patches_[a]) == sets.find(patches_[b]) || !grid_.hasNormal(a) ||
        !grid_.hasNormal(b)) {
      return;
    }
    const Point way = grid_.point(b) - grid_.point(a);
    const auto off = static_cast<float>(params_.max_occlusion_offset) + grid_.sigma(a);
    const bool on = grid_.normal(a).dot(grid_.normal(b)) >
                        static_cast<float>(std::cos(params_.max_occlusion_angle)) &&
                    std::abs(way.dot(grid_.normal(a))) < off &&
                    std::abs(way.dot(grid_.normal(b))) < off;
    PatchBorder& bridge = bridges[std::minmax(patches_[a], patches_[b])];
    ++(on ? bridge.convex : bridge.concave);
  }

  const SurfaceGrid& grid_;
  const Patches& patches_;
  const SegmentParams& params_;
};

}  // namespace

void joinByRules(const SurfaceGrid& grid, const Patches& patches, const SegmentParams& params,
                 hyselam::UnionFind& sets) {
  RuleMerger(grid, patches, params).run(sets);
}

}  // namespace hyselam_objects
