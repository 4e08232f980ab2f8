// Learned model of a set of places: as a value, and saved as a directory.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "selovis/classifiers/classifier.hpp"
#include "selovis/classifiers/grid_search.hpp"
#include "selovis/classifiers/samples.hpp"
#include "selovis/descriptors/descriptor.hpp"
#include "selovis/places/place_transitions.hpp"
#include "selovis/recognition/reliability_memory.hpp"

namespace selovis {

/// Horizontal field of view [rad] of a camera of which nothing else is known: 70 degrees.
constexpr double kDefaultFov = 70.0 * hyselam::kPi / 180.0;

struct PlaceModel {
  std::string descriptor;
  DescriptorParams descriptor_params;
  ClassifierParams classifier;
  PlaceTransitions transitions;         ///< places in the order of the classes; seen in training
  std::vector<double> views{0.0};       ///< sideways shifts of each training image, in image widths
  double horizontal_fov = kDefaultFov;  ///< of the camera [rad]
  std::vector<float> dictionary;        ///< of the descriptor, if it has one
  Samples samples;
  /// Stamp [s] of the last frame that learnFrames() added; NaN: not known. It is not saved.
  double learned_until = std::numeric_limits<double>::quiet_NaN();
  std::string svm;  ///< the state of a trained SVM, or of a fusion (TrainedClassifier)
  /// Where the camera was found to err with this model; learning begins it anew.
  ReliabilityMemory reliability;

  /// The descriptor with its dictionary. @throws hyselam::InputError, hyselam::ParameterError.
  std::unique_ptr<Descriptor> makeDescriptor() const;
  /// @throws hyselam::InputError, hyselam::ParameterError.
  std::unique_ptr<Classifier> makeClassifier() const;
};

/// One training frame.
struct TrainingFrame {
  cv::Mat image;
  SensorReadings readings;
  std::string place;
  hyselam::Pose2 pose = kNoPose;  ///< of the camera in the map
  std::string source{};           ///< that begins the messages of errors; may be empty
};

struct TrainingOptions {
  std::string descriptor = "FUSION-LEARNT";
  DescriptorParams descriptor_params;
  ClassifierParams classifier;
  /// Sideways shifts in image widths, each -0.5 to 0.5; none: viewsFor(classifier.kernel).
  std::vector<double> views;
  double horizontal_fov = kDefaultFov;  ///< of the camera [rad], 0.01 to 2 pi
  bool grid_search = false;             ///< choose the classifier's parameters by cross-validation
  GridSearchParams grid;
  std::uint64_t seed = 1;   ///< of the dictionary
  std::string libsvm_file;  ///< written in libsvm's format, if not empty
  std::function<void(const std::string& stage, std::size_t done, std::size_t all)> progress;
};

/// Frames are loaded one by one (a tour need not fit into memory), tour after tour, in time order.
/// A dictionary makes it load some of them twice.
using LoadFrame = std::function<TrainingFrame(std::size_t tour, std::size_t i)>;

/// @throws hyselam::InputError, hyselam::ParameterError, and what `load` throws.
PlaceModel trainPlaceModel(const std::vector<std::size_t>& frames_of_tours, const LoadFrame& load,
                           const TrainingOptions& options);

/// Adds frames, and the places that are new, to a model, and trains the classifier anew on all
/// signatures. Descriptor, dictionary and classifier parameters are those of the model.
/// @throws as trainPlaceModel().
PlaceModel extendPlaceModel(PlaceModel model, const std::vector<std::size_t>& frames_of_tours,
                            const LoadFrame& load, const TrainingOptions& options);

/// The five sideways shifts that exemplar models have of each image by default.
std::vector<double> exemplarViews();
/// Those, or the image alone for an SVM.
std::vector<double> viewsFor(SvmKernel kernel);

/// Pose of a camera that would have seen a shifted view: content that is shifted to the right is
/// seen by a camera turned to the left.
hyselam::Pose2 poseOfView(const hyselam::Pose2& camera, double shift, double horizontal_fov);

/// The image moved sideways by `shift` widths (positive: its content to the right), with its edge
/// column repeated.
cv::Mat shifted(const cv::Mat& image, double shift);

/// Writes the model into a directory, which is created if need be: `model.json` names descriptor,
/// parameters, places, what a fusion learned of its parts, and the data files with their size and
/// CRC-32. The data files
/// (binary, little-endian) have their checksum in their name and are written first, so that the
/// directory holds a complete model, old or new, at every moment. @throws hyselam::InputError, also
/// for a model that was not trained.
void savePlaceModel(const PlaceModel& model, const std::string& directory);

/// Replaces what is saved there of where the camera errs: of a model that savePlaceModel() wrote,
/// and without writing its signatures again.
/// @throws hyselam::InputError, also where another model is saved.
void saveReliability(const PlaceModel& model, const ReliabilityMemory& memory,
                     const std::string& directory);

/// Whether a model was saved there, usable or not.
bool holdsPlaceModel(const std::string& directory);

/// @throws hyselam::InputError with the file, the position in it and the reason.
PlaceModel loadPlaceModel(const std::string& directory);

}  // namespace selovis
