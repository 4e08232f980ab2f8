// Visual signatures: an image, and what else the robot senses with it, as a vector (dos Santos
// 2014, 6.3).
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"
#include "selovis/classifiers/samples.hpp"
#include "selovis/descriptors/lbp.hpp"

namespace selovis {

/// The sensor readings that go with one image. Those that a descriptor does not need may be
/// missing.
struct SensorReadings {
  /// Distances [m] across the camera's field of view, from the left edge of the image to the right,
  /// evenly spread over its columns. NaN and infinity: no return.
  std::vector<float> ranges;
  /// A whole laser scan [m], right to left, always the same beams.
  std::vector<float> scan;
  /// Heading against magnetic north [rad].
  double heading = std::numeric_limits<double>::quiet_NaN();
  /// Magnetic field in the camera's frame [T], or any unit, always the same.
  std::array<double, 3> magnetic{{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}};
  /// Pose of the camera in the odometry frame, which drifts but does not jump. For filters over
  /// time.
  std::optional<hyselam::Pose2> odometry;
  /// Time of the image [s].
  double stamp = std::numeric_limits<double>::quiet_NaN();
};

/// Which readings a descriptor needs beside the image.
struct RequiredReadings {
  bool ranges = false, scan = false, heading = false, magnetic = false;
};

/// Number of ranges that are taken from a depth image where a list or topic has no others.
constexpr int kDepthColumns = 20;

/// Ranges across a depth image (16 bits, millimeters along the optical axis, 0: none): in each of
/// `n` bands of columns the 10 % quantile of the half of the rows around the horizon [m].
/// @throws hyselam::InputError.
std::vector<float> rangesOfDepth(const cv::Mat& depth, int n);

struct DescriptorParams {
  LbpParams lbp;
  int value_min = 40;           ///< delta_v of Eq. 6.13, 0 to 255
  int saturation_min = 40;      ///< delta_s of Eq. 6.13, 0 to 255
  double near_range = 1.0;      ///< end of the first section of sLBP [m], above 0
  double middle_range = 2.0;    ///< end of the second section of sLBP [m], at least near_range
  double range_max = 10.0;      ///< ranges are clipped to it and divided by it (An, scan) [m]
  double heading_weight = 1.0;  ///< of the bins psi and [psi], 0 to 1000
  double range_weight = 1.0;    ///< of the bins An and scan, 0 to 1000
  int threads = 1;              ///< of LBPbyHSV, 1 to 64; the result does not depend on it

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError.
  void validate() const;
};

/// One kind of signature. An object keeps its buffers between frames: one per thread.
class Descriptor {
 public:
  virtual ~Descriptor() = default;

  /// Length of the vector.
  virtual int size() const = 0;
  /// Writes size() finite values.
  /// @throws hyselam::InputError for an image that does not suit (gray where color is needed, not
  ///   8-bit, empty), or a reading that is missing.
  virtual void compute(const cv::Mat& image, const SensorReadings& readings, float* out) = 0;
  virtual RequiredReadings requiredReadings() const { return {}; }
  /// What the signature is made of, in order; the sizes add up to size().
  virtual std::vector<SignaturePart> parts() const { return {{"", size(), 0.5}}; }

  /// Descriptors with a dictionary learn it from training images before the first compute().
  virtual bool needsDictionary() const { return false; }
  /// @throws hyselam::InputError where the images have too few features.
  virtual void learnDictionary(const std::vector<cv::Mat>& images, std::uint64_t seed);
  /// For model files; empty if there is none.
  virtual std::vector<float> dictionary() const { return {}; }
  /// @throws hyselam::InputError where the number of values does not fit.
  virtual void setDictionary(const std::vector<float>& values);

  std::vector<float> compute(const cv::Mat& image, const SensorReadings& readings = {}) {
    std::vector<float> out(static_cast<std::size_t>(size()));
    compute(image, readings, out.data());
    return out;
  }
};

// clang-format off
/// Makes a descriptor by its name in the thesis. Terms joined by '+' are concatenated.
///
/// | name | signature |
/// |---|---|
/// | LBPbyHSV-XnY | X: U or S; n colors, 3 to 16; Y: N, U or S; then nothing, -D, -IRIS or -IRIS-VP |
/// | hLBP | LBPbyHSV-U8N-IRIS |
/// | sLBP-(N)LRFn | also (A), (S); n columns with a mean range each |
/// | LBP8,R, LBP8,R-u | LBP of the gray image, 256 or 59 values |
/// | CENTRIST | LBP8,1 with the bare center |
/// | HSV-LBP, HSV-LBP-u, SLBP | LBP of the HSV channels; of a spatial pyramid |
/// | HSV-GIST, HSV-GISTs | GIST of an image of 32 x 32, or s x s pixels |
/// | BOF-SIFTn, BOF-ORBn | bag of n features; with -D for whole, top and bottom |
/// | SV-GIST | GIST of saturation and brightness |
/// | HSV-HIST | histogram of 16 hues, 4 saturations, 4 values |
/// | LOGCHROMA | layout of log-chromaticities, their means taken out (of this package) |
/// | RANKS | layout of the ranks of colors by channel (of this package) |
/// | GRAY | gray thumbnail of 32 x 24, mean and contrast taken out |
/// | LGOP | log-gradient orientation pyramid (of this package) |
/// | GLANCE | LGOP and GIST without hue (of this package) |
/// | FUSION | the terms of kFusionTerms, of an image at most 320 wide, for the kernel `fusion` |
/// | FUSION-LEARNT | FUSION and LEARNT, a projection of four of its parts whose weights were learnt elsewhere |
/// | psi, [psi], An | heading; magnetic field and its magnitude; n ranges. Also written with a Greek psi |
/// | scan | the whole laser scan in 61 groups of beams (of this package) |
///
/// @throws hyselam::InputError with the name and what is wrong with it; hyselam::ParameterError.
// clang-format on
std::unique_ptr<Descriptor> makeDescriptor(const std::string& name,
                                           const DescriptorParams& params = {});

/// What FUSION consists of.
extern const char* const kFusionTerms;

/// The names that `train --list` prints.
std::vector<std::string> descriptorNames();

}  // namespace selovis
