// The example building, for tests.
#pragma once

#include "hyselam_conversation/conversation.hpp"
#include "hyselam_conversation/example_map.hpp"

namespace hyselam_conversation {

/// Made once: reading the grammars takes longer than most tests.
inline std::shared_ptr<const Languages> exampleLanguages() {
  static const std::shared_ptr<const Languages> languages = Languages::shipped();
  return languages;
}

/// A robot at the corridor's west end, looking along it.
struct ExampleTalk {
  explicit ExampleTalk(const ConversationParams& params = {})
      : talk(params, {}, exampleLanguages()) {
    talk.setMap(exampleMap());
    talk.stand({1.0, 8.0, 0.0});
  }
  Conversation talk;
};

}  // namespace hyselam_conversation
