#include "ngram_slam/slam/slam_params.hpp"

#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

using hyselam::ParameterVisitor;
using hyselam::Range;

namespace {

const std::vector<std::pair<std::string, LoopClosureMode>>& loopClosureModes() {
  static const std::vector<std::pair<std::string, LoopClosureMode>> modes = {
      {"none", LoopClosureMode::kNone},     {"proximity", LoopClosureMode::kProximity},
      {"ngrams", LoopClosureMode::kNgrams}, {"signatures", LoopClosureMode::kSignatures},
      {"all", LoopClosureMode::kAll},       {"thesis", LoopClosureMode::kThesis}};
  return modes;
}

const Range kRatio = Range::between(0.0, 1.0);
const Range kAngle = Range::between(0.0, hyselam::kPi);
const Range kPositive = Range::above(0.0);
const Range kNotNegative = Range::atLeast(0.0);
const Range kCount = Range::between(1, 1e6);

}  // namespace

const char* toString(LoopClosureMode mode) {
  for (const auto& [name, value] : loopClosureModes()) {
    if (value == mode) return name.c_str();
  }
  return "";
}

LoopClosureMode loopClosureModeFromString(const std::string& text) {
  for (const auto& [name, value] : loopClosureModes()) {
    if (name == text) return value;
  }
  throw hyselam::ParameterError("loops", text,
                                "none, proximity, ngrams, signatures, all or thesis");
}

void RelocalizationParams::describe(ParameterVisitor& visit) {
  visit("min_points", min_points, Range::between(0, 1e6), "",
        "a scan of fewer surface points is not searched");
  visit("window", window, kPositive, "m",
        "positions searched around the pose of a scan that does not fit, each axis");
  visit("angle", angle, kAngle, "rad", "headings searched around it");
  visit("min_score", min_score, kRatio, "", "of the search");
  visit("min_gain", min_gain, kRatio, "", "in inlier ratio, for the pose found to be taken");
  visit("odometry_information_scale", odometry_information_scale, kRatio, "",
        "weight of odometry in the refinement of the pose found");
  visit("max_deviations", max_deviations, kNotNegative, "",
        "standard deviations of odometry; a scan whose points so large an error moves farther than "
        "refine/initial_distance is searched too; 0: none");
  visit("window_deviations", window_deviations, kPositive, "",
        "standard deviations of odometry that are searched then");
  visit("uncertain_resolution", uncertain_resolution, Range::between(0.01, 1.0), "m",
        "of that search");
}

void StepCheckParams::describe(ParameterVisitor& visit) {
  visit("path_before", path_before, kPositive, "m",
        "path before a step between keyframes that was searched, on whose surfaces the path behind "
        "it is laid once more");
  visit("path_behind", path_behind, kNotNegative, "m", "path behind it; 0: no step is asked again");
  visit("window", window, kPositive, "m", "positions searched around the step, each axis");
  visit("angle", angle, kAngle, "rad", "headings searched around it");
  visit("min_score", min_score, kRatio, "", "of the search, and share of points on surfaces");
  visit("min_overlap", min_overlap, kRatio, "",
        "share of the points in space that the other part observed");
  visit("min_deviations", min_deviations, kNotNegative, "",
        "standard deviations of the scans from the step as it was, for it to be changed");
}

void RunStartParams::describe(ParameterVisitor& visit) {
  visit("map_radius", map_radius, kNotNegative, "m",
        "keyframes this far beyond the window make the map that is searched");
  visit("min_score", min_score, kRatio, "", "of the search");
  visit("position_information", position_information, kPositive, "1/m^2",
        "of the edge that ties a run to the known map");
  visit("heading_information", heading_information, kPositive, "1/rad^2", "of that edge");
  visit("local_map_radius", local_map_radius, kNotNegative, "m",
        "old keyframes this near join the local map of a run that has just begun");
  visit("search_interval", search_interval, kPositive, "m",
        "path between searches around a start that is supposed only");
  visit("search_radius", search_radius, kPositive, "m", "of what is searched around it");
  visit("whole_map_interval", whole_map_interval, kPositive, "m",
        "path between searches of the whole map, until the run is tied to it");
  visit("place_spacing", place_spacing, kPositive, "m", "between the places that are searched");
  visit("place_interval", place_interval, kNotNegative, "m",
        "path between searches of the drawn maps for the last metres of the run, until it is tied; "
        "0: they are not searched");
  visit("min_place_probability", min_place_probability, kRatio, "",
        "of a place found so, beside all others: the scans are asked at more probable ones");
  visit("sure_place_probability", sure_place_probability, kRatio, "",
        "of a place found so, beside all others, to tie the run");
  visit("min_tie_probability", min_tie_probability, kRatio, "",
        "of a place and of the loop there that the scans verified, together, to tie the run");
  visit("place_min_span", place_min_span, kNotNegative, "m",
        "path of the run between that loop and another one that says the same");
  visit("own_map_path", own_map_path, kNotNegative, "m",
        "path after which a run that is not tied is a map of its own, and one that is keeps its "
        "ties");
}

namespace {

void describeNearLoops(LoopParams& p, ParameterVisitor& visit) {
  visit("near_max_uncertainty", p.near_max_uncertainty, kPositive, "m",
        "up to this uncertainty of its position a place is searched as near");
  visit("near_search_angle", p.near_search_angle, kAngle, "rad",
        "headings searched for a near loop");
  visit("near_min_score", p.near_min_score, kRatio, "", "of the search for a near loop");
  visit("near_min_inlier_ratio", p.near_min_inlier_ratio, kRatio, "",
        "part of the scan on known surfaces");
  visit("near_min_surface_ratio", p.near_min_surface_ratio, kRatio, "", "as far_min_surface_ratio");
  visit("near_segment_half_length", p.near_segment_half_length, kPositive, "m",
        "of the old path, each side");
  visit("near_resolution", p.near_resolution, Range::between(0.01, 1.0), "m",
        "of the search for a near loop");
  visit("near_inlier_distance", p.near_inlier_distance, kPositive, "m",
        "a point scores up to here from a surface");
  visit("near_max_points", p.near_max_points, kCount, "", "of the scan, in the search");
  visit("near_search_interval", p.near_search_interval, kCount, "keyframes",
        "between searches for near loops");
  visit("near_max_candidates", p.near_max_candidates, kCount, "", "places tried in a search");
}

void describeFarLoops(LoopParams& p, ParameterVisitor& visit) {
  visit("far_search_interval", p.far_search_interval, kPositive, "m",
        "of path between searches for far loops");
  visit("far_max_candidates", p.far_max_candidates, kCount, "", "places tried in a search");
  visit("far_old_segment_half_length", p.far_old_segment_half_length, kPositive, "m",
        "of the old path, each side");
  visit("far_new_segment_half_length", p.far_new_segment_half_length, kPositive, "m",
        "of the new path, each side");
  visit("far_resolution", p.far_resolution, Range::between(0.02, 1.0), "m",
        "of the search for a far loop, and of what both segments observed");
  visit("far_min_score", p.far_min_score, kRatio, "", "of the search for a far loop");
  visit("far_min_inlier_ratio", p.far_min_inlier_ratio, kRatio, "",
        "part of the points on known surfaces");
  visit("far_min_surface_ratio", p.far_min_surface_ratio, kRatio, "",
        "part of the points in space observed by the other segment that lie on its surfaces; both "
        "ways");
  visit("far_max_points", p.far_max_points, kCount, "", "in the search");
  visit("far_max_refined_points", p.far_max_refined_points, kCount, "",
        "in the refinement of the pose found");
}

void describeVerification(LoopParams& p, ParameterVisitor& visit) {
  visit("min_overlap", p.min_overlap, kRatio, "",
        "part of the new points in space that the old segment observed");
  visit("observed_space_side", p.observed_space_side, Range::between(1.0, 150.0), "m",
        "of the square of space around the old place that is compared");
  visit("ambiguity_distance", p.ambiguity_distance, kPositive, "m",
        "a far loop is ambiguous if a pose this far from the best one ...");
  visit("max_ambiguity_ratio", p.max_ambiguity_ratio, kRatio, "",
        "... has this part of its score; 1: not checked");
  visit("word_search_window", p.word_search_window, kPositive, "m",
        "positions searched around a match of words");
  visit("word_search_angle", p.word_search_angle, kAngle, "rad", "headings searched around it");
  visit("word_candidate_spacing", p.word_candidate_spacing, kNotNegative, "m",
        "of old path; matches of a new word closer than this are tried once");
  visit("word_max_candidates", p.word_max_candidates, kCount, "",
        "far loops tried for one new word");
  visit("signature_search_window", p.signature_search_window, kPositive, "m",
        "positions searched around a place with a like signature");
  visit("signature_search_angle", p.signature_search_angle, kAngle, "rad",
        "headings searched around the likeliest ones there");
}

void describeCandidates(LoopParams& p, ParameterVisitor& visit) {
  visit("min_path_length", p.min_path_length, kPositive, "m",
        "through the graph; nearer keyframes are no loop candidates");
  visit("candidate_spacing", p.candidate_spacing, kNotNegative, "m",
        "of old path between two candidates");
  visit("visibility_margin", p.visibility_margin, kNotNegative, "m",
        "this far beside a path its surfaces are seen");
  visit("segment_separation", p.segment_separation, kNotNegative, "m",
        "of path between the old and the new segment of a run");
  visit("position_uncertainty", p.position_uncertainty, kPositive, "m", "of a keyframe, at least");
  visit("position_uncertainty_per_meter", p.position_uncertainty_per_meter, kNotNegative, "m/m",
        "of path through the graph");
  visit("position_uncertainty_per_square_meter", p.position_uncertainty_per_square_meter,
        kNotNegative, "1/m", "of path through the graph: a heading that drifts bends it");
  visit("max_position_uncertainty", p.max_position_uncertainty, kPositive, "m",
        "search windows are no larger");
  visit("heading_uncertainty", p.heading_uncertainty, kNotNegative, "rad",
        "of a keyframe, at least");
  visit("heading_uncertainty_per_meter", p.heading_uncertainty_per_meter, kNotNegative, "rad/m",
        "of path through the graph");
  visit("loop_path_length", p.loop_path_length, kNotNegative, "m",
        "of a loop edge in a path through the graph");
}

void describeConsistency(LoopParams& p, ParameterVisitor& visit) {
  visit("min_consistent_loops", p.min_consistent_loops, kCount, "",
        "far loops that are pairwise consistent, to be accepted");
  visit("min_consistent_signature_loops", p.min_consistent_signature_loops, kCount, "",
        "the same where none of them comes from words");
  visit("min_tie_loops", p.min_tie_loops, kCount, "",
        "the same for those that tie a run to another map");
  visit("tie_min_span", p.tie_min_span, kNotNegative, "m",
        "of path that the new ends of these cover");
  visit("consistency_max_path_length", p.consistency_max_path_length, kPositive, "m",
        "between consistent loops");
  visit("consistency_min_span", p.consistency_min_span, kNotNegative, "m",
        "of path that the new ends of consistent loops cover");
  visit("consistency_distance", p.consistency_distance, kPositive, "m",
        "consistent loops differ by no more than this ...");
  visit("consistency_distance_per_meter", p.consistency_distance_per_meter, kNotNegative, "m/m",
        "... and this part of the path between them");
  visit("consistency_angle", p.consistency_angle, kPositive, "rad",
        "and in heading by no more than this");
  visit("company_half_length", p.company_half_length, kNotNegative, "m",
        "of path before and after a far loop, whose far loops are asked; 0: none");
  visit("max_contradiction", p.max_contradiction, kPositive, "",
        "those that contradict it weigh less than this part of those that do not");
  visit("min_signature_probability", p.min_signature_probability, kRatio, "",
        "far loops by signatures that are less probable wait for others like them");
  visit("thesis_position_stddev", p.thesis_position_stddev, kPositive, "m",
        "of the edges of loops = thesis");
  visit("thesis_heading_stddev", p.thesis_heading_stddev, kPositive, "rad",
        "of the edges of loops = thesis");
}

}  // namespace

void LoopParams::describe(ParameterVisitor& visit) {
  describeNearLoops(*this, visit);
  describeFarLoops(*this, visit);
  describeVerification(*this, visit);
  describeCandidates(*this, visit);
  describeConsistency(*this, visit);
}

void SlamParams::describe(ParameterVisitor& visit) {
  visit("loops", loops, loopClosureModes(), "which places are taken to be places seen before");
  visit("refine_odometry", refine_odometry, "match scans with what was seen last");
  visit.group("surface/", surface, {{"max_range", "max_range"}});
  visit.group("refine/", refine);
  visit.group(
      "odometry/", odometry,
      {{"position_per_meter", "odometry_noise"}, {"heading_per_radian", "odometry_turn_noise"}});
  visit.group("odometry_learning/", odometry_learning);
  visit.group("odometry_doubt/", odometry_doubt);
  visit("scan_step", scan_step, kNotNegative, "m",
        "scans nearer to the last one matched are placed by odometry");
  visit("scan_turn", scan_turn, kNotNegative, "rad", "and turned by less than this");
  visit.renamed("longest_step", "max_odometry_step");
  visit("max_odometry_step", max_odometry_step, kPositive, "m",
        "between two scans; more is an odometry jump");
  visit("jump_information", jump_information, kPositive, "1/m^2, 1/rad^2",
        "of the motion across an odometry jump");
  visit("keyframe_step", keyframe_step, kPositive, "m", "between keyframes");
  visit("keyframe_turn", keyframe_turn, kPositive, "rad", "between keyframes");
  visit("local_map_keyframes", local_map_keyframes, kCount, "",
        "keyframes that make the local map");
  visit("local_map_resolution", local_map_resolution, kPositive, "m", "of the local map");
  visit("min_inlier_ratio", min_inlier_ratio, kRatio, "",
        "part of a scan on known surfaces, below which its pose is searched");
  visit("weak_match_factor", weak_match_factor, kRatio, "",
        "part of min_inlier_ratio, below which a match is counted as weak");
  visit("scan_information_scale", scan_information_scale, Range::aboveUpTo(0.0, 1.0), "",
        "part of the information of a scan match that counts: its points are not independent");
  visit("odometry_information_scale", odometry_information_scale, kRatio, "",
        "part of the information of odometry that counts beside a scan match");
  visit.group("relocalization/", relocalization);
  visit.group("step_check/", step_check);
  visit.group("run_start/", run_start);
  visit.group("loop/", loop);
  visit.group("signatures/", signatures);
  visit("loop_latency", loop_latency, Range::between(0.0, 60.0), "s",
        "loops and optimizations count at the first scan so long after they were begun, by the "
        "stamps: equal scans give equal maps");
  visit.renamed("optimise_every", "optimize_interval");
  visit("optimize_interval", optimize_interval, kCount, "keyframes",
        "between optimizations when there are new loops");
  visit("dcs_phi", dcs_phi, kPositive, "", "squared error from which loops lose weight");
  visit.group("consolidation/", consolidation);
}

SlamParams::SlamParams() : words(NgramRecognizerParams::improved()) {
  surface.min_spacing = 0.03;
  observations.look_back = observations.bandwidth + 0.5;
  // The scans are asked afterwards: words need not be sure.
  words.min_probability = 0.2;
  // Nor need signatures; each candidate costs the time to verify it.
  signatures.recognizer.max_candidates = 5;
}

SlamParams SlamParams::thesis(int levels) {
  SlamParams p;
  p.loops = LoopClosureMode::kThesis;
  p.observations.look_back = 0.0;
  p.words = NgramRecognizerParams{};
  p.words.levels = levels;
  p.words.matcher.min_n.clear();
  for (int l = 0; l < levels; ++l) p.words.matcher.min_n.push_back(7 + 3 * l);
  return p;
}

void SlamParams::validate() const {
  hyselam::checkParameters(*this);
  surface.validate();
  refine.validate();
  observations.validate();
  words.validate();
  signatures.validate();
}

}  // namespace ngram_slam
