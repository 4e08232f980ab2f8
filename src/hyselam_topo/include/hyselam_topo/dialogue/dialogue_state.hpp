// The state of a dialogue as one file with a checksum.
#pragma once

#include <string>

#include "hyselam_topo/dialogue/dialogue.hpp"

namespace hyselam_topo {

/// A line "hyselam_dialogue 1 CRC BYTES", then as many bytes of JSON, in which the map and the
/// description stand as XML. Equal states give equal bytes.
std::string toText(const DialogueState& state);

/// Throws hyselam::InputError for another format or version, a wrong length or checksum, and for
/// inconsistent content.
DialogueState dialogueStateFromText(const std::string& text, const std::string& source);

/// Writes a file as a whole or not at all. Throws hyselam::InputError if it cannot be written.
void saveDialogueState(const std::string& path, const DialogueState& state);

/// Throws as dialogueStateFromText(), or if the file cannot be read.
DialogueState loadDialogueState(const std::string& path);

}  // namespace hyselam_topo
