#include "learnt_projection.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/numbers.hpp"
#include "shipped_projection.hpp"

namespace selovis {
namespace {

constexpr std::size_t kMostMebibytes = 2, kMostInputs = 16, kMostValues = 4096;
constexpr int kLargestWeight = 127;

double numberIn(hyselam::ModelLines& lines, std::string_view field, double least, double most) {
  const auto value = hyselam::parseNumber(field);
  if (!value || !(*value >= least && *value <= most)) {
    lines.fail("holds '" + hyselam::printable(field) + "' instead of a number in range");
  }
  return *value;
}

}  // namespace

const LearntProjection& LearntProjection::shipped() {
  static const LearntProjection projection =
      parse(kShippedProjection[0].text, "models/learnt_projection.txt");
  return projection;
}

// After the origin: the parts, then a line for each value: offset, unit, weights in that unit.
LearntProjection LearntProjection::parse(std::string_view text, const std::string& source) {
  hyselam::ModelLines lines(text, source, "learnt projection", kMostMebibytes);
  LearntProjection p;
  p.origin_ = lines.head("selovis learnt projection 1");
  const std::size_t inputs = lines.countOf("inputs", kMostInputs);
  for (std::size_t i = 0; i < inputs; ++i) {
    const auto fields = lines.nextFields();
    if (fields.size() != 3) lines.fail("is not a name, a size and a power");
    SignaturePart part;
    part.name = std::string(fields[0]);
    part.size = static_cast<int>(numberIn(lines, fields[1], 1.0, kMostValues));
    part.power = numberIn(lines, fields[2], 0.0, 1.0);
    p.width_ += static_cast<std::size_t>(part.size);
    p.inputs_.push_back(std::move(part));
  }
  const std::size_t values = lines.countOf("values", kMostValues);
  p.weights_.reserve(values * p.width_);
  for (std::size_t v = 0; v < values; ++v) {
    const auto fields = lines.nextFields();
    if (fields.size() != p.width_ + 2) {
      lines.fail("has " + std::to_string(fields.size()) + " numbers instead of " +
                 std::to_string(p.width_ + 2));
    }
    constexpr double kMost = 1e6;
    p.offsets_.push_back(static_cast<float>(numberIn(lines, fields[0], -kMost, kMost)));
    const double unit = numberIn(lines, fields[1], 0.0, kMost);
    for (std::size_t i = 2; i < fields.size(); ++i) {
      p.weights_.push_back(
          static_cast<float>(unit * numberIn(lines, fields[i], -kLargestWeight, kLargestWeight)));
    }
  }
  lines.end("values");
  return p;
}

void LearntProjection::project(const std::vector<float>& parts, float* out) const {
  double square = 0.0;
  for (std::size_t v = 0; v < offsets_.size(); ++v) {
    out[v] = offsets_[v] + dot(weights_.data() + v * width_, parts.data(), width_);
    square += static_cast<double>(out[v]) * static_cast<double>(out[v]);
  }
  const float factor = square > 1e-24 ? static_cast<float>(1.0 / std::sqrt(square)) : 0.0f;
  for (std::size_t v = 0; v < offsets_.size(); ++v) out[v] *= factor;
}

}  // namespace selovis
