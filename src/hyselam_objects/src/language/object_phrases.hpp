// Names of things as they are said: "the two small red cups", "half a dozen of John's pens".
#pragma once

#include <string>

#include "object_words.hpp"

namespace hyselam_objects {

/// The word of the text that ends before a byte, in lower case.
std::string wordBefore(const std::string& text, std::size_t at);

/// `text`: the whole text, in which the name's range lies.
ObjectPhrase phraseOf(const ObjectWords& words, const hyselam_topo::SaidName& name,
                      const std::string& text);

/// Why a phrase names no thing: a code of the reasons of the grammars; "" if it does.
std::string whyNoThing(const ObjectWords& words, const ObjectPhrase& phrase, bool is_landmark);

}  // namespace hyselam_objects
