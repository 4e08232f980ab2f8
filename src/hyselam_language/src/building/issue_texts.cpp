#include "issue_texts.hpp"

#include <map>

namespace hyselam_topo {
namespace {

const std::map<std::string, std::string>& english() {
  static const std::map<std::string, std::string> kTexts{
      {"count", "{count} were announced, {named} named"},
      {"no_side", "no side was told before"},
      {"same_side_left_out",
       "on which side that place lies was not told: I have not taken down 'same side'"},
      {"no_robot", "where the robot is was not told: say 'you are in ...'"},
      {"elsewhere",
       "sides are told as the robot sees them, and it is in '{robot}', not in '{from}'; say for "
       "example: it is next to '{from}'"},
      {"itself", "'{place}' lies beside itself"},
      {"twice", "a place is named twice"},
      {"other_side", "'{place}' was told to be {known}, not {side}"},
      {"seen_from", "told already, as seen from '{place}'"},
      {"rank_taken", "number {rank} {side} is '{place}'"},
      {"other_rank", "'{place}' was told to be number {known} of its side, not {rank}"},
      {"other_distance", "'{place}' was told to be {known} metres away, not {distance}"},
      {"out_of_range", "{value} is out of range"},
      {"one_rank", "one number, several places: say it of each"},
      {"distance_alone", "a distance alone is not enough: say also on which side it lies"},
      {"distance_left_out", "the distance was not taken down, only where it lies"},
      {"side_left_out", "sides of other floors were not taken down, only the floor"},
      {"nothing_said", "it does not tell where anything is"},
      {"one_denial", "deny one thing at a time"},
      {"denied", "the opposite was told: {fact}"},
      {"both_ways", "the sentence says it and denies it"},
      {"reversed", "the opposite was told: {fact}"},
      {"not_told", "that was not told before, and what it is not cannot be kept"},
      {"side_left", "on the left"},
      {"side_right", "on the right"},
      {"side_front", "in front"},
      {"side_back", "behind"},
      {"side_unknown", "there"},
      {"no_name", "'{name}' is no name"},
      {"other_place", "'{name}' is another place than '{place}'"},
      {"other_length", "another length was told: {known}, not {value}"},
      {"other_width", "another width was told: {known}, not {value}"},
      {"other_area", "another area was told: {known}, not {value}"},
      {"length_range", "a length of {value} is out of range"},
      {"width_range", "a width of {value} is out of range"},
      {"area_range", "an area of {value} is out of range"},
      {"metres", "no unit was said: taken as metres"},
      {"other_parts", "{known} parts were told, not {count}"},
      {"other_count", "{known} were told, not {count}"},
      {"other_doors", "{known} doors were told, not {count}"},
      {"other_floor", "'{place}' was told to be on another floor"},
      {"other_size_word", "'{place}' was told to be of another size"},
      {"more_doors", "{count} doors do not lead to {named} places"},
      {"unknown_place", "'{place}' was not told of"},
      {"nothing_corrected",
       "nothing was told that this corrects: say it without 'no' to "
       "add it, or 'I mean B, not A'"},
      {"taken_as_new", "nothing was told that this corrects: taken as new"},
      {"nothing_to_undo", "nothing was told that can be taken back"},
      {"replace_what", "which one shall '{name}' replace: {names}?"},
      {"which_number",
       "which number that replaces is not clear: say the whole sentence, as 'The lab is 7 metres "
       "long'"},
      {"it_nothing", "what '{name}' means was not told: say the name"},
      {"it_unsaid", "which place this is about was not told: say its name"},
      {"it_several", "'{name}' may mean {names}"},
      {"it_what", "'{name}' means no place told of: say the name"},
      {"may_mean", "'{name}' may mean {names}"},
      {"which", "which '{name}': {names}?"},
      {"number_of", "number {count}"},
      {"one_place", "here must be one place"},
      {"whose", "whose '{name}'? Tell me your name first: 'I am ...'"},
      {"what_of", "what of '{name}'? Say for example '{example}'"},
      {"strange", "shall I call a place '{name}'?"},
      {"between_what", "between which two places?"},
      {"which_side", "which of them is on the left?"},
      {"odd_count", "{count} places cannot be shared out to two sides"},
      {"row_of_one", "a row has two places or more"},
      {"or", " or "}};
  return kTexts;
}

}  // namespace

std::string issueText(const Grammar& grammar, const std::string& key,
                      const std::vector<std::pair<std::string, std::string>>& values) {
  std::string text = grammar.has("issue_" + key) ? grammar.say("issue_" + key) : english().at(key);
  for (const auto& [name, value] : values) {
    const std::size_t at = text.find("{" + name + "}");
    if (at != std::string::npos) text.replace(at, name.size() + 2, value);
  }
  return text;
}

std::vector<std::string> issueKeys() {
  std::vector<std::string> keys;
  for (const auto& [key, text] : english()) keys.push_back(key);
  return keys;
}

}  // namespace hyselam_topo
