// The learnt part of a signature: a linear projection of some of its other parts, learnt so that
// frames of one place come near each other, in whatever light, and those of other places far.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hyselam_common/model_text.hpp"
#include "selovis/classifiers/samples.hpp"

namespace selovis {

class LearntProjection {
 public:
  /// That this package comes with (models/learnt_projection.txt).
  static const LearntProjection& shipped();
  /// @throws hyselam::InputError with `source` and the line.
  static LearntProjection parse(std::string_view text, const std::string& source);

  /// Number of values.
  int size() const { return static_cast<int>(offsets_.size()); }
  /// Names, sizes and powers of the parts that are projected, in this order.
  const std::vector<SignaturePart>& inputs() const { return inputs_; }
  const hyselam::ModelOrigin& origin() const { return origin_; }

  /// @param parts the inputs one after the other, each value raised to its part's power.
  /// @param out size() values, together of length 1.
  void project(const std::vector<float>& parts, float* out) const;

 private:
  hyselam::ModelOrigin origin_;
  std::vector<SignaturePart> inputs_;
  std::size_t width_ = 0;       // of a row
  std::vector<float> weights_;  // row by row
  std::vector<float> offsets_;
};

}  // namespace selovis
