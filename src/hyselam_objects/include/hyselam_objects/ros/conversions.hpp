// Between object maps, camera data and their messages.
#pragma once

#include <hyselam_msgs/ObjectMap.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include "hyselam_objects/object_map.hpp"
#include "hyselam_objects/object_mapper.hpp"
#include "hyselam_objects/organised_cloud.hpp"

namespace hyselam_objects {

hyselam_msgs::ObjectMap toMsg(const ObjectMap& map);

/// Boxes, names and arrows of relations, in the namespaces `boxes`, `names`, `relations`; the first
/// marker deletes what was shown before. Doubtful objects (existence < 0.5) are transparent, those
/// only told are not shown.
visualization_msgs::MarkerArray objectMarkers(const ObjectMap& map);

/// Focal length and middle; the pose is left as it is. Throws hyselam::InputError for a camera
/// without a focal length.
PinholeCamera cameraOf(const sensor_msgs::CameraInfo& info);

/// An organised cloud of a depth image (16UC1 [mm] or 32FC1 [m]) and, if not null, a colour image
/// of the same size (bgr8, rgb8). Throws hyselam::InputError for other encodings and sizes that do
/// not fit.
OrganisedCloud cloudOf(const sensor_msgs::Image& depth, const sensor_msgs::Image* colour,
                       const PinholeCamera& camera);

/// Of a cloud with rows and the fields x, y, z and, if there, rgb. Throws hyselam::InputError for
/// clouds without rows, fields that are missing or of another type, and data that are too short.
OrganisedCloud cloudOf(const sensor_msgs::PointCloud2& msg);

}  // namespace hyselam_objects
