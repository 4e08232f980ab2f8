// Leads talks by the steps of a transcript; each step that says or moves something gives a record.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_conversation/conversation.hpp"
#include "hyselam_conversation/transcript.hpp"
#include "hyselam_topological_map/topological_map.hpp"

namespace hyselam_conversation {

/// How every talk begins.
struct Beginning {
  ConversationParams params;
  std::optional<hyselam_topo::AugmentedTopologicalMap> map;
  std::optional<hyselam_topo::DialogueState> state;  ///< before `map`, which may be a newer one
  hyselam_objects::ObjectMap objects;
  std::string
      start;  ///< "X,Y,THETA", or a place; "": in the first corridor, else the largest place
};

class TranscriptPlayer {
 public:
  /// @throws as Conversation, and hyselam::InputError for a start that is no place.
  explicit TranscriptPlayer(Beginning beginning,
                            std::shared_ptr<const Languages> languages = Languages::shipped());

  /// The record of what a step leads to (exchange_json.hpp) with `id` and `session`, the number of
  /// talks before; nothing for a step that only prepares. Throws as Conversation.
  std::optional<nlohmann::json> play(const Step& step);

  const Conversation& conversation() const { return *conversation_; }
  /// Expectations that were not met, as sentences.
  const std::vector<std::string>& failures() const { return failures_; }

 private:
  void begin(const std::string& language);
  std::optional<Exchange> perform(const Step& step);

  Beginning beginning_;
  std::shared_ptr<const Languages> languages_;
  std::optional<Conversation> conversation_;
  std::string reply_;  // to the last step that led to something
  std::vector<std::string> failures_;
  int session_ = 0;
  std::string id_;
};

}  // namespace hyselam_conversation
