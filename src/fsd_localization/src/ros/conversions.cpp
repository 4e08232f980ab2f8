#include "fsd_localization/ros/conversions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/markers.hpp"

namespace fsd_localization {

using hyselam::Pose2;

namespace {

constexpr double kLargestDensityValue = 98.0;

/// The covariance of a pose message over (x, y, z, roll, pitch, yaw), from one over (x, y, yaw).
void fillCovariance(const Eigen::Matrix3d& in, boost::array<double, 36>& out) {
  constexpr int kPlace[3] = {0, 1, 5};
  out.assign(0.0);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out[static_cast<std::size_t>(6 * kPlace[r] + kPlace[c])] = in(r, c);
  }
}

Eigen::Matrix3d rotated(const Eigen::Matrix3d& covariance, double angle) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  const double c = std::cos(angle), s = std::sin(angle);
  turn.topLeftCorner<2, 2>() << c, -s, s, c;
  return turn * covariance * turn.transpose();
}

}  // namespace

hyselam_msgs::FsdObservation toMsg(const FsdObservation& observation,
                                   const std::vector<KernelSpec>& kernels,
                                   const std_msgs::Header& header, double travelled) {
  constexpr float kUndefined = std::numeric_limits<float>::quiet_NaN();
  hyselam_msgs::FsdObservation msg;
  msg.header = header;
  msg.base_in_odom = hyselam::toPose2dMsg(observation.base_in_odom);
  for (std::size_t k = 0; k < observation.readings.size(); ++k) {
    const FsdReading& reading = observation.readings[k];
    msg.kernel_names.push_back(toString(kernels[k].profile));
    msg.bandwidths.push_back(static_cast<float>(kernels[k].bandwidth));
    msg.soft.push_back(static_cast<float>(reading.density.soft));
    msg.hard.push_back(reading.density.hard ? static_cast<float>(*reading.density.hard)
                                            : kUndefined);
    msg.upper.push_back(static_cast<float>(reading.density.upper));
    // The density grows where it does not fall.
    msg.gradient_direction.push_back(reading.descent ? static_cast<float>(hyselam::normalizeAngle(
                                                           *reading.descent + hyselam::kPi))
                                                     : kUndefined);
    msg.frontiers.push_back(reading.frontiers);
  }
  msg.travelled = travelled;
  return msg;
}

Eigen::Matrix3d spreadAround(const Pose2& pose, const Particles& particles) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  double total = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double w = particles.weight[i];
    const Pose2 p = particles.pose(i);
    const Eigen::Vector3d e(p.x - pose.x, p.y - pose.y,
                            hyselam::normalizeAngle(p.theta - pose.theta));
    sum += w * e * e.transpose();
    total += w;
  }
  if (!(total > 0.0) || !sum.allFinite()) return Eigen::Matrix3d::Zero();
  return sum / total;
}

geometry_msgs::PoseWithCovarianceStamped toMsg(const LocalizationResult& result,
                                               const Localizer& localizer,
                                               const std_msgs::Header& header) {
  geometry_msgs::PoseWithCovarianceStamped msg;
  msg.header = header;
  msg.pose.pose = hyselam::toPoseMsg(result.base_in_map);
  if (result.converged) {
    fillCovariance(result.covariance, msg.pose.covariance);
  } else {
    const Pose2& origin = localizer.map().geometry().origin;
    const Pose2 base_in_grid = hyselam::between(origin, result.base_in_map);
    Eigen::Matrix3d c = rotated(spreadAround(base_in_grid, localizer.particles()), origin.theta);
    // All particles may lie at one place that is only supposed, or in doubt.
    for (int i : {0, 1, 2}) c(i, i) = std::max(c(i, i), result.covariance(i, i));
    fillCovariance(c, msg.pose.covariance);
  }
  return msg;
}

hyselam_msgs::LocalizationStatus toStatusMsg(const LocalizationResult& result, double update_ms,
                                             const std_msgs::Header& header) {
  using Status = hyselam_msgs::LocalizationStatus;
  Status msg;
  msg.header = header;
  msg.phase = result.phase == Phase::kTracking ? Status::TRACKING
              : result.phase == Phase::kLost   ? Status::LOST
                                               : Status::GLOBAL;
  msg.converged = result.converged;
  msg.particles = static_cast<std::uint32_t>(result.particles);
  msg.effective_sample_size = static_cast<float>(result.effective_size);
  msg.match_quality = result.inlier_ratio ? static_cast<float>(*result.inlier_ratio)
                                          : std::numeric_limits<float>::quiet_NaN();
  msg.travelled = result.travelled;
  msg.update_ms = static_cast<float>(update_ms);
  std::ostringstream text;
  text.precision(2);
  text << std::fixed << toString(result.phase) << (result.converged ? "" : ", not converged")
       << ": x " << result.base_in_map.x << " m, y " << result.base_in_map.y << " m, ";
  text.precision(0);
  text << hyselam::degrees(result.base_in_map.theta) << " deg, " << 100.0 * result.cluster_weight
       << " % of " << result.particles << " particles";
  if (result.inlier_ratio)
    text << ", " << 100.0 * *result.inlier_ratio << " % of the returns explained";
  msg.text = text.str();
  return msg;
}

geometry_msgs::PoseArray toMsg(const Particles& particles, std::size_t most,
                               const Pose2& grid_in_map, const std_msgs::Header& header) {
  geometry_msgs::PoseArray msg;
  msg.header = header;
  Particles sample;
  if (particles.size() > most) resampleSystematic(particles, most, 0.5, sample);
  const Particles& shown = particles.size() > most ? sample : particles;
  msg.poses.reserve(shown.size());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    msg.poses.push_back(hyselam::toPoseMsg(grid_in_map * shown.pose(i)));
  }
  return msg;
}

nav_msgs::OccupancyGrid densityFieldMsg(const FsdMap& map, int kernel,
                                        const std_msgs::Header& header) {
  hyselam::OccupancyGrid grid(map.geometry(), 0);
  for (int y = 0; y < map.geometry().height; ++y) {
    for (int x = 0; x < map.geometry().width; ++x) {
      if (map.isFree({x, y})) {
        grid.at({x, y}) = static_cast<std::int8_t>(
            1 + std::lround((kLargestDensityValue - 1.0) * map.density({x, y}, kernel)));
      }
    }
  }
  return hyselam::toMsg(grid, header.frame_id, header.stamp);
}

visualization_msgs::MarkerArray kernelMarkers(const FsdObservation& observation,
                                              const std::vector<KernelSpec>& kernels,
                                              const std_msgs::Header& header) {
  using visualization_msgs::Marker;
  visualization_msgs::MarkerArray array;
  Marker base;
  base.header = header;
  if (observation.readings.empty()) {
    base.action = Marker::DELETEALL;
    array.markers.push_back(base);
    return array;
  }
  base.action = Marker::ADD;
  base.pose = hyselam::toPoseMsg(observation.base_in_odom);
  for (std::size_t k = 0; k < observation.readings.size(); ++k) {
    const double h = kernels[k].bandwidth, density = observation.readings[k].density.soft;
    base.id = static_cast<int>(k);
    base.color.r = static_cast<float>(density);
    base.color.g = 0.1F;
    base.color.b = static_cast<float>(1.0 - density);

    Marker disc = base;
    disc.ns = "disc";
    disc.type = Marker::CYLINDER;
    disc.pose.position.z = 0.01 * static_cast<double>(k + 1);
    disc.scale.x = disc.scale.y = 2.0 * h;
    disc.scale.z = 0.005;
    disc.color.a = 0.12F;
    array.markers.push_back(disc);

    Marker rim = base;
    rim.ns = "rim";
    rim.type = Marker::LINE_STRIP;
    rim.pose.position.z = 0.1;
    rim.scale.x = 0.06;
    rim.color.a = 0.9F;
    constexpr int kCorners = 72;
    for (int i = 0; i <= kCorners; ++i) {
      geometry_msgs::Point p;
      p.x = h * std::cos(2.0 * hyselam::kPi * i / kCorners);
      p.y = h * std::sin(2.0 * hyselam::kPi * i / kCorners);
      rim.points.push_back(p);
    }
    array.markers.push_back(rim);

    Marker label = base;
    label.ns = "density";
    label.type = Marker::TEXT_VIEW_FACING;
    const double angle = hyselam::radians(90.0 + 30.0 * static_cast<double>(k));
    label.pose.position.x += h * std::cos(angle);
    label.pose.position.y += h * std::sin(angle);
    label.pose.position.z = 0.3;
    label.pose.orientation = hyselam::yawToMsg(0.0);
    label.scale.z = 0.4;
    label.color.a = 1.0F;
    std::ostringstream text;
    text.precision(2);
    text << std::fixed << density;
    label.text = text.str();
    array.markers.push_back(label);
  }
  return array;
}

visualization_msgs::Marker shortTermMarker(const std::vector<hyselam::Point2>& points,
                                           const std_msgs::Header& header) {
  using visualization_msgs::Marker;
  Marker m = hyselam::marker(header.frame_id, "short_term", 0, Marker::CUBE_LIST);
  m.header = header;
  if (points.empty()) m.action = Marker::DELETE;
  m.scale.x = m.scale.y = ShortTermLayer::kCell;
  m.scale.z = 0.05;
  m.color = hyselam::color(1.0, 0.5, 0.0, 0.9);
  for (const hyselam::Point2& p : points) m.points.push_back(hyselam::at(p.x, p.y, 0.02));
  return m;
}

}  // namespace fsd_localization
