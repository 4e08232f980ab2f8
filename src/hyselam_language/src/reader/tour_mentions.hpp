// Which words of a tour name its rooms, and which of them name the same room.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "heard_text.hpp"
#include "hyselam_language/building/place_names.hpp"
#include "linear_classifier.hpp"
#include "mention_tagger.hpp"

namespace hyselam_topo {
namespace language {

/// What the second reader takes each word for, as features of the tagger of tours.
std::vector<Features> readerFeatures(const LinearClassifier& reader_tagger, const HeardText& text);

/// Mentions of rooms, in their order.
std::vector<Mention> roomMentions(const LinearClassifier& reader_tagger,
                                  const LinearClassifier& tour_tagger, const HeardText& text,
                                  double eager);

/// The numbers of those that a name may mean: by names that are the same, or one that is a part of
/// the other ("the doctor" of "Doctor Silva").
std::vector<std::size_t> sameRooms(const PlaceNames& names,
                                   const std::vector<std::vector<std::string>>& rooms,
                                   const std::string& name);

struct NamedRooms {
  std::vector<std::size_t> room_of;             ///< of each mention
  std::vector<std::vector<std::string>> names;  ///< of each room, as first said first
  std::vector<char> has_name;                   ///< 0: "my office", "the next room" may be any
};

/// Mentions of the same room; where a name may mean several, of the one named last.
NamedRooms namedRooms(const CompiledGrammar& grammar, const PlaceNames& names,
                      const HeardText& text, const std::vector<Mention>& mentions);

}  // namespace language
}  // namespace hyselam_topo
