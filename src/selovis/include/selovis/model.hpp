// What was learnt of a set of places, as a value and as a directory.
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "selovis/classifier.hpp"
#include "selovis/descriptor.hpp"
#include "selovis/place_graph.hpp"
#include "selovis/samples.hpp"

namespace selovis {

/// Of a camera of which nothing else is told: 70 degrees [rad].
constexpr double kAperture = 70.0 * hyselam::kPi / 180.0;

struct Model {
  std::string descriptor;
  DescriptorParams descriptor_params;
  ClassifierParams classifier;
  PlaceGraph graph;  ///< places in the order of the classes; transitions seen in training
  std::vector<double> views{
      0.0};                     ///< sideways shifts, in image widths, that each training image gave
  double aperture = kAperture;  ///< opening angle of the camera across the image [rad]
  std::vector<float> learnt;    ///< of the descriptor (a dictionary)
  Samples samples;
  std::string state;  ///< of an SVM

  /// A descriptor that has learnt what the training taught it.
  std::unique_ptr<Descriptor> makeDescriptor() const;
  std::unique_ptr<Classifier> makeClassifier() const;
};

/// One training frame.
struct TrainingFrame {
  cv::Mat image;
  Readings readings;
  std::string place;
  hyselam::Pose2 pose = kNoPose;  ///< of the camera in the map
};

struct TrainingOptions {
  std::string descriptor = "LBPbyHSV-U8N-IRIS";
  DescriptorParams descriptor_params;
  ClassifierParams classifier;
  std::vector<double> views{0.0};
  double aperture = kAperture;  ///< of the camera [rad], 0.01 to 2 pi
  bool grid_search = false;
  GridSearch grid;
  std::uint64_t seed = 1;
  std::string libsvm_file;  ///< gets libsvm's model file, if not empty
  std::function<void(const std::string& stage, std::size_t done, std::size_t all)> progress;
};

/// Frames come one by one (a tour need not fit into memory), tour after tour, in time order.
/// `load(tour, i)` may be called twice for a frame (dictionaries). Throws std::invalid_argument,
/// and what `load` throws.
Model train(const std::vector<std::size_t>& frames_of_tours,
            const std::function<TrainingFrame(std::size_t tour, std::size_t i)>& load,
            const TrainingOptions& options);

/// Adds frames, and the places that are new, to a model, and trains the classifier anew on all
/// signatures. Descriptor and dictionary stay. Kernel, cost and the like come from the model.
void addTo(Model& model, const std::vector<std::size_t>& frames_of_tours,
           const std::function<TrainingFrame(std::size_t tour, std::size_t i)>& load,
           const TrainingOptions& options);

/// The five sideways shifts that the exemplar kernel learns of each image by default.
std::vector<double> exemplarViews();

/// Of a camera that would have seen a view: what is shifted to the right, one turned to the left
/// sees.
hyselam::Pose2 poseOfView(const hyselam::Pose2& camera, double shift, double aperture);

/// The image moved sideways by `shift` widths (positive: its content to the right), its edge drawn
/// out.
cv::Mat shifted(const cv::Mat& image, double shift);

/// Writes the model into a directory, which is made if need be: `model.json` names descriptor,
/// parameters, places, and the data files with size and CRC-32. Data files carry the checksum in
/// their name and are written first, so that the directory holds a whole model, old or new, at
/// every moment. Throws hyselam::InputError.
void saveModel(const Model& model, const std::string& directory);

/// Whether a model was saved there, usable or not.
bool holdsModel(const std::string& directory);

/// Throws hyselam::InputError naming the file, the place in it and the reason.
Model loadModel(const std::string& directory);

}  // namespace selovis
