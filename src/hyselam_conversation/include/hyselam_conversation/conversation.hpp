// A whole talk with the robot without ROS, without a master and without a robot: the dialogue about
// places and the statements about objects joined as TopoEngine and ObjectEngine join them over
// topics, and a stand-in of the robot that has a pose in the map and drives along ways.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_objects/language/fill_map.hpp"
#include "hyselam_objects/mapping/object_map.hpp"
#include "hyselam_topo/dialogue/dialogue.hpp"
#include "hyselam_topo/dialogue/shared_dialogue.hpp"

namespace hyselam_conversation {

using hyselam_topo::Id;

/// What the stand-in of the robot is doing.
enum class Motion {
  kStanding,
  kDriving,   ///< along the legs of a goal
  kFollowing  ///< a person
};

/// "standing", "driving", "following".
const char* toString(Motion motion);

/// What is read from grammars and phrases: made once, shared by many conversations.
struct Languages {
  hyselam_topo::TopoParser places;
  std::vector<hyselam_topo::Phrases> phrases;
  hyselam_objects::ObjectParser objects;

  /// All shipped languages.
  static std::shared_ptr<const Languages> shipped();
};

struct ConversationParams {
  hyselam_topo::DialogueParams dialogue;
  /// Whether a robot that is sent somewhere is there before the next text; otherwise it is half-way
  /// until arrive() or until it is stopped or sent elsewhere.
  bool arrive_at_once = true;
};

/// Which part of the robot has replied.
enum class Layer { kNone, kPlaces, kObjects, kBoth };

/// "", "places", "objects", "both".
const char* toString(Layer layer);

/// The name of a place that was gained, lost or confirmed.
struct NameChange {
  Id place = 0;
  std::string code;    ///< of the place, as in the replies: "SS03"
  std::string before;  ///< "" for none
  std::string after;   ///< "" for none
  bool confirmed = false;
};

/// What one text of a person, or one event, has led to.
struct Exchange {
  std::string text;                ///< what was said; "" for an event
  std::vector<std::string> reply;  ///< what the robot says, in order
  std::string language;
  Layer layer = Layer::kNone;
  std::vector<hyselam_topo::Utterance> utterances;  ///< what the dialogue about places heard
  std::vector<std::string> forwarded;               ///< what was passed on to the layer of objects
  std::vector<hyselam_topo::Refusal> refusals;      ///< what was not taken down, and why
  /// Read-back: what is new or changed in the description, and answers of the layer of objects.
  std::vector<std::string> understood;
  std::string question;  ///< open after it; "" for none
  std::vector<NameChange> names;
  bool stopped = false;               ///< the robot was told to stop
  std::optional<Id> goal;             ///< where it was sent
  Motion motion = Motion::kStanding;  ///< after it
  Id place = 0;                       ///< of the robot after it; 0: not known

  std::string replyText() const;  ///< the sentences, separated by spaces
};

class Conversation {
 public:
  /// @throws hyselam::ParameterError as Dialogue.
  explicit Conversation(const ConversationParams& params = {},
                        hyselam_objects::ObjectMap objects = {},
                        std::shared_ptr<const Languages> languages = Languages::shipped());
  Conversation(const Conversation&) = delete;

  /// The map of the building: places, and their cells for a robot that drives. What is no place
  /// counts as a wall. @throws hyselam::InputError as Dialogue::setMap().
  Exchange setMap(const hyselam_topo::AugmentedTopologicalMap& map);
  /// Continues a dialogue that was saved, with its map. @throws as Dialogue::restore().
  void restore(hyselam_topo::DialogueState state);

  // ---- What happens to the robot. The reply is what it says unasked. ----
  /// The robot stands there from now on, and does not drive.
  Exchange stand(const hyselam::Pose2& pose);
  /// In the middle of the nearest place with that name or code ("SS03").
  /// @throws hyselam::InputError if no place is called so.
  Exchange standAt(const std::string& place);
  /// The robot is sent there by somebody, and on its way until arrive().
  /// @throws hyselam::InputError as standAt(), and if it does not set out, with the reason: it is
  /// there already, the name is only a guess, or there is no way.
  Exchange driveTo(const std::string& place);
  /// The robot is where it was sent, on the way through all places between.
  Exchange arrive();
  /// The robot asks now what there is to ask about its place.
  Exchange askHere();

  // ---- What is known beforehand, as from an earlier talk ----
  /// Confirms names. @throws hyselam::InputError as standAt(), and as Dialogue::name().
  void confirmNames(const std::string& place, const std::vector<std::string>& names);
  /// Names that are only guessed, so that the robot asks whether they are right. Throws likewise.
  void guessNames(const std::string& place, const std::vector<std::string>& names);

  /// Any text of a person. Never throws, whatever the content.
  Exchange say(const std::string& text);

  const hyselam_topo::Dialogue& dialogue() const { return dialogue_; }
  const hyselam_objects::ObjectMap& objects() const { return objects_; }
  /// The question that is open; "" for none.
  const std::string& question() const { return question_; }
  Motion motion() const { return motion_; }
  /// Names of places and kinds of objects that are known, sorted.
  std::vector<std::string> knownNames() const;

 private:
  using Names = std::map<Id, std::pair<std::string, bool>>;  // of places, and whether confirmed

  Id find(const std::string& place) const;
  Names namesNow() const;
  void take(const hyselam_topo::Reply& reply, Layer layer, Exchange& out);
  void perform(const hyselam_topo::DialogueAction& action, Exchange& out);
  void drive(const std::vector<hyselam_topo::RouteLeg>& legs, Exchange& out);
  /// Why the robot did not set out for a place.
  std::string whyNot(const std::string& place, const Exchange& answer) const;
  void moveTo(const hyselam::Pose2& pose, double seconds, Exchange& out);
  void askObjects(const hyselam_topo::ForwardedSentence& sentence, Exchange& out);
  void finish(const Names& before, Exchange& out);

  ConversationParams params_;
  std::shared_ptr<const Languages> languages_;
  hyselam_topo::Dialogue dialogue_;
  hyselam_topo::SharedDialogue shared_{dialogue_};
  hyselam_objects::ObjectMap objects_;
  hyselam_objects::ObjectDictionary dictionary_;  // nothing is recognized without a camera
  hyselam_topo::PlaceNames place_names_;
  hyselam_objects::FillMap fill_map_;
  double time_ = 0.0;  // of the robot's pose [s]
  Motion motion_ = Motion::kStanding;
  std::vector<hyselam::Pose2> ahead_;  // what remains of the way
  std::string question_;
};

}  // namespace hyselam_conversation
