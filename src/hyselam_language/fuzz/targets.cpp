#include <string>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "hyselam_language/building/describe_building.hpp"
#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_language/building/description_xml.hpp"

namespace hyselam_topo {
namespace {

using hyselam::testing::require;
using hyselam::testing::textOf;

/// Small, so that a bomb shows as a crash of the fuzzer's memory limit.
hyselam::XmlLimits limits() {
  hyselam::XmlLimits limits;
  limits.max_bytes = 1u << 20;
  return limits;
}

void checkRange(const TextRange& range, std::size_t size) {
  require(range.begin <= range.end && range.end <= size);
}

void checkUtterance(const Utterance& utterance, std::size_t size) {
  checkRange(utterance.range, size);
  checkRange(utterance.culprit, size);
  require(utterance.understood() != utterance.intent.empty());
  require(utterance.understood() != !utterance.reason.empty());
  for (const Slot& slot : utterance.slots) {
    checkRange(slot.range, size);
    for (const SaidName& name : slot.names) {
      checkRange(name.range, size);
      require(!name.text.empty());
    }
  }
}

/// Text into utterances and a description, which comes back from XML as it was.
void parser(const std::uint8_t* data, std::size_t size) {
  static const TopoParser kParser;
  const std::string text = textOf(data, size);
  ParseOptions options;
  if (size > 0 && data[0] % 4 == 0) options.expected = {"name_answer", "number_answer"};
  const ParsedText parsed = kParser.parse(text, options);
  DescriptionBuilder builder(kParser);
  for (const Utterance& utterance : parsed.utterances) {
    checkUtterance(utterance, size);
    builder.add(utterance);
  }
  const DescribedBuilding& building = builder.building();
  checkDescription(building, "told");
  require(descriptionFromXml(toXml(building)) == building);
  for (const Grammar& grammar : kParser.grammars()) {
    try {
      describeBuilding(building, grammar);
    } catch (const hyselam::InputError&) {
    }
  }
}

/// XML of a description: refused, or read and written to the same again.
void descriptionXml(const std::uint8_t* data, std::size_t size) {
  const std::string text = textOf(data, size);
  try {
    const DescribedBuilding building = descriptionFromXml(text, "fuzz", limits());
    require(descriptionFromXml(toXml(building)) == building);
  } catch (const hyselam::InputError&) {
  }
}

/// A grammar: refused, or good to understand a sentence with.
void grammar(const std::uint8_t* data, std::size_t size) {
  std::vector<Grammar> grammars;
  try {
    grammars.push_back(Grammar::fromYaml({{"fuzz", textOf(data, size)}}));
  } catch (const hyselam::InputError&) {
    return;
  }
  const Grammar::Intent first = grammars.front().intents().front();
  require(!first.name.empty());
  const TopoParser parser(std::move(grammars));
  std::string text = "The ball is crimson. The cup weighs 300 g.";
  for (const std::string& word : parser.grammars().front().words()) text += " " + word;
  for (const Utterance& said : parser.parse(text).utterances) checkUtterance(said, text.size());
}

/// A model of the second reader: refused, or good to read with.
void readerModel(const std::uint8_t* data, std::size_t size) {
  static const Grammar kGrammar = Grammar::shipped("en");
  try {
    const FactReader reader(kGrammar, "fuzz", textOf(data, size));
    const auto reading =
        reader.read("The cup is next to the lab, isn't it? Mary's is on the left.");
    require(reading && reading->probability >= 0.0 && reading->probability <= 1.0);
  } catch (const hyselam::InputError&) {
  }
}

}  // namespace
}  // namespace hyselam_topo

std::vector<hyselam::testing::FuzzTarget> hyselam::testing::fuzzTargets() {
  using namespace hyselam_topo;  // NOLINT: its own targets
  return {{"parser", parser},
          {"descriptionXml", descriptionXml},
          {"grammar", grammar},
          {"readerModel", readerModel}};
}
