#pragma once

#include "selovis/learning/place_model.hpp"

namespace selovis {

/// A model of these options before it has seen anything. @throws hyselam::ParameterError for those
/// of the classifier.
inline PlaceModel emptyModel(const TrainingOptions& options) {
  options.classifier.validate();
  PlaceModel model;
  model.descriptor = options.descriptor;
  model.descriptor_params = options.descriptor_params;
  model.classifier = options.classifier;
  model.views = options.views.empty() ? viewsFor(options.classifier.kernel) : options.views;
  model.horizontal_fov = options.horizontal_fov;
  return model;
}

}  // namespace selovis
