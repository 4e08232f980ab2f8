// A filter over the poses that the training frames were taken at, moved by odometry.
#pragma once

#include <optional>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "hyselam_common/rng.hpp"
#include "selovis/place_filter.hpp"
#include "selovis/samples.hpp"

namespace selovis {

struct PoseFilterParams {
  int particles = 1000;  ///< 10 to 100000
  double beta = 1.5;     ///< how fast likeness falls with (d^2 - d_min^2) / d_min^2, 0 to 1000
  double trust = 0.5;    ///< exponent of the likelihood of one second of frames, 0.001 to 10
  double reach = 2.0;    ///< [m] a frame may look like those learnt so near, 0.05 to 20
  double turn = hyselam::radians(18.0);  ///< [rad] and turned by less than this, 0.02 to pi
  double doubt = 3.0;  ///< how many frames' weight has the likeness of no pose in particular, > 0
  double jump = 0.02;  ///< share of particles set to poses that look alike, a second, 0 to 1
  double max_speed = 0.42;  ///< [m/s] without odometry, 0 to 10
  double max_turn = 1.0;    ///< [rad/s] without odometry, 0 to 10
  std::uint64_t seed = 1;
};

/// Throws hyselam::ParameterError.
void validate(const PoseFilterParams& params);

/// Where a filter over places forgets how the robot has come, this one remembers it: particles of
/// the camera's pose move with the odometry (or as fast as the robot may, without it), and are
/// weighed by how much the frame looks like those that were learnt near them. A direction that was
/// never looked in, at a spot that was visited, says nothing, and the odometry bridges it. The
/// probability of a place is the weight of the particles nearest to where it was learnt.
class PoseFilter {
 public:
  /// Samples without a pose are passed over; throws std::invalid_argument where none has one, or
  /// they lie more than 5 km apart.
  PoseFilter(const Samples& samples, int places, const PoseFilterParams& params);

  /// @param distances squared distance of the frame's signature to that of each sample.
  /// @param camera its pose by odometry, in any frame; none, or no finite numbers: not known.
  ///   Where it has jumped, farther than any robot drives, the step counts as not known.
  /// @param seconds since the frame before; below 0: none.
  void update(const std::vector<float>& distances, const std::optional<hyselam::Pose2>& camera,
              double seconds = 1.0);
  /// Back to knowing nothing.
  void reset();

  const std::vector<double>& probabilities() const { return state_; }

 private:
  struct Spot {  ///< a training frame with its views
    hyselam::Point2 at;
    int place;
    std::uint32_t begin, end;  // of views_
  };
  struct View {
    double heading;
    std::uint32_t sample;
  };
  hyselam::Pose2 drawn(double total);
  void move(const std::optional<hyselam::Pose2>& odometry, double seconds);
  double likelihood(const hyselam::Pose2& pose, double unseen, int* place) const;

  PoseFilterParams params_;
  std::vector<Spot> spots_;
  std::vector<View> views_;
  hyselam::Point2 origin_;
  double cell_ = 1.0;  // [m], at least the reach
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> bucket_begin_;  // spots_ are sorted by bucket, of `reach` metres each
  hyselam::Rng rng_;
  bool fresh_ = true;
  double jumps_due_ = 0.0;
  std::optional<hyselam::Pose2> odometry_;
  std::vector<hyselam::Pose2> particles_, next_;
  std::vector<double> weights_, likeness_, state_;
};

}  // namespace selovis
