// Parameters of the nodelet SemanticLocalization; README.md has the table.
#pragma once

#include <string>

#include "hyselam_common/parameters.hpp"
#include "selovis/learning/learner.hpp"
#include "selovis/recognition/image_recognizer.hpp"
#include "selovis/recognition/pose_supervisor.hpp"

namespace hyselam {
class ParamLoader;
}

namespace selovis {

/// Of images, and of the sensor readings that go with them.
struct ImageInputParams {
  std::string image_transport = "raw";
  double sync_tolerance = 0.1;  ///< between an image and its readings, at most [s]
  double sync_timeout = 0.3;    ///< that an image waits for its readings, at most [s]
  std::size_t queue_size = 10;  ///< images that may wait; the oldest is dropped first

  void describe(hyselam::ParameterVisitor& visit);
};

struct FrameIds {
  std::string global = "map";
  std::string base = "base_link";
  std::string odom = "odom";  ///< of the filter `poses`; empty: without odometry

  void describe(hyselam::ParameterVisitor& visit);
};

struct LearningParams {
  LearnerParams learner;
  bool learn = false;                ///< from the start
  int retrain_every = 200;           ///< learned frames; 0: only when ~retrain is called
  double min_border_distance = 0.5;  ///< frames nearer to another place are not learned [m]
  std::string save_model;            ///< directory; its model goes before `model`; empty: `model`
  bool autosave = true;              ///< into `save_model`, if it is not empty, after each training
  std::string save_map;              ///< topological map with signatures (XML); empty: none

  void describe(hyselam::ParameterVisitor& visit);
};

/// What is done when the robot is found to be kidnapped.
enum class OnKidnap {
  kNothing,  ///< it is reported
  kGlobal,   ///< the localization searches the whole map
  kPlace,    ///< the localization searches the recognized place, if it is known, else the whole map
};

struct SupervisionParams {
  PoseSupervisorParams supervisor;
  bool use_scan = true;                ///< compare the scan with the map as well
  double expected_place_radius = 1.0;  ///< places so near to the pose agree with it [m]
  OnKidnap on_kidnap = OnKidnap::kPlace;
  /// The place must become known within this time, else the whole map is searched [s].
  double relocalization_timeout = 3.0;
  /// A localization that does not publish its status is not tested so long after its pose was set
  /// [s].
  double grace_period = 20.0;

  void describe(hyselam::ParameterVisitor& visit);
};

struct SemanticLocalizationParams {
  std::string model;                         ///< directory; empty: nothing learned yet
  std::string descriptor = "FUSION-LEARNT";  ///< without a model
  SvmKernel kernel = SvmKernel::kFusion;     ///< without a model
  ImageRecognizerParams recognizer;
  ImageInputParams input;
  FrameIds frame_ids;
  LearningParams learning;
  SupervisionParams supervision;
  double marker_height = 2.0;      ///< of a bar of probability 1 [m]
  double diagnostic_period = 1.0;  ///< [s]

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

/// From the parameter server. @throws hyselam::ParameterError.
SemanticLocalizationParams loadParams(hyselam::ParamLoader& loader);

}  // namespace selovis
