#include "hyselam_objects/detect_objects.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/require.hpp"
#include "hyselam_objects/object_descriptor.hpp"
#include "join_patches.hpp"
#include "surface_grid.hpp"

namespace hyselam_objects {
namespace {

constexpr int kNone = Patches::kNone;

double cross(const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
  return static_cast<double>(a.x()) * b.y() - static_cast<double>(a.y()) * b.x();
}

/// Counter-clockwise (monotone chain).
std::vector<Eigen::Vector2f> hullOf(std::vector<Eigen::Vector2f> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  std::vector<Eigen::Vector2f> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t begin = hull.size();
    for (const Eigen::Vector2f& p : points) {
      while (hull.size() >= begin + 2 &&
             cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    if (!hull.empty()) hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

double areaOf(const std::vector<Eigen::Vector2f>& hull) {
  double area = 0.0;
  for (std::size_t i = 0; i < hull.size(); ++i) area += cross(hull[i], hull[(i + 1) % hull.size()]);
  return 0.5 * area;
}

/// How far a point lies outside of the hull; <= 0 inside [m].
double outside(const std::vector<Eigen::Vector2f>& hull, const Eigen::Vector2f& p) {
  double farthest = -1e9;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2f way = hull[(i + 1) % hull.size()] - hull[i];
    const double length = way.norm();
    if (length > 0.0) farthest = std::max(farthest, -cross(way, p - hull[i]) / length);
  }
  return farthest;
}

struct Surface {
  double height = 0.0;
  std::vector<std::size_t> pixels;
  std::vector<Eigen::Vector2f> hull;
};

class Detector {
 public:
  Detector(const OrganisedCloud& cloud, const Eigen::Isometry3d& camera, const DetectParams& params)
      : cloud_(cloud),
        params_(params),
        grid_(cloud, params.segment),
        eye_(camera.translation().cast<float>()) {
    const Eigen::Isometry3f pose = camera.cast<float>();
    points_.resize(grid_.size());
    up_.assign(grid_.size(), 0.0f);
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (!grid_.isValid(i)) continue;
      points_[i] = pose * grid_.point(i);
      if (isNear(i) && grid_.hasNormal(i)) up_[i] = (pose.linear() * grid_.normal(i)).z();
    }
  }

  std::vector<DetectedObject> run() {
    findSurfaces();
    findWalls();
    std::vector<bool> on_furniture(grid_.size(), false), on_floor(grid_.size(), false);
    std::vector<std::vector<std::size_t>> bodies(surfaces_.size());
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (!isNear(i) || points_[i].z() < params_.floor_clearance + 1.5f * grid_.sigma(i)) continue;
      assign(i, &on_furniture, &on_floor, &bodies);
    }
    std::vector<DetectedObject> found;
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      DetectedObject object = describe(bodies[s], 0.0);
      object.furniture = true;
      object.high.z = surfaces_[s].height;
      object.low.z = 0.0;
      found.push_back(std::move(object));
    }
    split(on_furniture, false, &found);
    split(on_floor, true, &found);
    return found;
  }

 private:
  bool isNear(std::size_t i) const {
    return grid_.isValid(i) && grid_.point(i).z() < static_cast<float>(params_.range);
  }

  void findSurfaces() {
    const auto upright = static_cast<float>(std::cos(params_.level));
    std::vector<char> open(grid_.size(), 0);
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      open[i] = isNear(i) && up_[i] > upright && points_[i].z() > params_.surface_height;
    }
    std::vector<Surface> pieces;
    std::deque<std::size_t> front;
    for (std::size_t seed = 0; seed < grid_.size(); ++seed) {
      if (open[seed] == 0) continue;
      Surface piece;
      open[seed] = 0;
      front.push_back(seed);
      while (!front.empty()) {
        const std::size_t i = front.front();
        front.pop_front();
        piece.pixels.push_back(i);
        grid_.forNeighbours(i, [&](std::size_t j) {
          const float step = std::abs(points_[i].z() - points_[j].z());
          if (open[j] == 0 || step > 0.01f + 2.0f * grid_.sigma(i)) return;
          open[j] = 0;
          front.push_back(j);
        });
      }
      if (piece.pixels.size() < 20) continue;
      std::vector<float> heights;
      std::vector<Eigen::Vector2f> ground;
      for (const std::size_t i : piece.pixels) {
        heights.push_back(points_[i].z());
        ground.push_back(points_[i].head<2>());
      }
      const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
      std::nth_element(heights.begin(), middle, heights.end());
      piece.height = *middle;
      piece.hull = hullOf(std::move(ground));
      if (piece.hull.size() >= 3) pieces.push_back(std::move(piece));
    }
    join(&pieces);
    for (Surface& piece : pieces) {
      if (areaOf(piece.hull) >= params_.surface_area) surfaces_.push_back(std::move(piece));
    }
    std::stable_sort(surfaces_.begin(), surfaces_.end(),
                     [](const Surface& a, const Surface& b) { return a.height > b.height; });
    surfaces_.erase(std::remove_if(surfaces_.begin(), surfaces_.end(),
                                   [this](const Surface& s) {
                                     return std::any_of(surfaces_.begin(), surfaces_.end(),
                                                        [&](const Surface& below) {
                                                          return isTopOfThings(s, below);
                                                        });
                                   }),
                    surfaces_.end());
  }

  // What stands on furniture and is not taller than things are is no furniture, however large.
  bool isTopOfThings(const Surface& surface, const Surface& below) const {
    const double step = surface.height - below.height;
    if (step < 0.03 || step > params_.segment.tallest) return false;
    if (areaOf(surface.hull) > 0.7 * areaOf(below.hull)) return false;
    const auto within = std::count_if(surface.hull.begin(), surface.hull.end(),
                                      [&](const auto& p) { return outside(below.hull, p) < 0.05; });
    return 5 * within > 4 * static_cast<std::ptrdiff_t>(surface.hull.size());
  }

  // Where something upright is taller than things are; what stands there in the plane is a part of
  // it. Else the walls of a room would be the inside of a bowl, and a thing before them its
  // outside.
  void findWalls() {
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (!isNear(i) || std::abs(up_[i]) > 0.5f || points_[i].z() < params_.tallest) continue;
      const auto [x, y] = cellOf(points_[i]);
      for (int dx = -1; dx <= 1; ++dx) {
        for (int dy = -1; dy <= 1; ++dy) walls_.insert({x + dx, y + dy});
      }
    }
  }

  static std::pair<int, int> cellOf(const Eigen::Vector3f& p) {
    constexpr float kCell = 0.08f;  // [m]
    return {static_cast<int>(std::floor(p.x() / kCell)),
            static_cast<int>(std::floor(p.y() / kCell))};
  }

  // Whether the camera sees through the plane between two pieces at more than what hides it: then
  // they are the tops of two things, not one top with something on it.
  bool isGapOpen(const Surface& a, const Surface& b,
                 const std::vector<Eigen::Vector2f>& both) const {
    constexpr double kBetween = 0.03, kOpen = 0.3;
    const auto height = static_cast<float>(0.5 * (a.height + b.height));
    if (eye_.z() < height + 0.05f) return false;
    std::size_t open = 0, all = 0;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      // A ray that ends above the plane may go through it behind what it ends on.
      if (!grid_.isValid(i) || points_[i].z() > eye_.z() - 0.05f) continue;
      const Eigen::Vector3f ray = points_[i] - eye_;
      const Eigen::Vector2f at = (eye_ + ray * ((height - eye_.z()) / ray.z())).head<2>();
      if (outside(both, at) > 0.0 || outside(a.hull, at) < kBetween ||
          outside(b.hull, at) < kBetween) {
        continue;
      }
      ++all;
      open += points_[i].z() < height - 0.03f - 2.0f * grid_.sigma(i);
    }
    return static_cast<double>(open) > kOpen * static_cast<double>(all);
  }

  // What things on a table cut in two.
  void join(std::vector<Surface>* pieces) const {
    constexpr double kGap = 0.25, kStep = 0.02;
    for (std::size_t i = 0; i < pieces->size(); ++i) {
      for (std::size_t j = i + 1; j < pieces->size();) {
        Surface &a = (*pieces)[i], &b = (*pieces)[j];
        bool near = false;
        for (const Eigen::Vector2f& p : b.hull) near = near || outside(a.hull, p) < kGap;
        if (!near || std::abs(a.height - b.height) > kStep) {
          ++j;
          continue;
        }
        std::vector<Eigen::Vector2f> both = a.hull;
        both.insert(both.end(), b.hull.begin(), b.hull.end());
        both = hullOf(std::move(both));
        if (isGapOpen(a, b, both)) {
          ++j;
          continue;
        }
        const auto na = static_cast<double>(a.pixels.size()),
                   nb = static_cast<double>(b.pixels.size());
        a.height = (na * a.height + nb * b.height) / (na + nb);
        a.pixels.insert(a.pixels.end(), b.pixels.begin(), b.pixels.end());
        a.hull = std::move(both);
        pieces->erase(pieces->begin() + static_cast<std::ptrdiff_t>(j));
        j = i + 1;
      }
    }
  }

  void assign(std::size_t i, std::vector<bool>* on_furniture, std::vector<bool>* on_floor,
              std::vector<std::vector<std::size_t>>* bodies) const {
    const Eigen::Vector3f& p = points_[i];
    const double noise = params_.segment.support_distance + 2.0 * grid_.sigma(i);
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {  // the highest first
      const double away = outside(surfaces_[s].hull, p.head<2>());
      const double height = p.z() - surfaces_[s].height;
      if (height > noise && height < params_.segment.tallest && away < 0.02) {
        (*on_furniture)[i] = true;
        return;
      }
      if (height <= noise && away < 0.04 + grid_.sigma(i)) {
        (*bodies)[s].push_back(i);
        return;
      }
    }
    (*on_floor)[i] = p.z() < params_.tallest && walls_.count(cellOf(p)) == 0;
  }

  void split(const std::vector<bool>& marked, bool floor,
             std::vector<DetectedObject>* found) const {
    const Patches patches(grid_, marked, params_.segment);
    const std::vector<int> objects = joinPatches(grid_, patches, params_.segment);
    std::vector<std::vector<std::size_t>> pixels;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (objects[i] == kNone) continue;
      const auto number = static_cast<std::size_t>(objects[i]);
      if (pixels.size() <= number) pixels.resize(number + 1);
      pixels[number].push_back(i);
    }
    const std::size_t first = found->size();
    for (const auto& each : pixels) {
      if (each.size() < static_cast<std::size_t>(params_.smallest)) continue;
      DetectedObject object = describe(each, 0.02);
      if (floor && (object.high.z > 0.98 * params_.tallest || object.low.z > 0.15)) continue;
      // Edges of what is behind: thin shreds without a body.
      const double wide = std::max(object.high.x - object.low.x, object.high.y - object.low.y);
      if (wide < 0.02 || wide > 1.5) continue;
      found->push_back(std::move(object));
    }
    if (floor) return;
    // What goes on to the greatest height of things is something taller: a wall, a window.
    found->erase(std::remove_if(found->begin() + static_cast<std::ptrdiff_t>(first), found->end(),
                                [this](const DetectedObject& object) { return isTaller(object); }),
                 found->end());
    std::vector<bool> floats;
    for (std::size_t i = first; i < found->size(); ++i) {
      floats.push_back(isFloating((*found)[i], *found, first));
    }
    for (std::size_t i = first; i < found->size(); ++i) {
      (*found)[i].cut = (*found)[i].cut || floats[i - first];
    }
  }

  bool isTaller(const DetectedObject& object) const {
    const Point3 c = object.centre();
    for (const Surface& surface : surfaces_) {  // the highest first
      const Eigen::Vector2f middle(static_cast<float>(c.x), static_cast<float>(c.y));
      if (surface.height > c.z || outside(surface.hull, middle) > 0.1) continue;
      return object.high.z > surface.height + 0.95 * params_.segment.tallest;
    }
    return false;
  }

  // Nothing stands in the air: the lower part of what seems to is hidden, or it hangs at a wall.
  bool isFloating(const DetectedObject& object, const std::vector<DetectedObject>& all,
                  std::size_t first) const {
    constexpr double kContact = 0.02, kAside = 0.02;
    const Point3 c = object.centre();
    const Eigen::Vector3f middle(static_cast<float>(c.x), static_cast<float>(c.y),
                                 static_cast<float>(c.z));
    const double noise = 2.0 * sigmaAt((middle - eye_).norm()) + params_.segment.support_distance;
    for (const Surface& surface : surfaces_) {
      const double air = object.low.z - surface.height;
      if (air > -kContact && air < kContact + noise &&
          outside(surface.hull, middle.head<2>()) < kAside) {
        return false;
      }
    }
    // On another thing; what is as thin as the noise there is that thing's own top.
    for (std::size_t i = first; i < all.size(); ++i) {
      if (object.high.z - object.low.z < kContact + noise) break;
      const DetectedObject& below = all[i];
      if (&below == &object || below.centre().z > c.z) continue;
      const bool over = c.x > below.low.x - kAside && c.x < below.high.x + kAside &&
                        c.y > below.low.y - kAside && c.y < below.high.y + kAside;
      if (over && std::abs(object.low.z - below.high.z) < kContact + noise) return false;
    }
    return true;
  }

  double sigmaAt(float depth) const {
    const double more = std::max(0.0, static_cast<double>(depth) - 0.4);
    return params_.segment.noise_floor + params_.segment.noise_growth * more * more;
  }

  /// `trim`: share of the points that lie outside of the box on each side.
  DetectedObject describe(const std::vector<std::size_t>& pixels, double trim) const {
    DetectedObject object;
    object.points = pixels.size();
    std::vector<Eigen::Vector3f> points;
    std::vector<std::uint32_t> colours;
    std::array<std::vector<float>, 3> axes;
    for (const std::size_t i : pixels) {
      const auto x = static_cast<int>(i % static_cast<std::size_t>(grid_.width()));
      const auto y = static_cast<int>(i / static_cast<std::size_t>(grid_.width()));
      object.cut =
          object.cut || x < 2 || y < 2 || x + 2 >= grid_.width() || y + 2 >= grid_.height();
      points.push_back(points_[i]);
      for (std::size_t k = 0; k < 3; ++k) axes[k].push_back(points_[i][static_cast<int>(k)]);
      if (!cloud_.colours.empty()) colours.push_back(colourAt(x, y));
    }
    std::array<double, 3> low{}, high{};
    for (std::size_t k = 0; k < 3 && !pixels.empty(); ++k) {
      const auto n = static_cast<double>(axes[k].size() - 1);
      const auto at = [&](double share) {
        const auto place = axes[k].begin() + static_cast<std::ptrdiff_t>(share * n);
        std::nth_element(axes[k].begin(), place, axes[k].end());
        return static_cast<double>(*place);
      };
      low[k] = at(trim);
      high[k] = at(1.0 - trim);
    }
    object.low = {low[0], low[1], low[2]};
    object.high = {high[0], high[1], high[2]};
    object.descriptor = describeView(points, colours);
    object.colour = colourName(colours);
    return object;
  }

  std::uint32_t colourAt(int x, int y) const {
    const int step = params_.segment.reduce;
    const int fx = std::min(x * step + step / 2, cloud_.width - 1);
    const int fy = std::min(y * step + step / 2, cloud_.height - 1);
    return cloud_.colours[static_cast<std::size_t>(fy) * static_cast<std::size_t>(cloud_.width) +
                          static_cast<std::size_t>(fx)];
  }

  const OrganisedCloud& cloud_;
  const DetectParams& params_;
  const SurfaceGrid grid_;
  const Eigen::Vector3f eye_;            // in the map frame
  std::vector<Eigen::Vector3f> points_;  // in the map frame
  std::vector<float> up_;                // z of the normal in the map frame
  std::vector<Surface> surfaces_;        // the highest first
  std::set<std::pair<int, int>> walls_;  // cells of the plane
};

}  // namespace

std::vector<DetectedObject> detectObjects(const OrganisedCloud& cloud,
                                          const Eigen::Isometry3d& camera_in_map,
                                          const DetectParams& params) {
  using hyselam::require;
  checkSegment(cloud, params.segment);
  if (!camera_in_map.matrix().allFinite()) {
    throw hyselam::InputError("camera", "pose", "is not finite");
  }
  require("range", params.range, params.range > 0.0, "> 0");
  require("level", params.level, params.level > 0.0 && params.level < 1.5, "0 .. 1.5");
  require("surface_area", params.surface_area, params.surface_area > 0.0, "> 0");
  require("surface_height", params.surface_height, params.surface_height > 0.0, "> 0");
  require("tallest", params.tallest, params.tallest > 0.0, "> 0");
  require("floor_clearance", params.floor_clearance, params.floor_clearance > 0.0, "> 0");
  require("smallest", params.smallest, params.smallest >= 10, ">= 10");
  return Detector(cloud, camera_in_map, params).run();
}

}  // namespace hyselam_objects
