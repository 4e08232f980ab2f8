#include "hyselam_objects/segmentation/segment_cloud.hpp"

#include <algorithm>

#include "hyselam_common/errors.hpp"
#include "segment_frame.hpp"

namespace hyselam_objects {

void checkCloud(const OrganizedCloud& cloud) {
  using hyselam::InputError;
  const auto size = static_cast<std::size_t>(std::max(0, cloud.width)) *
                    static_cast<std::size_t>(std::max(0, cloud.height));
  if (cloud.width < 0 || cloud.height < 0 || cloud.points.size() != size ||
      (!cloud.colors.empty() && cloud.colors.size() != size)) {
    throw InputError("cloud", "", "has not as many points as its width and height say");
  }
  if (size > 50000000) throw InputError("cloud", "", "has more than 50 million points");
}

void SegmentParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  const Range share = Range::between(0.0, 10.0), length = share, angle = share;
  visit("downsampling", downsampling, Range::between(1, 8), "", "of rows and columns");
  visit("noise_floor", noise_floor, length, "m", "standard deviation of a depth at 0.4 m");
  visit("noise_growth", noise_growth, share, "1/m", "its growth with (depth - 0.4 m)^2");
  visit("normal_window", normal_window, Range::between(1, 20), "pixel",
        "half side of the window of a normal, in reduced pixels");
  visit("max_smooth_angle", max_smooth_angle, angle, "rad",
        "between the normals of neighbors in one patch");
  visit("max_surface_variation", max_surface_variation, share, "", "where patches grow");
  visit("support_distance", support_distance, length, "m",
        "nearer points belong to the support plane; noise is added");
  visit("max_object_height", max_object_height, length, "m", "above the support plane");
  visit("max_support_tilt", max_support_tilt, Range::inside(0.0, 1.5), "rad",
        "of the support plane, where up is known");
  visit("join_bias", join_bias, Range::between(-10.0, 10.0), "",
        "log-odds added for each pair of patches: more joins more");
  visit("min_convex_ratio", min_convex_ratio, share, "",
        "share of the contact of two patches that must be convex, in rooms");
  visit("min_contact_ratio", min_contact_ratio, share, "",
        "share of the border of two patches that must be in contact, in rooms");
  visit("min_border_ratio", min_border_ratio, share, "",
        "length of the convex contact over the root of the smaller patch's size, in rooms");
  visit("concavity_tolerance", concavity_tolerance, angle, "rad",
        "a smaller concave angle counts as flat");
  visit("max_step", max_step, length, "m", "surfaces in contact miss each other by less");
  visit("min_hollow_angle", min_hollow_angle, angle, "rad",
        "concave turn of the normals inside a hollow object");
  visit("min_hollow_ratio", min_hollow_ratio, share, "",
        "share of the lower edge of the inside that the outside hides");
  visit("max_occlusion_length", max_occlusion_length, length, "m",
        "distance between parts of one surface behind an occluder");
  visit("max_occlusion_angle", max_occlusion_angle, angle, "rad",
        "between the normals of those parts");
  visit("max_occlusion_offset", max_occlusion_offset, length, "m",
        "by which those parts miss each other");
  visit("min_object_pixels", min_object_pixels, Range::atLeast(1), "pixel",
        "reduced pixels of an object");
  visit("max_fragment_pixels", max_fragment_pixels, Range::atLeast(0), "pixel",
        "smaller fragments join the object around them");
  visit("max_fragment_gap", max_fragment_gap, length, "m",
        "distance between a fragment and the object that it joins");
}

void SegmentParams::validate() const {
  hyselam::checkParameters(*this);
}

CloudSegmentation segmentCloud(const OrganizedCloud& cloud, const SegmentParams& params,
                               const std::optional<Eigen::Vector3f>& up) {
  return segmentCloudBy(cloud, params, up, RelationModel::shipped());
}

}  // namespace hyselam_objects
