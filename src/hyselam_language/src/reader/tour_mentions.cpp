#include "tour_mentions.hpp"

#include <algorithm>
#include <set>

#include "building/name_words.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// Of a probability, so that a regression may tell them apart.
std::string bin(double probability) {
  constexpr double kBins[] = {0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 0.97};
  return std::to_string(std::upper_bound(std::begin(kBins), std::end(kBins), probability) -
                        std::begin(kBins));
}

using NameWords = std::set<std::string>;

NameWords wordsOf(const std::string& name) {
  const std::vector<std::string> all = wordsOfName(name);
  return {all.begin(), all.end()};
}

bool isPartOf(const NameWords& part, const NameWords& whole) {
  return !part.empty() && std::includes(whole.begin(), whole.end(), part.begin(), part.end());
}

/// What names a room once does so elsewhere: "Sofia" in a row of names, "nkosi" of "Doctor Nkosi".
std::vector<Mention> withRepeated(const HeardText& text, const std::vector<Mention>& found) {
  const auto wordAt = [&](std::size_t at) { return text.word(static_cast<std::ptrdiff_t>(at)); };
  std::set<std::string> names;
  std::vector<bool> taken(text.tokens().size(), false);
  for (const Mention& mention : found) {
    for (std::size_t at = mention.begin; at < mention.end; ++at) taken[at] = true;
    const auto last = static_cast<std::ptrdiff_t>(mention.end) - 1;
    if (!text.isKeyword(last) && (!text.isNoun(last) || mention.end - mention.begin == 1) &&
        text.tokens()[mention.end - 1].kind == TokenKind::kWord && text.word(last).size() > 2)
      names.insert(text.word(last));
  }
  std::vector<Mention> all = found;
  for (std::size_t at = 0; at < taken.size(); ++at) {
    if (!taken[at] && names.count(wordAt(at)) != 0)
      all.push_back({at, at + 1, Mention::Kind::kThing, 0.5});
  }
  std::sort(all.begin(), all.end(),
            [](const Mention& a, const Mention& b) { return a.begin < b.begin; });
  return all;
}

/// "Our staff room" is the staff room.
Mention withoutArticle(const CompiledGrammar& grammar, const HeardText& text, Mention mention) {
  const NameType* places = grammar.nameType("place");
  const auto is_before = [&](const std::string& word) {
    return places != nullptr && (places->isArticle(word) || places->speaker.count(word) != 0);
  };
  while (mention.begin + 1 < mention.end &&
         is_before(text.word(static_cast<std::ptrdiff_t>(mention.begin))))
    ++mention.begin;
  return mention;
}

/// "My office", "the next door".
bool isAnyRoom(const CompiledGrammar& grammar, const PlaceNames& names, const HeardText& text,
               const Mention& mention) {
  if (mention.end - mention.begin > 1) return false;
  const std::string& word = text.word(static_cast<std::ptrdiff_t>(mention.begin));
  return grammar.pointed_words.count(word) != 0 ||
         (text.isNoun(static_cast<std::ptrdiff_t>(mention.begin)) && names.isPlainRoom(word));
}

}  // namespace

std::vector<std::size_t> sameRooms(const PlaceNames& names,
                                   const std::vector<std::vector<std::string>>& rooms,
                                   const std::string& name) {
  std::vector<std::size_t> same = names.find(name, rooms);
  if (!same.empty()) return same;
  const NameWords words = wordsOf(name);
  for (std::size_t room = 0; room < rooms.size(); ++room) {
    const bool part =
        std::any_of(rooms[room].begin(), rooms[room].end(), [&](const std::string& other) {
          const NameWords others = wordsOf(other);
          return isPartOf(words, others) || isPartOf(others, words);
        });
    if (part) same.push_back(room);
  }
  return same;
}

std::vector<Features> readerFeatures(const LinearClassifier& reader_tagger, const HeardText& text) {
  const FoundMentions found = findMentions(reader_tagger, text);
  const std::vector<std::string> tags = tagsOf(text, found.mentions);
  std::vector<Features> all;
  for (std::size_t at = 0; at < tags.size(); ++at) {
    const std::string p = bin(found.name_probabilities[at]);
    all.push_back({"reader=" + tags[at], "p=" + p, "p=" + p + "reader=" + tags[at]});
    // Of a person, whether or not the language knows the name.
    const bool begins = at == 0 || text.endsSentence(at - 1);
    if (text.tokens()[at].starts_upper && !begins &&
        !text.isNoun(static_cast<std::ptrdiff_t>(at))) {
      const std::string& before = text.word(static_cast<std::ptrdiff_t>(at) - 1);
      const std::string& behind = text.word(static_cast<std::ptrdiff_t>(at) + 1);
      all.back().insert(all.back().end(), {"person", "person-1=" + before, "person+1=" + behind,
                                           "person-1+1=" + before + "_" + behind});
    }
    if (at > 0) all.back().push_back("reader-1=" + tags[at - 1]);
    if (at + 1 < tags.size()) all.back().push_back("reader+1=" + tags[at + 1]);
  }
  return all;
}

std::vector<Mention> roomMentions(const LinearClassifier& reader_tagger,
                                  const LinearClassifier& tour_tagger, const HeardText& text,
                                  double eager) {
  const std::vector<Mention> found =
      findMentions(tour_tagger, text, readerFeatures(reader_tagger, text), eager).mentions;
  return withRepeated(text, found);
}

NamedRooms namedRooms(const CompiledGrammar& grammar, const PlaceNames& names,
                      const HeardText& text, const std::vector<Mention>& mentions) {
  NamedRooms rooms;
  std::vector<std::size_t> last_said;  // number of the mention
  for (std::size_t m = 0; m < mentions.size(); ++m) {
    const Mention own = withoutArticle(grammar, text, mentions[m]);
    const std::string name = text.nameOf(own);
    const bool is_name = !isAnyRoom(grammar, names, text, own);
    const std::vector<std::size_t> same = sameRooms(names, rooms.names, name);
    if (same.empty()) {
      rooms.room_of.push_back(rooms.names.size());
      rooms.names.push_back({name});
      rooms.has_name.push_back(is_name ? 1 : 0);
      last_said.push_back(m);
      continue;
    }
    const std::size_t room = *std::max_element(
        same.begin(), same.end(), [&](auto a, auto b) { return last_said[a] < last_said[b]; });
    rooms.room_of.push_back(room);
    last_said[room] = m;
    auto& known = rooms.names[room];
    if (std::find(known.begin(), known.end(), name) == known.end()) known.push_back(name);
    if (is_name) rooms.has_name[room] = 1;
  }
  return rooms;
}

}  // namespace language
}  // namespace hyselam_topo
