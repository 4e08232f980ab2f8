// The signature of a place in bytes, and how features become one: learnt once, shipped as data.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ngram_slam/signatures/place_features.hpp"
#include "ngram_slam/signatures/signature_sensor.hpp"

namespace ngram_slam {

/// Values that tell places apart best first. Steps of equal size for each value, see
/// SignatureModel.
struct PlaceSignature {
  static constexpr std::size_t kSize = 64;
  std::array<std::int8_t, kSize> values{};

  bool operator==(const PlaceSignature& o) const { return values == o.values; }
};

/// The features as a list of numbers that are the same whichever way the robot faces: the
/// densities; the magnitudes of the spectrum of the logarithm of the free distances; for each ring
/// the magnitudes of the spectrum of its sectors.
class SignatureFeatures {
 public:
  static constexpr std::size_t kDistanceWaves = 25;  ///< of the spectrum, with the constant one
  static constexpr std::size_t kContextWaves = 9;
  static constexpr std::size_t kSize =
      PlaceFeatures::kBandwidths.size() + kDistanceWaves + PlaceFeatures::kRings * kContextWaves;
  using Vector = std::array<float, kSize>;

  static Vector of(const PlaceFeatures& features);
};

/// Where a model comes from.
struct SignatureOrigin {
  std::string command, data, in_sample, out_of_sample;
};

/// What is learnt: an affine map from the features to values that vary by 1 (standard deviation)
/// between two visits of one place and by more between places; each value's variance among all
/// places; and how sure a match is by what the scans say of it.
///
/// Two signatures are compared by the logarithm of a ratio of likelihoods: of both values at one
/// place, and of each by itself. Both are taken as normal distributions, so values that agree count
/// the more the rarer they are ("probabilistic linear discriminant analysis": Prince and Elder,
/// ICCV 2007).
class SignatureModel {
 public:
  static constexpr std::size_t kSize = PlaceSignature::kSize;
  using Row = SignatureFeatures::Vector;

  /// `rows`: of the map; `offsets`: added; `variances`: of the values among all places, above 1;
  /// `sensor`: what made the features that it was learnt from.
  /// @throws hyselam::ParameterError for numbers that are not finite or out of range.
  SignatureModel(std::vector<Row> rows, std::vector<float> offsets, std::vector<float> variances,
                 const SignatureSensorParams& sensor = {}, SignatureOrigin origin = {});
  /// The model that comes with the package.
  static const SignatureModel& shipped();
  /// @throws hyselam::InputError for a file that cannot be read or is damaged.
  static SignatureModel load(const std::string& path);
  static SignatureModel parse(std::string_view text, const std::string& source);
  /// @throws hyselam::InputError
  void save(const std::string& path) const;
  std::string text() const;

  PlaceSignature signatureOf(const PlaceFeatures& features) const;
  /// Log of the ratio of likelihoods: above 0 where one place is likelier than two.
  double logRatio(const PlaceSignature& a, const PlaceSignature& b) const;
  /// One unit of a value in its standard deviations between visits.
  const std::vector<float>& steps() const { return steps_; }
  const std::vector<float>& variances() const { return variances_; }
  const SignatureOrigin& origin() const { return origin_; }
  const SignatureSensorParams& sensor() const { return sensor_; }
  /// Features of another sensor mean something else.
  /// @throws hyselam::ParameterError unless `sensor` makes them as that of the model does.
  void requireSensor(const SignatureSensorParams& sensor) const;

  /// logRatio() is constant() + own(a) + own(b) + the sum of cross()[i] * a[i] * b[i].
  float constant() const { return constant_; }
  float own(const PlaceSignature& s) const;
  const std::array<float, kSize>& cross() const { return cross_; }

 private:
  std::vector<Row> rows_;
  std::vector<float> offsets_, variances_;
  SignatureSensorParams sensor_;
  SignatureOrigin origin_;
  std::vector<float> steps_;
  float constant_ = 0.0F;
  std::array<float, kSize> square_{}, cross_{};
};

}  // namespace ngram_slam
