#include "selovis/ros/parameters.hpp"

namespace selovis {

using hyselam::Range;

SemanticLocalizationParams loadParams(hyselam::ParamLoader& loader) {
  SemanticLocalizationParams p;
  loader.get("model", p.model,
             "directory that `train` or ~save has written, to begin with; empty: nothing learnt");
  loader.get("descriptor", p.descriptor, "without a model");
  loader.get("kernel", p.kernel, {"linear", "poly", "rbf", "exemplar"}, "without a model");

  PlaceFilterParams& f = p.recogniser.filter;
  f.kind = FilterKind::kBayes;
  loader.getEnum<FilterKind>("filter", f.kind,
                             {{"none", FilterKind::kNone},
                              {"lowpass", FilterKind::kLowPass},
                              {"markov", FilterKind::kMarkov},
                              {"bayes", FilterKind::kBayes},
                              {"poses", FilterKind::kPoses}},
                             "over time");
  loader.get("alpha", f.alpha, Range::between(0.0, 1e6), "of the low-pass filter (Eq. 6.15)");
  loader.get("rho1", f.rho1, Range::between(1e-6, 1e6), "of the chain (Eq. 6.23)");
  loader.get("rho2", f.rho2, Range::between(0.0, 100.0), "of the chain (Eq. 6.23)");
  loader.get("stay_min", f.stay_min, Range::between(0.0, 1.0), "of the chain (Eq. 6.24)");
  loader.get("stay", f.stay, Range::between(0.0, 1.0), "bayes: staying from frame to frame");
  loader.get("trust", f.trust, Range::between(1e-3, 10.0), "bayes: exponent of a frame's witness");
  loader.get("unknown_below", f.unknown_below, Range::between(0.0, 1.0), "probability");
  loader.get("transition_min", f.transition_min, Range::between(0.0, 1.0), "probability");
  loader.get("novelty_max", p.recogniser.novelty_max, Range::atLeast(0.0), "0: never unknown");
  loader.getEnum<DescriptiveKind>("images", p.recogniser.descriptive.kind,
                                  {{"none", DescriptiveKind::kNone},
                                   {"sift", DescriptiveKind::kSift},
                                   {"corners", DescriptiveKind::kCorners}},
                                  "images that tell nothing are passed over");
  loader.get("min_features", p.recogniser.descriptive.min_features, Range::between(0, 100000),
             "0: 10 by sift, 20 by corners");

  loader.get("image_transport", p.image_transport, "raw, compressed or another one installed");
  loader.get("sync_tolerance", p.sync_tolerance, Range::between(0.0, 10.0), "[s]");
  loader.get("sync_wait", p.sync_wait, Range::between(0.0, 60.0), "[s] of wall time");
  loader.get("queue_size", p.queue_size, Range::between(1, 10000), "images");
  loader.get("global_frame_id", p.global_frame_id, "frame of the map");
  loader.get("base_frame_id", p.base_frame_id, "frame of the robot");
  loader.get("odom_frame_id", p.odom_frame_id, "filter poses: frame of odometry; empty: without");
  PoseFilterParams& pose = p.recogniser.poses;
  loader.get("particles", pose.particles, Range::between(10, 100000), "of the filter poses");
  loader.get("pose_beta", pose.beta, Range::between(0.0, 1000.0), "fall of likeness");
  loader.get("pose_trust", pose.trust, Range::between(1e-3, 10.0), "of one second of frames");
  loader.get("pose_reach", pose.reach, Range::between(0.05, 20.0), "[m]");
  loader.get("pose_turn", pose.turn, Range::between(0.02, hyselam::kPi), "[rad]");
  loader.get("pose_doubt", pose.doubt, Range::between(1e-6, 1e6), "frames");
  loader.get("pose_jump", pose.jump, Range::between(0.0, 1.0), "share a second");
  loader.get("max_speed", pose.max_speed, Range::between(0.0, 10.0), "[m/s] without odometry");
  loader.get("max_turn", pose.max_turn, Range::between(0.0, 10.0), "[rad/s] without odometry");

  loader.get("learn", p.learn, "from the start");
  loader.get("min_travel", p.learner.min_travel, Range::between(0.0, 100.0), "[m]");
  loader.get("min_turn", p.learner.min_turn, Range::between(0.0, 7.0), "[rad]");
  loader.get("aperture_x", p.learner.aperture_x, Range::between(0.01, 6.28),
             "[rad] where no camera_info comes");
  loader.get("aperture_y", p.learner.aperture_y, Range::between(0.01, 6.28), "[rad]");
  int frames = static_cast<int>(p.learner.max_frames);
  loader.get("max_frames", frames, Range::between(1, 1e6), "kept while learning");
  p.learner.max_frames = static_cast<std::size_t>(frames);
  loader.get("retrain_every", p.retrain_every, Range::between(0, 1e6), "frames; 0: when asked");
  loader.get("border", p.border, Range::between(0.0, 10.0), "[m]");
  loader.get("save_model", p.save_model,
             "directory, gone on with if it holds a model; empty: ~save writes to `model`");
  loader.get("autosave", p.autosave, "after each training, if `save_model` is given");
  loader.get("save_map", p.save_map, "file (XML); empty: the map is not written");

  SupervisorParams& s = p.supervisor;
  loader.get("supervisor_trust", s.trust, Range::between(1e-3, 1.0), "exponent of each frame");
  loader.get("supervisor_threshold", s.threshold, Range::between(1e-3, 1e3), "[nats]");
  loader.get("supervisor_least", s.least, Range::between(1e-9, 0.1), "probability");
  loader.get("known_from", s.known_from, Range::between(0.0, 1.0), "probability");
  loader.get("reach", p.reach, Range::between(0.0, 10.0), "[m]");
  loader.getEnum<OnKidnap>(
      "on_kidnap", p.on_kidnap,
      {{"none", OnKidnap::kNothing}, {"global", OnKidnap::kGlobal}, {"place", OnKidnap::kPlace}},
      "what is done when the pose is no longer believed");
  loader.get("patience", p.patience, Range::between(0.0, 600.0), "[s]");
  loader.get("settle", p.settle, Range::between(0.0, 3600.0), "[s]");

  loader.get("marker_height", p.marker_height, Range::between(0.1, 100.0), "[m]");
  loader.get("diagnostic_period", p.diagnostic_period, Range::between(0.05, 60.0), "[s]");
  validate(f);
  validate(s);
  validate(p.learner);
  return p;
}

}  // namespace selovis
