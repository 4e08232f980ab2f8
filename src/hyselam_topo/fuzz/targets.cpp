#include <string>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "hyselam_topo/describe_building.hpp"
#include "hyselam_topo/description_builder.hpp"
#include "hyselam_topo/description_xml.hpp"
#include "hyselam_topo/dialogue_state.hpp"
#include "hyselam_topo/octomap_reader.hpp"
#include "hyselam_topo/phrases.hpp"
#include "hyselam_topo/topological_map_xml.hpp"

namespace hyselam_topo {
namespace {

using hyselam::testing::require;
using hyselam::testing::textOf;

/// Small, so that a bomb shows as a crash of the fuzzer's memory limit.
XmlLimits limits() {
  XmlLimits limits;
  limits.max_bytes = 1u << 20;
  limits.max_grid_cells = 1u << 20;
  limits.max_appearance_values = 1u << 20;
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

/// XML of a topological map: the same.
void mapXml(const std::uint8_t* data, std::size_t size) {
  const std::string text = textOf(data, size);
  AugmentedTopologicalMap map;
  try {
    map = fromXml(text, "fuzz", limits());
  } catch (const hyselam::InputError&) {
    return;
  }
  checkMap(map, "read");
  // Extras may hold XML that is written otherwise; everything else must stay.
  try {
    const AugmentedTopologicalMap again = fromXml(toXml(map));
    require(again.places.size() == map.places.size() && again.edges == map.edges &&
            again.grid == map.grid);
  } catch (const hyselam::InputError&) {
  }
}

/// The state of a dialogue: refused, or written to the same again. Length and checksum are put
/// right.
void dialogueState(const std::uint8_t* data, std::size_t size) {
  const std::string body = textOf(data, size);
  const std::string head =
      "hyselam_dialogue 1 " + hyselam::crc32Text(body) + " " + std::to_string(size) + "\n";
  DialogueState state;
  try {
    state = dialogueStateFromText(head + body, "fuzz");
  } catch (const hyselam::InputError&) {
    return;
  }
  std::string once;
  try {
    once = toText(state);
  } catch (const hyselam::InputError&) {
    return;  // extras of the XML within may be written otherwise, and be refused then
  }
  require(toText(dialogueStateFromText(once, "written")) == once);
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

/// The file of an OctoMap, .bt or .ot: refused, or cubes within the space that keys can tell.
void octoMap(const std::uint8_t* data, std::size_t size) {
  constexpr int kEdge = 32768;
  OctoMapLimits few;
  few.max_leaves = 1u << 16;
  VoxelMap map;
  try {
    map = parseOctoMap(textOf(data, size), "fuzz", few);
  } catch (const hyselam::InputError&) {
    return;
  }
  require(map.leaves.size() <= few.max_leaves);
  for (const VoxelLeaf& leaf : map.leaves) {
    require(leaf.size >= 1 && leaf.probability >= 0.0f && leaf.probability <= 1.0f);
    for (const int at : {leaf.x, leaf.y, leaf.z}) require(at >= -kEdge && at + leaf.size <= kEdge);
  }
}

/// What the robot says, as data: refused, or good to say things with.
void phrases(const std::uint8_t* data, std::size_t size) {
  try {
    const Phrases read = Phrases::fromYaml("fuzz", textOf(data, size));
    require(!read.language().empty());
    read.say("at_named", {{"code", "A1"}, {"names", read.list({"a", "b", "{code}"})}});
    require(!read.number(1.5, 1).empty());
  } catch (const hyselam::InputError&) {
  }
}

}  // namespace
}  // namespace hyselam_topo

std::vector<hyselam::testing::FuzzTarget> hyselam::testing::fuzzTargets() {
  using namespace hyselam_topo;  // NOLINT: its own targets
  return {{"parser", parser},   {"descriptionXml", descriptionXml},
          {"mapXml", mapXml},   {"dialogueState", dialogueState},
          {"grammar", grammar}, {"octoMap", octoMap},
          {"phrases", phrases}};
}
