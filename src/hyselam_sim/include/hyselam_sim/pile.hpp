// Things that lie in a pile on a table, as they come to rest when one after the other is let fall.
#pragma once

#include <vector>

#include "hyselam_common/rng.hpp"
#include "hyselam_sim/articles.hpp"
#include "hyselam_sim/camera.hpp"

namespace hyselam_sim {

struct PlacedArticle {
  const Article* article = nullptr;
  Pose3 pose;  ///< on the table: z up, 0 on its top; the middle of the pile is at x = y = 0 [m]
};

/// Lets the things fall in this order, each turned at random, near the middle. Each slides, tilts
/// and rolls down until no small motion leads lower; they touch, none is within another.
std::vector<PlacedArticle> dropPile(const std::vector<const Article*>& things, hyselam::Rng& rng);

/// A thing that stands as it was drawn, its middle above the middle of the table.
PlacedArticle standing(const Article& article);

/// How far a thing is from the table and the others; below 0 if it is within one [m].
double clearance(const PlacedArticle& thing, const std::vector<PlacedArticle>& others);

/// A camera at this distance [m] from a point 5 cm above the middle of the table, which it looks
/// at. Directions in rad. The pose is that of the optical frame (z forward, x right, y down).
Pose3 cameraAround(double azimuth, double elevation, double distance);

/// What the camera sees of things on a table of 1.2 m by 1.2 m, 0.75 m above a floor. `owner`: 0
/// table and floor, 1 + index of the thing. Surfaces that it looks along give no depth, as those of
/// real depth cameras. @throws hyselam::ParameterError.
CameraFrame viewOfPile(const CameraParams& params, const std::vector<PlacedArticle>& things,
                       const Pose3& camera, hyselam::Rng& rng);

}  // namespace hyselam_sim
