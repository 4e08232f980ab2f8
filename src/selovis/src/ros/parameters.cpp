#include "selovis/ros/parameters.hpp"

#include "hyselam_common/ros/params.hpp"

namespace selovis {

using hyselam::Range;

void ImageInputParams::describe(hyselam::ParameterVisitor& visit) {
  visit("image_transport", image_transport, "raw, compressed or another one that is installed");
  visit("sync_tolerance", sync_tolerance, Range::between(0.0, 10.0), "s",
        "between an image and its readings, at most");
  visit("sync_timeout", sync_timeout, Range::between(0.0, 60.0), "s",
        "that an image waits for its readings, at most (wall time)");
  visit("queue_size", queue_size, Range::between(1, 10000), "", "images that may wait");
}

void FrameIds::describe(hyselam::ParameterVisitor& visit) {
  visit("global_frame_id", global, "frame of the map");
  visit("base_frame_id", base, "frame of the robot");
  visit("odom_frame_id", odom, "frame of the odometry, for the filter poses; empty: without");
}

void LearningParams::describe(hyselam::ParameterVisitor& visit) {
  visit("learn", learn, "from the start");
  visit.group("", learner);
  visit("retrain_every", retrain_every, Range::between(0, 1e6), "",
        "learned frames; 0: when asked");
  visit("min_border_distance", min_border_distance, Range::between(0.0, 10.0), "m",
        "frames nearer to another place are not learned");
  visit("save_model", save_model,
        "directory of the model that is learned; one that is there goes before `model`; empty: "
        "~save writes to `model`");
  visit("autosave", autosave,
        "into `save_model`, if it is given, after each training; at the end where the camera was "
        "found to err");
  visit("save_map", save_map, "file (XML) of the map with signatures; empty: not written");
}

void SupervisionParams::describe(hyselam::ParameterVisitor& visit) {
  visit.group("kidnapping_", supervisor);
  visit("kidnapping_use_scan", use_scan,
        "compare scan and map at the pose and elsewhere as well, where both are published");
  visit("expected_place_radius", expected_place_radius, Range::between(0.0, 10.0), "m",
        "places so near to the pose agree with it");
  visit("on_kidnap", on_kidnap,
        {{"none", OnKidnap::kNothing}, {"global", OnKidnap::kGlobal}, {"place", OnKidnap::kPlace}},
        "where the localization begins again when the robot was kidnapped");
  visit("relocalization_timeout", relocalization_timeout, Range::between(0.0, 600.0), "s",
        "for the place of a kidnapped robot to become known, before the whole map is searched");
  visit("grace_period", grace_period, Range::between(0.0, 3600.0), "s",
        "after its pose was set a localization without localization_status is not tested");
}

void SemanticLocalizationParams::describe(hyselam::ParameterVisitor& visit) {
  for (const auto& [former, now] :
       {std::pair("alpha", "low_pass_alpha"),
        std::pair("rho1", "markov_rho1"),
        std::pair("rho2", "markov_rho2"),
        std::pair("stay_min", "markov_min_stay_probability"),
        std::pair("stay", "bayes_stay_probability"),
        std::pair("trust", "bayes_likelihood_exponent"),
        std::pair("unknown_below", "min_place_probability"),
        std::pair("transition_min", "min_transition_probability"),
        std::pair("novelty_max", "max_novelty"),
        std::pair("images", "descriptive_filter"),
        std::pair("sync_wait", "sync_timeout"),
        std::pair("particles", "pose_particles"),
        std::pair("pose_beta", "pose_similarity_beta"),
        std::pair("pose_trust", "pose_likelihood_exponent"),
        std::pair("pose_reach", "pose_kernel_radius"),
        std::pair("pose_turn", "pose_kernel_angle"),
        std::pair("pose_doubt", "pose_prior_weight"),
        std::pair("pose_jump", "pose_injection_rate"),
        std::pair("max_speed", "pose_max_speed"),
        std::pair("max_turn", "pose_max_turn_rate"),
        std::pair("aperture_x", "horizontal_fov"),
        std::pair("aperture_y", "vertical_fov"),
        std::pair("border", "min_border_distance"),
        std::pair("supervisor_least", "kidnapping_min_frame_probability"),
        std::pair("known_from", "kidnapping_min_place_probability"),
        std::pair("reach", "expected_place_radius"),
        std::pair("patience", "relocalization_timeout"),
        std::pair("settle", "grace_period")}) {
    visit.renamed(former, now);
  }
  visit("model", model,
        "directory that `train` or ~save has written, to begin with; empty: nothing learned");
  visit("descriptor", descriptor, "without a model");
  visit("kernel", kernel, svmKernelWords(), "without a model");
  visit.group("", recognizer);
  visit.group("", input);
  visit.group("", frame_ids);
  visit.group("", learning);
  visit.group("", supervision);
  visit("marker_height", marker_height, Range::between(0.1, 100.0), "m",
        "of a bar of probability 1");
  visit("diagnostic_period", diagnostic_period, Range::between(0.05, 60.0), "s",
        "between two diagnostics");
}

void SemanticLocalizationParams::validate() const {
  hyselam::checkParameters(*this);
}

SemanticLocalizationParams loadParams(hyselam::ParamLoader& loader) {
  return hyselam::loadDescribed<SemanticLocalizationParams>(loader);
}

}  // namespace selovis
