// A particle filter over the poses that the training frames were taken at, moved by odometry.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_common/rng.hpp"
#include "selovis/classifiers/samples.hpp"
#include "selovis/filters/learned_views.hpp"
#include "selovis/filters/place_filter.hpp"

namespace selovis {

struct PoseFilterParams {
  int particles = 1000;  ///< 10 to 100000
  /// A training view at the squared distance d^2 of signatures has the similarity
  /// exp(-similarity_beta (d^2 - d_min^2) / d_min^2), d_min being that of the most similar one; 0
  /// to 1000.
  double similarity_beta = 1.5;
  /// Exponent of the likelihood of one second of frames, below 1 because consecutive frames are not
  /// independent; 0.001 to 10.
  double likelihood_exponent = 0.5;
  /// Position radius of the kernel regression: training images nearer to a particle than this
  /// predict its view [m], 0.05 to 20.
  double kernel_radius = 2.0;
  /// Heading radius of the kernel regression: training views that differ in heading from a particle
  /// by less than this predict its view [rad], 0.02 to pi.
  double kernel_angle = hyselam::radians(18.0);
  /// Weight of the mean similarity of all views, in training frames at the particle's own pose;
  /// 1e-6 to 1e6. A direction that was never learned is not ruled out.
  double prior_weight = 3.0;
  /// Share of the particles that are redrawn near similar views each second, 0 to 1.
  double injection_rate = 0.02;
  double max_speed = 0.42;     ///< of the robot without odometry [m/s], 0 to 10
  double max_turn_rate = 1.0;  ///< of the robot without odometry [rad/s], 0 to 10
  std::uint64_t seed = 1;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

/// Particle filter over the camera pose; unlike a filter over places, it uses the path. Particles
/// move with the odometry (without it, with random motions within the robot's speed limits), and
/// are weighted by the similarity of the frame to the training views around them (kernel
/// regression). Odometry bridges poses from which nothing was learned. The probability of a place
/// is the weight of the particles whose nearest training frame belongs to it.
class PoseFilter {
 public:
  /// Samples without a pose are not used.
  /// @throws hyselam::InputError where no sample has a pose, or they lie more than 5 km apart;
  ///   hyselam::ParameterError.
  PoseFilter(const Samples& samples, int places, const PoseFilterParams& params);

  /// @param distances squared distance of the frame's signature to that of each sample.
  /// @param camera its pose by odometry, in any fixed frame; none, or not finite: not known. A step
  ///   that is longer than a robot can drive counts as not known.
  /// @param seconds since the frame before; negative values count as 0.
  /// @throws hyselam::InputError for another number of distances.
  void update(const std::vector<float>& distances, const std::optional<hyselam::Pose2>& camera,
              double seconds = 1.0);
  /// Back to the uniform distribution.
  void reset();

  /// Why these samples cannot be filtered by their poses; empty if they can.
  static std::string whyNot(const Samples& samples) { return LearnedViews::whyNot(samples); }

  /// Of each place, of sum 1.
  const std::vector<double>& probabilities() const { return state_; }

 private:
  struct Likelihood {
    double value;
    int place;  // of the nearest training pose; -1: none within the radius
  };

  /// A pose near a view drawn by similarity.
  hyselam::Pose2 drawPose(double total);
  void move(const std::optional<hyselam::Pose2>& odometry, double seconds);
  void injectParticles(double total, double seconds);
  /// The kernel regression at a pose; `mean` similarity of all views.
  Likelihood likelihood(const hyselam::Pose2& pose, double mean) const;
  void resample(double total_weight);

  PoseFilterParams params_;
  LearnedViews views_;
  hyselam::Rng rng_;
  bool first_ = true;
  double injections_due_ = 0.0;
  std::optional<hyselam::Pose2> odometry_;
  std::vector<hyselam::Pose2> particles_, next_;
  std::vector<double> weights_, state_;
};

}  // namespace selovis
