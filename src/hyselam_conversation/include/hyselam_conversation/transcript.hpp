// A talk as a text file: one line is one thing that is said or that happens.
//
//   # a comment; empty lines are left out, too
//   @ kitchen              the robot stands in the middle of the kitchen (or of "SS03")
//   @pose 1.5 2 0.3        ... at x, y [m] and theta [rad] in the map
//   @ask                   the robot asks now what there is to ask about its place
//   @name SS03 toilet; WC  known beforehand: the names of a place, confirmed
//   @guess SS03 kitchen    ... only guessed
//   @drive library         the robot is on its way there, and not there yet
//   @arrive                ... now it is
//   @id NAME               of the next thing that is said, for the records
//   @reset, @reset pt      a new talk from the beginning; the language of its first sentences
//   Where are you?         anything else is said by a person
//   > I am at              expected in what the robot has replied to the line above
#pragma once

#include <string>
#include <vector>

#include "hyselam_common/pose2.hpp"

namespace hyselam_conversation {

struct Step {
  enum class Kind {
    kSay,
    kPlace,
    kPose,
    kAsk,
    kName,
    kGuess,
    kDrive,
    kArrive,
    kId,
    kReset,
    kExpect
  };
  Kind kind = Kind::kSay;
  /// kSay: what is said; kId: the id; kReset: the language, or ""; kExpect: part of the reply.
  std::string text;
  std::string place;               ///< name or code
  std::vector<std::string> names;  ///< kName, kGuess
  hyselam::Pose2 pose;
  std::size_t line = 0;  ///< of the text, from 1
};

/// The steps of a text. @throws hyselam::InputError with `source` and the line for a line that
/// begins with @ and is none of the above.
std::vector<Step> stepsOf(const std::string& text, const std::string& source);

/// Parts of a text between a sign, without spaces around them; empty ones are left out.
std::vector<std::string> partsOf(const std::string& text, char separator);

/// "1.5,2,0.3" or "1.5 2 0.3": x, y [m], theta [rad]. False for another text.
bool parsePose(const std::string& text, hyselam::Pose2* pose);

}  // namespace hyselam_conversation
