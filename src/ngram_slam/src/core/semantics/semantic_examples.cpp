#include "ngram_slam/semantics/semantic_examples.hpp"

#include <algorithm>
#include <limits>
#include <locale>
#include <sstream>
#include <string_view>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"

namespace ngram_slam {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{256} << 20;

std::string headLine() {
  std::string head;
  for (const SemanticFeature& feature : kSemanticFeatureList) {
    head += std::string(feature.name) + ",";
  }
  return head + "class";
}

std::vector<std::string_view> splitAtCommas(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

}  // namespace

std::string textOf(const std::vector<SemanticExample>& examples) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(std::numeric_limits<double>::max_digits10);
  out << headLine() << '\n';
  for (const SemanticExample& example : examples) {
    for (const SemanticFeature& feature : kSemanticFeatureList) {
      out << example.features.*feature.member << ',';
    }
    out << toString(example.semantic_class) << '\n';
  }
  return out.str();
}

std::vector<SemanticExample> readExamples(const std::string& path) {
  std::vector<SemanticExample> examples;
  hyselam::forEachLine(
      hyselam::readTextFile(path, kMaxBytes), [&](std::size_t number, std::string_view line) {
        const auto fail = [&](const std::string& reason) {
          throw hyselam::InputError(path, "line " + std::to_string(number), reason);
        };
        if (number == 1) {
          if (line != headLine()) fail("must be '" + headLine() + "'");
          return;
        }
        const std::vector<std::string_view> fields = splitAtCommas(line);
        if (fields.size() != kSemanticFeatures + 1) {
          fail("is not a value for each feature and a class");
        }
        SemanticExample example;
        for (std::size_t i = 0; i < kSemanticFeatures; ++i) {
          const auto value = hyselam::parseNumber(fields[i]);
          if (!value) fail(std::string(kSemanticFeatureList[i].name) + " is no number");
          example.features.*kSemanticFeatureList[i].member = *value;
        }
        const auto semantic_class = semanticClassFromString(std::string(fields.back()));
        if (!semantic_class) fail("'" + std::string(fields.back()) + "' is no class");
        example.semantic_class = *semantic_class;
        examples.push_back(example);
      });
  return examples;
}

}  // namespace ngram_slam
