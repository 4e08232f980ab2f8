#include "hyselam_objects/language/answer_text.hpp"

#include <algorithm>

namespace hyselam_objects {

TextAnswer answerText(const std::string& text, const ObjectParser& parser, const ObjectMap& map,
                      const ObjectDictionary& dictionary, FillMap& fill_map) {
  TextAnswer out;
  std::size_t understood = 0;
  const std::vector<ObjectReply> replies = fill_map.process(text);
  for (const ObjectReply& reply : replies) {
    out.text += (out.text.empty() ? "" : " ") + reply.text;
    out.objects.insert(out.objects.end(), reply.objects.begin(), reply.objects.end());
    for (const Id id : reply.places) out.places.push_back(*map.findPlace(id));
    if (!reply.reason.empty()) out.reason += (out.reason.empty() ? "" : "; ") + reply.reason;
    understood += reply.kind != ReplyKind::kNotUnderstood;
    out.is_question = reply.kind == ReplyKind::kQuestion;
    out.go_to_place = out.go_to_place || reply.code == "going";
    if (reply.code == "shown") out.shown.push_back(reply.kind_of_object);
  }
  out.understood = understood > 0;
  out.about_things = !out.understood && parser.isAboutThings(text);
  out.all_understood = understood == replies.size();
  // NewObject: the robot asks to be shown what it cannot recognize.
  const std::string kind = fill_map.kindToShow(dictionary, replies);
  if (!kind.empty()) out.text += " " + fill_map.showRequest(kind);
  return out;
}

}  // namespace hyselam_objects
