// Parameters of SLAM, with defaults suitable for small offices to long corridors.
//
// Terms (Maffei 2017, chapters 4 and 5): an observation is the free-space density (the share of the
// cells around the robot that are free and connected with it) at a pose, taken every 0.1 m of path.
// A word is a segment of the path with one density class: class, size and change of direction
// (angle). Levels are alternative segmentations into words that skip short interruptions. An n-gram
// match is a sequence of words that also occurs earlier in the path.
#pragma once

#include <string>

#include "hyselam_common/parameters.hpp"
#include "hyselam_scan_matching/icp.hpp"
#include "hyselam_scan_matching/surface_points.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/slam/consolidation.hpp"
#include "ngram_slam/slam/odometry_doubt.hpp"
#include "ngram_slam/slam/odometry_noise.hpp"
#include "ngram_slam/slam/signature_places.hpp"
#include "ngram_slam/words/observation_sensor.hpp"

namespace ngram_slam {

/// Which loop closure candidates are used.
enum class LoopClosureMode {
  kNone,
  kProximity,   ///< candidates from the pose estimate, verified by the scans
  kNgrams,      ///< near candidates as kProximity, far ones from n-gram matches; verified
  kSignatures,  ///< near candidates as kProximity, far ones from signatures of places; verified
  kAll,         ///< far candidates from proximity, n-grams and signatures; verified
  /// Candidates from n-gram matches, not verified: relative pose set to identity (turned by pi for
  /// reverse matches), with fixed information (5.2.4).
  kThesis
};
/// "none", "proximity", "ngrams", "signatures", "all", "thesis".
const char* toString(LoopClosureMode mode);
/// @throws hyselam::ParameterError `loops` for any other text.
LoopClosureMode loopClosureModeFromString(const std::string& text);

/// A scan is searched around its pose if too few of its points lie on the local map, or if odometry
/// may have put them farther from their surfaces than IcpParams::initial_distance.
///
/// Score of a search, here and below: mean over the points of the scan of a value that falls from 1
/// on a known surface to 0 at CorrelativeMatcherParams::max_distance from it.
struct RelocalizationParams {
  int min_points = 30;     ///< only scans with more surface points are relocalized, >= 0
  double window = 0.6;     ///< of positions: +- this along each axis [m], > 0
  double angle = 0.35;     ///< of headings: +- this [rad], 0..pi
  double min_score = 0.4;  ///< minimum score of the search, 0..1
  double min_gain = 0.1;   ///< minimum gain in inlier ratio to accept the pose found, 0..1
  /// Odometry's information is weighted by this factor when the pose found is refined, 0..1.
  double odometry_information_scale = 0.05;
  /// Odometry counts with errors of this many standard deviations, >= 0; 0: searched only if too
  /// few points fit.
  double max_deviations = 3.0;
  /// Then this many standard deviations are searched, > 0, instead of `window` and `angle` ...
  double window_deviations = 4.0;
  double uncertain_resolution = 0.1;  ///< ... with cells of this size [m], 0.01..1

  void describe(hyselam::ParameterVisitor& visit);
};

/// A step between two keyframes whose scan had to be searched, as odometry left too much open, is
/// asked again when more is known: the scans of the path behind it are laid on those before it.
/// One scan may fit beside its place; a stretch of path hardly does.
struct StepCheckParams {
  double path_before = 8.0;   ///< path before the step [m], > 0
  double path_behind = 5.0;   ///< path behind it [m], >= 0; 0: no step is asked again
  double window = 0.8;        ///< search window around the step, +- along each axis [m], > 0
  double angle = 0.45;        ///< search window of headings, +- [rad], 0..pi
  double min_score = 0.15;    ///< minimum score of the search, and fraction of inliers, 0..1
  double min_overlap = 0.2;   ///< minimum fraction of the points in space that the other part saw
  double min_deviations = 3;  ///< of the scans, from what they say to what was believed, >= 0

  void describe(hyselam::ParameterVisitor& visit);
};

/// Where a run begins in a known map.
///
/// A pose that is known (RunTrust::kKnown: the robot was switched to another mode meanwhile) is
/// refined by a search of the first scan and tied to the map at once. One that is supposed may be
/// wrong by metres or by half a turn, or be in another building: the run is a map of its own until
/// far loops tie it to the known one: three that agree (LoopParams::min_tie_loops), or two of which
/// one is at a place of the drawn maps that no other one rivals.
struct RunStartParams {
  double map_radius =
      10.0;  ///< beyond the window of SlamEngine::startRun(), of keyframes used [m], >= 0
  double min_score = 0.4;  ///< minimum score of the search, 0..1
  /// Information of the edge that connects the run to the nearest old keyframe; the information of
  /// the scan match is added.
  double position_information = 1.0;  ///< [1/m^2], > 0
  double heading_information = 10.0;  ///< [1/rad^2], > 0
  /// Old keyframes within this distance are added to the local map until the run has
  /// local_map_keyframes of its own [m], >= 0.
  double local_map_radius = 3.0;

  // A supposed start.
  double search_interval = 1.0;     ///< path between searches around the supposed pose [m], > 0
  double search_radius = 5.0;       ///< of what is searched around it, at any heading [m], > 0
  double whole_map_interval = 5.0;  ///< path between searches of the whole map [m], > 0
  double place_spacing = 4.0;       ///< between places that are searched [m], > 0
  /// Path between searches of the drawn maps for the last metres of the run [m], >= 0; 0: they are
  /// not searched.
  double place_interval = 1.0;
  /// The scans are asked at a place found so if it is right with more than this probability beside
  /// all others, 0..1 (of two that are alike each has 0.5) ...
  double min_place_probability = 0.5;
  /// ... and a verified loop there ties the run if it has this one, 0..1, ...
  double sure_place_probability = 0.9;
  /// ... together with what the scans say this one, 0..1, ...
  double min_tie_probability = 0.995;
  /// ... and if another loop so much path beside it says the same [m], >= 0: one found otherwise,
  /// or at another place as sure as the first.
  double place_min_span = 1.0;
  /// A run that is not tied after this much path is shown as a map of its own; one that is tied
  /// listens to loops that contradict its ties for as long [m], >= 0.
  double own_map_path = 60.0;

  void describe(hyselam::ParameterVisitor& visit);
};

/// When a loop closure between two path segments is accepted.
///
/// Near loop: the relative position uncertainty is at most `near_max_uncertainty`; one scan is
/// matched with a segment of the old path. Far loop: the uncertainty is larger; a segment of
/// the new path is matched with a longer one of the old path. Candidates of both kinds come from
/// proximity or n-gram matches.
///
/// One struct for all its parameters, because candidates, search, verification and consistency of
/// both kinds share them; they stand in these groups.
struct LoopParams {
  double near_max_uncertainty = 1.5;      ///< of the position, for a near loop [m], > 0
  double near_search_angle = 0.3;         ///< search window of headings, +- [rad], 0..pi
  double near_min_score = 0.55;           ///< minimum score of the search, 0..1
  double near_min_inlier_ratio = 0.5;     ///< fraction of the scan's points on known surfaces, 0..1
  double near_min_surface_ratio = 0.85;   ///< as far_min_surface_ratio
  double near_segment_half_length = 5.0;  ///< old path before and after the candidate [m], > 0
  double near_resolution = 0.06;          ///< cell size of the search [m], > 0
  double near_inlier_distance = 0.2;  ///< points score up to this distance from a surface [m], > 0
  int near_max_points = 80;           ///< points of the scan used in the search, >= 1
  int near_search_interval = 3;       ///< keyframes between searches, >= 1
  int near_max_candidates = 2;        ///< candidates tried per search, >= 1

  double far_search_interval = 1.5;           ///< path between searches [m], > 0
  int far_max_candidates = 2;                 ///< candidates tried per search, >= 1
  double far_old_segment_half_length = 10.0;  ///< old path before and after the candidate [m], > 0
  double far_new_segment_half_length = 4.0;   ///< new path before and after the keyframe [m], > 0
  double far_resolution = 0.1;  ///< cell size of the search and of ObservedSpace [m], 0.02..1
  double far_min_score = 0.5;   ///< minimum score of the search, 0..1
  double far_min_inlier_ratio = 0.35;  ///< fraction of the points on known surfaces, 0..1
  /// Of the points in space observed by the other segment, the fraction on its surfaces instead of
  /// in its free space; required in both directions, 0..1.
  double far_min_surface_ratio = 0.85;
  int far_max_points = 250;           ///< points used in the search, up to twice as many, >= 1
  int far_max_refined_points = 1000;  ///< used to refine the pose found, up to twice as many, >= 1

  /// Minimum fraction of the new points on surfaces or in free space of the old segment, 0..1.
  double min_overlap = 0.5;
  /// Side of the square around a keyframe in which observed space is compared [m], 1..150.
  double observed_space_side = 100.0;
  /// A far loop is ambiguous if a pose farther than this from the best one [m], > 0, ...
  double ambiguity_distance = 1.0;
  /// ... reaches this fraction of the best score, 0..1; 1: not checked.
  double max_ambiguity_ratio = 0.9;

  // Candidates from n-gram matches.
  double word_search_window = 4.0;  ///< search window around a pose from an n-gram match [m], > 0
  double word_search_angle = 0.6;   ///< search window of headings around it, +- [rad], 0..pi
  /// Matches of a new word that are closer than this along the old path are tried once [m], >= 0.
  double word_candidate_spacing = 5.0;
  int word_max_candidates = 4;  ///< far loops tried for one new word, >= 1

  // Candidates from signatures of places, at any heading.
  double signature_search_window = 3.0;  ///< search window around the older place [m], > 0
  double signature_search_angle = 0.4;   ///< of headings around the likeliest ones, +- [rad], 0..pi

  // Candidate selection: uncertainty of an older keyframe relative to the current one, by the
  // length of the shortest path through the graph.
  double min_path_length = 15.0;   ///< keyframes closer along the path are no candidates [m], > 0
  double candidate_spacing = 3.0;  ///< old path that separates two candidates [m], >= 0
  /// Added to the position uncertainty: surfaces are visible from this far beside a path [m], >= 0.
  double visibility_margin = 2.0;
  double segment_separation = 10.0;   ///< path between old and new segment of a run [m], >= 0
  double position_uncertainty = 0.4;  ///< constant term [m], > 0
  double position_uncertainty_per_meter = 0.03;  ///< linear term [m/m], >= 0
  /// Quadratic term from heading drift.
  double position_uncertainty_per_square_meter = 0.0005;  ///< [m/m^2], >= 0
  double max_position_uncertainty = 15.0;        ///< upper bound of the search window [m], > 0
  double heading_uncertainty = 0.1;              ///< constant term [rad], >= 0
  double heading_uncertainty_per_meter = 0.003;  ///< linear term [rad/m], >= 0
  double loop_path_length = 0.5;  ///< length assigned to a loop edge in path lengths [m], >= 0

  // Far loops are accepted in groups of pairwise consistent ones (as by PCM, Mangelson 2018).
  int min_consistent_loops = 2;  ///< minimum size of a group, >= 1
  /// The same of a group in which none comes from words: buildings repeat themselves, and both
  /// signatures and searches of wide windows find their copies.
  int min_consistent_signature_loops = 3;
  /// Far loops that tie a run to another map: nothing else is known of where it lies there. All of
  /// them have to be as probable as those by signatures.
  int min_tie_loops = 3;
  double tie_min_span = 2.0;  ///< minimum path covered by their newer keyframes [m], >= 0
  double consistency_max_path_length = 40.0;  ///< maximum path between two of its loops [m], > 0
  double consistency_min_span = 1.5;   ///< minimum path covered by its newer keyframes [m], >= 0
  double consistency_distance = 0.25;  ///< maximum position error between two loops [m], > 0
  double consistency_distance_per_meter = 0.02;  ///< added per meter of path between them, >= 0
  double consistency_angle = 0.06;  ///< maximum heading error between two loops [rad], > 0

  /// Far loops from this much path, before and after, that contradict a far loop must weigh less
  /// than this part of those that do not, [m] and > 0; 0 m: they are not asked.
  double company_half_length = 10.0;
  double max_contradiction = 0.33;
  /// A far loop by signatures that is less probable (loopProbability()) waits for more company.
  double min_signature_probability = 0.5;

  double thesis_position_stddev = 0.5;  ///< position, for edges of kThesis [m], > 0
  double thesis_heading_stddev = 0.2;   ///< heading, for edges of kThesis [rad], > 0

  void describe(hyselam::ParameterVisitor& visit);
  /// Position uncertainty [m] after a path through the graph of `path_length` [m].
  double positionUncertainty(double path_length) const {
    return position_uncertainty +
           (position_uncertainty_per_meter + position_uncertainty_per_square_meter * path_length) *
               path_length;
  }
  /// How far two keyframes may lie apart [m] by odometry after `path_length` [m] if they show the
  /// same place.
  double signatureReach(double path_length) const {
    return positionUncertainty(path_length) + visibility_margin + 1.0;
  }
};

struct SlamParams {
  SlamParams();
  /// Configuration of the thesis: its word matching and its loop closures (kThesis). `levels`:
  /// number of levels of words.
  static SlamParams thesis(int levels = 3);

  /// Extraction of surface points: points of a scan with the normal of the surface they lie on.
  hyselam_scan_matching::SurfacePointParams surface;
  hyselam_scan_matching::IcpParams refine;
  OdometryNoise odometry;
  OdometryLearningParams odometry_learning;
  OdometryDoubtParams odometry_doubt;
  bool refine_odometry = true;  ///< match scans to the local map; false: raw odometry
  /// A scan within scan_step and scan_turn of the last matched one takes its pose from odometry,
  /// unless OdometryDoubtParams says otherwise.
  double scan_step = 0.05;         ///< [m], >= 0
  double scan_turn = 0.03;         ///< [rad], >= 0
  double max_odometry_step = 5.0;  ///< larger steps between two scans are odometry jumps [m], > 0
  /// Information of the motion across an odometry jump, where the robot is assumed stationary
  /// [1/m^2, 1/rad^2].
  double jump_information = 0.1;       ///< > 0
  double keyframe_step = 0.25;         ///< distance between keyframes [m], > 0
  double keyframe_turn = 0.2;          ///< turn between keyframes [rad], > 0
  int local_map_keyframes = 40;        ///< latest keyframes in the local map, >= 1
  double local_map_resolution = 0.03;  ///< cell size [m], > 0
  /// A scan with a smaller fraction of points on known surfaces, 0..1, is relocalized by a search.
  double min_inlier_ratio = 0.5;
  /// A match is weak if its inlier ratio is still below this fraction of min_inlier_ratio, 0..1.
  double weak_match_factor = 0.8;
  /// The information of a scan match is weighted by this factor, (0, 1]: points of a scan are not
  /// independent.
  double scan_information_scale = 0.1;
  /// Odometry's information is weighted by this factor in an edge that has a scan match, 0..1.
  double odometry_information_scale = 0.5;

  RelocalizationParams relocalization;
  StepCheckParams step_check;
  RunStartParams run_start;
  LoopClosureMode loops = LoopClosureMode::kAll;
  LoopParams loop;
  ObservationSensorParams observations;  ///< densities along the path
  SignaturePlacesParams signatures;      ///< signatures of places and their candidates
  NgramRecognizerParams words;           ///< segmentation into words and their n-gram matches

  /// Loops and optimizations count at the first scan taken this long after the one at which they
  /// were begun [s], >= 0; see BackgroundJobs.
  double loop_latency = 1.0;
  int optimize_interval = 20;  ///< keyframes between optimizations when there are new loops, >= 1
  double dcs_phi = 20.0;       ///< squared error above which loops lose weight, > 0
  ConsolidationParams consolidation;  ///< of a saved map, before another run begins

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

}  // namespace ngram_slam
