#include "hyselam_objects/recognition/object_descriptor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"

namespace hyselam_objects {
namespace {

constexpr std::size_t kSizes = 3, kDistances = 16, kHues = 12, kGreys = 4;
constexpr float kDistanceBin = 0.03f;  // [m]
constexpr int kPairs = 2000;
// Weights of the parts in a distance; each part alone is at most about 1.
constexpr float kSizeWeight = 1.2f, kShapeWeight = 0.25f, kColourWeight = 0.45f;
// Less saturated than this is gray.
constexpr float kLeastSaturation = 0.25f, kLeastValue = 0.12f;

struct Hsv {
  float hue = 0.0f;  // 0 .. 1
  float saturation = 0.0f;
  float value = 0.0f;
};

Hsv toHsv(std::uint32_t rgb) {
  const float r = static_cast<float>(rgb >> 16 & 255u) / 255.0f;
  const float g = static_cast<float>(rgb >> 8 & 255u) / 255.0f;
  const float b = static_cast<float>(rgb & 255u) / 255.0f;
  const float high = std::max({r, g, b}), low = std::min({r, g, b}), span = high - low;
  Hsv out{0.0f, high > 0.0f ? span / high : 0.0f, high};
  if (span <= 0.0f) return out;
  float hue = high == r   ? (g - b) / span
              : high == g ? 2.0f + (b - r) / span
                          : 4.0f + (r - g) / span;
  if (hue < 0.0f) hue += 6.0f;
  out.hue = hue / 6.0f;
  return out;
}

void add(float* histogram, std::size_t bins, float at, bool around, float weight) {
  // Shared by the two bins whose middles are nearest.
  const float place = at * static_cast<float>(bins) - 0.5f;
  const float low = std::floor(place), share = place - low;
  const auto bin = [&](float index) {
    const int n = static_cast<int>(bins), i = static_cast<int>(index);
    return static_cast<std::size_t>(around ? (i + n) % n : std::clamp(i, 0, n - 1));
  };
  histogram[bin(low)] += weight * (1.0f - share);
  histogram[bin(low + 1.0f)] += weight * share;
}

/// Length of a whole object and its standard deviation from those of single views, some of which
/// show a part: of the larger half the middle.
std::pair<double, double> wholeLength(std::vector<double> lengths) {
  std::sort(lengths.begin(), lengths.end());
  const std::size_t half = lengths.size() / 2;
  const double whole = lengths[half + (lengths.size() - half) / 2];
  double squares = 0.0;
  for (std::size_t i = half; i < lengths.size(); ++i) {
    squares += (lengths[i] - whole) * (lengths[i] - whole);
  }
  return {whole, std::sqrt(squares / static_cast<double>(lengths.size() - half))};
}

}  // namespace

std::vector<float> describeView(const std::vector<Eigen::Vector3f>& points,
                                const std::vector<std::uint32_t>& colors, std::uint64_t seed) {
  if (points.size() < 10) return {};
  std::vector<float> out(kDescriptorSize, 0.0f);
  Eigen::Vector3f low = points.front(), high = low;
  Eigen::Vector2f mean = Eigen::Vector2f::Zero();
  for (const Eigen::Vector3f& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    mean += p.head<2>();
  }
  // A view shows one side: how wide it is across, not how deep.
  const float across = (high - low).head<2>().maxCoeff(), less = (high - low).head<2>().minCoeff();
  out[0] = kSizeWeight * across;
  out[1] = 0.5f * kSizeWeight * less;
  out[2] = kSizeWeight * (high.z() - low.z());

  hyselam::Rng rng(seed);
  float* shape = out.data() + kSizes;
  const auto n = static_cast<std::uint32_t>(points.size());
  for (int i = 0; i < kPairs; ++i) {
    const float d = (points[rng.below(n)] - points[rng.below(n)]).norm();
    add(shape, kDistances, std::min(d / (kDistanceBin * kDistances), 0.999f), false,
        kShapeWeight / kPairs);
  }
  if (colors.size() != points.size()) return out;
  float* hues = shape + kDistances;
  float* greys = hues + kHues;
  const float weight = kColourWeight / static_cast<float>(points.size());
  for (const std::uint32_t rgb : colors) {
    const Hsv c = toHsv(rgb);
    if (c.saturation > kLeastSaturation && c.value > kLeastValue) {
      add(hues, kHues, c.hue, true, weight);
    } else {
      add(greys, kGreys, c.value, false, weight);
    }
  }
  return out;
}

double descriptorDistance(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.size() != b.size() || a.empty()) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(static_cast<double>(a[i]) - b[i]);
  return sum;
}

std::string colorName(const std::vector<std::uint32_t>& colors) {
  if (colors.empty()) return "";
  constexpr std::array<const char*, 12> kNames{"red",   "orange", "yellow", "green",
                                               "green", "green",  "blue",   "blue",
                                               "blue",  "purple", "pink",   "red"};
  std::array<int, 12> votes{};
  std::array<int, 3> grey{};  // black, grey, white
  for (const std::uint32_t rgb : colors) {
    const Hsv c = toHsv(rgb);
    if (c.saturation > kLeastSaturation && c.value > kLeastValue) {
      ++votes[static_cast<std::size_t>(std::lround(c.hue * 12.0f)) % 12];
    } else {
      ++grey[c.value < 0.25f ? 0u : c.value < 0.75f ? 1u : 2u];
    }
  }
  const auto hue = std::max_element(votes.begin(), votes.end());
  const auto shade = std::max_element(grey.begin(), grey.end());
  if (*shade > *hue) {
    constexpr std::array<const char*, 3> kGreyNames{"black", "grey", "white"};
    return kGreyNames.at(static_cast<std::size_t>(shade - grey.begin()));
  }
  return kNames.at(static_cast<std::size_t>(hue - votes.begin()));
}

std::optional<ObjectRecognition> recognizeObject(const std::vector<float>& view,
                                                 const ObjectDictionary& dictionary) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const GenericObject* best = nullptr;
  double least = kFar, second = kFar;
  for (const GenericObject& object : dictionary.objects) {
    if (object.classifier.type != kDescriptorType) continue;
    double nearest = kFar;
    for (const auto& known : object.classifier.views) {
      nearest = std::min(nearest, descriptorDistance(view, known));
    }
    if (nearest < least) {
      second = least;
      least = nearest;
      best = &object;
    } else {
      second = std::min(second, nearest);
    }
  }
  if (best == nullptr || least > best->classifier.max_distance) return std::nullopt;
  return ObjectRecognition{best->name, least, second - least};
}

void LearnParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("acceptance_factor", acceptance_factor, Range::above(0.0), "",
        "a view is accepted up to this factor times the largest distance between learned views");
  visit("min_acceptance", min_acceptance, Range::atLeast(0.0), "",
        "lower limit of the distance up to which a view is accepted");
  visit("max_views", max_views, Range::atLeast(1), "", "number of views kept of an object");
}

void LearnParams::validate() const {
  hyselam::checkParameters(*this);
}

GenericObject learnObject(const std::string& name, const std::vector<std::vector<float>>& views,
                          const std::vector<Eigen::Vector3d>& sizes, const LearnParams& params) {
  params.validate();
  GenericObject object;
  object.name = name;
  object.classifier.type = kDescriptorType;
  std::vector<std::vector<float>> usable;
  for (const auto& view : views) {
    if (view.size() == kDescriptorSize) usable.push_back(view);
  }
  if (usable.empty()) throw hyselam::InputError("object '" + name + "'", "", "there is no view");

  double widest = 0.0;
  for (std::size_t i = 0; i < usable.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < usable.size(); ++j) {
      if (i != j) nearest = std::min(nearest, descriptorDistance(usable[i], usable[j]));
    }
    if (std::isfinite(nearest)) widest = std::max(widest, nearest);
  }
  object.classifier.max_distance =
      std::max(params.min_acceptance, params.acceptance_factor * widest);

  // Farthest points first: few views that cover all.
  auto& kept = object.classifier.views;
  kept.push_back(usable.front());
  std::vector<double> gap(usable.size(), std::numeric_limits<double>::infinity());
  while (kept.size() < std::min(params.max_views, usable.size())) {
    for (std::size_t i = 0; i < usable.size(); ++i) {
      gap[i] = std::min(gap[i], descriptorDistance(usable[i], kept.back()));
    }
    const auto farthest = std::max_element(gap.begin(), gap.end());
    if (*farthest <= 0.0) break;
    kept.push_back(usable[static_cast<std::size_t>(farthest - gap.begin())]);
  }
  object.texture.assign(kHues + kGreys, 0.0f);
  for (const auto& view : usable) {
    for (std::size_t i = 0; i < object.texture.size(); ++i) {
      object.texture[i] +=
          view[kSizes + kDistances + i] / (kColourWeight * static_cast<float>(usable.size()));
    }
  }
  if (sizes.empty()) return object;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<double> along;
    for (const Eigen::Vector3d& size : sizes) {
      along.push_back(k == 0   ? std::max(size.x(), size.y())
                      : k == 1 ? std::min(size.x(), size.y())
                               : size.z());
    }
    std::tie(object.shape.size[k], object.shape.spread[k]) = wholeLength(std::move(along));
  }
  return object;
}

}  // namespace hyselam_objects
