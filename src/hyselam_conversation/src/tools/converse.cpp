// converse [--map TOPO.xml] [--transcript IN.txt] [--json OUT]: a talk with the robot without ROS.
#include <algorithm>
#include <iostream>
#include <iterator>

#include "exchange_json.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_conversation/transcript.hpp"
#include "hyselam_topo/dialogue/dialogue_state.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "shipped_maps.hpp"

namespace {

using hyselam_conversation::Conversation;
using hyselam_conversation::ConversationParams;
using hyselam_conversation::Exchange;
using hyselam_conversation::Languages;
using hyselam_conversation::Step;
using hyselam_topo::AugmentedTopologicalMap;
using nlohmann::json;

struct Options {
  std::string map, objects, state, start, transcript, language = "en", ask = "unconfirmed";
  bool lines = false;
};

AugmentedTopologicalMap mapOf(const Options& o) {
  if (!o.map.empty()) return hyselam_topo::loadXml(o.map);
  return hyselam_topo::fromXml(hyselam_conversation::kShippedMaps[0].text, "the shipped map");
}

constexpr const char* kStartInExample =
    "1,8,0";  // at the west end of the corridor, looking along it

/// Where a robot begins that was not told: the first corridor, else the largest place.
std::string defaultStart(const AugmentedTopologicalMap& map) {
  const hyselam_topo::Place* best = nullptr;
  for (const hyselam_topo::Place& place : map.places) {
    if (place.kind == hyselam_topo::PlaceKind::kCorridor) return codeOf(place);
    if (best == nullptr || place.area > best->area) best = &place;
  }
  return best == nullptr ? "" : codeOf(*best);
}

hyselam_topo::AskPolicy policyOf(const std::string& word) {
  if (word == "never") return hyselam_topo::AskPolicy::kNever;
  return word == "always" ? hyselam_topo::AskPolicy::kAlways
                          : hyselam_topo::AskPolicy::kUnconfirmed;
}

/// One talk after another, each from the same beginning.
class Talks {
 public:
  explicit Talks(const Options& options) : o_(options), map_(mapOf(options)) {
    params_.dialogue.language = o_.language;
    params_.dialogue.ask = policyOf(o_.ask);
    if (!o_.objects.empty()) objects_ = hyselam_objects::loadObjectMap(o_.objects);
    if (!o_.state.empty()) state_ = hyselam_topo::loadDialogueState(o_.state);
    begin();
  }

  Conversation& now() { return *now_; }

  /// The exchange that a step leads to; nothing for one that only prepares.
  std::optional<json> run(const Step& step) {
    const auto description = descriptionLines(*now_);
    const auto objects = summaryLines(now_->objects());
    const std::optional<Exchange> exchange = perform(step);
    if (!exchange) return std::nullopt;
    json record = recordOf(*exchange, *now_, description, objects);
    record["session"] = session_;
    if (step.kind == Step::Kind::kSay) record["id"] = std::exchange(id_, "");
    return record;
  }

 private:
  void begin() {
    now_.emplace(params_, objects_, languages_);
    if (state_) now_->restore(*state_);
    if (!state_ || !o_.map.empty()) now_->setMap(map_);
    const std::string start = o_.start.empty() ? defaultStart(now_->dialogue().map()) : o_.start;
    hyselam::Pose2 pose;
    if (hyselam_conversation::parsePose(start, &pose)) {
      now_->stand(pose);
    } else if (!start.empty()) {
      now_->standAt(start);
    }
  }

  std::optional<Exchange> perform(const Step& step) {
    switch (step.kind) {
      case Step::Kind::kSay:
        return now_->say(step.text);
      case Step::Kind::kPlace:
        return now_->standAt(step.place);
      case Step::Kind::kPose:
        return now_->stand(step.pose);
      case Step::Kind::kAsk:
        return now_->askHere();
      case Step::Kind::kDrive:
        return now_->driveTo(step.place);
      case Step::Kind::kArrive:
        return now_->arrive();
      case Step::Kind::kName:
        now_->confirmName(step.place, step.name);
        return std::nullopt;
      case Step::Kind::kGuess:
        now_->guessName(step.place, step.name);
        return std::nullopt;
      case Step::Kind::kId:
        id_ = step.text;
        return std::nullopt;
      case Step::Kind::kReset:
        ++session_;
        begin();
        return std::nullopt;
    }
    return std::nullopt;
  }

  const Options& o_;
  AugmentedTopologicalMap map_;
  ConversationParams params_;
  hyselam_objects::ObjectMap objects_;
  std::optional<hyselam_topo::DialogueState> state_;
  std::shared_ptr<const Languages> languages_ = Languages::shipped();
  std::optional<Conversation> now_;
  int session_ = 0;
  std::string id_;
};

void print(const json& record) {
  const std::string text = record["text"], reply = record["reply"], place = record["place"];
  if (text.empty()) {
    std::cout << "(" << record["motion"].get<std::string>() << ", "
              << (place.empty() ? "nowhere" : place) << ")\n";
  } else {
    std::cout << "You:   " << text << '\n';
  }
  for (const json& sentence : record["sentences"]) {
    std::cout << "Robot: " << sentence.get<std::string>() << '\n';
  }
}

/// One JSON object a line and step, for programs that lead the talk.
json serve(Talks& talks) {
  json records = json::array();
  for (std::string line; std::getline(std::cin, line);) {
    json answer = json::object();
    try {
      for (const Step& step : hyselam_conversation::stepsOf(line, "input")) {
        if (const auto record = talks.run(step)) records.push_back(answer = *record);
      }
    } catch (const hyselam::InputError& e) {
      answer["error"] = e.what();
    }
    answer["open_question"] = talks.now().question();
    answer["known_names"] = talks.now().knownNames();
    std::cout << answer.dump() << std::endl;
  }
  return records;
}

json run(const Options& o) {
  Talks talks(o);
  if (o.lines) return serve(talks);
  json records = json::array();
  const std::string text = o.transcript.empty() || o.transcript == "-"
                               ? std::string(std::istreambuf_iterator<char>(std::cin), {})
                               : hyselam::readTextFile(o.transcript, std::size_t{1} << 24);
  for (const Step& step :
       hyselam_conversation::stepsOf(text, o.transcript.empty() ? "stdin" : o.transcript)) {
    if (const auto record = talks.run(step)) {
      print(*record);
      records.push_back(*record);
    }
  }
  return records;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "A talk with the robot without ROS: reads what people say, one line a text, and prints what "
      "the robot answers. Lines that begin with @ put the robot somewhere and more: see the "
      "package's README.",
      "converse");
  app.option_defaults()->always_capture_default();
  Options options;
  app.add_option("--map", options.map,
                 "topological map, e.g. by gr2to; otherwise the example, an office of 20 rooms");
  app.add_option("--objects", options.objects, "object map to begin with");
  app.add_option("--state", options.state, "state of a dialogue to go on with");
  app.add_option("--start", options.start,
                 "where the robot is: X,Y,THETA or a place; otherwise in the first corridor");
  app.add_option("--transcript", options.transcript,
                 "what is said, and what happens; - or none: the standard input");
  app.add_option("--language", options.language, "of the robot's first sentences")
      ->check(CLI::IsMember({"en", "pt"}));
  app.add_option("--ask", options.ask, "when the robot asks by itself on entering a place")
      ->check(CLI::IsMember({"never", "unconfirmed", "always"}));
  app.add_flag("--lines", options.lines,
               "answer each line of the standard input with a line of JSON, for programs");
  return hyselam::runTool(argc, argv, app, [&] { return run(options); });
}
