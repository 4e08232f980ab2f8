// From one frame to a place: filter of images, descriptor, classifier, filter over time.
#pragma once

#include <memory>
#include <vector>

#include "selovis/descriptive.hpp"
#include "selovis/model.hpp"
#include "selovis/place_filter.hpp"
#include "selovis/pose_filter.hpp"

namespace selovis {

struct RecogniserParams {
  DescriptiveParams descriptive;
  PlaceFilterParams filter;  ///< with kPoses a PoseFilter stands in its place
  /// A frame that lies farther from everything learnt than so many times the usual is no witness
  /// (exemplar classifiers); 0: never.
  double novelty_max = 0.0;
  PoseFilterParams poses;
};

struct Recognition {
  bool descriptive = true;  ///< false: the frame told nothing and the filter stood still
  bool novel = false;       ///< nothing learnt fits: the filter stood still, the place is unknown
  double novelty = 0.0;
  int frame_place = -1;    ///< likeliest by this frame alone; -1: not descriptive or novel
  PlaceEstimate estimate;  ///< by all frames
};

/// One stream of frames. The filter of each frame allocates nothing once the first has passed,
/// other than what the descriptor's library needs.
class Recogniser {
 public:
  /// `graph` must have the model's places in the model's order (reordered()); the filter kPoses
  /// needs exemplars with poses. Throws std::invalid_argument.
  Recogniser(const Model& model, const PlaceGraph& graph, const RecogniserParams& params);

  Recognition update(const cv::Mat& image, const Readings& readings = {});
  /// The part after the descriptor, for signatures that are at hand.
  Recognition updateWithSignature(const float* signature, const Readings& readings = {});
  void reset();

  const std::vector<std::string>& places() const { return places_; }
  const std::vector<double>& frameProbabilities() const { return frame_; }
  const std::vector<double>& probabilities() const {
    return poses_ ? poses_->probabilities() : filter_.probabilities();
  }
  const std::vector<float>& signature() const { return signature_; }

 private:
  PlaceEstimate estimate() const { return estimateOf(probabilities(), graph_, params_.filter); }

  RecogniserParams params_;
  std::vector<std::string> places_;
  std::unique_ptr<Descriptor> descriptor_;
  std::unique_ptr<Classifier> classifier_;
  DescriptiveFilter descriptive_;
  PlaceGraph graph_;
  PlaceFilter filter_;
  std::unique_ptr<PoseFilter> poses_;  // null with all other filters
  double last_stamp_;                  // NaN: not known
  std::vector<float> signature_;
  std::vector<double> frame_;
};

}  // namespace selovis
