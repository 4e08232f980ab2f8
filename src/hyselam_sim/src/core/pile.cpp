#include "hyselam_sim/pile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hyselam_sim {
namespace {

using cv::Vec3d;

constexpr double kTouching = 5e-4;  // [m]
constexpr double kFriction = 0.35;  // way down per way across without which nothing slides

Vec3d randomAxis(hyselam::Rng& rng) {
  return {rng.gaussian(), rng.gaussian(), rng.gaussian()};
}

Vec3d middleOf(const PlacedArticle& thing) {
  return thing.pose * thing.article->middle;
}

/// Least distance of the surface of one from another, if that is below `least`.
double surfaceDistance(const PlacedArticle& one, const PlacedArticle& other, double least) {
  const Pose3 in_other = other.pose.inverse() * one.pose;
  for (const Vec3d& p : one.article->surface) {
    const Vec3d q = in_other * p;
    // No nearer than the ball around the other one.
    if (cv::norm(q - other.article->middle) - other.article->radius >= least) continue;
    least = std::min(least, other.article->distance(q));
  }
  return least;
}

void lower(PlacedArticle* thing, const std::vector<PlacedArticle>& others) {
  for (int step = 0; step < 200; ++step) {
    const double free = clearance(*thing, others);
    if (free < kTouching) return;
    thing->pose.at[2] -= 0.9 * free;
  }
}

/// Small motions at random, of which those are made that lead down: it slides where that is steep
/// enough, tilts and rolls about points of its surface.
void settle(PlacedArticle* thing, const std::vector<PlacedArticle>& others, int motions,
            hyselam::Rng& rng) {
  constexpr double kLeast = 0.02;  // of the scale of motions
  const auto& surface = thing->article->surface;
  double slide_scale = 1.0, turn_scale = 1.0;
  for (int i = 0; i < motions; ++i) {
    const bool slides = i % 4 == 0;
    double& scale = slides ? slide_scale : turn_scale;
    PlacedArticle moved = *thing;
    if (slides) {
      moved.pose.at += randomAxis(rng) * (0.005 * scale);
    } else {
      const cv::Vec3d pivot =
          thing->pose * surface[rng.below(static_cast<std::uint32_t>(surface.size()))];
      const cv::Matx33d turn = turnAbout(randomAxis(rng), 0.15 * scale * rng.gaussian());
      moved.pose.turn = turn * thing->pose.turn;
      moved.pose.at = turn * (thing->pose.at - pivot) + pivot;
    }
    const cv::Vec3d way = middleOf(moved) - middleOf(*thing);
    const double across = slides ? std::hypot(way[0], way[1]) : 0.0;
    if (way[2] < -kFriction * across && clearance(moved, others) > -kTouching) {
      *thing = moved;
      scale = std::min(1.0, 2.0 * scale);
    } else {
      scale = std::max(kLeast, 0.97 * scale);
    }
  }
}

}  // namespace

double clearance(const PlacedArticle& thing, const std::vector<PlacedArticle>& others) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3d& p : thing.article->surface) least = std::min(least, (thing.pose * p)[2]);
  for (const PlacedArticle& other : others) {
    const double apart =
        cv::norm(middleOf(thing) - middleOf(other)) - thing.article->radius - other.article->radius;
    if (apart >= least) continue;
    least = surfaceDistance(thing, other, least);
    least = surfaceDistance(other, thing, least);
  }
  return least;
}

std::vector<PlacedArticle> dropPile(const std::vector<const Article*>& things, hyselam::Rng& rng) {
  constexpr double kSpread = 0.05, kHigh = 0.6;  // [m]
  constexpr int kMotions = 2000, kRounds = 2;
  std::vector<PlacedArticle> out;
  for (const Article* article : things) {
    PlacedArticle thing{article, {}};
    thing.pose.turn = turnAbout(randomAxis(rng), rng.uniform(0.0, 2.0 * hyselam::kPi));
    const Vec3d above{kSpread * rng.gaussian(), kSpread * rng.gaussian(), kHigh};
    thing.pose.at = above - thing.pose.turn * article->middle;
    lower(&thing, out);
    settle(&thing, out, kMotions, rng);
    lower(&thing, out);
    out.push_back(thing);
  }
  // What came later may lie on what would still move under it.
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      PlacedArticle thing = out[i];
      std::vector<PlacedArticle> others = out;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      settle(&thing, others, kMotions / 2, rng);
      lower(&thing, others);
      out[i] = thing;
    }
  }
  return out;
}

PlacedArticle standing(const Article& article) {
  PlacedArticle out{&article, {}};
  out.pose.at = {-article.middle[0], -article.middle[1], 1.0};
  lower(&out, {});
  return out;
}

Pose3 cameraAround(double azimuth, double elevation, double distance) {
  const Vec3d back{std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                   std::sin(elevation)};
  const Vec3d forward = -back, right{-std::sin(azimuth), std::cos(azimuth), 0.0};
  const Vec3d down = forward.cross(right);
  Pose3 out;
  for (int i = 0; i < 3; ++i) {
    out.turn(i, 0) = right[i];
    out.turn(i, 1) = down[i];
    out.turn(i, 2) = forward[i];
  }
  out.at = Vec3d{0.0, 0.0, 0.05} + distance * back;
  return out;
}

}  // namespace hyselam_sim
