// Is the robot where its pose says? The frame's look and the scan's fit at the pose, against those
// at the best poses elsewhere, followed along the robot's own motion.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "selovis/filters/learned_views.hpp"
#include "selovis/recognition/reliability_memory.hpp"
#include "selovis/recognition/scan_fit.hpp"

namespace selovis {

struct ViewTestParams {
  /// Wanted time between two false alarms [h], 0.01 to 1e5. The threshold follows from it.
  double false_alarm_hours = 24.0;
  /// Looks that are nearer in time than this are one look [s], 0.01 to 10.
  double correlation_time = 0.4;
  /// Looks count as those of a right pose once the pose was kept so much longer [s], 1 to 600.
  double proven_after = 10.0;
  /// Whether it is remembered where the camera errs.
  bool remember = true;

  void describe(hyselam::ParameterVisitor& visit);
};

/// One frame of the camera, with what else is known of its moment.
struct ViewTestFrame {
  /// Squared distances of the frame's signature to those of the samples (Classifier::distances).
  const std::vector<float>* distances = nullptr;
  double seconds = 0.0;                ///< since the frame before; negative: 0
  std::optional<hyselam::Pose2> base;  ///< the pose that is tested, in the map
  hyselam::Pose2 camera_in_base;
  /// The base by odometry, in any fixed frame: how rivals move. Without, they move as the pose.
  std::optional<hyselam::Pose2> odometry;
  const ScanPoints* scan = nullptr;  ///< of about the same time; null: none
};

/// Another explanation: the robot is there, and has been since the evidence for it began.
struct RivalPose {
  hyselam::Pose2 base;     ///< in the map
  int place = -1;          ///< of the nearest learned frame; -1: none near
  double evidence = 0.0;   ///< [nats] for it, against the pose
  double log_ratio = 0.0;  ///< of the last look
  bool by_scan = false;    ///< the scan was aligned with the map there
};

struct ViewTestState {
  bool tested = false;    ///< false: no pose
  double coverage = 0.0;  ///< how much was learned of the view at the pose, 0 to 1; 0: no evidence
  double evidence = 0.0;  ///< [nats] against the pose, 0 to a little above the threshold
  /// Evidence of this frame for the leading rival, times the share of a look that it is. [nats]
  double increment = 0.0;
  /// The leading rival, if it leads by kRivalLead.
  std::optional<RivalPose> rival;
};

/// A sequential test (CUSUM, Page 1954) with several rivals at a time. A rival begins at a learned
/// view that looks like the frame, moves with the robot, and gathers the log-likelihood ratio of
/// what is seen and scanned there against the pose; at 0 it is dropped. So frames that err do not
/// add up unless they err for one pose that moves as the robot does.
///
/// Evidence is gathered in time: a look is worth min(1, seconds / correlation_time) of its ratio,
/// so that the rate of the camera does not matter.
class ViewTest {
 public:
  static constexpr double kRivalLead = 2.0;      ///< [nats] over the next one
  static constexpr double kElsewhere = 3.0;      ///< [m] a rival begins so far off, or ...
  static constexpr double kElsewhereTurn = 1.0;  ///< [rad] ... turned by so much

  /// @throws hyselam::InputError (LearnedViews).
  /// @param memory where the camera was found to err with these samples.
  ViewTest(const Samples& samples, const ViewTestParams& params, ReliabilityMemory memory = {});

  /// From now on scans are compared with this map; null: they are not.
  void setMap(std::shared_ptr<const ScanFit> map) { fit_ = std::move(map); }
  ViewTestState update(const ViewTestFrame& frame);
  /// The pose was set: all evidence is forgotten, what the camera was found to err in is not.
  void reset();
  /// The pose has been rejected: what was seen from it lately is not counted as seen from a right
  /// pose, unless the robot turns out to have been there.
  void reject();

  /// [nats] at which a pose is to be rejected.
  double threshold() const { return threshold_; }
  /// The threshold at which right poses are rejected once in so many hours.
  static double thresholdFor(double hours, double correlation_time);
  const ReliabilityMemory& memory() const { return memory_; }

 private:
  struct Look {
    double at;  // [s] on clock_
    hyselam::Pose2 pose;
    std::vector<int> places;  // that it spoke for
    double looks;
  };
  struct Rejected {
    std::deque<Look> looks;
    std::optional<hyselam::Pose2> odom_in_map;
  };

  double likelihoodAt(const hyselam::Pose2& camera, LearnedViews::Regression* seen) const;
  void moveRivals(const ViewTestFrame& frame);
  void addRivals(const ViewTestFrame& frame, const hyselam::Pose2& camera);
  /// Adds what the frame, worth so many looks, says of the rivals; `state` gets what it says of the
  /// leading one. @returns the places that the camera spoke for.
  std::vector<int> weighRivals(const ViewTestFrame& frame, double looks, double at_pose,
                               ViewTestState& state);
  /// Those without evidence, those that have met the pose or a better one, the last of too many.
  void dropRivals(const hyselam::Pose2& base);
  bool isElsewhere(const hyselam::Pose2& a, const hyselam::Pose2& b) const;
  void remember(const ViewTestFrame& frame, double looks, const std::vector<int>& places);

  ViewTestParams params_;
  double threshold_;
  LearnedViews views_;
  std::shared_ptr<const ScanFit> fit_;
  ReliabilityMemory memory_;
  std::vector<RivalPose> rivals_;
  std::vector<std::uint32_t> order_;
  std::optional<hyselam::Pose2> last_base_, last_odometry_;
  double mean_ = 0.0;   // similarity of all views to the last frame
  double clock_ = 0.0;  // [s]
  std::deque<Look> pending_;
  std::optional<Rejected> rejected_;
};

}  // namespace selovis
