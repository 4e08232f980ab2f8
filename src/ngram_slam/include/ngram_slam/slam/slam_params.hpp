// All that can be set about SLAM, with values that serve from a small office to long corridors.
#pragma once

#include <string>

#include "hyselam_common/parameters.hpp"
#include "hyselam_scan_matching/icp.hpp"
#include "hyselam_scan_matching/surface_points.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/words/observation_sensor.hpp"

namespace ngram_slam {

/// How exact odometry is: standard deviations of a motion of `d` meters that turns by `a` radians.
struct OdometryNoise {
  double position_base = 0.01;        ///< of the position, of every motion [m], > 0
  double position_per_meter = 0.1;    ///< [m/m], >= 0
  double position_per_radian = 0.05;  ///< [m/rad], >= 0
  double heading_base = 0.01;         ///< of the heading, of every motion [rad], > 0
  double heading_per_radian = 0.1;    ///< [rad/rad], >= 0
  double heading_per_meter = 0.05;    ///< [rad/m], >= 0

  void describe(hyselam::ParameterVisitor& visit);
  /// Inverse covariance of (x, y, theta) of the motion.
  Eigen::Matrix3d information(const hyselam::Pose2& motion) const;
};

/// Which places are taken to be places seen before.
enum class LoopClosureMode {
  kNone,
  kProximity,  ///< where the poses say so, verified by the scans
  kNgrams,     ///< near ones as kProximity; far ones where words say so, verified by the scans
  kAll,        ///< both
  kThesis      ///< where words say so, not verified: the same pose, with fixed information (5.2.4)
};
/// "none", "proximity", "ngrams", "all", "thesis".
const char* toString(LoopClosureMode mode);
/// @throws hyselam::ParameterError `loops` for any other text.
LoopClosureMode loopClosureModeFromString(const std::string& text);

/// A scan of which too little lies on the local map is searched in a window around its pose.
struct RelocalizationParams {
  int min_points = 30;     ///< a scan of fewer surface points is not searched, >= 0
  double window = 0.6;     ///< positions this far from the pose, each axis [m], > 0
  double angle = 0.35;     ///< headings this far from it [rad], 0..pi
  double min_score = 0.4;  ///< of the search, 0..1
  double min_gain = 0.1;   ///< in inlier ratio, for the pose found to be taken, 0..1
  /// Odometry's information counts this much in the refinement of the pose found, 0..1.
  double odometry_information_scale = 0.05;

  void describe(hyselam::ParameterVisitor& visit);
};

/// The first scan of a run in a known map is searched around the pose where the run begins.
struct RunStartParams {
  double map_radius = 10.0;  ///< keyframes this far beyond the window make the map [m], >= 0
  double min_score = 0.4;    ///< of the search, 0..1
  /// Of the edge that ties the run to the nearest old keyframe, before what the scan match adds.
  double position_information = 1.0;  ///< [1/m^2], > 0
  double heading_information = 10.0;  ///< [1/rad^2], > 0
  /// Old keyframes this near join the local map until the run has enough of its own [m], >= 0.
  double local_map_radius = 3.0;

  void describe(hyselam::ParameterVisitor& visit);
};

/// When two segments of the path are one and the same place.
///
/// A near loop: the graph knows the relative pose to `near_max_uncertainty`; one scan is matched
/// with a segment of the old path around the place. A far loop: the pose is known worse, or by
/// words only; a segment of the new path is searched in a longer one of the old.
struct LoopParams {
  double near_max_uncertainty = 1.5;      ///< of the position, for a near loop [m], > 0
  double near_search_angle = 0.3;         ///< headings searched [rad], 0..pi
  double near_min_score = 0.55;           ///< of the search, 0..1
  double near_min_inlier_ratio = 0.5;     ///< part of the scan on known surfaces, 0..1
  double near_min_surface_ratio = 0.85;   ///< as far_min_surface_ratio
  double near_segment_half_length = 5.0;  ///< of the old path, each side [m], > 0
  double near_resolution = 0.06;          ///< of the search [m], > 0
  double near_inlier_distance = 0.2;      ///< a point scores up to here from a surface [m], > 0
  int near_max_points = 80;               ///< of the scan, in the search, >= 1
  int near_search_interval = 3;           ///< keyframes between searches, >= 1
  int near_max_candidates = 2;            ///< places tried in a search, >= 1

  double far_search_interval = 1.5;           ///< path between searches [m], > 0
  int far_max_candidates = 2;                 ///< places tried in a search, >= 1
  double far_old_segment_half_length = 10.0;  ///< of the old path, each side [m], > 0
  double far_new_segment_half_length = 4.0;   ///< of the new path, each side [m], > 0
  double far_resolution = 0.1;                ///< of the search and of ObservedSpace [m], 0.02..1
  double far_min_score = 0.5;                 ///< of the search, 0..1
  double far_min_inlier_ratio = 0.35;         ///< part of the points on known surfaces, 0..1
  /// Part of the points in space that the other segment observed that lie on its surfaces, not in
  /// its free space; both ways, 0..1.
  double far_min_surface_ratio = 0.8;
  int far_max_points = 250;           ///< in the search, >= 1
  int far_max_refined_points = 1000;  ///< in the refinement of what was found, >= 1

  /// Part of the new points on surfaces or in free space of the old segment, 0..1.
  double min_overlap = 0.5;
  double observed_space_side = 100.0;  ///< of the square of ObservedSpace [m], 1..150
  /// Ambiguous is a far loop if a pose this far from the best one [m], > 0 ...
  double ambiguity_distance = 1.0;
  double max_ambiguity_ratio = 0.9;  ///< ... has this part of its score, 0..1; 1: not checked

  // Matches of words.
  double word_search_window = 4.0;      ///< words may be off by this much [m], > 0
  double word_search_angle = 0.6;       ///< [rad], 0..pi
  double word_candidate_spacing = 5.0;  ///< of old path: matches closer than this are one [m], >= 0
  int word_max_candidates = 4;          ///< far loops tried for one new word, >= 1

  // Where to look: how uncertain the pose of an older keyframe is, seen from here along the
  // shortest path in the graph.
  double min_path_length = 15.0;      ///< nearer in the graph nothing can be learnt [m], > 0
  double candidate_spacing = 3.0;     ///< of old path between two candidates [m], >= 0
  double visibility_margin = 2.0;     ///< this far beside a path its surfaces are seen [m], >= 0
  double segment_separation = 10.0;   ///< of path between old and new segment of a run [m], >= 0
  double position_uncertainty = 0.4;  ///< [m], > 0
  double position_uncertainty_per_meter = 0.03;  ///< [m/m], >= 0
  /// A heading that drifts bends the path.
  double position_uncertainty_per_square_meter = 0.0005;  ///< [m/m^2], >= 0
  double max_position_uncertainty = 15.0;                 ///< windows are no larger [m], > 0
  double heading_uncertainty = 0.1;                       ///< [rad], >= 0
  double heading_uncertainty_per_meter = 0.003;           ///< [rad/m], >= 0
  double loop_path_length = 0.5;  ///< of a loop edge on the way through the graph [m], >= 0

  // Far loops are accepted in groups of pairwise consistent ones (as by PCM, Mangelson 2018).
  int min_consistent_loops = 2;                  ///< far loops that are consistent, >= 1
  double consistency_max_path_length = 40.0;     ///< that lie this close along the path [m], > 0
  double consistency_min_span = 1.5;             ///< of their new ends along the path [m], >= 0
  double consistency_distance = 0.25;            ///< and differ by no more than this [m], > 0
  double consistency_distance_per_meter = 0.02;  ///< and this part of the path between them, >= 0
  double consistency_angle = 0.06;               ///< in heading [rad], > 0

  double thesis_position_stddev = 0.5;  ///< of the edges of kThesis [m], > 0
  double thesis_heading_stddev = 0.2;   ///< [rad], > 0

  void describe(hyselam::ParameterVisitor& visit);
  /// Of a keyframe at the end of a path through the graph of `path_length` [m]. [m]
  double positionUncertainty(double path_length) const {
    return position_uncertainty +
           (position_uncertainty_per_meter + position_uncertainty_per_square_meter * path_length) *
               path_length;
  }
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
  double scan_turn = 0.03;         ///< [rad], >= 0
  double max_odometry_step = 5.0;  ///< between two scans; more is an odometry jump [m], > 0
  /// Of the motion across an odometry jump, where the robot is taken to have stood [1/m^2,
  /// 1/rad^2].
  double jump_information = 0.1;       ///< > 0
  double keyframe_step = 0.25;         ///< between keyframes [m], > 0
  double keyframe_turn = 0.2;          ///< [rad], > 0
  int local_map_keyframes = 40;        ///< that make the local map, >= 1
  double local_map_resolution = 0.03;  ///< [m], > 0
  /// Below this part of a scan on known surfaces, 0..1, its pose is searched (relocalization).
  double min_inlier_ratio = 0.5;
  /// Below this part of min_inlier_ratio, after the search, a match is counted as weak, 0..1.
  double weak_match_factor = 0.8;
  /// Points of a scan are not independent: the part of a match's information that counts, (0, 1].
  double scan_information_scale = 0.1;
  /// The part of odometry's information that counts in an edge beside a scan match, 0..1.
  double odometry_information_scale = 0.5;

  RelocalizationParams relocalization;
  RunStartParams run_start;
  LoopClosureMode loops = LoopClosureMode::kAll;
  LoopParams loop;
  ObservationSensorParams observations;
  NgramRecognizerParams words;

  int optimize_interval = 20;  ///< keyframes between optimizations when there are new loops, >= 1
  double dcs_phi = 20.0;       ///< squared error from which loops lose weight, > 0

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

}  // namespace ngram_slam
