// Conversions between object maps, camera data and their messages.
#pragma once

#include <hyselam_msgs/ObjectMap.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include "hyselam_objects/mapping/object_map.hpp"
#include "hyselam_objects/mapping/object_mapper.hpp"
#include "hyselam_objects/segmentation/organized_cloud.hpp"

namespace hyselam_objects {

hyselam_msgs::ObjectMap toMsg(const ObjectMap& map);

/// Boxes, names and arrows of relations, in the namespaces `boxes`, `names`, `relations`; the first
/// marker deletes all former ones. Doubtful objects (existence < 0.5) are transparent; objects that
/// were only described have no marker.
visualization_msgs::MarkerArray objectMarkers(const ObjectMap& map);

/// Focal length and principal point; the pose is left at its default.
/// @throws hyselam::InputError for a camera without a focal length.
PinholeCamera cameraFromInfo(const sensor_msgs::CameraInfo& info);

/// An organized cloud of a depth image (16UC1 [mm] or 32FC1 [m]) and, if not null, a color image of
/// the same size (bgr8, rgb8).
/// @throws hyselam::InputError for other encodings and sizes that do not match.
OrganizedCloud cloudFromImages(const sensor_msgs::Image& depth, const sensor_msgs::Image* color,
                               const PinholeCamera& camera);

/// From a cloud with rows and the fields x, y, z and, if there, rgb.
/// @throws hyselam::InputError for clouds without rows, fields that are missing or of another type,
///         and data that are too short.
OrganizedCloud cloudFromMsg(const sensor_msgs::PointCloud2& msg);

}  // namespace hyselam_objects
