#include "hyselam_sim/articles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"

namespace hyselam_sim {
namespace {

using cv::Vec2d;
using cv::Vec3d;
using Shape = Part::Shape;

double boxDistance(const Vec3d& p, const Vec3d& half) {
  Vec3d outside;
  double inside = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double d = std::abs(p[i]) - half[i];
    outside[i] = std::max(d, 0.0);
    inside = std::max(inside, d);
  }
  return cv::norm(outside) + std::min(inside, 0.0);
}

/// Of a cone cut off at both ends: radius a at z = -c, b at z = c.
double coneDistance(const Vec3d& p, double a, double b, double c) {
  const Vec2d q{std::hypot(p[0], p[1]), p[2]};
  const Vec2d to_lid{q[0] - std::min(q[0], q[1] < 0.0 ? a : b), std::abs(q[1]) - c};
  const Vec2d rim{b, c}, along{b - a, 2.0 * c};
  const double share = std::clamp((rim - q).dot(along) / along.dot(along), 0.0, 1.0);
  const Vec2d to_side = q - rim + share * along;
  const double d = std::min(cv::norm(to_lid), cv::norm(to_side));
  return to_side[0] < 0.0 && to_lid[1] < 0.0 ? -d : d;
}

double partDistance(const Part& part, const Vec3d& in_thing) {
  constexpr double kWall = 0.004;
  const Vec3d p = part.pose.turn.t() * (in_thing - part.pose.at);
  switch (part.shape) {
    case Shape::kBox:
      return boxDistance(p, {part.a, part.b, part.c});
    case Shape::kCone:
      return coneDistance(p, part.a, part.b, part.c);
    case Shape::kCup:
      return std::max(
          coneDistance(p, part.a, part.b, part.c),
          -coneDistance(p - Vec3d{0.0, 0.0, 2.0 * kWall}, part.a - kWall, part.b - kWall, part.c));
    case Shape::kBall:
      return cv::norm(p) - part.a;
    case Shape::kRing:
      return std::hypot(std::hypot(p[0], p[1]) - part.a, p[2]) - part.b;
  }
  return 0.0;
}

/// Half the side of a cube around the part, in its own frame.
double reach(const Part& part) {
  return part.shape == Shape::kRing ? part.a + part.b : std::max({part.a, part.b, part.c}) * 1.01;
}

/// Points at random in cubes around the parts, led to the surface.
void addSurface(Article* article) {
  constexpr std::size_t kPoints = 500;
  constexpr double kOn = 2e-4;
  hyselam::Rng rng(7);
  while (article->surface.size() < kPoints) {
    const Part& part = article->parts[rng.below(static_cast<std::uint32_t>(article->parts.size()))];
    const double far = reach(part);
    Vec3d p{rng.uniform(-far, far), rng.uniform(-far, far), rng.uniform(-far, far)};
    p = part.pose * p;
    for (int step = 0; step < 8; ++step) {
      const double d = article->distance(p);
      if (std::abs(d) < kOn) {
        article->surface.push_back(p);
        break;
      }
      Vec3d slope;
      for (int i = 0; i < 3; ++i) {
        Vec3d beside = p;
        beside[i] += 1e-4;
        slope[i] = article->distance(beside) - d;
      }
      const double length = cv::norm(slope);
      if (length == 0.0) break;
      p -= slope * (d / length);
    }
  }
  for (const Vec3d& p : article->surface) article->middle += p * (1.0 / kPoints);
  for (const Vec3d& p : article->surface) {
    article->radius = std::max(article->radius, cv::norm(p - article->middle) + 0.005);
  }
}

Pose3 at(double x, double y, double z) {
  return {cv::Matx33d::eye(), {x, y, z}};
}

/// Turned about an axis by so many degrees.
Pose3 at(double x, double y, double z, const Vec3d& axis, double degrees) {
  return {turnAbout(axis, hyselam::radians(degrees)), {x, y, z}};
}

const Vec3d kX{1.0, 0.0, 0.0}, kY{0.0, 1.0, 0.0};
const cv::Vec3f kBlack{0.10f, 0.09f, 0.09f}, kGray{0.45f, 0.45f, 0.46f},
    kWhite{0.85f, 0.87f, 0.88f}, kYellow{0.10f, 0.70f, 0.90f}, kRed{0.13f, 0.12f, 0.75f},
    kGreen{0.20f, 0.55f, 0.15f}, kBlue{0.65f, 0.30f, 0.12f}, kOrange{0.08f, 0.42f, 0.90f},
    kBrown{0.30f, 0.45f, 0.62f};

/// Parts by name of the thing; lengths in metres, z up as it stands.
std::vector<Article> things() {
  const auto box = Shape::kBox, cone = Shape::kCone, cup = Shape::kCup, ball = Shape::kBall,
             ring = Shape::kRing;
  return {
      {"drill",
       {{cone, .031, .028, .070, at(0, 0, 0, kY, 90), kYellow},
        {cone, .024, .013, .024, at(.094, 0, 0, kY, 90), kBlack},
        {cone, .004, .003, .035, at(.152, 0, 0, kY, 90), kGray},
        {box, .019, .015, .055, at(-.030, 0, -.075, kY, 12), kYellow},
        {box, .050, .034, .021, at(-.040, 0, -.145), kBlack}},
       {},
       {},
       0.0},
      {"mug",
       {{cup, .040, .042, .048, at(0, 0, 0), kRed},
        {ring, .026, .006, 0, at(.046, 0, 0, kX, 90), kRed}},
       {},
       {},
       0.0},
      {"watering can",
       {{cup, .075, .062, .065, at(0, 0, 0), kGreen},
        {cone, .013, .009, .095, at(.135, 0, .025, kY, 42), kGreen},
        {cone, .010, .028, .014, at(.208, 0, .106, kY, 42), kGreen},
        {ring, .052, .007, 0, at(-.068, 0, .012, kX, 90), kGreen}},
       {},
       {},
       0.0},
      {"duck",
       {{ball, .048, 0, 0, at(0, 0, 0), kYellow},
        {ball, .030, 0, 0, at(.030, 0, .060), kYellow},
        {cone, .016, .007, .014, at(.066, 0, .056, kY, 90), kOrange},
        {cone, .026, .006, .026, at(-.052, 0, .022, kY, -60), kYellow}},
       {},
       {},
       0.0},
      {"lamp",
       {{cone, .065, .058, .010, at(0, 0, -.13), kBlack},
        {cone, .007, .007, .085, at(-.022, 0, -.040, kY, -16), kGray},
        {cone, .007, .007, .060, at(.000, 0, .080, kY, 55), kGray},
        {cone, .022, .052, .038, at(.062, 0, .098, kY, 145), kBlack}},
       {},
       {},
       0.0},
      {"stapler",
       {{box, .078, .018, .006, at(0, 0, 0), kBlack},
        {box, .074, .015, .011, at(-.002, 0, .030, kY, -9), kBlue},
        {cone, .012, .012, .017, at(-.068, 0, .012, kX, 90), kGray}},
       {},
       {},
       0.0},
      {"bottle",
       {{cone, .035, .035, .070, at(0, 0, 0), kGreen},
        {cone, .035, .014, .020, at(0, 0, .090), kGreen},
        {cone, .014, .014, .025, at(0, 0, .133), kWhite}},
       {},
       {},
       0.0},
      {"torch",
       {{cone, .015, .015, .060, at(0, 0, 0), kGray},
        {cone, .015, .028, .022, at(0, 0, .080), kBlack}},
       {},
       {},
       0.0},
      {"toy car",
       {{box, .065, .027, .014, at(0, 0, 0), kRed},
        {box, .032, .024, .013, at(-.008, 0, .026), kWhite},
        {cone, .016, .016, .006, at(.040, .030, -.012, kX, 90), kBlack},
        {cone, .016, .016, .006, at(.040, -.030, -.012, kX, 90), kBlack},
        {cone, .016, .016, .006, at(-.040, .030, -.012, kX, 90), kBlack},
        {cone, .016, .016, .006, at(-.040, -.030, -.012, kX, 90), kBlack}},
       {},
       {},
       0.0},
      {"roll of tape", {{ring, .042, .014, 0, at(0, 0, 0), kBrown}}, {}, {}, 0.0},
      {"tin", {{cone, .037, .037, .055, at(0, 0, 0), kGray}}, {}, {}, 0.0},
      {"box of tea", {{box, .065, .035, .045, at(0, 0, 0), kOrange}}, {}, {}, 0.0},
      {"hair dryer",
       {{cone, .038, .034, .065, at(0, 0, 0, kY, 90), kBlue},
        {cone, .030, .020, .030, at(.093, 0, 0, kY, 90), kBlack},
        {box, .018, .014, .060, at(-.025, 0, -.085, kY, 6), kBlue}},
       {},
       {},
       0.0},
  };
}

}  // namespace

cv::Matx33d turnAbout(const Vec3d& axis, double angle) {
  const double length = cv::norm(axis);
  if (length == 0.0) return cv::Matx33d::eye();
  const Vec3d k = axis * (1.0 / length);
  const cv::Matx33d cross(0.0, -k[2], k[1], k[2], 0.0, -k[0], -k[1], k[0], 0.0);
  return cv::Matx33d::eye() + cross * std::sin(angle) + cross * cross * (1.0 - std::cos(angle));
}

double Article::distance(const Vec3d& p, std::size_t* part) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double d = partDistance(parts[i], p);
    if (d >= nearest) continue;
    nearest = d;
    if (part != nullptr) *part = i;
  }
  return nearest;
}

const std::vector<Article>& household() {
  static const std::vector<Article> all = [] {
    std::vector<Article> out = things();
    for (Article& article : out) addSurface(&article);
    return out;
  }();
  return all;
}

const Article& householdThing(const std::string& name) {
  std::string names;
  for (const Article& article : household()) {
    if (article.name == name) return article;
    names += (names.empty() ? "" : ", ") + article.name;
  }
  throw hyselam::InputError("thing", name, "is none of " + names);
}

}  // namespace hyselam_sim
