// What one text of a person leads to: what the robot says and does, and what another node may
// understand. Plain values.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_topo/dialogue/place_pose.hpp"
#include "hyselam_topo/dialogue/route.hpp"

namespace hyselam_topo {

struct DialogueAction {
  enum class Kind {
    kMap,     ///< the names or places of map() have changed
    kWalls,   ///< the described walls have changed, and so has gridWithWalls()
    kGo,      ///< drive `legs`, one after another
    kStop,    ///< stop driving
    kFollow,  ///< follow the person
    kTurn,    ///< turn by `angle`
    kPose     ///< a person says that the robot is at `pose`: its localisation starts from there
  };
  Kind kind = Kind::kMap;
  std::vector<RouteLeg> legs;
  double angle = 0.0;  ///< [rad], left > 0
  std::optional<PlacePose> pose = std::nullopt;
};

/// A sentence for another node, which handles other topics (objects).
struct ForwardedSentence {
  std::string text;
  /// Reply if no other node understands it either; empty: the dialogue understands the sentence and
  /// processes it then, by hear() without forwarding.
  std::string refusal;
  /// Refused because it is about an object: another node can give the reason.
  bool about_object = false;
  /// The dialogue understands the sentence, but cannot do it or does not know the place: its
  /// refusal is the one to give.
  bool understood = false;
  std::string reason;      ///< of the refusal, without the sentence around it
  std::string suggestion;  ///< as Refusal::suggestion
  /// The suggestion is what may have been meant: Dialogue::refuse() asks for it, and after a "no"
  /// for the alternatives.
  bool suggests_meaning = false;
  std::vector<std::string> alternatives;
  std::string rest;  ///< the refusals of parts that the suggestion is not about
};

/// A statement, or part of one, that is not understood or contradicts what is known.
struct Refusal {
  std::string text;        ///< what was said
  std::string reason;      ///< for people
  bool by_other = false;   ///< the reason is that of the node that handles objects
  std::string suggestion;  ///< a sentence that would be understood; "": none
};

struct Reply {
  std::string language;
  std::vector<std::string> sentences;
  std::vector<DialogueAction> actions;
  std::vector<ForwardedSentence> forwarded;
  std::vector<Refusal> refusals;      ///< what was not taken down; `sentences` tells it
  std::vector<Utterance> utterances;  ///< what was heard
  bool unknown_name = false;          ///< unknown place name in the last command
  /// Stop or cancel was said: what other nodes have begun or asked is over, too.
  bool stopped = false;
  /// A question that another node has asked is over: something else was said.
  bool ends_other_question = false;

  std::string text() const;  ///< the sentences, separated by spaces
  bool has(DialogueAction::Kind kind) const;
  /// What `next` says, does, refuses and has heard comes after what this does, in its language.
  /// Its `forwarded` and its flags are left out: only this text is passed on to other nodes.
  void append(Reply next);
};

struct HearOptions {
  /// Another node also handles sentences: those that are not understood, or name an unknown place,
  /// are returned in Reply::forwarded instead of being refused.
  bool forward_unknown = false;
  /// The last topic was an object: "it is in room X" refers to it, and "A is in room X" is about an
  /// object if A is not a known place.
  bool objects_spoken_of = false;
  /// Another node asked the last question: answers are forwarded to it.
  bool others_asked_last = false;
};

}  // namespace hyselam_topo
