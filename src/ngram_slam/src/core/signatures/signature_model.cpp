#include <algorithm>
#include <cmath>
#include <locale>
#include <optional>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"
#include "hyselam_common/numbers.hpp"
#include "ngram_slam/signatures/place_signature.hpp"

namespace ngram_slam {

namespace {

constexpr const char* kMagic = "ngram_slam place signatures 2";
constexpr const char* kSumName = "crc32 ";
constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
constexpr double kLargest = 1e6;  // of any number of a model
// A value is told up to so many standard deviations among all places.
constexpr double kTold = 4.0;

struct OriginLine {
  const char* name;
  std::string SignatureOrigin::*member;
};
constexpr std::array<OriginLine, 4> kOriginLines{
    {{"command: ", &SignatureOrigin::command},
     {"data: ", &SignatureOrigin::data},
     {"in sample: ", &SignatureOrigin::in_sample},
     {"out of sample: ", &SignatureOrigin::out_of_sample}}};

struct SensorField {
  const char* name;
  double SignatureSensorParams::*member;
};
constexpr std::array<SensorField, 3> kSensorFields{
    {{"spacing", &SignatureSensorParams::spacing},
     {"half_window", &SignatureSensorParams::half_window},
     {"resolution", &SignatureSensorParams::resolution}}};

/// What the signatures are made of: parameters of the sensor, and what is fixed.
std::string sensorLine(const SignatureSensorParams& sensor) {
  std::ostringstream out;
  out.imbue(std::locale::classic());  // whatever the process writes numbers like
  out << "sensor:";
  for (const SensorField& f : kSensorFields) out << " " << f.name << " " << sensor.*f.member;
  out << " range " << PlaceFeatures::kRange << " kernels";
  for (const double bandwidth : PlaceFeatures::kBandwidths) out << " " << bandwidth;
  return out.str();
}

/// The parameters in a line that sensorLine() could have made; nothing for any other.
std::optional<SignatureSensorParams> parseSensor(std::string_view line) {
  SignatureSensorParams sensor;
  std::vector<std::string_view> fields;
  hyselam::splitFields(line, &fields);
  if (fields.size() < 1 + 2 * kSensorFields.size()) return std::nullopt;
  for (std::size_t i = 0; i < kSensorFields.size(); ++i) {
    const auto value = hyselam::parseNumber(fields[2 + 2 * i]);
    if (!value) return std::nullopt;
    sensor.*kSensorFields[i].member = *value;
  }
  if (line != sensorLine(sensor)) return std::nullopt;
  try {
    sensor.validate();
  } catch (const hyselam::ParameterError&) {
    return std::nullopt;
  }
  return sensor;
}

std::string sizesLine() {
  return "features: " + std::to_string(SignatureFeatures::kSize) +
         " values: " + std::to_string(PlaceSignature::kSize);
}

/// Six digits: the model in memory is the one that is read back.
std::string shortText(float value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << static_cast<double>(value);
  return out.str();
}

/// As it is written: what is refused when it is read is refused here.
float rounded(const char* name, float value, double least) {
  const auto written = hyselam::parseNumber(shortText(value));
  if (!written || !(*written > least && *written < kLargest)) {
    throw hyselam::ParameterError(name, static_cast<double>(value),
                                  least < 0.0 ? "finite, below 1e6" : "above 1, below 1e6");
  }
  return static_cast<float>(*written);
}

}  // namespace

SignatureModel::SignatureModel(std::vector<Row> rows, std::vector<float> offsets,
                               std::vector<float> variances, const SignatureSensorParams& sensor,
                               SignatureOrigin origin)
    : rows_(std::move(rows)),
      offsets_(std::move(offsets)),
      variances_(std::move(variances)),
      sensor_((sensor.validate(), sensor)),
      origin_(std::move(origin)) {
  if (rows_.size() != kSize || offsets_.size() != kSize || variances_.size() != kSize) {
    throw hyselam::ParameterError("rows", rows_.size(), std::to_string(kSize));
  }
  for (Row& row : rows_) {
    for (float& value : row) value = rounded("weight", value, -kLargest);
  }
  double constant = 0.0;
  for (std::size_t i = 0; i < kSize; ++i) {
    offsets_[i] = rounded("offset", offsets_[i], -kLargest);
    variances_[i] = rounded("variance", variances_[i], 1.0);
    const double all = std::max(1.0 + 1e-6, static_cast<double>(variances_[i])), shared = all - 1.0;
    const double determinant = all * all - shared * shared;
    const double step = kTold * std::sqrt(all) / 127.0;
    steps_.push_back(static_cast<float>(step));
    constant -= 0.5 * (std::log(determinant) - 2.0 * std::log(all));
    square_[i] = static_cast<float>(-0.5 * (all / determinant - 1.0 / all) * step * step);
    cross_[i] = static_cast<float>(shared / determinant * step * step);
  }
  constant_ = static_cast<float>(constant);
}

void SignatureModel::requireSensor(const SignatureSensorParams& sensor) const {
  for (const SensorField& f : kSensorFields) {
    const double given = sensor.*f.member, learnt = sensor_.*f.member;
    if (std::abs(given - learnt) <= 1e-6 * learnt) continue;
    std::ostringstream expected;
    expected << learnt << ", with which the model of the signatures was learnt";
    throw hyselam::ParameterError(f.name, given, expected.str());
  }
}

PlaceSignature SignatureModel::signatureOf(const PlaceFeatures& features) const {
  const SignatureFeatures::Vector x = SignatureFeatures::of(features);
  PlaceSignature signature;
  for (std::size_t i = 0; i < kSize; ++i) {
    float sum = offsets_[i];
    for (std::size_t k = 0; k < x.size(); ++k) sum += rows_[i][k] * x[k];
    signature.values[i] =
        static_cast<std::int8_t>(std::lround(std::clamp(sum / steps_[i], -127.0F, 127.0F)));
  }
  return signature;
}

float SignatureModel::own(const PlaceSignature& s) const {
  float sum = 0.0F;
  for (std::size_t i = 0; i < kSize; ++i) {
    const auto v = static_cast<float>(s.values[i]);
    sum += square_[i] * v * v;
  }
  return sum;
}

double SignatureModel::logRatio(const PlaceSignature& a, const PlaceSignature& b) const {
  double sum = constant_ + own(a) + own(b);
  for (std::size_t i = 0; i < kSize; ++i) {
    sum += static_cast<double>(cross_[i] * static_cast<float>(a.values[i]) *
                               static_cast<float>(b.values[i]));
  }
  return sum;
}

std::string SignatureModel::text() const {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << kMagic << "\n";
  for (const OriginLine& line : kOriginLines) out << line.name << origin_.*line.member << "\n";
  out << sensorLine(sensor_) << "\n" << sizesLine() << "\n";
  for (std::size_t i = 0; i < kSize; ++i) {
    out << shortText(variances_[i]) << " " << shortText(offsets_[i]);
    for (const float weight : rows_[i]) out << " " << shortText(weight);
    out << "\n";
  }
  const std::string body = out.str();
  return body + kSumName + hyselam::crc32Text(body) + "\n";
}

void SignatureModel::save(const std::string& path) const {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) { out << text(); });
}

SignatureModel SignatureModel::load(const std::string& path) {
  return parse(hyselam::readTextFile(path, kMaxBytes), path);
}

SignatureModel SignatureModel::parse(std::string_view text, const std::string& source) {
  const auto refuse = [&](std::size_t line, const std::string& reason) {
    throw hyselam::InputError(source, "line " + std::to_string(line), reason);
  };
  const std::size_t sum = text.rfind(kSumName);
  const std::string_view first = text.substr(0, text.find('\n'));
  if (first != kMagic) refuse(1, hyselam::formatRefusal(first, kMagic));
  if (sum == std::string_view::npos ||
      text.substr(sum) != kSumName + hyselam::crc32Text(text.substr(0, sum)) + "\n") {
    throw hyselam::InputError(source, "end", "is damaged or cut off (wrong checksum)");
  }
  std::vector<Row> rows;
  std::vector<float> offsets, variances;
  SignatureOrigin origin;
  SignatureSensorParams sensor;
  constexpr std::size_t kHead = 3 + kOriginLines.size();
  std::vector<std::string_view> fields;
  hyselam::forEachLine(text.substr(0, sum), [&](std::size_t number, std::string_view line) {
    if (number == 1) return;
    if (number == kHead - 1) {
      const auto given = parseSensor(line);
      if (!given) refuse(number, "is not like \"" + sensorLine(sensor) + "\"");
      sensor = *given;
      return;
    }
    if (number < kHead) {
      const OriginLine& expected = kOriginLines[number - 2];
      const std::string_view name = expected.name;
      if (line.substr(0, name.size()) != name)
        refuse(number, "has no \"" + std::string(name) + "\"");
      origin.*expected.member = std::string(line.substr(name.size()));
      return;
    }
    if (number == kHead) {
      if (line != sizesLine()) refuse(number, "is not \"" + sizesLine() + "\"");
      return;
    }
    hyselam::splitFields(line, &fields);
    if (rows.size() == kSize || fields.size() != SignatureFeatures::kSize + 2) {
      refuse(number, "has " + std::to_string(fields.size()) + " numbers instead of " +
                         std::to_string(SignatureFeatures::kSize + 2) + ", or is one too many");
    }
    Row row{};
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto value = hyselam::parseNumber(fields[i]);
      if (!value || std::abs(static_cast<double>(static_cast<float>(*value))) >= kLargest) {
        refuse(number, "holds '" + hyselam::printable(fields[i]) + "' instead of a number");
      }
      const auto given = static_cast<float>(*value);
      if (i == 0 && !(given > 1.0F)) refuse(number, "has a variance that is not above 1");
      if (i == 0) variances.push_back(given);
      if (i == 1) offsets.push_back(given);
      if (i >= 2) row[i - 2] = given;
    }
    rows.push_back(row);
  });
  if (rows.size() != kSize) {
    throw hyselam::InputError(
        source, "end",
        "has " + std::to_string(rows.size()) + " values instead of " + std::to_string(kSize));
  }
  return {std::move(rows), std::move(offsets), std::move(variances), sensor, std::move(origin)};
}

}  // namespace ngram_slam
