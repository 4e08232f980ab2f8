// From the values of the core to the messages that show them.
#pragma once

#include <geometry_msgs/PoseArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <hyselam_msgs/FsdObservation.h>
#include <hyselam_msgs/LocalizationStatus.h>
#include <nav_msgs/OccupancyGrid.h>
#include <visualization_msgs/MarkerArray.h>

#include "fsd_localization/localizer.hpp"

namespace fsd_localization {

/// @param header stamp of the scan, odometry frame. @param travelled since the start [m].
hyselam_msgs::FsdObservation toMsg(const FsdObservation& observation,
                                   const std::vector<KernelSpec>& kernels,
                                   const std_msgs::Header& header, double travelled);

/// Covariance of all particles around a pose: what is known where the heaviest cluster is not
/// everything. Particles and pose in the grid's frame; covariance over (x, y, theta) in that frame.
Eigen::Matrix3d spreadAround(const hyselam::Pose2& pose, const Particles& particles);

/// Covariance of the cluster where the result is converged, else of all particles, so that a guess
/// never looks certain. @param header stamp of the scan, map frame.
geometry_msgs::PoseWithCovarianceStamped toMsg(const LocalizationResult& result,
                                               const Localizer& localizer,
                                               const std_msgs::Header& header);

hyselam_msgs::LocalizationStatus toStatusMsg(const LocalizationResult& result, double update_ms,
                                             const std_msgs::Header& header);

/// All particles, or, of more than `most`, a sample by weight. @param header map frame.
geometry_msgs::PoseArray toMsg(const Particles& particles, std::size_t most,
                               const hyselam::Pose2& grid_in_map, const std_msgs::Header& header);

/// The density of one kernel: 0 where the map is not free, else 1 .. 98 for densities 0 .. 1
/// (rviz's cost colours keep 99 and 100 for something else).
nav_msgs::OccupancyGrid densityFieldMsg(const FsdMap& map, int kernel,
                                        const std_msgs::Header& header);

/// A flat disc and its rim for each kernel around the robot, coloured from blue (density 0) to red
/// (1), with the density written beside the rim. Without readings: a message that deletes them.
visualization_msgs::MarkerArray kernelMarkers(const FsdObservation& observation,
                                              const std::vector<KernelSpec>& kernels,
                                              const std_msgs::Header& header);

/// What only the present has, as a cube each; taken away where there is nothing.
visualization_msgs::Marker shortTermMarker(const std::vector<hyselam::Point2>& points,
                                           const std_msgs::Header& header);

}  // namespace fsd_localization
