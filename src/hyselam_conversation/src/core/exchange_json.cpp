#include "hyselam_conversation/exchange_json.hpp"

#include <algorithm>
#include <iterator>

#include "hyselam_language/testing/language_outlines.hpp"

namespace hyselam_conversation {
namespace {

using nlohmann::json;

/// Lines of `a` that are not in `b`; both sorted.
std::vector<std::string> minus(const std::vector<std::string>& a,
                               const std::vector<std::string>& b) {
  std::vector<std::string> rest;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(rest));
  return rest;
}

std::string labelOf(const Conversation& conversation, Id id) {
  const hyselam_topo::Place* place = conversation.dialogue().map().findPlace(id);
  if (place == nullptr) return "";
  const std::vector<std::string> names = namesOf(*place);
  return codeOf(*place) + (names.empty() ? "" : " " + names.front());
}

json namesIn(const Exchange& exchange) {
  json all = json::object();
  for (const NameChange& each : exchange.names) {
    all[each.code] = {{"before", each.before}, {"name", each.after}, {"confirmed", each.confirmed}};
  }
  return all;
}

}  // namespace

std::vector<std::string> descriptionLines(const Conversation& conversation) {
  return hyselam_topo::testing::outline(conversation.dialogue().description());
}

json recordOf(const Exchange& exchange, const Conversation& conversation,
              const std::vector<std::string>& description_before,
              const std::vector<std::string>& objects_before) {
  json refusals = json::array();
  std::string reason;
  for (const hyselam_topo::Refusal& each : exchange.refusals) {
    refusals.push_back({{"text", each.text},
                        {"reason", each.reason},
                        {"suggestion", each.suggestion},
                        {"layer", each.by_other ? "objects" : "places"}});
    reason += (reason.empty() ? "" : " ") + each.reason;
  }
  json heard = json::array();
  for (const hyselam_topo::Utterance& each : exchange.utterances) {
    heard.push_back(hyselam_topo::testing::outline(each));
  }
  const std::vector<std::string> description = descriptionLines(conversation);
  const std::vector<std::string> objects = summaryLines(conversation.objects());
  return {{"text", exchange.text},
          {"language", exchange.language},
          {"reply", exchange.replyText()},
          {"sentences", exchange.reply},
          {"layer", toString(exchange.layer)},
          {"heard", heard},
          {"forwarded", exchange.forwarded},
          {"understood", exchange.understood},
          {"refused", !exchange.refusals.empty()},
          {"reason", reason},
          {"refusals", refusals},
          {"question", exchange.question},
          {"names", namesIn(exchange)},
          {"stopped", exchange.stopped},
          {"goal", exchange.goal ? json(labelOf(conversation, *exchange.goal)) : json(nullptr)},
          {"motion", toString(exchange.motion)},
          {"place", labelOf(conversation, exchange.place)},
          {"description", description},
          {"new", minus(description, description_before)},
          {"gone", minus(description_before, description)},
          {"objects", objects},
          {"new_objects", minus(objects, objects_before)},
          {"gone_objects", minus(objects_before, objects)}};
}

}  // namespace hyselam_conversation
