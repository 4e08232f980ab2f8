// One answer to a whole text about objects, for those who pass texts on: the dialogue about places.
#pragma once

#include <string>
#include <vector>

#include "hyselam_objects/language/fill_map.hpp"

namespace hyselam_objects {

/// What a text leads to; FillMap replies sentence by sentence.
struct TextAnswer {
  std::string text;         ///< for people: the replies, and requests to be shown new kinds
  bool understood = false;  ///< any part; the text tells which were not
  bool all_understood = false;
  bool about_things =
      false;                 ///< ObjectParser::isAboutThings(): a refusal is for this layer to give
  std::string reason;        ///< why parts were not understood; "" if all were
  bool is_question = false;  ///< the last reply is a question: the next text may answer it
  bool go_to_place = false;  ///< "fetch the pen": drive to the nearest of `places`
  std::vector<Id> objects;   ///< that the replies are about
  std::vector<ObjectPlace> places;  ///< that the replies are about
  std::vector<std::string> shown;   ///< kinds of objects that a person shows
};

/// Records what a text says and answers its questions. `parser` and `map` are those of `fill_map`.
/// One kind of objects that the dictionary cannot recognize is asked to be shown, see
/// FillMap::kindToShow().
TextAnswer answerText(const std::string& text, const ObjectParser& parser, const ObjectMap& map,
                      const ObjectDictionary& dictionary, FillMap& fill_map);

}  // namespace hyselam_objects
