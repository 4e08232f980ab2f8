// Training of the odds that two patches belong to one object, from clouds whose points are labelled
// by hand.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hyselam_objects/pcl/cloud_io.hpp"
#include "segmentation/relation_model.hpp"
#include "segmentation_score.hpp"

namespace hyselam_objects {

/// Two patches of a labelled cloud.
struct RelationExample {
  PatchRelation relation;
  bool one_object = false;  ///< most points of both have the label of one object
};

struct LabelledCloud {
  std::string name;
  CloudFile file;  ///< labels as mOSD has them, see segmentation_score.hpp
  std::vector<RelationExample> examples;
};

/// Reads *.pcd of the folders, sorted by name, and finds their examples.
/// @throws hyselam::InputError for a folder without one, and for a cloud without labels.
std::vector<LabelledCloud> readLabelledClouds(const std::vector<std::string>& folders);

/// Logistic regression, L2-regularized, examples weighted by size up to 100 pixels, on the clouds
/// for which `used` holds. The result does not say where it comes from.
RelationModel trainRelations(const std::vector<LabelledCloud>& clouds,
                             const std::function<bool(const LabelledCloud&)>& used);

/// Score of one cloud. `with_colors`: whether the segmentation may see them.
SegmentationScore scoreCloud(const LabelledCloud& cloud, const RelationModel& model,
                             bool with_colors = true);

}  // namespace hyselam_objects
