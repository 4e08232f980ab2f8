// All that can be set about SLAM, with values that serve from a small office to long corridors.
#pragma once

#include "hyselam_scan_matching/icp.hpp"
#include "hyselam_scan_matching/surface_points.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/words/observation_sensor.hpp"

namespace ngram_slam {

/// What odometry is worth: deviations of a motion of `d` metres that turns by `a` radians.
struct OdometryNoise {
  double base = 0.01;            ///< of the position, of every motion [m], > 0
  double per_metre = 0.1;        ///< [m/m], >= 0
  double per_turn = 0.05;        ///< [m/rad], >= 0
  double turn_base = 0.01;       ///< of the heading, of every motion [rad], > 0
  double turn_per_turn = 0.1;    ///< [rad/rad], >= 0
  double turn_per_metre = 0.05;  ///< [rad/m], >= 0

  /// Inverse covariance of (x, y, theta) of the motion.
  Eigen::Matrix3d information(const hyselam::Pose2& motion) const;
};

/// Which places are taken to be places seen before.
enum class SlamLoops {
  kNone,
  kProximity,  ///< where the poses say so, verified by the scans
  kNgrams,     ///< near ones as kProximity; far ones where words say so, verified by the scans
  kAll,        ///< both
  kThesis      ///< where words say so, not verified: the same pose, with fixed information (5.2.4)
};
/// "none", "proximity", "ngrams", "all", "thesis".
const char* nameOf(SlamLoops loops);

/// When two stretches of the way are one and the same place.
struct LoopParams {
  // Near: the graph knows the relative pose well; one scan against a stretch of the old way.
  double near_window = 1.5;   ///< up to this uncertainty a place is near [m], > 0
  double near_turn = 0.3;     ///< headings searched [rad], 0..pi
  double near_score = 0.55;   ///< least score of the search, 0..1
  double near_matched = 0.5;  ///< least part of the scan on known surfaces, 0..1
  double near_fit = 0.85;     ///< as far_fit
  /// Least part of the new points on surfaces or in space seen free by the old stretch, 0..1.
  double least_known = 0.5;
  double near_stretch = 5.0;  ///< of old way each side [m], > 0
  int every = 3;              ///< keyframes between searches, >= 1
  int most = 2;               ///< places tried in a search, >= 1

  // Far: a stretch of the new way against a longer one of the old.
  double far_every = 1.5;       ///< way between searches [m], > 0
  int far_most = 2;             ///< places tried in a search, >= 1
  double far_stretch = 10.0;    ///< of old way each side [m], > 0
  double far_half = 4.0;        ///< of new way each side [m], > 0
  double far_resolution = 0.1;  ///< of the search and of SeenSpace [m], 0.02..1
  double far_score = 0.5;       ///< least score of the search, 0..1
  double far_matched = 0.35;    ///< least part of the points on known surfaces, 0..1
  double far_fit =
      0.8;  ///< least part of what the other knows that lies on surfaces, both ways, 0..1
  double word_window = 4.0;  ///< how far words may be off [m], > 0
  double word_turn = 0.6;    ///< [rad], 0..pi
  /// Another pose of the window, this far away, may reach this part of the score at most.
  double rival_apart = 1.0;  ///< [m], > 0
  double rival_share = 0.9;  ///< 0..1; 1: not asked

  // How uncertain the pose of an older place is, seen from here along the shortest way in the
  // graph.
  double least_way = 15.0;   ///< nearer along the graph there is nothing to be learnt [m], > 0
  double uncertainty = 0.4;  ///< [m], > 0
  double uncertainty_growth = 0.03;  ///< [m/m], >= 0
  /// A heading that drifts as it may bends the way.
  double uncertainty_bend = 0.0005;  ///< [m/m^2], >= 0
  double most_uncertainty = 15.0;    ///< windows are no larger [m], > 0
  double turn_growth = 0.003;        ///< of the heading [rad/m], >= 0

  // Far loops are believed in company only.
  int company = 2;            ///< far loops that agree with each other, >= 1
  double company_way = 40.0;  ///< that lie this close along the way [m], > 0
  /// The new ways of company must be this far apart: what is seen from one spot is one opinion.
  double company_span = 1.5;       ///< [m], >= 0
  double agreement = 0.25;         ///< and contradict each other by no more than this [m], > 0
  double agreement_growth = 0.02;  ///< and this part of the way between them, >= 0
  double agreement_turn = 0.06;    ///< in heading [rad], > 0

  /// [m] for a place at the end of `way` [m].
  double reach(double way) const {
    return uncertainty + (uncertainty_growth + uncertainty_bend * way) * way;
  }

  double thesis_deviation = 0.5;       ///< of kThesis' edges [m], > 0
  double thesis_turn_deviation = 0.2;  ///< [rad], > 0
};

struct SlamParams {
  SlamParams();
  /// As the thesis has it: its own words, which have to be sure, and loops of kThesis.
  static SlamParams thesis(int levels = 3);

  hyselam_scan_matching::SurfacePointParams surface;
  hyselam_scan_matching::IcpParams refine;
  OdometryNoise odometry;
  bool refine_odometry = true;  ///< scans against what was seen last; else odometry as it is
  double scan_step =
      0.05;  ///< scans nearer to the last one matched are placed by odometry [m], >= 0
  double scan_turn = 0.03;      ///< [rad], >= 0
  double longest_step = 5.0;    ///< between two scans; more is a leap of the odometry [m], > 0
  double keyframe_step = 0.25;  ///< between keyframes [m], > 0
  double keyframe_turn = 0.2;   ///< [rad], > 0
  int local_keyframes = 40;     ///< that make the local map, >= 1
  double local_cell = 0.03;     ///< of the local map [m], > 0
  /// Below this part of a scan on known surfaces, 0..1, the neighbourhood is searched.
  double lost = 0.5;
  /// Points of a scan are not independent: the part of a match's information that is believed,
  /// (0, 1].
  double scan_information = 0.1;

  SlamLoops loops = SlamLoops::kAll;
  LoopParams loop;
  ObservationSensorParams observations;
  NgramRecognizerParams words;

  int optimise_every = 20;  ///< keyframes between optimisations when there are new loops, >= 1
  double dcs_phi = 20.0;    ///< squared error from which loops lose weight, > 0

  /// @throws hyselam::ParameterError
  void validate() const;
};

}  // namespace ngram_slam
