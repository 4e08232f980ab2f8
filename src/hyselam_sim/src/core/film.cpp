#include "hyselam_sim/film.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_sim {
namespace {

// Between the samples of the truth; where it jumps (the robot was carried), the one before.
Pose2 truthAt(const std::vector<hyselam::StampedPose2>& truth, double stamp) {
  constexpr double kJump = 0.5;  // [m]
  const Pose2 pose = hyselam::poseAt(truth, stamp, 1e-6).value();
  const auto after = std::upper_bound(
      truth.begin(), truth.end(), stamp,
      [](double t, const hyselam::StampedPose2& sample) { return t < sample.stamp; });
  if (after == truth.begin() || after == truth.end()) return pose;
  const Pose2& a = std::prev(after)->pose;
  const Point2 way = Point2{after->pose.x, after->pose.y} - Point2{a.x, a.y};
  return length(way) > kJump ? a : pose;
}

}  // namespace

void FilmParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit.group("camera_", camera);
  visit.group("light_", light);
  visit("rate", rate, Range::between(0.01, 120.0), "Hz", "pictures per second");
  visit("start_time", start_time, Range::any(), "s",
        "stamp at which doors and people begin to move");
}

void FilmParams::validate() const {
  hyselam::checkParameters(*this);
}

std::size_t filmLength(const hyselam::RobotLog& log, const FilmParams& params) {
  params.validate();
  if (log.ground_truth.empty()) {
    throw hyselam::InputError("log", "", "has no ground truth to film along");
  }
  const double seconds = log.ground_truth.back().stamp - log.ground_truth.front().stamp;
  return 1 + static_cast<std::size_t>(std::floor(seconds * params.rate + 1e-9));
}

void film(const Scene& scene, const hyselam::RobotLog& log, const std::vector<Person>& people,
          std::uint64_t seed, const FilmParams& params,
          const std::function<void(const FilmFrame&)>& take) {
  const std::size_t frames = filmLength(log, params);
  FilmFrame frame;
  for (std::size_t i = 0; i < frames; ++i) {
    frame.stamp = log.ground_truth.front().stamp + static_cast<double>(i) / params.rate;
    frame.base = truthAt(log.ground_truth, frame.stamp);
    frame.place = scene.regions().placeAt({frame.base.x, frame.base.y});
    hyselam::Rng rng(seed, i);
    frame.picture = takePicture(params.camera, scene, params.light, people, frame.base,
                                frame.stamp - params.start_time, rng);
    take(frame);
  }
}

}  // namespace hyselam_sim
