// Tours of drawn corridors, written by people for the training of the reader of tours: what a
// person says who shows a robot round, with the rooms marked in it.
//
// A file has for each tour a line "## ID | KIND | ROOMS" with the room's doors as SIDE NUMBER @
// metres along the corridor ("L1@4.4 R1@4.0"), then lines of text in which each mention of a room
// is "[the staff room](L1)", and an empty line.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "reader/heard_text.hpp"

namespace hyselam_topo {
namespace language {

struct TourDoor {
  bool is_left = false;
  double along = 0.0;  ///< [m]
};

struct AnnotatedTour {
  struct Said {
    TextRange range;  ///< in the text
    std::string room;
  };
  std::string id;
  std::string kind;                       ///< of the building, with names of its own
  std::string text;                       ///< without marks
  std::map<std::string, TourDoor> doors;  ///< of each room
  std::vector<Said> said;
};

/// Throws hyselam::InputError that names the file and the line.
std::vector<AnnotatedTour> loadTours(const std::string& path);

/// The words of what was marked, without articles, and its rooms.
struct MarkedMentions {
  std::vector<Mention> mentions;
  std::vector<std::string> rooms;  ///< of each
};
MarkedMentions markedMentions(const CompiledGrammar& grammar, const HeardText& text,
                              const AnnotatedTour& tour);

}  // namespace language
}  // namespace hyselam_topo
