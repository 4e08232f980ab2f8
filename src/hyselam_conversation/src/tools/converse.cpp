// converse [--map TOPO.xml] [--transcript IN.txt] [--json OUT]: a talk with the robot without ROS.
#include <iostream>
#include <iterator>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_conversation/example_map.hpp"
#include "hyselam_conversation/transcript_player.hpp"
#include "hyselam_topo/dialogue/dialogue_state.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace {

using hyselam_conversation::Beginning;
using hyselam_conversation::Step;
using hyselam_conversation::TranscriptPlayer;
using nlohmann::json;

struct Options {
  std::string map, objects, state, start, transcript, language = "en", ask = "unconfirmed";
  double match_time_limit = hyselam_topo::DialogueParams::defaultMatch().time_limit;
  bool lines = false;
};

constexpr const char* kStartInExample = "1,8,0";  // the corridor's west end, looking along it

hyselam_topo::AskPolicy policyOf(const std::string& word) {
  if (word == "never") return hyselam_topo::AskPolicy::kNever;
  return word == "always" ? hyselam_topo::AskPolicy::kAlways
                          : hyselam_topo::AskPolicy::kUnconfirmed;
}

Beginning beginningOf(const Options& o) {
  Beginning out;
  out.params.dialogue.language = o.language;
  out.params.dialogue.ask = policyOf(o.ask);
  out.params.dialogue.match.time_limit = o.match_time_limit;
  out.start = o.start;
  if (!o.objects.empty()) out.objects = hyselam_objects::loadObjectMap(o.objects);
  if (!o.state.empty()) out.state = hyselam_topo::loadDialogueState(o.state);
  if (!o.map.empty()) {
    out.map = hyselam_topo::loadXml(o.map);
  } else if (o.state.empty()) {
    out.map = hyselam_conversation::exampleMap();
    if (out.start.empty()) out.start = kStartInExample;
  }
  return out;
}

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
json serve(TranscriptPlayer& player) {
  json records = json::array();
  for (std::string line; std::getline(std::cin, line);) {
    json answer = json::object();
    try {
      for (const Step& step : hyselam_conversation::stepsOf(line, "input")) {
        if (const auto record = player.play(step)) records.push_back(answer = *record);
      }
    } catch (const hyselam::InputError& e) {
      answer["error"] = e.what();
    }
    answer["open_question"] = player.conversation().question();
    answer["known_names"] = player.conversation().knownNames();
    std::cout << answer.dump() << std::endl;
  }
  return records;
}

/// Plays the steps of a transcript; `records` holds what was said, also if one cannot be done.
/// @throws hyselam::InputError with the line, std::runtime_error for replies that are not expected
void play(const std::vector<Step>& steps, const std::string& source, TranscriptPlayer& player,
          json* records) {
  for (const Step& step : steps) {
    try {
      if (const auto record = player.play(step)) {
        print(*record);
        records->push_back(*record);
      }
    } catch (const hyselam::InputError& e) {
      throw hyselam::InputError(source, "line " + std::to_string(step.line), e.what());
    }
  }
  for (const std::string& failure : player.failures()) std::cerr << failure << '\n';
  if (!player.failures().empty()) {
    throw std::runtime_error(std::to_string(player.failures().size()) +
                             " replies are not as expected");
  }
}

json run(const Options& o) {
  TranscriptPlayer player(beginningOf(o));
  if (o.lines) return serve(player);
  json records = json::array();
  const bool is_file = !o.transcript.empty() && o.transcript != "-";
  const std::string text = is_file ? hyselam::readTextFile(o.transcript, std::size_t{1} << 24)
                                   : std::string(std::istreambuf_iterator<char>(std::cin), {});
  const std::string source = is_file ? o.transcript : "stdin";
  const std::vector<Step> steps = hyselam_conversation::stepsOf(text, source);
  try {
    play(steps, source, player, &records);
  } catch (const std::exception&) {
    throw hyselam::PartialResult{records, std::current_exception()};
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
  app.add_option("--match-time-limit", options.match_time_limit,
                 "then the best names found so far are taken [s]");
  app.add_flag("--lines", options.lines,
               "answer each line of the standard input with a line of JSON, for programs");
  return hyselam::runTool(argc, argv, app, [&] { return run(options); });
}
