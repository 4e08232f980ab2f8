// What a text has led to, as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "hyselam_conversation/conversation.hpp"

namespace hyselam_conversation {

/// A record: text, understood, refused, reason, question, names (place to name and whether it is
/// confirmed: those that changed), stopped, goal, reply, layer, description and objects after it,
/// what of them is new or gone, motion, place, heard, forwarded, language.
nlohmann::json recordOf(const Exchange& exchange, const Conversation& conversation,
                        const std::vector<std::string>& description_before,
                        const std::vector<std::string>& objects_before);

/// The description as lines, sorted: "corridor left kitchen > library".
std::vector<std::string> descriptionLines(const Conversation& conversation);

}  // namespace hyselam_conversation
