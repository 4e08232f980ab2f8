#include "ngram_slam/slam/slam_params.hpp"

#include <cmath>

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

namespace {

void above(const char* name, double value) {
  if (!(value > 0.0 && std::isfinite(value))) throw hyselam::ParameterError(name, value, "above 0");
}
void atLeast0(const char* name, double value) {
  if (!(value >= 0.0 && std::isfinite(value)))
    throw hyselam::ParameterError(name, value, "at least 0");
}
void share(const char* name, double value) {
  if (!(value >= 0.0 && value <= 1.0)) throw hyselam::ParameterError(name, value, "from 0 to 1");
}
void atLeast1(const char* name, int value) {
  if (value < 1) throw hyselam::ParameterError(name, value, "at least 1");
}
void angle(const char* name, double value) {
  if (!(value >= 0.0 && value <= hyselam::kPi))
    throw hyselam::ParameterError(name, value, "from 0 to pi");
}

}  // namespace

Eigen::Matrix3d OdometryNoise::information(const hyselam::Pose2& motion) const {
  const double way = std::hypot(motion.x, motion.y), turned = std::abs(motion.theta);
  const double position = base + per_metre * way + per_turn * turned;
  const double heading = turn_base + turn_per_turn * turned + turn_per_metre * way;
  const double p = 1.0 / (position * position);
  return Eigen::Vector3d(p, p, 1.0 / (heading * heading)).asDiagonal();
}

const char* nameOf(SlamLoops loops) {
  switch (loops) {
    case SlamLoops::kNone:
      return "none";
    case SlamLoops::kProximity:
      return "proximity";
    case SlamLoops::kNgrams:
      return "ngrams";
    case SlamLoops::kThesis:
      return "thesis";
    case SlamLoops::kAll:
      break;
  }
  return "all";
}

SlamParams::SlamParams() : words(NgramRecognizerParams::improved()) {
  surface.min_spacing = 0.03;
  observations.look_back = observations.bandwidth + 0.5;
  // The scans are asked afterwards: words need not be sure.
  words.min_probability = 0.2;
}

SlamParams SlamParams::thesis(int levels) {
  SlamParams p;
  p.loops = SlamLoops::kThesis;
  p.observations.look_back = 0.0;
  p.words = NgramRecognizerParams{};
  p.words.levels = levels;
  p.words.matcher.min_n.clear();
  for (int l = 0; l < levels; ++l) p.words.matcher.min_n.push_back(7 + 3 * l);
  return p;
}

void SlamParams::validate() const {
  surface.validate();
  refine.validate();
  observations.validate();
  words.validate();
  above("odometry.base", odometry.base);
  above("odometry.turn_base", odometry.turn_base);
  atLeast0("odometry.per_metre", odometry.per_metre);
  atLeast0("odometry.per_turn", odometry.per_turn);
  atLeast0("odometry.turn_per_turn", odometry.turn_per_turn);
  atLeast0("odometry.turn_per_metre", odometry.turn_per_metre);
  atLeast0("scan_step", scan_step);
  atLeast0("scan_turn", scan_turn);
  above("longest_step", longest_step);
  above("keyframe_step", keyframe_step);
  above("keyframe_turn", keyframe_turn);
  atLeast1("local_keyframes", local_keyframes);
  above("local_cell", local_cell);
  share("lost", lost);
  if (!(scan_information > 0.0 && scan_information <= 1.0))
    throw hyselam::ParameterError("scan_information", scan_information, "above 0, at most 1");
  atLeast1("optimise_every", optimise_every);
  above("dcs_phi", dcs_phi);

  above("loop.near_window", loop.near_window);
  angle("loop.near_turn", loop.near_turn);
  share("loop.near_score", loop.near_score);
  share("loop.near_matched", loop.near_matched);
  above("loop.near_stretch", loop.near_stretch);
  atLeast1("loop.every", loop.every);
  atLeast1("loop.most", loop.most);
  above("loop.far_every", loop.far_every);
  atLeast1("loop.far_most", loop.far_most);
  above("loop.far_stretch", loop.far_stretch);
  above("loop.far_half", loop.far_half);
  if (!(loop.far_resolution >= 0.02 && loop.far_resolution <= 1.0))
    throw hyselam::ParameterError("loop.far_resolution", loop.far_resolution, "from 0.02 to 1");
  share("loop.far_score", loop.far_score);
  share("loop.far_matched", loop.far_matched);
  share("loop.near_fit", loop.near_fit);
  share("loop.least_known", loop.least_known);
  share("loop.far_fit", loop.far_fit);
  above("loop.word_window", loop.word_window);
  angle("loop.word_turn", loop.word_turn);
  above("loop.rival_apart", loop.rival_apart);
  share("loop.rival_share", loop.rival_share);
  above("loop.least_way", loop.least_way);
  above("loop.uncertainty", loop.uncertainty);
  atLeast0("loop.uncertainty_growth", loop.uncertainty_growth);
  atLeast0("loop.uncertainty_bend", loop.uncertainty_bend);
  above("loop.most_uncertainty", loop.most_uncertainty);
  atLeast0("loop.turn_growth", loop.turn_growth);
  atLeast1("loop.company", loop.company);
  above("loop.company_way", loop.company_way);
  atLeast0("loop.company_span", loop.company_span);
  above("loop.agreement", loop.agreement);
  atLeast0("loop.agreement_growth", loop.agreement_growth);
  above("loop.agreement_turn", loop.agreement_turn);
  above("loop.thesis_deviation", loop.thesis_deviation);
  above("loop.thesis_turn_deviation", loop.thesis_turn_deviation);
}

}  // namespace ngram_slam
