#include "selovis/recogniser.hpp"

#include <algorithm>
#include <stdexcept>

#include "hyselam_common/errors.hpp"

namespace selovis {

Recogniser::Recogniser(const Model& model, const PlaceGraph& graph, const RecogniserParams& params)
    : params_(params),
      places_(model.graph.places),
      descriptor_(model.makeDescriptor()),
      classifier_(model.makeClassifier()),
      descriptive_(params.descriptive),
      filter_(graph, params.filter),
      signature_(static_cast<std::size_t>(descriptor_->size())),
      frame_(places_.size(), 0.0) {
  if (graph.places != places_) {
    throw std::invalid_argument("the graph's places are not those of the model");
  }
  if (!(params.novelty_max >= 0.0)) {
    throw hyselam::ParameterError("novelty_max", params.novelty_max, "0 or more");
  }
}

Recognition Recogniser::update(const cv::Mat& image, const Readings& readings) {
  if (!descriptive_.accepts(image)) {
    Recognition result;
    result.descriptive = false;
    result.estimate = filter_.estimate();
    filter_.skip();
    return result;
  }
  descriptor_->compute(image, readings, signature_.data());
  return updateWithSignature(signature_.data());
}

Recognition Recogniser::updateWithSignature(const float* signature) {
  Recognition result;
  classifier_->predict(signature, frame_.data());
  result.novelty = classifier_->novelty();
  if (params_.novelty_max > 0.0 && result.novelty > params_.novelty_max) {
    result.novel = true;
    filter_.skip();
    return result;  // the place is unknown
  }
  result.frame_place =
      static_cast<int>(std::max_element(frame_.begin(), frame_.end()) - frame_.begin());
  filter_.update(frame_.data());
  result.estimate = filter_.estimate();
  return result;
}

}  // namespace selovis
