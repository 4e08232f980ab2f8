#include "hyselam_objects/segmentation/detect_objects.hpp"

#include <algorithm>
#include <utility>

#include "horizontal_surfaces.hpp"
#include "hyselam_common/errors.hpp"
#include "merge_patches.hpp"
#include "support.hpp"
#include "wall_cells.hpp"

namespace hyselam_objects {
namespace {

class Detector {
 public:
  Detector(const OrganizedCloud& cloud, const Eigen::Isometry3d& camera, const DetectParams& params)
      : params_(params),
        frame_(cloud, camera, params),
        surfaces_(findHorizontalSurfaces(frame_, params)),
        walls_(frame_, params.max_object_height) {}

  std::vector<DetectedObject> run() const {
    const PixelGroups groups = groupPixels();
    std::vector<DetectedObject> found;
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      found.push_back(furniture(surfaces_[s], groups.bodies[s]));
    }
    for (const auto& objects : {onFurniture(groups.on_furniture), onFloor(groups.on_floor)}) {
      found.insert(found.end(), objects.begin(), objects.end());
    }
    return found;
  }

 private:
  /// The pixels by what they belong to; floor and walls are in none.
  struct PixelGroups {
    std::vector<std::vector<std::size_t>>
        bodies;  ///< of each surface: its top and what is below it
    std::vector<bool> on_furniture, on_floor;
  };

  PixelGroups groupPixels() const {
    PixelGroups groups;
    groups.bodies.resize(surfaces_.size());
    groups.on_furniture.assign(frame_.size(), false);
    groups.on_floor.assign(frame_.size(), false);
    for (std::size_t i = 0; i < frame_.size(); ++i) {
      const double floor = params_.floor_clearance + 1.5f * frame_.grid().sigma(i);
      if (frame_.isInRange(i) && frame_.point(i).z() >= floor) assign(i, groups);
    }
    return groups;
  }

  void assign(std::size_t i, PixelGroups& groups) const {
    const Eigen::Vector3f& p = frame_.point(i);
    const float sigma = frame_.grid().sigma(i);
    const double noise = params_.segmentation.support_distance + 2.0 * sigma;
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {  // the highest first
      const double away = distanceOutside(surfaces_[s].hull, p.head<2>());
      const double height = p.z() - surfaces_[s].height;
      if (height > noise && height < params_.segmentation.max_object_height && away < 0.02) {
        groups.on_furniture[i] = true;
        return;
      }
      if (height <= noise && away < 0.04 + sigma) {
        groups.bodies[s].push_back(i);
        return;
      }
    }
    groups.on_floor[i] = p.z() < params_.max_object_height && !walls_.contains(p);
  }

  DetectedObject furniture(const HorizontalSurface& top,
                           const std::vector<std::size_t>& body) const {
    DetectedObject object = frame_.objectOf(body, 0.0);
    object.furniture = true;
    object.high.z = top.height;
    object.low.z = 0.0;
    return object;
  }

  std::vector<DetectedObject> onFurniture(const std::vector<bool>& marked) const {
    std::vector<DetectedObject> objects = split(marked);
    objects.erase(std::remove_if(objects.begin(), objects.end(),
                                 [this](const DetectedObject& object) {
                                   return exceedsObjectHeight(object, surfaces_, params_);
                                 }),
                  objects.end());
    for (DetectedObject& object : objects) {
      object.partial = object.partial ||
                       isFloating(object, objects, surfaces_, frame_.cameraPosition(), params_);
    }
    return objects;
  }

  std::vector<DetectedObject> onFloor(const std::vector<bool>& marked) const {
    std::vector<DetectedObject> objects = split(marked);
    objects.erase(std::remove_if(objects.begin(), objects.end(),
                                 [this](const DetectedObject& object) {
                                   return object.high.z > 0.98 * params_.max_object_height ||
                                          object.low.z > 0.15;
                                 }),
                  objects.end());
    return objects;
  }

  /// The objects that the marked pixels show.
  std::vector<DetectedObject> split(const std::vector<bool>& marked) const {
    const Patches patches(frame_.grid(), marked, params_.segmentation);
    const std::vector<int> objects =
        mergePatchesByRules(frame_.grid(), patches, params_.segmentation);
    std::vector<std::vector<std::size_t>> pixels;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (objects[i] == Patches::kNone) continue;
      const auto number = static_cast<std::size_t>(objects[i]);
      if (pixels.size() <= number) pixels.resize(number + 1);
      pixels[number].push_back(i);
    }
    std::vector<DetectedObject> found;
    for (const auto& each : pixels) {
      if (each.size() < static_cast<std::size_t>(params_.min_points)) continue;
      DetectedObject object = frame_.objectOf(each, 0.02);
      // Edges of what is behind, as of a window sill: thin strips without a body.
      constexpr double kThin = 0.02, kLow = 0.05, kWidest = 1.5;  // [m]
      const Eigen::Vector3d size = object.size();
      const double wide = std::max(size.x(), size.y()), deep = std::min(size.x(), size.y());
      if (wide < kThin || wide > kWidest || (deep < kThin && size.z() < kLow)) continue;
      found.push_back(std::move(object));
    }
    return found;
  }

  const DetectParams& params_;
  const MappedFrame frame_;
  const std::vector<HorizontalSurface> surfaces_;  // the highest first
  const WallCells walls_;
};

}  // namespace

void DetectParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit.renamed("range", "max_range");
  visit.renamed("tallest", "max_object_height");
  visit("max_range", max_range, Range::between(0.5, 20.0), "m", "farther points are ignored");
  visit("max_tilt", max_tilt, Range::inside(0.0, 1.5), "rad",
        "of the normals of a horizontal surface from upright");
  visit("min_surface_area", min_surface_area, Range::above(0.0), "m^2",
        "of the top of a piece of furniture");
  visit("min_surface_height", min_surface_height, Range::above(0.0), "m",
        "of the top of a piece of furniture above the floor");
  visit("max_object_height", max_object_height, Range::between(0.1, 3.0), "m",
        "of an object that stands on the floor; what is taller is a wall");
  visit("floor_clearance", floor_clearance, Range::above(0.0), "m",
        "lower points belong to the floor");
  visit("min_points", min_points, Range::atLeast(10), "", "number of points of an object");
}

void DetectParams::validate() const {
  hyselam::checkParameters(*this);
  segmentation.validate();
}

Eigen::Vector3d DetectedObject::size() const {
  const double height = high.z - low.z;
  if (outline.empty()) return {high.x - low.x, high.y - low.y, height};
  const GroundBox box = boxAround(outline);
  return {box.length, box.width, height};
}

std::vector<DetectedObject> detectObjects(const OrganizedCloud& cloud,
                                          const Eigen::Isometry3d& camera_in_map,
                                          const DetectParams& params) {
  checkCloud(cloud);
  params.validate();
  if (!camera_in_map.matrix().allFinite()) {
    throw hyselam::InputError("camera", "pose", "is not finite");
  }
  return Detector(cloud, camera_in_map, params).run();
}

}  // namespace hyselam_objects
