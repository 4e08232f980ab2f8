// Visual signatures: an image, and what else the robot senses with it, as a vector.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "selovis/lbp.hpp"

namespace selovis {

/// What goes with one image. What a descriptor does not need may be missing.
struct Readings {
  /// Distances [m] across the camera's field of view, from the left edge of the image to the right,
  /// evenly spread over its columns. NaN and infinity: no return there.
  std::vector<float> ranges;
  /// A whole laser scan [m], right to left, always the same beams.
  std::vector<float> scan;
  /// Heading against magnetic north [rad].
  double heading = std::numeric_limits<double>::quiet_NaN();
  /// Magnetic field in the camera's frame [T], or any unit, always the same.
  std::array<double, 3> magnetic{{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}};
  /// Of the camera, in a frame that drifts but does not jump. For filters over time.
  std::optional<hyselam::Pose2> odometry;
  /// Time of the image [s].
  double stamp = std::numeric_limits<double>::quiet_NaN();
};

/// What a descriptor needs beside the image.
struct ReadingNeeds {
  bool ranges = false, scan = false, heading = false, magnetic = false;
};
/// By the descriptor's name.
ReadingNeeds needsOf(const std::string& descriptor);

/// So many distances are taken from a depth image where a list or topic has no others.
constexpr int kDepthColumns = 20;

/// Distances across a depth image (16-bit, millimetres along the optical axis, 0 none): the nearest
/// tenth of each of `n` column bands in the rows about the horizon. Throws std::invalid_argument.
std::vector<float> rangesOfDepth(const cv::Mat& depth, int n);

struct DescriptorParams {
  LbpParams lbp;
  int value_min = 40;           ///< delta_v of Eq. 6.13, 0 to 255
  int saturation_min = 40;      ///< delta_s of Eq. 6.13, 0 to 255
  double near_range = 1.0;      ///< [m] first section of sLBP
  double middle_range = 2.0;    ///< [m] second section of sLBP
  double range_max = 10.0;      ///< [m] distances are cut here and divided by it (An, scan)
  double heading_weight = 1.0;  ///< of the bins psi and [psi]
  double range_weight = 1.0;    ///< of the bins An and scan
  int threads = 1;              ///< for LBPbyHSV; the result does not depend on it
};

/// Throws hyselam::ParameterError.
void validate(const DescriptorParams& params);

/// One kind of signature. An object keeps its buffers between frames: one per thread.
class Descriptor {
 public:
  virtual ~Descriptor() = default;

  /// Length of the vector.
  virtual int size() const = 0;
  /// Writes size() finite values. Throws std::invalid_argument: an image that does not suit (grey
  /// where colour is needed, not 8-bit, empty) or a reading that is missing.
  virtual void compute(const cv::Mat& image, const Readings& readings, float* out) = 0;

  /// Descriptors with a dictionary learn it from training images before the first compute().
  virtual bool needsTraining() const { return false; }
  virtual void train(const std::vector<cv::Mat>& images, std::uint64_t seed) {
    (void)images;
    (void)seed;
  }
  /// What was learnt, for model files; empty if nothing is.
  virtual std::vector<float> learnt() const { return {}; }
  /// Throws std::invalid_argument where the numbers do not fit.
  virtual void setLearnt(const std::vector<float>& values) { (void)values; }

  std::vector<float> compute(const cv::Mat& image, const Readings& readings = {}) {
    std::vector<float> out(static_cast<std::size_t>(size()));
    compute(image, readings, out.data());
    return out;
  }
};

/// Makes a descriptor by its name in the thesis. Terms joined by '+' are put one after the other.
///
///   LBPbyHSV-XnY       X: U or S; n colours, 3 to 16; Y: N, U or S; then nothing, -D, -IRIS or
///   -IRIS-VP hLBP               LBPbyHSV-U8N-IRIS sLBP-(N)LRFn       also (A), (S); n columns with
///   a mean distance each LBP8,R  LBP8,R-u   of the grey image, 256 or 59 values; CENTRIST: LBP8,1
///   with the bare centre HSV-LBP  HSV-LBP-u  SLBP  HSV-GIST  HSV-GIST64  HSV-GIST128 BOF-SIFTn
///   BOF-ORBn n words, with -D for whole, top and bottom LGOP               log-gradient
///   orientation pyramid (this package's own) psi  [psi]  An     heading; magnetic field and its
///   magnitude; n distances. Also written ψ scan               the whole laser scan in 61 groups of
///   beams (this package's own)
///
/// Throws std::invalid_argument with the name and what is wrong with it.
std::unique_ptr<Descriptor> makeDescriptor(const std::string& name,
                                           const DescriptorParams& params = {});

/// The names that the tools list.
std::vector<std::string> descriptorNames();

}  // namespace selovis
