// Statements of all kinds, sensible or not, as outlines of said_statements.hpp.
#pragma once

#include <array>
#include <random>
#include <string>

namespace hyselam_topo {
namespace testing {

class RandomStatements {
 public:
  explicit RandomStatements(unsigned seed) : rng_(seed) {}

  std::string statement() {
    std::string text = pick(5) == 0 ? "no " : "";
    text += intent();
    if (pick(6) == 0) text += " denied=yes";
    return text;
  }

 private:
  std::size_t pick(std::size_t n) { return rng_() % n; }

  template <std::size_t N>
  std::string oneOf(const std::array<const char*, N>& all) {
    return all.at(pick(N));
  }

  std::string name() {
    return oneOf<12>({"hall", "kitchen", "lab", "room_1", "room_2", "toilets", "Tom's_office",
                      "Atlantis", "<it>", "<they>", "<here>", "<other>"});
  }
  std::string names() { return pick(2) == 0 ? name() : name() + "," + name(); }
  std::string side() { return "side=" + oneOf<5>({"left", "right", "front", "back", "same"}); }
  std::string number() { return std::to_string(1 + pick(5)); }

  std::string located() {
    std::string text = "located places=" + names();
    if (pick(2) == 0) text += " " + side();
    if (pick(3) == 0) text += " nth=" + oneOf<4>({"1", "2", "3", "-1"});
    if (pick(4) == 0) text += " distance=" + number();
    if (pick(6) == 0) text += " floor=" + oneOf<3>({"0", "1", "-1"});
    for (const char* slot : {"next_to", "opposite", "end_of", "after", "before", "behind", "within",
                             "to", "via", "from"}) {
      if (pick(8) == 0) text += std::string(" ") + slot + "=" + name();
    }
    return text;
  }

  std::string intent() {
    switch (pick(18)) {
      case 0:
        return "robot_in place=" + name();
      case 1:
        return "neighbours places=" + names() + " " + side();
      case 2:
        return "joined a=" + name() + " b=" + names();
      case 3:
        return "next_to a=" + name() + " b=" + name();
      case 4:
        return "between a=" + name() + " b=" + name() + " c=" + name();
      case 5:
        return "at_end_of a=" + name() + " b=" + name();
      case 6:
        return "size place=" + name() + " length=" + number() + " width=" + number();
      case 7:
        return "alias place=" + name() + " aliases=" + name();
      case 8:
        return "larger a=" + name() + " b=" + name();
      case 9:
        return "size_word place=" + names() + " size_word=" + oneOf<2>({"small", "large"});
      case 10:
        return "doors place=" + name() + " doors=" + number() + " to=" + names();
      case 11:
        return "row places=" + names();
      case 12:
        return "each_side places=" + name() + " count=2";
      case 13:
        return "gone places=" + name();
      case 14:
        return "exists places=" + name() + " count=" + number();
      case 15:
        return "owner place=" + name() + " owners=Ann";
      default:
        return located();
    }
  }

  std::mt19937 rng_;
};

}  // namespace testing
}  // namespace hyselam_topo
