// Choice of a classifier's parameters by cross-validation.
#pragma once

#include <functional>
#include <vector>

#include "selovis/classifiers/classifier.hpp"

namespace selovis {

struct GridSearchParams {
  std::vector<double> costs{1.0, 10.0, 100.0};
  std::vector<double> gammas{0.3, 1.0, 3.0, 10.0};
  std::vector<double> betas{3.0, 10.0, 30.0};  ///< of the exemplar classifier
  /// Each fold is made of stretches of consecutive frames, so that neighbors in time stay together;
  /// 2 or more.
  int folds = 4;
  /// The SVM's table of kernel values holds at most so many samples, evenly chosen (5000: 400 MB).
  std::size_t max_samples = 5000;
};

/// `params` with the cost and gamma (beta of the exemplar classifier) of the highest
/// cross-validated accuracy, the first among equals. A fusion is given back as it is.
struct GridSearchResult {
  ClassifierParams params;
  double accuracy = -1.0;
};

/// @param progress is called with (done, all) before each training, and at the end.
/// @throws hyselam::InputError (trainClassifier), hyselam::ParameterError.
GridSearchResult searchGrid(const Samples& samples, int places, const GridSearchParams& grid,
                            const ClassifierParams& params,
                            const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace selovis
