// Parameters of the nodelet SemanticLocalization: names, ranges and meaning are in README.md.
#pragma once

#include <string>

#include "hyselam_common/ros/params.hpp"
#include "selovis/learner.hpp"
#include "selovis/recogniser.hpp"
#include "selovis/supervisor.hpp"

namespace selovis {

/// What is done when the pose is no longer believed.
enum class OnKidnap {
  kNothing,  ///< it is told
  kGlobal,   ///< part 1 searches the whole map
  kPlace,    ///< part 1 searches the place that was recognised, if it is known, else the whole map
};

struct SemanticLocalizationParams {
  std::string model;                  ///< directory; empty: begin with nothing learnt
  std::string descriptor = "GLANCE";  ///< without a model
  std::string kernel = "exemplar";    ///< without a model
  RecogniserParams recogniser;
  std::string image_transport = "raw";
  double sync_tolerance = 0.1;  ///< image and readings lie at most so far apart [s]
  double sync_wait = 0.3;       ///< an image waits at most so long for its readings [s]
  int queue_size = 10;          ///< images that may wait; the oldest is dropped first
  std::string global_frame_id = "map";
  std::string base_frame_id = "base_link";
  std::string odom_frame_id = "odom";  ///< of the filter `poses`; empty: without odometry

  LearnerParams learner;
  bool learn = false;       ///< from the start, not only when asked
  int retrain_every = 200;  ///< frames; 0: only when asked
  double border = 0.5;      ///< frames nearer to another place are not learnt [m]
  std::string save_model;   ///< directory, gone on with if it holds a model; empty: `model`
  bool autosave = true;     ///< into `save_model`, if it is not empty, after each training
  std::string save_map;     ///< topological map with signatures (XML); empty: none

  SupervisorParams supervisor;
  double reach = 1.0;  ///< places so near to the pose are as good as its own [m]
  OnKidnap on_kidnap = OnKidnap::kPlace;
  double patience = 3.0;  ///< the place is waited for so long before the whole map is searched [s]
  double settle = 20.0;   ///< the pose is not judged so long after it was set, unless told [s]

  double marker_height = 2.0;      ///< of a bar of probability 1 [m]
  double diagnostic_period = 1.0;  ///< [s]
};

/// @throws hyselam::ParameterError.
SemanticLocalizationParams loadParams(hyselam::ParamLoader& loader);

}  // namespace selovis
