#include "patch_relations.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace hyselam_objects {
namespace {

constexpr int kNone = Patches::kNone;
constexpr float kMostColor = 3.0f;  // distances of colors beyond are as good

float ratio(int part, int whole) {
  return whole > 0 ? static_cast<float>(part) / static_cast<float>(whole) : 0.0f;
}

/// Angle between two normals of length 1 [rad].
float angleBetween(const Point& a, const Point& b) {
  return std::acos(std::clamp(a.dot(b), -1.0f, 1.0f));
}

/// Mean and variance of the colors of each patch, and its pixels.
struct PatchLook {
  Point mean = Point::Zero(), variance = Point::Zero();
  Point middle = Point::Zero(), normal = Point::Zero();
  std::vector<std::size_t> pixels;
};

class PatchRelater {
 public:
  PatchRelater(const SurfaceGrid& grid, const Patches& patches, const SegmentParams& params)
      : grid_(grid), patches_(patches), params_(params), looks_(patches.count()) {}

  std::vector<PatchRelation> run() {
    describePatches();
    compareNeighbors();
    compareLines();
    findHollow();
    std::vector<PatchRelation> out;
    for (auto& [pair, relation] : relations_) {
      if (!relation.touches() && !relation.isBridged() && !relation.is_hollow) continue;
      relation.first = pair.first;
      relation.second = pair.second;
      finish(relation);
      out.push_back(relation);
    }
    return out;
  }

 private:
  PatchRelation& relation(int a, int b) { return relations_[std::minmax(a, b)]; }
  const PatchLook& look(int patch) const { return looks_[static_cast<std::size_t>(patch)]; }

  void describePatches() {
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patches_[i] == kNone) continue;
      PatchLook& look = looks_[static_cast<std::size_t>(patches_[i])];
      look.pixels.push_back(i);
      look.middle += grid_.point(i);
      if (grid_.hasNormal(i)) look.normal += grid_.normal(i);
      look.mean += grid_.color(i);
      look.variance += grid_.color(i).cwiseAbs2();
    }
    for (PatchLook& look : looks_) {
      if (look.pixels.empty()) continue;
      const auto n = static_cast<float>(look.pixels.size());
      look.middle /= n;
      look.mean /= n;
      look.variance = (look.variance / n - look.mean.cwiseAbs2()).cwiseMax(4e-4f);
    }
  }

  // How far a surface goes from one pixel to the next beyond what a pixel measures across: much
  // where it is seen at a flat angle. [m]
  float pixelLength(std::size_t i, int dx, int dy) const {
    const std::optional<std::size_t> next = grid_.neighbor(i, dx, dy);
    if (!next || patches_[*next] != patches_[i]) return 0.0f;
    const Point way = grid_.point(*next) - grid_.point(i);
    return std::clamp(std::abs(way.z()) - way.head<2>().norm(), 0.0f, 0.03f);
  }

  void compareNeighbors() {
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patches_[i] == kNone) continue;
      for (const auto& [dx, dy] : {std::pair<int, int>{1, 0}, {0, 1}}) {
        const std::optional<std::size_t> j = grid_.neighbor(i, dx, dy);
        if (!j || patches_[*j] == kNone || patches_[*j] == patches_[i]) continue;
        if (grid_.areConnected(i, *j)) {
          compareAt(i, *j, dx, dy);
        } else {
          ++relation(patches_[i], patches_[*j]).jumps;
        }
      }
    }
  }

  void compareAt(std::size_t i, std::size_t j, int dx, int dy) {
    const std::size_t a = patches_.innerPixel(i, -dx, -dy), b = patches_.innerPixel(j, dx, dy);
    if (!grid_.hasNormal(a) || !grid_.hasNormal(b)) return;
    PatchRelation& to = relation(patches_[i], patches_[j]);
    // Two faces of one object meet: the last pixel of each lies on the other. At a step it does
    // not.
    const float tolerance = static_cast<float>(params_.max_step) + 2.0f * grid_.sigma(i);
    const bool meet = std::abs(grid_.normal(b).dot(grid_.point(i) - grid_.point(b))) <
                          tolerance + pixelLength(i, -dx, -dy) &&
                      std::abs(grid_.normal(a).dot(grid_.point(j) - grid_.point(a))) <
                          tolerance + pixelLength(j, dx, dy);
    ++to.border;
    to.border_chroma += (grid_.color(a) - grid_.color(b)).tail<2>().norm();
    if (!meet) return;
    const Point way = (grid_.point(a) - grid_.point(b)).normalized();
    const float bend = way.dot(grid_.normal(a) - grid_.normal(b));
    const float turn = angleBetween(grid_.normal(a), grid_.normal(b));
    const bool convex = bend > 0.0f || turn < static_cast<float>(params_.concavity_tolerance);
    ++(convex ? to.convex : to.concave);
    to.turn += bend > 0.0f ? turn : -turn;
  }

  // Rows and columns: where a patch ends and another one begins further on.
  void compareLines() {
    for (int y = 0; y < grid_.height(); ++y) compareAlong(grid_.index(0, y), 1, 0);
    for (int x = 0; x < grid_.width(); ++x) compareAlong(grid_.index(x, 0), 0, 1);
  }

  void compareAlong(std::size_t start, int dx, int dy) {
    constexpr std::size_t kEnds = 12;  // looked back to
    ends_.clear();
    int before = kNone;
    std::size_t previous = start;
    for (std::optional<std::size_t> i = start; i; i = grid_.neighbor(*i, dx, dy)) {
      if (!grid_.isValid(*i)) continue;
      const int now = patches_[*i];
      if (now != before) {
        if (before != kNone) ends_.push_back(previous);
        if (now != kNone) {
          const std::size_t first = ends_.size() > kEnds ? ends_.size() - kEnds : 0;
          for (std::size_t k = first; k < ends_.size(); ++k) {
            if (patches_[ends_[k]] != now) compareAcross(ends_[k], *i, dx, dy);
          }
        }
      }
      before = now;
      previous = *i;
    }
  }

  enum class Between { kUnknown, kNearer, kFarther };

  // What is seen between two pixels of a line.
  Between between(std::size_t a, std::size_t b, int dx, int dy) const {
    const float way = (grid_.point(b) - grid_.point(a)).norm();
    if (way > static_cast<float>(params_.max_occlusion_length)) return Between::kUnknown;
    const auto steps =
        static_cast<float>(dx != 0 ? b - a : (b - a) / static_cast<std::size_t>(grid_.width()));
    float k = 1.0f;
    Between out = Between::kUnknown;
    for (std::optional<std::size_t> i = grid_.neighbor(a, dx, dy); i && *i != b;
         i = grid_.neighbor(*i, dx, dy), k += 1.0f) {
      if (!grid_.isValid(*i)) continue;
      const float line = grid_.point(a).z() + k / steps * (grid_.point(b).z() - grid_.point(a).z());
      if (grid_.point(*i).z() > line + 2.0f * grid_.sigma(*i)) return Between::kFarther;
      out = Between::kNearer;
    }
    return out;
  }

  void compareAcross(std::size_t a, std::size_t b, int dx, int dy) {
    const Between seen = between(a, b, dx, dy);
    if (seen == Between::kUnknown) return;
    PatchRelation& to = relation(patches_[a], patches_[b]);
    if (seen == Between::kFarther) {
      ++to.seen_through;
      return;
    }
    const float gap = (grid_.point(b) - grid_.point(a)).norm();
    a = patches_.innerPixel(a, -dx, -dy);
    b = patches_.innerPixel(b, dx, dy);
    if (!grid_.hasNormal(a) || !grid_.hasNormal(b)) return;
    const Point way = grid_.point(b) - grid_.point(a);
    const float tolerance = static_cast<float>(params_.max_occlusion_offset) + grid_.sigma(a);
    const float off =
        std::max(std::abs(way.dot(grid_.normal(a))), std::abs(way.dot(grid_.normal(b))));
    const float angle = angleBetween(grid_.normal(a), grid_.normal(b));
    ++to.hidden;
    to.continued += angle < static_cast<float>(params_.max_occlusion_angle) && off < tolerance;
    to.angle += angle;
    to.offset += std::min(off / tolerance, 5.0f);
    to.gap += gap;
  }

  // The inside of a cup or bowl: a hollow patch whose lower edge is hidden, over most of its width,
  // by one that lies below it in the image, is as wide and bends outwards about as much.
  void findHollow() {
    struct Cover {
      int columns = 0;        // in which the outside hides the end of the inside
      float distance = 0.0f;  // sum over them [m]
    };
    std::map<std::pair<int, int>, Cover> covers;
    std::vector<std::pair<int, int>> reach(patches_.count(), {grid_.width(), -1});  // columns
    std::vector<int> columns(patches_.count(), 0);
    std::map<int, std::size_t> last;  // of the column: the lowest pixel of each patch
    for (int x = 0; x < grid_.width(); ++x) {
      last.clear();
      std::map<std::pair<int, int>, float> seen;
      for (int y = 0; y < grid_.height(); ++y) {
        const std::size_t i = grid_.index(x, y);
        if (patches_[i] == kNone) continue;
        for (const auto& [upper, end] : last) {
          const float distance = (grid_.point(i) - grid_.point(end)).norm();
          if (upper != patches_[i] && isHollow(upper) &&
              grid_.point(i).z() < grid_.point(end).z() &&
              distance < static_cast<float>(params_.max_occlusion_length)) {
            seen.insert({{upper, patches_[i]}, distance});
          }
        }
        last[patches_[i]] = i;
      }
      for (const auto& entry : last) {
        const auto patch = static_cast<std::size_t>(entry.first);
        ++columns[patch];
        reach[patch] = {std::min(reach[patch].first, x), std::max(reach[patch].second, x)};
      }
      for (const auto& [pair, distance] : seen) {
        ++covers[pair].columns;
        covers[pair].distance += distance;
      }
    }
    std::map<int, std::pair<float, int>> best;  // of the inside: mean distance and the outside
    for (const auto& [pair, cover] : covers) {
      const auto [inner, outer] = pair;
      const auto [a0, a1] = reach[static_cast<std::size_t>(inner)];
      const auto [b0, b1] = reach[static_cast<std::size_t>(outer)];
      const float width =
          ratio(std::min(a1, b1) + 1 - std::max(a0, b0), std::max(a1, b1) + 1 - std::min(a0, b0));
      if (patches_.patch(outer).bend < -0.5f * patches_.patch(inner).bend || width < 0.6f ||
          cover.columns < params_.min_hollow_ratio * columns[static_cast<std::size_t>(inner)]) {
        continue;
      }
      const float mean = cover.distance / static_cast<float>(cover.columns);
      const auto [at, is_new] = best.insert({inner, {mean, outer}});
      if (!is_new) at->second = std::min(at->second, {mean, outer});
    }
    for (const auto& [inner, outer] : best) relation(inner, outer.second).is_hollow = true;
  }
  bool isHollow(int patch) const {
    return patches_.patch(patch).size >= params_.max_fragment_pixels &&
           patches_.patch(patch).bend < -static_cast<float>(params_.min_hollow_angle);
  }

  // Means from sums, and what is measured on whole patches.
  void finish(PatchRelation& to) const {
    const PatchLook &a = look(to.first), &b = look(to.second);
    to.smaller = static_cast<int>(std::min(a.pixels.size(), b.pixels.size()));
    if (const int meeting = to.convex + to.concave; meeting > 0) {
      to.turn /= static_cast<float>(meeting);
    }
    if (to.border > 0) to.border_chroma /= static_cast<float>(to.border);
    if (grid_.hasColors()) {
      const Eigen::Array3f sum = a.variance.array() + b.variance.array();
      const Eigen::Array3f root = (a.variance.array() * b.variance.array()).sqrt();
      const Eigen::Array3f distance =
          0.25f * (a.mean - b.mean).array().square() / sum + 0.5f * (0.5f * sum / root).log();
      to.lightness = distance(0);
      to.chroma = distance(1) + distance(2);
    }
    if (to.hidden == 0) return;
    const auto n = static_cast<float>(to.hidden);
    to.angle /= n;
    to.offset /= n;
    to.gap /= n;
    const Point along = (b.middle - a.middle).normalized();
    const Point normal = (a.normal + b.normal).normalized();
    const Point across = normal.cross(along).normalized();
    const auto [a0, a1] = extent(a, along);
    const auto [b0, b1] = extent(b, along);
    to.gap_ratio = to.gap / std::max(0.005f, std::min(a1 - a0, b1 - b0));
    const auto [c0, c1] = extent(a, across);
    const auto [d0, d1] = extent(b, across);
    const float both = std::min(c1, d1) - std::max(c0, d0);
    const float either = std::max(c1, d1) - std::min(c0, d0);
    to.outline = either > 0.0f ? std::max(0.0f, both / either) : 0.0f;
  }

  // From where to where a patch reaches in a direction, without the outermost points [m].
  static std::pair<float, float> extentOf(std::vector<float>& places) {
    const std::size_t cut = places.size() / 20;
    std::sort(places.begin(), places.end());
    return {places[cut], places[places.size() - 1 - cut]};
  }
  std::pair<float, float> extent(const PatchLook& look, const Point& direction) const {
    constexpr std::size_t kMost = 200;  // points
    std::vector<float> places;
    const std::size_t step = std::max<std::size_t>(1, look.pixels.size() / kMost);
    for (std::size_t k = 0; k < look.pixels.size(); k += step) {
      places.push_back(direction.dot(grid_.point(look.pixels[k])));
    }
    return extentOf(places);
  }

  const SurfaceGrid& grid_;
  const Patches& patches_;
  const SegmentParams& params_;
  std::vector<PatchLook> looks_;
  std::map<std::pair<int, int>, PatchRelation> relations_;
  std::vector<std::size_t> ends_;
};

}  // namespace

const std::array<RelationFeature, kContactFeatureCount> kContactFeatures = {
    {{"one", false},
     {"convex_share", false},
     {"turn", false},
     {"turn_inwards", false},
     {"meeting_share", false},
     {"jump_share", false},
     {"log_length", false},
     {"log_size", false},
     {"border_chroma", true},
     {"color_distance", true},
     {"seen_through_share", false}}};

const std::array<RelationFeature, kBridgeFeatureCount> kBridgeFeatures = {
    {{"one", false},
     {"continued_share", false},
     {"angle", false},
     {"offset", false},
     {"log_gap_ratio", false},
     {"gap", false},
     {"log_length", false},
     {"log_size", false},
     {"outline", false},
     {"color_distance", true},
     {"seen_through_share", false},
     {"root_chroma_distance", true},
     {"root_lightness_distance", true},
     {"touching", false},
     {"concave_share", false}}};

std::array<float, kContactFeatureCount> PatchRelation::contactFeatures() const {
  const int meeting = convex + concave;
  const auto root = std::sqrt(static_cast<float>(std::max(1, smaller)));
  return {1.0f,
          ratio(convex, meeting),
          std::clamp(turn, -1.0f, 1.0f),
          std::max(0.0f, -turn),
          ratio(meeting, border + jumps),
          ratio(jumps, border + jumps),
          std::log(static_cast<float>(std::max(1, meeting)) / root),
          std::log(root),
          border_chroma,
          std::min(lightness + chroma, kMostColor),
          ratio(seen_through, seen_through + hidden)};
}

std::array<float, kBridgeFeatureCount> PatchRelation::bridgeFeatures() const {
  const auto root = std::sqrt(static_cast<float>(std::max(1, smaller)));
  const bool touching = touches();
  return {1.0f,
          ratio(continued, hidden),
          angle,
          offset,
          std::log(std::max(0.1f, gap_ratio)),
          gap,
          std::log(static_cast<float>(std::max(1, hidden)) / root),
          std::log(root),
          outline,
          std::min(lightness + chroma, kMostColor),
          ratio(seen_through, seen_through + hidden),
          std::sqrt(std::min(chroma, 2.0f)),
          std::sqrt(std::min(lightness, 2.0f)),
          touching ? 1.0f : 0.0f,
          touching ? ratio(concave, convex + concave) : 0.0f};
}

std::vector<PatchRelation> relatePatches(const SurfaceGrid& grid, const Patches& patches,
                                         const SegmentParams& params) {
  return PatchRelater(grid, patches, params).run();
}

}  // namespace hyselam_objects
