#include "hyselam_objects/segment_cloud.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "surface_grid.hpp"

namespace hyselam_objects {
namespace {

constexpr int kNone = -1;
constexpr double kSplinterShare =
    0.2;  // of its contour that a splinter has in common with its host
constexpr std::array<std::array<int, 2>, 4> kNeighbours{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

void check(const OrganisedCloud& cloud, const SegmentParams& p) {
  using hyselam::InputError;
  using hyselam::ParameterError;
  const auto size = static_cast<std::size_t>(std::max(0, cloud.width)) *
                    static_cast<std::size_t>(std::max(0, cloud.height));
  if (cloud.width < 0 || cloud.height < 0 || cloud.points.size() != size ||
      (!cloud.colours.empty() && cloud.colours.size() != size)) {
    throw InputError("cloud", "", "has not as many points as its width and height say");
  }
  if (size > 50000000) throw InputError("cloud", "", "has more than 50 million points");
  if (p.reduce < 1 || p.reduce > 8) throw ParameterError("reduce", p.reduce, "1 .. 8");
  if (p.normal_window < 1 || p.normal_window > 20) {
    throw ParameterError("normal_window", p.normal_window, "1 .. 20");
  }
  for (const auto& [name, value] : {std::pair<const char*, double>{"noise_floor", p.noise_floor},
                                    {"noise_growth", p.noise_growth},
                                    {"smooth_angle", p.smooth_angle},
                                    {"flat", p.flat},
                                    {"support_distance", p.support_distance},
                                    {"tallest", p.tallest},
                                    {"convex_share", p.convex_share},
                                    {"concave_tolerance", p.concave_tolerance},
                                    {"step", p.step},
                                    {"meeting_share", p.meeting_share},
                                    {"border_share", p.border_share},
                                    {"hollow", p.hollow},
                                    {"splinter_gap", p.splinter_gap},
                                    {"hollow_share", p.hollow_share},
                                    {"bridge_length", p.bridge_length},
                                    {"bridge_angle", p.bridge_angle},
                                    {"bridge_distance", p.bridge_distance}}) {
    if (!(value >= 0.0 && value <= 10.0)) throw ParameterError(name, value, "0 .. 10");
  }
  if (p.splinter < 0) throw ParameterError("splinter", p.splinter, ">= 0");
  if (p.smallest < 1) throw ParameterError("smallest", p.smallest, ">= 1");
}

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

/// The plane that most of the surface lies in.
std::optional<Plane> findSupport(const SurfaceGrid& grid, const SegmentParams& params) {
  std::vector<std::size_t> valid;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.hasNormal(i)) valid.push_back(i);
  }
  if (valid.size() < 100) return std::nullopt;
  hyselam::Rng rng(params.seed);
  const std::size_t step = std::max<std::size_t>(1, valid.size() / 4000);
  Plane best;
  std::size_t most = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const std::size_t i = valid[rng.below(static_cast<std::uint32_t>(valid.size()))];
    if (grid.variation(i) > 0.01f) continue;
    const Plane plane{grid.normal(i), grid.normal(i).dot(grid.point(i))};
    std::size_t inliers = 0;
    for (std::size_t k = 0; k < valid.size(); k += step) {
      const std::size_t j = valid[k];
      const float tolerance = 0.008f + 2.0f * grid.sigma(j);
      inliers += std::abs(plane.heightOf(grid.point(j))) < tolerance &&
                 grid.normal(j).dot(plane.normal) > 0.95f;
    }
    if (inliers > most) {
      most = inliers;
      best = plane;
    }
  }
  if (most * step < 100) return std::nullopt;
  for (int round = 0; round < 3; ++round) {  // least squares over the inliers
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    double n = 0.0;
    for (const std::size_t j : valid) {
      const float tolerance = 0.004f + 2.0f * grid.sigma(j);
      if (std::abs(best.heightOf(grid.point(j))) > tolerance ||
          grid.normal(j).dot(best.normal) < 0.95f) {
        continue;
      }
      const Eigen::Vector3d p = grid.point(j).cast<double>();
      mean += p;
      moments += p * p.transpose();
      n += 1.0;
    }
    if (n < 50.0) break;
    mean /= n;
    const Eigen::Matrix3d spread = moments / n - mean * mean.transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
    Eigen::Vector3f normal = axes.eigenvectors().col(0).cast<float>();
    if (normal.dot(mean.cast<float>()) > 0.0f) normal = -normal;
    best = {normal, normal.dot(mean.cast<float>())};
  }
  return best;
}

/// The work on one frame.
class Segmenter {
 public:
  Segmenter(const SurfaceGrid& grid, const Plane& support, const SegmentParams& params)
      : grid_(grid), support_(support), params_(params), patch_(grid.size(), kNone) {}

  /// The object of each reduced pixel, kNone for none; numbered from 0.
  std::vector<int> run() {
    markObjects();
    growPatches();
    fillPatches();
    measurePatches();
    Joined joined(patches_);
    joinConvex(joined);
    joinHollow(joined);
    joinBehind(joined);
    return objects(joined);
  }

 private:
  void markObjects() {
    above_.assign(grid_.size(), false);
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (!grid_.isValid(i)) continue;
      const float height = support_.heightOf(grid_.point(i));
      above_[i] = height > static_cast<float>(params_.support_distance) + 1.5f * grid_.sigma(i) &&
                  height < static_cast<float>(params_.tallest);
    }
  }

  bool isSmooth(std::size_t i) const {
    return above_[i] && grid_.hasNormal(i) && grid_.variation(i) < static_cast<float>(params_.flat);
  }

  bool continues(std::size_t i, std::size_t j) const {
    const auto turn = static_cast<float>(std::cos(params_.smooth_angle));
    const Point way = grid_.point(j) - grid_.point(i);
    return grid_.normal(i).dot(grid_.normal(j)) > turn &&
           std::abs(grid_.normal(i).dot(way)) < 3.0f * grid_.sigma(i) + 0.002f;
  }

  void growPatches() {
    std::vector<std::size_t> seeds;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (isSmooth(i)) seeds.push_back(i);
    }
    std::stable_sort(seeds.begin(), seeds.end(), [this](std::size_t a, std::size_t b) {
      return grid_.variation(a) < grid_.variation(b);
    });
    std::deque<std::size_t> front;
    for (const std::size_t seed : seeds) {
      if (patch_[seed] != kNone) continue;
      const int patch = static_cast<int>(patches_++);
      patch_[seed] = patch;
      front.push_back(seed);
      while (!front.empty()) {
        const std::size_t i = front.front();
        front.pop_front();
        grid_.forNeighbours(i, [&](std::size_t j) {
          if (patch_[j] != kNone || !isSmooth(j) || !continues(i, j)) return;
          patch_[j] = patch;
          front.push_back(j);
        });
      }
    }
  }

  // Pixels at edges go to the neighbouring patch whose surface they are nearest to.
  void fillPatches() {
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (above_[i] && patch_[i] == kNone) open.push_back(i);
    }
    for (int round = 0; round < 2 * params_.normal_window + 2 && !open.empty(); ++round) {
      std::vector<std::pair<std::size_t, int>> taken;
      std::vector<std::size_t> left;
      for (const std::size_t i : open) {
        float least = std::numeric_limits<float>::infinity();
        int best = kNone;
        grid_.forNeighbours(i, [&](std::size_t j) {
          if (patch_[j] == kNone || !grid_.touch(i, j)) return;
          const Point way = grid_.point(i) - grid_.point(j);
          const float off = grid_.hasNormal(j) ? std::abs(grid_.normal(j).dot(way)) : way.norm();
          if (off < least) {
            least = off;
            best = patch_[j];
          }
        });
        if (best == kNone) {
          left.push_back(i);
        } else {
          taken.emplace_back(i, best);
        }
      }
      if (taken.empty()) break;
      for (const auto& [i, patch] : taken) patch_[i] = patch;
      open = std::move(left);
    }
    // What has no smooth neighbour is a patch of its own (thin or rough things).
    for (const std::size_t seed : open) {
      if (patch_[seed] != kNone) continue;
      const int patch = static_cast<int>(patches_++);
      std::deque<std::size_t> front{seed};
      patch_[seed] = patch;
      while (!front.empty()) {
        const std::size_t i = front.front();
        front.pop_front();
        grid_.forNeighbours(i, [&](std::size_t j) {
          if (!above_[j] || patch_[j] != kNone || !grid_.touch(i, j)) return;
          patch_[j] = patch;
          front.push_back(j);
        });
      }
    }
  }

  struct Patch {
    int size = 0;
    float bend = 0.0f;  // mean turn of the normals over some pixels [rad]; < 0: hollow
  };

  void measurePatches() {
    patch_of_.assign(patches_, {});
    std::vector<int> pairs(patches_, 0);
    const int reach = params_.normal_window + 2;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patch_[i] == kNone) continue;
      const auto p = static_cast<std::size_t>(patch_[i]);
      ++patch_of_[p].size;
      for (const auto& [dx, dy] : {std::pair<int, int>{reach, 0}, {0, reach}}) {
        const std::optional<std::size_t> j = grid_.shifted(i, dx, dy);
        if (!j || patch_[*j] != patch_[i] || !grid_.hasNormal(i) || !grid_.hasNormal(*j)) continue;
        const Point way = (grid_.point(i) - grid_.point(*j)).normalized();
        patch_of_[p].bend += way.dot(grid_.normal(i) - grid_.normal(*j));
        ++pairs[p];
      }
    }
    for (std::size_t p = 0; p < patches_; ++p) {
      if (pairs[p] > 0) patch_of_[p].bend /= static_cast<float>(pairs[p]);
    }
  }

  struct Border {
    int all = 0;      // pixels where two patches touch in the picture
    int convex = 0;   // where their surfaces meet and bend outwards, or not at all
    int concave = 0;  // where they meet and bend inwards
  };

  // The pixel some steps further in the direction, as long as the patch goes on.
  std::size_t inside(std::size_t i, int dx, int dy) const {
    const int patch = patch_[i];
    for (int k = 0; k < params_.normal_window + 1; ++k) {
      const std::optional<std::size_t> next = grid_.shifted(i, dx, dy);
      if (!next || patch_[*next] != patch) break;
      i = *next;
    }
    return i;
  }

  // How far a surface goes from one pixel to the next beyond what a pixel measures across: much
  // where it is seen at a flat angle. [m]
  float pixelLength(std::size_t i, int dx, int dy) const {
    const std::optional<std::size_t> next = grid_.shifted(i, dx, dy);
    if (!next || patch_[*next] != patch_[i]) return 0.0f;
    const Point way = grid_.point(*next) - grid_.point(i);
    return std::clamp(std::abs(way.z()) - way.head<2>().norm(), 0.0f, 0.03f);
  }

  void joinConvex(Joined& joined) const {
    std::map<std::pair<int, int>, Border> borders;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patch_[i] == kNone) continue;
      for (const auto& [dx, dy] : {std::pair<int, int>{1, 0}, {0, 1}}) {
        const std::optional<std::size_t> j = grid_.shifted(i, dx, dy);
        if (!j || patch_[*j] == kNone || patch_[*j] == patch_[i] || !grid_.touch(i, *j)) continue;
        const std::size_t a = inside(i, -dx, -dy), b = inside(*j, dx, dy);
        if (!grid_.hasNormal(a) || !grid_.hasNormal(b)) continue;
        Border& border = borders[std::minmax(patch_[i], patch_[*j])];
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
      const int smaller = std::min(patch_of_[static_cast<std::size_t>(pair.first)].size,
                                   patch_of_[static_cast<std::size_t>(pair.second)].size);
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
    std::vector<int> columns(patches_, 0);
    std::map<int, std::size_t> last;  // of the column: the lowest pixel of each patch
    for (int x = 0; x < grid_.width(); ++x) {
      last.clear();
      std::set<std::pair<int, int>> seen;
      for (int y = 0; y < grid_.height(); ++y) {
        const std::size_t i = grid_.index(x, y);
        if (patch_[i] == kNone) continue;
        for (const auto& [upper, end] : last) {
          if (upper != patch_[i] && grid_.point(i).z() < grid_.point(end).z() &&
              (grid_.point(i) - grid_.point(end)).norm() <
                  static_cast<float>(params_.bridge_length)) {
            seen.insert({upper, patch_[i]});
          }
        }
        last[patch_[i]] = i;
      }
      for (const auto& entry : last) ++columns[static_cast<std::size_t>(entry.first)];
      for (const auto& pair : seen) ++below[pair];
    }
    for (const auto& [pair, count] : below) {
      const Patch& inner = patch_of_[static_cast<std::size_t>(pair.first)];
      const Patch& outer = patch_of_[static_cast<std::size_t>(pair.second)];
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
        const int now = patch_[*i] == kNone ? kNone : joined.root(patch_[*i]);
        if (now != before) {
          if (before != kNone) ends.push_back(previous);
          if (now != kNone) {
            for (const std::size_t a : ends) {
              if (joined.root(patch_[a]) != now && isHidden(a, *i, dx, dy)) {
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
    a = inside(a, -dx, -dy);
    b = inside(b, dx, dy);
    if (joined.root(patch_[a]) == joined.root(patch_[b]) || !grid_.hasNormal(a) ||
        !grid_.hasNormal(b))
      return;
    const Point way = grid_.point(b) - grid_.point(a);
    const auto off = static_cast<float>(params_.bridge_distance) + grid_.sigma(a);
    const bool on =
        grid_.normal(a).dot(grid_.normal(b)) > static_cast<float>(std::cos(params_.bridge_angle)) &&
        std::abs(way.dot(grid_.normal(a))) < off && std::abs(way.dot(grid_.normal(b))) < off;
    Border& bridge = bridges[std::minmax(patch_[a], patch_[b])];
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
    std::vector<int> size(patches_, 0);
    for (const int patch : patch_) {
      if (patch != kNone) ++size[static_cast<std::size_t>(joined.root(patch))];
    }
    std::map<std::pair<int, int>, int> contacts;
    std::vector<int> contour(patches_, 0);
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patch_[i] == kNone) continue;
      const int a = joined.root(patch_[i]);
      if (size[static_cast<std::size_t>(a)] >= params_.splinter) continue;
      grid_.forNeighbours(i, [&](std::size_t j) {
        const int b = patch_[j] == kNone ? kNone : joined.root(patch_[j]);
        if (a == b) return;
        ++contour[static_cast<std::size_t>(a)];
        const bool near = b != kNone && (grid_.point(i) - grid_.point(j)).norm() <
                                            static_cast<float>(params_.splinter_gap);
        if (near) ++contacts[{a, b}];
      });
    }
    std::vector<std::pair<int, int>> joins;
    for (std::size_t p = 0; p < patches_; ++p) {
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
    std::vector<int> total(patches_, 0);
    std::vector<float> nearest(patches_, std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patch_[i] == kNone) continue;
      const auto root = static_cast<std::size_t>(joined.root(patch_[i]));
      ++total[root];
      nearest[root] = std::min(nearest[root], grid_.point(i).norm());
    }
    std::vector<int> order;
    for (std::size_t p = 0; p < patches_; ++p) {
      if (total[p] >= params_.smallest) order.push_back(static_cast<int>(p));
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return nearest[static_cast<std::size_t>(a)] < nearest[static_cast<std::size_t>(b)];
    });
    std::vector<int> number(patches_, kNone);
    for (std::size_t k = 0; k < order.size(); ++k) {
      number[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
    }
    std::vector<int> out(grid_.size(), kNone);
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patch_[i] != kNone) out[i] = number[static_cast<std::size_t>(joined.root(patch_[i]))];
    }
    return out;
  }

  const SurfaceGrid& grid_;
  const Plane& support_;
  const SegmentParams& params_;
  std::vector<bool> above_;
  std::vector<int> patch_;
  std::size_t patches_ = 0;
  std::vector<Patch> patch_of_;  ///< by number
};

}  // namespace

Segmentation segmentCloud(const OrganisedCloud& cloud, const SegmentParams& params) {
  check(cloud, params);
  Segmentation out;
  out.labels.assign(cloud.size(), 0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.isValid(i)) out.labels[i] = 1;
  }
  const SurfaceGrid grid(cloud, params);
  out.support = findSupport(grid, params);
  if (!out.support) return out;
  const std::vector<int> objects = Segmenter(grid, *out.support, params).run();

  for (int y = 0; y < cloud.height; ++y) {
    for (int x = 0; x < cloud.width; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(cloud.width) +
                     static_cast<std::size_t>(x);
      if (out.labels[i] == 0) continue;
      // Of the reduced pixels around: the one whose depth is nearest.
      float least = std::numeric_limits<float>::infinity();
      int object = kNone;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const int gx = x / params.reduce + dx, gy = y / params.reduce + dy;
          if (gx < 0 || gy < 0 || gx >= grid.width() || gy >= grid.height()) continue;
          const std::size_t j = grid.index(gx, gy);
          if (!grid.isValid(j)) continue;
          const float off = (grid.point(j) - cloud.points[i]).squaredNorm();
          if (off < least) {
            least = off;
            object = objects[j];
          }
        }
      }
      if (object == kNone) continue;
      out.labels[i] = static_cast<std::uint32_t>(object + 2);
      out.objects = std::max(out.objects, static_cast<std::uint32_t>(object + 1));
    }
  }
  return out;
}

}  // namespace hyselam_objects
