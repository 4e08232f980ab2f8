// What a fusion learns beside its exemplars: how far each part is to be trusted.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "part_exemplars.hpp"
#include "selovis/classifiers/classifier.hpp"

namespace selovis {

/// Of one part.
struct PartCalibration {
  /// Exponent of the part's place probabilities, the inverse of their temperature: where frames lie
  /// as far from learned ones as another tour's do, and where they lie as near as the next frame.
  double weight = 1.0, near_weight = 1.0;
  /// Squared nearest distances of the learned frames that were left out: the median, and the
  /// largest. From the median to the largest the weight falls to 0.
  double median = 0.0, largest = std::numeric_limits<double>::infinity();
  double near_median = 0.0;  ///< the same with but a few frames about them left out
  double accuracy = 0.0;     ///< of the part alone on the frames left out
};

struct FusionCalibration {
  /// What was left out to learn it: "tours", "stretches" of the one tour, or "nothing": there was
  /// too little, and the weights are those that other environments suggest.
  std::string left_out = "nothing";
  std::size_t frames = 0;  ///< so many frames were asked for
  /// Of the sum: learned with more and fewer frames left out, then lowered to what later tours
  /// need.
  double temperature = 1.0;
  std::vector<PartCalibration> parts;
  double accuracy = 0.0;  ///< of the fusion on the frames left out
  double log_loss = 0.0;  ///< mean negative logarithm of the right place's probability
  /// A novelty that 5 % of the frames left out exceed, and the share of frames that exceed it when
  /// their whole place is left out: what "unknown" can be expected to notice.
  double unknown_novelty = 0.0, unknown_noticed = 0.0;
};

/// Logarithms of the place probabilities of one part, from its neighbors: soft nearest neighbors
/// with `beta`, and a floor.
void placeLogLikelihoods(const std::vector<Neighbor>& nearest, const std::vector<int>& labels,
                         double beta, std::vector<double>& out);

/// The weights of the parts for a frame with these squared nearest distances: between those for far
/// and near frames, by the median over the parts of where the distance lies between their medians.
/// @param weights one for each part.
void weightsAt(const FusionCalibration& calibration, const std::vector<double>& nearest,
               std::vector<double>& weights);

/// The share of a part's weight at a squared nearest distance, 1 to 0.
double rangeShare(const PartCalibration& part, double nearest);

/// Weighs the parts by range: parts that count colors as they are vouch for each other, the least
/// share is that of all. If all shares are 0, each gets a little: the parts still have an order.
void shareByRange(const FusionCalibration& calibration, const std::vector<SignaturePart>& parts,
                  const std::vector<double>& nearest, std::vector<double>& shares);

/// The parts that are asked speak for those that are out of range, up to a limit: what the sum of
/// logarithms is multiplied by. @param weights of all parts, @param asked what range left of it.
double evidenceScale(double weights, double asked);

/// Learns it by leaving frames out: whole tours where several were learned, else stretches of time.
FusionCalibration calibrateFusion(const Samples& samples, int places, double beta,
                                  const FrameIndex& frames, std::vector<PartExemplars>& exemplars);

/// JSON, as it stands in model.json. @throws hyselam::InputError.
std::string toText(const FusionCalibration& calibration, const std::vector<SignaturePart>& parts);
FusionCalibration fusionCalibrationFromText(const std::string& text,
                                            const std::vector<SignaturePart>& parts);

}  // namespace selovis
