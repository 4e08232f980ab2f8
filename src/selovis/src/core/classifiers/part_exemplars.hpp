// The exemplars of one part of the signatures: which learned views are near, and how near.
#pragma once

#include <cstdint>
#include <vector>

#include "selovis/classifiers/samples.hpp"

namespace selovis {

/// The learned frames, each with its views: consecutive samples.
struct FrameIndex {
  explicit FrameIndex(const Samples& samples);
  std::size_t count() const { return begin.size() - 1; }

  std::vector<std::uint32_t> begin;  ///< first sample of each frame, then the number of samples
};

struct Neighbor {
  float distance;  ///< squared
  std::uint32_t sample;
};

/// Nearest neighbors by one part. Signatures are kept in 16-bit integers, so distances are the same
/// on every machine. All frames are looked at in a few principal components of their first view;
/// the views of the frames that are near by these are compared exactly. A few frames, or all if
/// `full_scan`, are compared exactly from the start.
class PartExemplars {
 public:
  /// @param offset where the part begins in a signature.
  PartExemplars(const Samples& samples, const FrameIndex& frames, std::size_t offset,
                const SignaturePart& part, bool full_scan);

  /// The nearest views, the nearest first. @param part of a signature. @param blocked one flag for
  /// each frame: those that are not looked at; may be null.
  /// @returns none if all frames are blocked.
  const std::vector<Neighbor>& search(const float* part,
                                      const std::vector<char>* blocked = nullptr);
  /// What search() answered last.
  const std::vector<Neighbor>& nearest() const { return nearest_; }
  /// The frames whose views were compared exactly by the last search, and these views.
  const std::vector<std::uint32_t>& comparedFrames() const { return order_; }
  const std::vector<Neighbor>& compared() const { return compared_; }
  /// Squared distances of the last signature to all frames, estimated by their first views; only
  /// where not all frames were compared.
  const std::vector<float>& frameDistances() const { return frame_distances_; }

 private:
  void quantize(const float* part, std::int16_t* out);
  float distanceTo(std::uint32_t sample) const;
  void learnComponents();
  void project(const std::int16_t* row, float* out, float* residue);
  void estimate();
  void keepNearest();

  const FrameIndex* frames_;
  std::size_t size_, padded_;
  double power_, scale_;
  std::vector<float> buffer_, centered_;
  std::vector<std::int16_t> rows_, query_;
  std::vector<float> squares_;
  float query_square_ = 0.0f;
  // Principal components of the first views; none: all frames are compared.
  std::vector<float> mean_, components_, codes_, residues_;
  std::vector<float> frame_distances_, few_;
  std::vector<std::uint32_t> order_;
  std::vector<Neighbor> compared_, nearest_;
};

}  // namespace selovis
