// The state of a dialogue: what outlives the talk, as a value and as one file with a checksum.
#pragma once

#include <optional>
#include <string>

#include "hyselam_common/pose2.hpp"
#include "hyselam_language/building/described_building.hpp"
#include "hyselam_topo/dialogue/place_man.hpp"

namespace hyselam_topo {

/// State of a dialogue; a plain value, for files (dialogue_state.hpp).
struct DialogueState {
  std::string language;
  PlaceMan::State places;  ///< of the place manager
  DescribedBuilding description;
  /// Heading of the robot when sides (left, front, ...) were last described, map frame [rad].
  std::optional<double> heading;
  /// Where the robot stood then, map frame [m].
  std::optional<hyselam::Point2> position;
  /// The place of the map where the robot was when it was last told, or found, where it is; 0: not
  /// known.
  Id told_at = 0;
};

/// A line "hyselam_dialogue VERSION CRC BYTES", then as many bytes of JSON, in which the maps and
/// the description stand as XML; version 2 if there is a shelf, else 1. Equal states give equal
/// bytes.
std::string toText(const DialogueState& state);

/// Throws hyselam::InputError for another format or version, a wrong length or checksum, and for
/// inconsistent content.
DialogueState dialogueStateFromText(const std::string& text, const std::string& source);

/// Writes a file as a whole or not at all. Throws hyselam::InputError if it cannot be written.
void saveDialogueState(const std::string& path, const DialogueState& state);

/// Throws as dialogueStateFromText(), or if the file cannot be read.
DialogueState loadDialogueState(const std::string& path);

}  // namespace hyselam_topo
