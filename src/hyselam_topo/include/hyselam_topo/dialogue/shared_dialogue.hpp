// A conversation that the dialogue about places shares with a node that handles objects: which
// sentences go on to it, and what is said and done with its answers.
//
// Used by the node (TopoEngine) and by the conversation without ROS (package hyselam_conversation).
#pragma once

#include <string>
#include <vector>

#include "hyselam_topo/dialogue/dialogue.hpp"

namespace hyselam_topo {

/// What the other node answers to a forwarded sentence.
struct OtherAnswer {
  struct Goal {
    std::string name;
    Id place = 0;  ///< in the topological map; 0: not known
  };
  bool understood = false;
  /// Not understood, but rather about things than about places: `reply` is the refusal to give.
  bool about_things = false;
  std::string reply;   ///< for people
  std::string reason;  ///< of a refusal, without the sentence around it
  bool is_question = false;
  bool go_to_place = false;  ///< "fetch the pen": drive to the nearest of `places`
  std::vector<Goal> places;  ///< that the reply is about
};

class SharedDialogue {
 public:
  /// `dialogue` must outlive this.
  explicit SharedDialogue(Dialogue& dialogue) : dialogue_(dialogue) {}

  /// Dialogue::restore(), and nothing was said of objects yet. Throws likewise.
  void restore(DialogueState state);
  /// Any text of a person. `others_listen`: there is a node that handles objects; the sentences for
  /// it are in Reply::forwarded, and each is to be given to answered() with its answer.
  Reply hear(const std::string& text, bool others_listen);
  /// What is said and done with the answer to a forwarded sentence; nullptr: none came in time.
  Reply answered(const ForwardedSentence& sentence, const OtherAnswer* answer);

  /// The last question was about an object.
  bool objectAskedLast() const { return object_asked_last_; }

 private:
  Reply carryOut(const OtherAnswer& answer);
  std::vector<Id> goalsOf(const OtherAnswer& answer) const;

  Dialogue& dialogue_;
  bool objects_spoken_of_ = false;  // in the last sentence
  bool object_asked_last_ = false;
};

}  // namespace hyselam_topo
