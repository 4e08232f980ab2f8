// Learning places while the robot drives (dos Santos 2014, 7.3.2): signatures with the place and
// pose where they were taken, kept in a model and in the augmented topological map.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hyselam_common/parameters.hpp"
#include "hyselam_common/pose2.hpp"
#include "hyselam_topological_map/topological_map.hpp"
#include "selovis/learning/place_model.hpp"

namespace selovis {

/// The signatures of one image, one for each sideways view that the model has.
struct LearnedFrame {
  std::string place;
  double stamp = 0.0;                          ///< [s]
  hyselam::Pose2 camera;                       ///< in the map
  double height = 0.0;                         ///< of the camera [m]
  std::vector<std::vector<float>> signatures;  ///< by view
};

struct LearnerParams {
  double min_travel = 0.2;                         ///< between two frames [m], 0 to 100
  double min_turn = hyselam::radians(10.0);        ///< or so much turn [rad], 0 to 7
  double horizontal_fov = hyselam::radians(70.0);  ///< of the camera [rad], 0.01 to 2 pi
  double vertical_fov = hyselam::radians(55.0);
  std::size_t max_frames = 20000;  ///< no more are collected, 1 to 1e6

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

/// A model without any place. @throws hyselam::InputError for a descriptor that needs a dictionary,
/// which cannot be learned frame by frame; hyselam::ParameterError.
PlaceModel untrainedPlaceModel(const TrainingOptions& options);

/// Adds frames to a model and trains it anew; consecutive frames of different places add a
/// transition. @throws hyselam::InputError for fewer than two places in all.
PlaceModel learnFrames(PlaceModel model, const std::vector<LearnedFrame>& frames);

/// Adds the signatures of frames to the places of the map that have their names. A view shifted
/// sideways is kept with the heading of a camera that would have seen it.
/// @returns the number of frames whose place is not on the map.
std::size_t storeSignatures(const std::vector<LearnedFrame>& frames, const PlaceModel& model,
                            const LearnerParams& params,
                            hyselam_topo::AugmentedTopologicalMap& map);

/// The frames whose signatures a map holds, in order of time. Signatures of other descriptors or
/// lengths than the model's are left out.
std::vector<LearnedFrame> framesFromMap(const hyselam_topo::AugmentedTopologicalMap& map,
                                        const PlaceModel& model);

/// Collects frames of a running robot.
class Learner {
 public:
  /// @param model known so far, or untrainedPlaceModel(). @throws hyselam::ParameterError.
  Learner(std::shared_ptr<const PlaceModel> model, const LearnerParams& params);

  /// Keeps the frame if the robot has moved enough since the last one that was kept, or is in
  /// another place. @returns whether it was kept. @throws hyselam::InputError
  /// (Descriptor::compute).
  bool add(const cv::Mat& image, const SensorReadings& readings, const std::string& place,
           const hyselam::Pose2& camera, double height, double stamp);

  /// Frames of a place that was given another name belong to that name.
  void rename(const std::vector<PlaceRenaming>& renamings);

  const std::vector<LearnedFrame>& frames() const { return frames_; }

 private:
  std::shared_ptr<const PlaceModel> model_;
  LearnerParams params_;
  std::unique_ptr<Descriptor> descriptor_;
  std::vector<LearnedFrame> frames_;
};

}  // namespace selovis
