// Articles of household size: boxes, cones, balls and rings put together, as signed distances.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace hyselam_sim {

/// A rigid motion: what is at p in the moved frame is at turn * p + at.
struct Pose3 {
  cv::Matx33d turn = cv::Matx33d::eye();
  cv::Vec3d at{0.0, 0.0, 0.0};

  cv::Vec3d operator*(const cv::Vec3d& p) const { return turn * p + at; }
  Pose3 operator*(const Pose3& other) const { return {turn * other.turn, *this * other.at}; }
  Pose3 inverse() const { return {turn.t(), turn.t() * -at}; }
};

/// Turned about an axis, which need not have length 1, by an angle [rad].
cv::Matx33d turnAbout(const cv::Vec3d& axis, double angle);

/// A part of a thing, in a frame of its own.
struct Part {
  enum class Shape {
    kBox,   ///< half sides a, b, c
    kCone,  ///< about z from -c, where its radius is a, to c, where it is b: a cylinder if a = b
    kCup,   ///< the same, open above, with a wall of 4 mm
    kBall,  ///< radius a
    kRing,  ///< in the plane of x and y: radius a to the middle of a wire of radius b
  };
  Shape shape = Shape::kBox;
  double a = 0.0, b = 0.0, c = 0.0;  ///< [m], > 0 where the shape has them
  Pose3 pose;                        ///< in the thing
  cv::Vec3f color;                   ///< blue, green, red, 0 .. 1
};

struct Article {
  std::string name;
  std::vector<Part> parts;
  std::vector<cv::Vec3d> surface;  ///< points all over it [m]
  cv::Vec3d middle;                ///< of these points
  double radius = 0.0;             ///< of the ball around the middle that holds all of it [m]

  /// From a point in its frame to its surface, below 0 inside; never more than the true distance
  /// outside [m]. `part` gets the index of the nearest part.
  double distance(const cv::Vec3d& p, std::size_t* part = nullptr) const;
};

/// A drill, a mug, a watering can, a lamp, ...: all have names of their own. The same each time.
const std::vector<Article>& household();

/// @throws hyselam::InputError for a name that no thing has, with those that there are.
const Article& householdThing(const std::string& name);

}  // namespace hyselam_sim
