// What the tools of place signatures have in common: recorded runs as keyframes and as places along
// them, with the truth.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/carmen_log.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/ros/bag_tool.hpp"
#include "ngram_slam/signatures/signature_sensor.hpp"
#include "ngram_slam/signatures/signature_training.hpp"
#include "ngram_slam/slam/slam_engine.hpp"
#include "reference_poses.hpp"

namespace ngram_slam {

struct LogPlace {
  PlaceOnWay on_way;
  double stamp = 0.0;  // [s]
  PlaceFeatures features;
  std::optional<hyselam::Pose2> truth;
};

/// A log after SLAM without loops.
struct PlaceLog {
  std::string name, path;
  hyselam::BagOptions bag_options;
  std::vector<SlamKeyframe> keyframes;
  std::vector<hyselam::StampedPose2> reference;
  std::vector<LogPlace> places;
};

/// A place lies between two keyframes, by its way from one to the other; its stamp too.
inline double stampOf(const PlaceOnWay& at, const std::vector<SlamKeyframe>& keyframes) {
  const auto nearest = static_cast<std::size_t>(at.keyframe);
  const SlamKeyframe& k = keyframes[nearest];
  double stamp = k.stamp, best = distance(k.pose, at.pose);
  const auto tryNeighbor = [&](std::size_t other) {
    if (other >= keyframes.size()) return;
    const SlamKeyframe& n = keyframes[other];
    const double length = distance(k.pose, n.pose);
    if (!(length > 0.0) || length > SignatureSensor::kMaxStep) return;
    const double share = std::min(1.0, distance(k.pose, at.pose) / length);
    const double miss = distance(hyselam::interpolate(k.pose, n.pose, share), at.pose);
    if (miss < best) {
      best = miss;
      stamp = k.stamp + share * (n.stamp - k.stamp);
    }
  };
  if (nearest > 0) tryNeighbor(nearest - 1);
  tryNeighbor(nearest + 1);
  return stamp;
}

inline PlaceLog placesOf(const std::string& name, const hyselam::RobotLog& log,
                         std::vector<hyselam::StampedPose2> reference,
                         const SignatureSensorParams& sensor_params) {
  PlaceLog out;
  out.name = name;
  out.reference = std::move(reference);
  SlamParams params;
  params.loops = LoopClosureMode::kNone;
  SlamEngine engine(params);
  hyselam::Progress progress("odometry of " + name, log.scans.size());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    progress.update(i + 1);
    const auto odometry = hyselam::poseAt(log.odometry, log.scans[i].stamp, 0.2);
    if (!odometry) continue;
    try {
      engine.add(log.scans[i], *odometry);
    } catch (const hyselam::InputError&) {
    }
  }
  engine.endRun();
  out.keyframes = engine.keyframes();
  if (out.keyframes.empty()) throw hyselam::InputError(name, "", "gives no keyframes");
  SignatureSensor sensor(sensor_params, [&](const PlaceOnWay& at, const PlaceFeatures& features) {
    const SlamKeyframe& k = out.keyframes[static_cast<std::size_t>(at.keyframe)];
    auto truth = hyselam::poseAt(out.reference, k.stamp, 0.5);
    if (truth) truth = *truth * between(k.pose, at.pose);
    out.places.push_back({at, stampOf(at, out.keyframes), features, truth});
  });
  for (std::size_t k = 0; k < out.keyframes.size(); ++k) {
    sensor.add(static_cast<std::int64_t>(k), out.keyframes[k].pose, out.keyframes[k].scan);
  }
  sensor.finish();
  return out;
}

/// "path/intel.log.gz" is intel.
inline std::string nameOfLog(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  const std::string file = slash == std::string::npos ? path : path.substr(slash + 1);
  return file.substr(0, file.find('.'));
}

struct PlaceLogOptions {
  std::vector<std::string> logs;
  ReferenceFiles references;
  hyselam::BagOptions bag_options;

  void addTo(CLI::App& app) {
    app.option_defaults()->always_capture_default();
    app.add_option("logs", logs, "CARMEN logs or bags, plain or gzip")->required();
    hyselam::addBagOptions(app, &bag_options);
    references.addTo(app);
  }
  /// @throws hyselam::InputError for a log that cannot be read or has no true poses
  std::vector<PlaceLog> read() const {
    references.check(logs.size());
    std::vector<PlaceLog> all;
    for (std::size_t i = 0; i < logs.size(); ++i) {
      const hyselam::RobotLog log = hyselam::readRobotLog(logs[i], bag_options);
      const auto reference = references.of(i, log);
      if (reference.empty()) throw hyselam::InputError(logs[i], "", kNoTruth);
      all.push_back(placesOf(nameOfLog(logs[i]), log, reference, {}));
      all.back().path = logs[i];
      all.back().bag_options = bag_options;
    }
    return all;
  }
};

/// The places as examples to learn from.
inline std::vector<SignatureExample> examplesOf(const PlaceLog& log) {
  std::vector<SignatureExample> examples;
  for (const LogPlace& p : log.places) {
    examples.push_back({SignatureFeatures::of(p.features), p.truth});
  }
  return examples;
}

}  // namespace ngram_slam
