// From one image to a place: filter of images, descriptor, classifier, filter over time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "selovis/descriptors/descriptive_filter.hpp"
#include "selovis/filters/place_filter.hpp"
#include "selovis/filters/pose_filter.hpp"
#include "selovis/learning/place_model.hpp"

namespace selovis {

struct ImageRecognizerParams {
  DescriptiveFilterParams descriptive;
  /// Of the kind kPoses: a PoseFilter takes its place. kAuto: both run; the PoseFilter, where the
  /// model has exemplars with poses that it can use (posesProblem()), answers frames with odometry,
  /// the Bayes filter all others.
  PlaceFilterParams filter;
  /// A frame of a higher novelty (Classifier::novelty) shows an unknown place; 0: never.
  double max_novelty = 0.0;
  PoseFilterParams poses;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

struct Recognition {
  bool descriptive = true;  ///< false: the image was rejected and the filter was not updated
  bool novel = false;       ///< the place is unknown and the filter was not updated
  double novelty = 0.0;     ///< Classifier::novelty
  int frame_place = -1;     ///< most likely by this frame alone; -1: not descriptive, or novel
  PlaceEstimate estimate;   ///< by all frames
};

/// Recognizes the places of one stream of images. After the first frame no memory is allocated,
/// other than by the descriptor's library.
class ImageRecognizer {
 public:
  /// @param transitions those of the model's places, in the model's order (reordered()).
  /// @throws hyselam::InputError for other places, and for the filter kPoses with a model without
  ///   exemplars and poses; hyselam::ParameterError.
  ImageRecognizer(const PlaceModel& model, const PlaceTransitions& transitions,
                  const ImageRecognizerParams& params);

  /// @throws hyselam::InputError (Descriptor::compute).
  Recognition update(const cv::Mat& image, const SensorReadings& readings = {});
  /// The part after the descriptor, for a signature that is computed already.
  Recognition updateWithSignature(const float* signature, const SensorReadings& readings = {});
  /// Forgets all frames.
  void reset();

  const std::vector<std::string>& places() const { return places_; }
  /// Of each place, by the last frame alone.
  const std::vector<double>& frameProbabilities() const { return frame_; }
  /// Of each place, by all frames.
  const std::vector<double>& probabilities() const {
    return by_poses_ ? poses_->probabilities() : filter_.probabilities();
  }
  /// Squared distances of the last frame to all samples; null where the classifier has none.
  const std::vector<float>* distances() const { return classifier_->distances(); }
  /// What each part of the last frame said; null where the classifier does not tell them apart.
  const std::vector<PartOpinion>* opinions() const { return classifier_->opinions(); }
  /// Its colors lie outside of what was learned, what is independent of light does not: the frame
  /// was taken in a light that was not learned.
  bool lightIsUnlearned() const;
  /// Why the filter kAuto does not use the poses that the model has; empty if it does, if there are
  /// none, or with another filter.
  const std::string& posesProblem() const { return poses_problem_; }
  const std::vector<float>& signature() const { return signature_; }

 private:
  PlaceEstimate estimate() const {
    return mostLikelyPlace(probabilities(), transitions_, params_.filter);
  }
  void updatePoses(const SensorReadings& readings);

  ImageRecognizerParams params_;
  std::vector<std::string> places_;
  std::unique_ptr<Descriptor> descriptor_;
  std::unique_ptr<Classifier> classifier_;
  DescriptiveFilter descriptive_;
  PlaceTransitions transitions_;
  PlaceFilter filter_;
  std::unique_ptr<PoseFilter> poses_;  // null with all other filters
  std::string poses_problem_;
  bool by_poses_ = false;  // the last frame
  double last_stamp_;      // NaN: not known
  std::vector<float> signature_;
  std::vector<double> frame_;
};

}  // namespace selovis
