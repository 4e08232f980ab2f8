#include "hyselam_objects/detect_objects.hpp"

#include <algorithm>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/require.hpp"
#include "join_patches.hpp"
#include "level_surfaces.hpp"
#include "support.hpp"
#include "wall_cells.hpp"

namespace hyselam_objects {
namespace {

class Detector {
 public:
  Detector(const OrganisedCloud& cloud, const Eigen::Isometry3d& camera, const DetectParams& params)
      : params_(params),
        frame_(cloud, camera, params),
        surfaces_(findLevelSurfaces(frame_, params)),
        walls_(frame_, params.tallest) {}

  std::vector<DetectedObject> run() const {
    const Shares shares = share();
    std::vector<DetectedObject> found;
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {
      found.push_back(furniture(surfaces_[s], shares.bodies[s]));
    }
    for (const auto& things : {onFurniture(shares.on_furniture), onFloor(shares.on_floor)}) {
      found.insert(found.end(), things.begin(), things.end());
    }
    return found;
  }

 private:
  /// What the pixels belong to; floor and walls are in none.
  struct Shares {
    std::vector<std::vector<std::size_t>> bodies;  ///< of each surface: its top and what is below
    std::vector<bool> on_furniture, on_floor;
  };

  Shares share() const {
    Shares shares;
    shares.bodies.resize(surfaces_.size());
    shares.on_furniture.assign(frame_.size(), false);
    shares.on_floor.assign(frame_.size(), false);
    for (std::size_t i = 0; i < frame_.size(); ++i) {
      const double floor = params_.floor_clearance + 1.5f * frame_.grid().sigma(i);
      if (frame_.isNear(i) && frame_.point(i).z() >= floor) assign(i, &shares);
    }
    return shares;
  }

  void assign(std::size_t i, Shares* shares) const {
    const Eigen::Vector3f& p = frame_.point(i);
    const float sigma = frame_.grid().sigma(i);
    const double noise = params_.segment.support_distance + 2.0 * sigma;
    for (std::size_t s = 0; s < surfaces_.size(); ++s) {  // the highest first
      const double away = outside(surfaces_[s].hull, p.head<2>());
      const double height = p.z() - surfaces_[s].height;
      if (height > noise && height < params_.segment.tallest && away < 0.02) {
        shares->on_furniture[i] = true;
        return;
      }
      if (height <= noise && away < 0.04 + sigma) {
        shares->bodies[s].push_back(i);
        return;
      }
    }
    shares->on_floor[i] = p.z() < params_.tallest && !walls_.contains(p);
  }

  DetectedObject furniture(const LevelSurface& top, const std::vector<std::size_t>& body) const {
    DetectedObject object = frame_.describe(body, 0.0);
    object.furniture = true;
    object.high.z = top.height;
    object.low.z = 0.0;
    return object;
  }

  std::vector<DetectedObject> onFurniture(const std::vector<bool>& marked) const {
    std::vector<DetectedObject> things = split(marked);
    things.erase(std::remove_if(things.begin(), things.end(),
                                [this](const DetectedObject& object) {
                                  return isTaller(object, surfaces_, params_);
                                }),
                 things.end());
    for (DetectedObject& object : things) {
      object.cut = object.cut || isFloating(object, things, surfaces_, frame_.eye(), params_);
    }
    return things;
  }

  std::vector<DetectedObject> onFloor(const std::vector<bool>& marked) const {
    std::vector<DetectedObject> things = split(marked);
    things.erase(std::remove_if(things.begin(), things.end(),
                                [this](const DetectedObject& object) {
                                  return object.high.z > 0.98 * params_.tallest ||
                                         object.low.z > 0.15;
                                }),
                 things.end());
    return things;
  }

  /// The things that the marked pixels show.
  std::vector<DetectedObject> split(const std::vector<bool>& marked) const {
    const Patches patches(frame_.grid(), marked, params_.segment);
    const std::vector<int> objects = joinPatches(frame_.grid(), patches, params_.segment);
    std::vector<std::vector<std::size_t>> pixels;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (objects[i] == Patches::kNone) continue;
      const auto number = static_cast<std::size_t>(objects[i]);
      if (pixels.size() <= number) pixels.resize(number + 1);
      pixels[number].push_back(i);
    }
    std::vector<DetectedObject> found;
    for (const auto& each : pixels) {
      if (each.size() < static_cast<std::size_t>(params_.smallest)) continue;
      DetectedObject object = frame_.describe(each, 0.02);
      // Edges of what is behind: thin shreds without a body.
      const double wide = std::max(object.high.x - object.low.x, object.high.y - object.low.y);
      if (wide >= 0.02 && wide <= 1.5) found.push_back(std::move(object));
    }
    return found;
  }

  const DetectParams& params_;
  const MappedFrame frame_;
  const std::vector<LevelSurface> surfaces_;  // the highest first
  const WallCells walls_;
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
