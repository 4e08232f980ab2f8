// What a tour of a building says of sides and order: somebody walks along a corridor in thought and
// tells the rooms as they come, on both sides, forth and back. Seldom does one sentence tell all of
// a room; its side was said three sentences ago ("and on that side too, after the lab, ..."). So
// each mention of a room and each pair of near mentions gets the words around them as features.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "grammar/compiled_grammar.hpp"
#include "heard_text.hpp"
#include "linear_classifier.hpp"

namespace hyselam_topo {
namespace language {

class TourContext {
 public:
  /// Text and mentions, of rooms only and in their order, must outlive this; `room_of`: which room
  /// each names, any numbers.
  TourContext(const TourWords& words, const HeardText& text, const std::vector<Mention>& rooms,
              const std::vector<std::size_t>& room_of);

  /// Numbers of mentions that are told after one another, or with one between them.
  std::vector<std::pair<std::size_t, std::size_t>> pairs() const;

  /// Which side a mention is told to be on: each feature begins with the side that a word near it
  /// tells, "l" or "r"; none where nothing near it tells one.
  Features ofSide(std::size_t room) const;
  /// The same as if left and right had been said for each other.
  static Features mirrored(Features features);
  /// Whether a word for a side belongs to the mention.
  bool hasOwnSide(std::size_t room) const { return ruled_[room].how == "own"; }
  /// Whether its room was spoken of before, and nothing new is said of its side.
  bool isKnown(std::size_t room) const { return ruled_[room].how == "known"; }
  /// How the second of a pair lies to the first.
  Features ofPair(std::size_t first, std::size_t second) const;
  /// Where in its row it is: "first", "at the end".
  Features ofPosition(std::size_t room) const;

 private:
  /// A word that tells a side: "left", or "side" in "the other side".
  struct Cue {
    std::size_t at = 0;
    bool left = false;
    std::string how;  ///< "", "other" or "same"
  };
  /// The side that a plain rule gives a mention: that of the word for a side in its clause, the
  /// other one behind "across from", else that of the mention before.
  struct Ruled {
    enum class Side { kUnknown, kLeft, kRight };
    Side side = Side::kUnknown;
    std::string how = "none";  ///< "own", "known" (of the same room before), "across", "carried"
    std::size_t steps = 0;     ///< mentions since one with a word of its own
  };
  void findCues();
  /// Numbers of the cues that belong to each mention; kNone without.
  std::vector<std::size_t> ownCues() const;
  void rule();
  bool isAcross(std::size_t room) const;
  std::size_t acrossFrom(std::size_t room) const;
  void addCueBefore(std::size_t room, std::size_t rank, const Cue& cue, Features* out) const;
  void addCueBehind(std::size_t room, const Cue& cue, bool side_said_before, Features* out) const;
  void addGap(const Mention& first, const Mention& second, const std::string& mark,
              Features* out) const;
  void addSides(std::size_t first, std::size_t second, const std::string& mark,
                Features* out) const;
  void addAround(const Mention& first, const Mention& second, const std::string& mark,
                 Features* out) const;
  std::size_t namesWithin(std::size_t begin, std::size_t end) const;
  std::size_t countOf(const WordSet& words, std::size_t begin, std::size_t end) const;
  std::size_t commasWithin(std::size_t begin, std::size_t end) const;
  const std::string& word(std::size_t at) const;
  bool isNamed(std::size_t at) const { return named_[at]; }
  /// The last cue before a token; null without one.
  const Cue* lastCue(std::size_t before) const;

  const TourWords& words_;
  const HeardText& text_;
  const std::vector<Mention>& rooms_;
  std::vector<std::size_t> sentence_;  ///< of each token
  std::vector<bool> named_;            ///< the token is part of a mention
  std::vector<Cue> cues_;
  std::vector<std::size_t> room_of_;
  std::vector<char> is_new_;  ///< the mention is the first of its room
  std::vector<Ruled> ruled_;
};

}  // namespace language
}  // namespace hyselam_topo
