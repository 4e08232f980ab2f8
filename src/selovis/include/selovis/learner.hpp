// Learning places while the robot drives (7.3.2): signatures with the place and pose they were
// taken at, kept in a model and in the augmented topological map, trained in the background.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "hyselam_topological_map/topological_map.hpp"
#include "selovis/model.hpp"

namespace selovis {

/// One image's signatures: one for each sideways view that the model asks for.
struct LearntFrame {
  std::string place;
  double stamp = 0.0;                      ///< [s]
  hyselam::Pose2 camera;                   ///< in the map
  double height = 0.0;                     ///< of the camera [m]
  std::vector<std::vector<float>> values;  ///< by view
};

struct LearnerParams {
  double min_travel = 0.2;                     ///< between frames that are kept [m], 0 or more
  double min_turn = hyselam::radians(10.0);    ///< or turn [rad], 0 or more
  double aperture_x = hyselam::radians(70.0);  ///< opening angle of the camera [rad], (0, 2 pi]
  double aperture_y = hyselam::radians(55.0);
  std::size_t max_frames = 20000;  ///< more are not kept, at least 1
};

/// Throws hyselam::ParameterError.
void validate(const LearnerParams& params);

/// A model of this descriptor that has not learnt anything yet. Throws std::invalid_argument for a
/// descriptor that needs a dictionary, which cannot be learnt frame by frame.
Model emptyModel(const TrainingOptions& options);

/// Puts frames into a model and trains it anew; frames that follow each other in time tell the
/// transitions between places. Throws std::invalid_argument for less than two places in all.
void learn(Model& model, const std::vector<LearntFrame>& frames);

/// Puts frames into the places of the map that have their names, as VisualSignature: a view shifted
/// sideways is kept as what a camera turned by it would have seen. Returns how many frames found no
/// place.
std::size_t store(const std::vector<LearntFrame>& frames, const Model& model,
                  const LearnerParams& params, hyselam_topo::AugmentedTopologicalMap* map);

/// The frames whose signatures of this model's kind a map holds, in order of time. Signatures of
/// other descriptors or lengths are passed over.
std::vector<LearntFrame> framesOf(const hyselam_topo::AugmentedTopologicalMap& map,
                                  const Model& model);

/// Takes frames as they come.
class Learner {
 public:
  /// `model`: what is known so far, or emptyModel().
  Learner(std::shared_ptr<const Model> model, const LearnerParams& params);

  /// Keeps the frame if the robot has moved enough since the last one that was kept, or is in
  /// another place. Returns whether it did. Throws std::invalid_argument (Descriptor::compute).
  bool add(const cv::Mat& image, const Readings& readings, const std::string& place,
           const hyselam::Pose2& camera, double height, double stamp);

  /// Frames of places that got another name are frames of that name.
  void rename(const std::vector<Renaming>& renamings);

  const std::vector<LearntFrame>& frames() const { return frames_; }
  void clear() { frames_.clear(); }

 private:
  std::shared_ptr<const Model> model_;
  LearnerParams params_;
  std::unique_ptr<Descriptor> descriptor_;
  std::vector<LearntFrame> frames_;
};

/// One training at a time in a thread of its own.
class BackgroundTraining {
 public:
  struct Outcome {
    std::shared_ptr<const Model> model;  ///< null if it failed
    std::string error;
    std::size_t frames = 0;
  };

  ~BackgroundTraining();
  /// Begins; false if one is still running, or no thread can be had. `done` is called in the other
  /// thread, before busy() ends; what it throws is lost.
  bool start(std::shared_ptr<const Model> model, std::vector<LearntFrame> frames,
             std::function<void(const Outcome&)> done);
  bool busy() const;

 private:
  mutable std::mutex mutex_;
  bool busy_ = false;
  std::thread thread_;
};

}  // namespace selovis
