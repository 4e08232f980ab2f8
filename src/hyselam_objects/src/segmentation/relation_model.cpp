#include "relation_model.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <string_view>
#include <vector>

#include "hyselam_common/numbers.hpp"
#include "shipped_patch_relations.hpp"

namespace hyselam_objects {
namespace {

constexpr const char* kFormat = "hyselam_patch_relations 1";
constexpr std::size_t kMostMebibytes = 1;
constexpr double kMostWeight = 1e6;

/// Reads the weights of a model.
class RelationModelReader {
 public:
  RelationModelReader(const std::string& text, const std::string& source)
      : lines_(text, source, "file of patch relations", kMostMebibytes) {}

  RelationModel read() {
    RelationModel model;
    model.origin = lines_.head(kFormat);
    readWeights("contact", kContactFeatures, model.with_colors.contact,
                model.without_colors.contact);
    readWeights("bridge", kBridgeFeatures, model.with_colors.bridge, model.without_colors.bridge);
    lines_.end("weights");
    return model;
  }

 private:
  double weightOf(std::string_view field) const {
    const auto value = hyselam::parseNumber(field);
    if (!value || !(std::abs(*value) <= kMostWeight)) {
      lines_.fail("'" + hyselam::printable(field) + "' is no weight");
    }
    return *value;
  }

  template <std::size_t n>
  void readWeights(const std::string& key, const std::array<RelationFeature, n>& features,
                   std::array<double, n>& with_colors, std::array<double, n>& without_colors) {
    if (lines_.valueOf(key) != std::to_string(n)) {
      lines_.fail("the features are not the " + std::to_string(n) + " of this version");
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::vector<std::string_view> fields = lines_.nextFields();
      if (fields.size() != 3 || fields[0] != features[i].name) {
        lines_.fail(std::string("the feature '") + features[i].name +
                    "' and two weights are expected");
      }
      with_colors[i] = weightOf(fields[1]);
      without_colors[i] = weightOf(fields[2]);
      if (features[i].of_color && without_colors[i] != 0.0) {
        lines_.fail("a feature of color has no weight where colors are not known");
      }
    }
  }

  hyselam::ModelLines lines_;
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
  out << hyselam::modelHead(kFormat, origin);
  writeWeights(out, "contact", kContactFeatures, with_colors.contact, without_colors.contact);
  writeWeights(out, "bridge", kBridgeFeatures, with_colors.bridge, without_colors.bridge);
  return hyselam::withChecksum(out.str());
}

}  // namespace hyselam_objects
