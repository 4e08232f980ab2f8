#include <string>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/fuzz_target.hpp"
#include "hyselam_topo/dialogue/dialogue_state.hpp"
#include "hyselam_topo/dialogue/phrases.hpp"

namespace hyselam_topo {
namespace {

using hyselam::testing::require;
using hyselam::testing::textOf;

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
  return {{"dialogueState", dialogueState}, {"phrases", phrases}};
}
