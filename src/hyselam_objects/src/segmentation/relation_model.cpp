#include "relation_model.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <string_view>
#include <vector>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "shipped_patch_relations.hpp"

namespace hyselam_objects {
namespace {

constexpr const char* kFormat = "hyselam_patch_relations 1";
constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
constexpr double kMostWeight = 1e6;

/// Reads the lines of a model one after another; knows where it is for its messages.
class RelationModelReader {
 public:
  RelationModelReader(const std::string& text, const std::string& source)
      : source_(source), rest_(text) {}

  RelationModel read() {
    if (rest_.size() > kMaxBytes) fail("has more than 1 MiB");
    checkChecksum();
    if (nextLine() != kFormat) fail(std::string("is no '") + kFormat + "'");
    RelationModel model;
    model.origin.command = valueOf("command");
    model.origin.data = valueOf("data");
    model.origin.in_sample = valueOf("in_sample");
    model.origin.left_out = valueOf("left_out");
    readWeights("contact", kContactFeatures, model.with_colors.contact,
                model.without_colors.contact);
    readWeights("bridge", kBridgeFeatures, model.with_colors.bridge, model.without_colors.bridge);
    if (!rest_.empty()) {
      nextLine();
      fail("there is more than the weights");
    }
    return model;
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw hyselam::InputError(source_, line_ == 0 ? "" : "line " + std::to_string(line_), reason);
  }

  /// Takes the last line off: the checksum of all before it.
  void checkChecksum() {
    const std::string_view key = "checksum ";
    const std::size_t last = rest_.rfind(key);
    if (last == std::string_view::npos || (last > 0 && rest_[last - 1] != '\n')) {
      fail("has no checksum: it is cut short, or no file of patch relations");
    }
    const std::string_view body = rest_.substr(0, last);
    if (rest_.substr(last) != std::string(key) + hyselam::crc32Text(body) + "\n") {
      fail("the checksum is wrong: it was damaged or changed by hand");
    }
    rest_ = body;
  }

  std::string_view nextLine() {
    ++line_;
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) fail("it ends too early");
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return line;
  }

  std::string valueOf(const std::string& key) {
    const std::string_view line = nextLine();
    if (line.substr(0, key.size() + 1) != key + " ") fail("'" + key + "' is expected");
    return std::string(line.substr(key.size() + 1));
  }

  double weightOf(std::string_view field) const {
    const auto value = hyselam::parseNumber(field);
    if (!value || !(std::abs(*value) <= kMostWeight)) {
      fail("'" + hyselam::printable(field) + "' is no weight");
    }
    return *value;
  }

  template <std::size_t n>
  void readWeights(const std::string& key, const std::array<RelationFeature, n>& features,
                   std::array<double, n>& with_colors, std::array<double, n>& without_colors) {
    if (valueOf(key) != std::to_string(n)) {
      fail("the features are not the " + std::to_string(n) + " of this version");
    }
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<std::string_view> fields;
      hyselam::splitFields(nextLine(), &fields);
      if (fields.size() != 3 || fields[0] != features[i].name) {
        fail(std::string("the feature '") + features[i].name + "' and two weights are expected");
      }
      with_colors[i] = weightOf(fields[1]);
      without_colors[i] = weightOf(fields[2]);
      if (features[i].of_color && without_colors[i] != 0.0) {
        fail("a feature of color has no weight where colors are not known");
      }
    }
  }

  const std::string& source_;
  std::string_view rest_;
  std::size_t line_ = 0;
};

template <std::size_t n>
void writeWeights(std::ostream& out, const char* key,
                  const std::array<RelationFeature, n>& features,
                  const std::array<double, n>& with_colors,
                  const std::array<double, n>& without_colors) {
  out << key << ' ' << n << '\n';
  for (std::size_t i = 0; i < n; ++i) {
    out << features[i].name << ' ' << with_colors[i] << ' ' << without_colors[i] << '\n';
  }
}

/// What a weighted sum of features says, no more than kMostOdds: no single relation is certain.
template <std::size_t n>
double oddsBy(const std::array<double, n>& weights, const std::array<float, n>& features) {
  constexpr double kMostOdds = 8.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) sum += weights[i] * static_cast<double>(features[i]);
  return std::clamp(sum, -kMostOdds, kMostOdds);
}

}  // namespace

double RelationModel::oddsOfOneObject(const PatchRelation& relation, bool has_colors) const {
  constexpr double kHollow = 6.0;
  const RelationWeights& weights = has_colors ? with_colors : without_colors;
  double odds = relation.is_hollow ? kHollow : 0.0;
  if (relation.touches()) odds += oddsBy(weights.contact, relation.contactFeatures());
  if (relation.isBridged()) odds += oddsBy(weights.bridge, relation.bridgeFeatures());
  return odds;
}

RelationModel RelationModel::fromText(const std::string& text, const std::string& source) {
  return RelationModelReader(text, source).read();
}

const RelationModel& RelationModel::shipped() {
  static const RelationModel model =
      fromText(kShippedPatchRelations[0].text, "shipped patch relations");
  return model;
}

std::string RelationModel::toText() const {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(6);
  out << kFormat << '\n'
      << "command " << origin.command << '\n'
      << "data " << origin.data << '\n'
      << "in_sample " << origin.in_sample << '\n'
      << "left_out " << origin.left_out << '\n';
  writeWeights(out, "contact", kContactFeatures, with_colors.contact, without_colors.contact);
  writeWeights(out, "bridge", kBridgeFeatures, with_colors.bridge, without_colors.bridge);
  const std::string body = out.str();
  return body + "checksum " + hyselam::crc32Text(body) + "\n";
}

}  // namespace hyselam_objects
