#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "hyselam_sim/pile.hpp"
#include "sensor.hpp"

namespace hyselam_sim {
namespace {

using cv::Vec3d;
using cv::Vec3f;

constexpr double kHalfTable = 0.6, kTableHeight = 0.75;                          // [m]
const Vec3f kTableColor{0.42f, 0.55f, 0.66f}, kFloorColor{0.35f, 0.36f, 0.36f};  // BGR

struct Ray {
  Vec3d from, along;  ///< along has length 1
};

/// Where a ray meets something.
struct Hit {
  double way = std::numeric_limits<double>::infinity();  ///< along the ray [m]
  Vec3d normal{0.0, 0.0, 1.0};
  Vec3f color = kFloorColor;
  int owner = 0;
};

/// The part of a ray within the ball around a thing; empty: begin > end.
struct Interval {
  double begin = 1.0, end = 0.0;
};

Interval withinBall(const Ray& ray, const Vec3d& middle, double radius) {
  const Vec3d to = middle - ray.from;
  const double nearest = to.dot(ray.along);
  const double square = radius * radius - (to.dot(to) - nearest * nearest);
  if (square < 0.0 || nearest + std::sqrt(square) < 0.0) return {};
  return {std::max(0.0, nearest - std::sqrt(square)), nearest + std::sqrt(square)};
}

/// A thing with its motion the other way round.
struct Lying {
  const Article* article;
  Pose3 pose, inverse;
  Vec3d middle;
};

/// The way along a ray to the surface of a thing, at most `farthest`; infinite if it passes by.
/// The distance from the surface is a way that is free (Hart 1996).
double wayTo(const Ray& ray, const Lying& thing, double farthest) {
  constexpr double kOn = 1e-4;  // [m]
  const Interval within = withinBall(ray, thing.middle, thing.article->radius);
  const Vec3d from = thing.inverse * ray.from, along = thing.inverse.turn * ray.along;
  double way = within.begin;
  for (int step = 0; step < 100 && way <= std::min(within.end, farthest); ++step) {
    const double free = thing.article->distance(from + way * along);
    if (free < kOn) return way;
    way += free;
  }
  return std::numeric_limits<double>::infinity();
}

Vec3d normalAt(const Lying& thing, const Vec3d& in_thing) {
  constexpr double kBeside = 5e-5;
  Vec3d slope;
  for (int i = 0; i < 3; ++i) {
    Vec3d beside{0.0, 0.0, 0.0};
    beside[i] = kBeside;
    slope[i] =
        thing.article->distance(in_thing + beside) - thing.article->distance(in_thing - beside);
  }
  return thing.pose.turn * slope * (1.0 / std::max(1e-12, cv::norm(slope)));
}

class PileView {
 public:
  explicit PileView(const std::vector<PlacedArticle>& things) {
    for (const PlacedArticle& thing : things) {
      things_.push_back(
          {thing.article, thing.pose, thing.pose.inverse(), thing.pose * thing.article->middle});
    }
  }

  Hit hit(const Ray& ray) const {
    Hit out;
    if (ray.along[2] < 0.0) {
      out.way = -ray.from[2] / ray.along[2];
      const Vec3d p = ray.from + out.way * ray.along;
      if (std::max(std::abs(p[0]), std::abs(p[1])) < kHalfTable) {
        out.color = kTableColor;
      } else {
        out.way = -(ray.from[2] + kTableHeight) / ray.along[2];
      }
    }
    for (std::size_t i = 0; i < things_.size(); ++i) {
      const double way = wayTo(ray, things_[i], out.way);
      if (way >= out.way) continue;
      out.way = way;
      out.owner = static_cast<int>(i) + 1;
    }
    if (out.owner == 0) return out;
    const Lying& thing = things_[static_cast<std::size_t>(out.owner) - 1];
    const Vec3d in_thing = thing.inverse * (ray.from + out.way * ray.along);
    std::size_t part = 0;
    thing.article->distance(in_thing, &part);
    out.color = thing.article->parts[part].color;
    out.normal = normalAt(thing, in_thing);
    return out;
  }

  /// Colour by a lamp above, with the shadows that it throws.
  Vec3f light(const Ray& ray, const Hit& hit) const {
    const Vec3d p = ray.from + (hit.way - 1e-3) * ray.along + 1e-3 * hit.normal;
    const Vec3d to_lamp = cv::normalize(Vec3d{0.5, -0.7, 1.6} - p);
    double share = 0.35 + 0.15 * std::max(0.0, -hit.normal.dot(ray.along));
    const double facing = hit.normal.dot(to_lamp);
    if (facing > 0.0 && !isShadowed({p, to_lamp})) share += 0.55 * facing;
    return hit.color * static_cast<float>(share);
  }

 private:
  bool isShadowed(const Ray& ray) const {
    return std::any_of(things_.begin(), things_.end(), [&](const Lying& thing) {
      return std::isfinite(wayTo(ray, thing, std::numeric_limits<double>::infinity()));
    });
  }

  std::vector<Lying> things_;
};

}  // namespace

CameraFrame viewOfPile(const CameraParams& params, const std::vector<PlacedArticle>& things,
                       const Pose3& camera, hyselam::Rng& rng) {
  constexpr double kLeastFacing = 0.17;  // cosine: surfaces seen at less than 10 degrees
  params.validate();
  const PileView view(things);
  const cv::Size size(params.width, params.height);
  cv::Mat color(size, CV_32FC3), depth(size, CV_32FC1), owner(size, CV_32SC1);
  const double focal = params.focalLength();
  for (int v = 0; v < params.height; ++v) {
    for (int u = 0; u < params.width; ++u) {
      const Vec3d in_camera{(u - 0.5 * (params.width - 1)) / focal,
                            (v - 0.5 * (params.height - 1)) / focal, 1.0};
      const Ray ray{camera.at, camera.turn * in_camera * (1.0 / cv::norm(in_camera))};
      const Hit hit = view.hit(ray);
      const bool seen = std::isfinite(hit.way) && -hit.normal.dot(ray.along) > kLeastFacing;
      depth.at<float>(v, u) = seen ? static_cast<float>(hit.way / cv::norm(in_camera)) : 0.0f;
      owner.at<std::int32_t>(v, u) = hit.owner;
      color.at<Vec3f>(v, u) = std::isfinite(hit.way) ? view.light(ray, hit) : kFloorColor;
    }
  }
  const std::uint64_t seed = rng();
  return {develop(params, color, seed), measureDepth(params, depth, seed), owner};
}

}  // namespace hyselam_sim
