// Late fusion: each part of a signature compares with the exemplars by itself and says how likely
// each place is; the logarithms are added, weighted by what each part was worth on learned frames
// that were left out.
#pragma once

#include <string>
#include <vector>

#include "fusion_calibration.hpp"
#include "part_exemplars.hpp"
#include "selovis/classifiers/classifier.hpp"

namespace selovis {

class FusionClassifier : public Classifier {
 public:
  /// Calibrates itself on the samples.
  /// @throws hyselam::InputError for samples without parts.
  FusionClassifier(const Samples& samples, int places, const ClassifierParams& params);
  /// With the calibration that state() gave. @param full_scan compares with all samples, for tests.
  /// @throws hyselam::InputError for another text.
  FusionClassifier(const Samples& samples, int places, const ClassifierParams& params,
                   const std::string& state, bool full_scan = false);

  int places() const override { return places_; }
  void predict(const float* signature, double* probabilities) override;
  double novelty() const override { return novelty_; }
  /// 1 + kViewScale times the weighted mean over the parts of (d^2 - d_min^2) / d_min^2, each at
  /// most kFar: the ratios that PoseFilter takes of squared distances are those of the parts.
  const std::vector<float>* distances() const override;
  const std::vector<PartOpinion>* opinions() const override { return &opinions_; }

  const FusionCalibration& calibration() const { return calibration_; }
  std::string state() const { return toText(calibration_, parts_); }

 private:
  void index(const Samples& samples, bool full_scan);

  int places_;
  ClassifierParams params_;
  std::vector<SignaturePart> parts_;
  std::vector<int> labels_;
  FrameIndex frames_;
  std::vector<PartExemplars> exemplars_;
  FusionCalibration calibration_;
  double novelty_ = 0.0;
  std::vector<double> sum_, log_likelihoods_, nearest_, weights_, shares_;
  std::vector<PartOpinion> opinions_;
  mutable bool distances_known_ = false;
  mutable std::vector<float> distances_, part_distances_, frame_sums_;
  mutable std::vector<char> compared_;  // frames, by any part
  mutable std::vector<std::uint32_t> compared_frames_;
};

}  // namespace selovis
