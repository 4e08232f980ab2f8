// parse_description (TEXT | -) --out HUMAN.xml: what people tell about a building, as a graph.
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <iterator>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_language/building/description_xml.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"
#include "hyselam_language/reader/tour_reader.hpp"

namespace {

using hyselam_topo::DescribedBuilding;
using hyselam_topo::DescriptionIssue;
using hyselam_topo::ParsedText;
using hyselam_topo::Slot;
using hyselam_topo::TextRange;
using hyselam_topo::Utterance;
using nlohmann::json;

constexpr std::size_t kMaxBytes = 1u << 20;

struct Input {
  std::string name;  ///< for errors
  std::string text;
};

Input inputOf(const std::string& argument) {
  if (argument == "-") {
    std::string text(std::istreambuf_iterator<char>(std::cin), {});
    return {"stdin", std::move(text)};
  }
  std::error_code ignored;
  if (std::filesystem::exists(argument, ignored)) {
    return {argument, hyselam::readTextFile(argument, kMaxBytes)};
  }
  return {"text", argument};
}

json rangeOf(TextRange range) {
  return {range.begin, range.end};
}

template <typename T>
json maybe(const std::optional<T>& value) {
  return value ? json(*value) : json(nullptr);
}

json placesOf(const DescribedBuilding& building) {
  json all = json::array();
  for (const auto& place : building.places) {
    all.push_back(
        {{"id", place.id},
         {"name", place.name},
         {"aliases", place.aliases},
         {"kind", place.kind ? json(toString(*place.kind)) : json(nullptr)},
         {"length", maybe(place.length)},
         {"width", maybe(place.width)},
         {"area", maybe(place.area)},
         {"parts", maybe(place.parts)},
         {"size_word", place.size_word ? json(toString(*place.size_word)) : json(nullptr)},
         {"doors", maybe(place.doors)},
         {"floor", maybe(place.floor)}});
  }
  return all;
}

json slotOf(const Slot& slot) {
  json value = {{"type", slot.type}, {"range", rangeOf(slot.range)}};
  if (!slot.names.empty()) {
    value["names"] = json::array();
    for (const auto& name : slot.names) {
      if (!name.reference.empty()) {
        value["names"].push_back({{"reference", name.reference}});
      } else if (name.speaker) {
        value["names"].push_back({{"speaker", name.text}});
      } else {
        value["names"].push_back(name.text);
      }
    }
  }
  if (slot.number) value["number"] = *slot.number;
  if (slot.unit_assumed) value["unit_assumed"] = true;
  if (!slot.word.empty()) value["word"] = slot.word;
  return value;
}

json understood(const Utterance& utterance) {
  json slots = json::object();
  for (const Slot& slot : utterance.slots) slots[slot.name] = slotOf(slot);
  json spelling = json::array();
  for (const auto& each : utterance.spelling) {
    spelling.push_back({{"said", each.said}, {"taken_as", each.taken_as}});
  }
  return {{"text", utterance.text},
          {"range", rangeOf(utterance.range)},
          {"kind", toString(utterance.kind)},
          {"intent", utterance.intent},
          {"correction", utterance.correction},
          {"slots", slots},
          {"spelling", spelling},
          {"left_out", utterance.left_out}};
}

json notUnderstood(const Utterance& utterance) {
  return {{"text", utterance.text},
          {"range", rangeOf(utterance.range)},
          {"reason", utterance.reason},
          {"code", utterance.reason_code},
          {"culprit", rangeOf(utterance.culprit)},
          {"suggestion", utterance.suggestion},
          {"suggests_meaning", utterance.suggests_meaning}};
}

json issueOf(const DescriptionIssue& issue) {
  json told = {{"text", issue.text},
               {"range", rangeOf(issue.range)},
               {"kind", toString(issue.kind)},
               {"reason", issue.reason}};
  if (!issue.name.empty()) told["name"] = issue.name;
  return told;
}

/// Questions to the person rather than faults.
bool isAsked(const DescriptionIssue& issue) {
  return issue.kind == hyselam_topo::IssueKind::kAsk ||
         issue.kind == hyselam_topo::IssueKind::kStrangeName;
}

struct Options {
  std::string text, out, language = "auto";
  std::vector<std::string> grammars, accepted;
  std::string speaker;
  bool tour = false;
  hyselam_topo::DescriptionParams params;
};

json resultOf(const ParsedText& parsed, const DescribedBuilding& building,
              const std::vector<DescriptionIssue>& issues, double microseconds) {
  json result;
  result["language"] = parsed.language;
  result["places"] = placesOf(building);
  result["connections"] = json::array();
  for (const auto& each : building.connections) {
    result["connections"].push_back({{"from", each.from},
                                     {"to", each.to},
                                     {"side", toString(each.side)},
                                     {"order", each.order},
                                     {"rank", maybe(each.rank)},
                                     {"distance", maybe(each.distance)},
                                     {"side_certainty", each.side_certainty},
                                     {"order_certainty", each.order_certainty}});
  }
  result["relations"] = json::array();
  for (const auto& each : building.relations) {
    json relation = {{"kind", toString(each.kind)}, {"a", each.a}, {"b", each.b}};
    if (each.c != 0) relation["c"] = each.c;
    if (each.side != hyselam_topo::Side::kUnknown) relation["side"] = toString(each.side);
    if (each.denied) relation["denied"] = true;
    result["relations"].push_back(relation);
  }
  result["robot_place"] = maybe(building.robot_place);
  result["place_count"] = maybe(building.place_count);
  result["understood"] = json::array();
  result["not_understood"] = json::array();
  for (const Utterance& utterance : parsed.utterances) {
    if (utterance.understood()) {
      result["understood"].push_back(understood(utterance));
    } else {
      result["not_understood"].push_back(notUnderstood(utterance));
    }
  }
  result["issues"] = json::array();
  result["asks"] = json::array();
  for (const DescriptionIssue& issue : issues) {
    result["issues"].push_back(issueOf(issue));
    if (isAsked(issue)) result["asks"].push_back(issueOf(issue));
  }
  result["microseconds"] = microseconds;
  return result;
}

long percent(double probability) {
  return std::lround(100.0 * probability);
}

void printRow(const char* side, const std::vector<hyselam_topo::TourRoom>& row) {
  std::cout << side << ':';
  const char* before = " ";
  for (const hyselam_topo::TourRoom& room : row) {
    std::cout << before << room.name << " (" << percent(room.side_certainty) << " %";
    if (&room != &row.front())
      std::cout << ", behind the one before " << percent(room.order_certainty) << " %";
    std::cout << ')';
    before = "; ";
  }
  std::cout << '\n';
}

/// Running talk as a tour along a corridor.
json runTour(const Options& o) {
  const Input input = inputOf(o.text);
  if (!o.grammars.empty())
    throw hyselam::InputError("--grammar", "", "the reader of tours knows the shipped ones only");
  hyselam_topo::ParseOptions options;
  options.language = o.language;
  options.max_bytes = kMaxBytes;
  const ParsedText parsed = hyselam_topo::TopoParser().parse(input.text, options);
  const auto grammar = hyselam_topo::Grammar::shipped(parsed.language);
  const hyselam_topo::ToldTour tour = hyselam_topo::TourReader::shipped(grammar).read(input.text);
  if (tour.empty())
    throw hyselam::InputError(input.name, "", "names no room: this is no tour of a building");
  const DescribedBuilding building = hyselam_topo::describeTour(tour, grammar.say("tour_corridor"));
  hyselam_topo::saveXml(o.out, building);
  std::cout << parsed.language << ": a tour past " << building.places.size() - 1 << " rooms -> "
            << o.out << '\n';
  printRow("left", tour.left);
  printRow("right", tour.right);
  return resultOf({parsed.language, {}}, building, {}, 0.0);
}

json run(const Options& o) {
  if (o.tour) return runTour(o);
  using Clock = std::chrono::steady_clock;
  const Input input = inputOf(o.text);
  const hyselam_topo::TopoParser parser =
      o.grammars.empty() ? hyselam_topo::TopoParser()
                         : hyselam_topo::TopoParser({hyselam_topo::Grammar::load(o.grammars)});
  hyselam_topo::ParseOptions options;
  options.language = o.language;
  options.max_bytes = kMaxBytes;
  const auto begin = Clock::now();
  const ParsedText parsed = parser.parse(input.text, options);
  hyselam_topo::DescriptionBuilder builder(parser, o.params);
  builder.setSpeaker(o.speaker);
  for (const std::string& name : o.accepted) builder.acceptName(name);
  const std::vector<DescriptionIssue> issues = builder.add(parsed);
  const double microseconds =
      std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
  const bool unusable =
      !parsed.utterances.empty() &&
      (parsed.utterances[0].reason_code == "not_text" || input.text.size() > options.max_bytes);
  if (unusable) throw hyselam::InputError(input.name, "", parsed.utterances[0].reason);
  const DescribedBuilding& building = builder.building();
  hyselam_topo::saveXml(o.out, building);
  std::cout << parsed.language << ": " << building.places.size() << " places, "
            << building.connections.size() << " connections, " << building.relations.size()
            << " relations -> " << o.out << '\n';
  for (const Utterance& utterance : parsed.utterances) {
    for (const std::string& words : utterance.left_out) std::cout << "left out: " << words << '\n';
    if (utterance.understood()) continue;
    std::cout << "not understood: " << utterance.text << " (" << utterance.reason << ")\n";
  }
  for (const DescriptionIssue& issue : issues) {
    const bool notice = issue.kind == hyselam_topo::IssueKind::kNotice;
    std::cout << (notice ? "noted: " : "not taken down: ") << issue.text << " (" << issue.reason
              << ")\n";
  }
  return resultOf(parsed, building, issues, microseconds);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Turns what a person tells about a building into a graph of places: names, sizes, sides, "
      "and where the robot is. Sentences that are not understood are listed with the reason; the "
      "status is 0 all the same.",
      "parse_description");
  Options options;
  app.add_option("TEXT", options.text,
                 "what was said; the file of that name, if there is one; - for the standard input")
      ->required();
  app.add_option("--out", options.out, "XML of the described building")->required();
  app.add_option("--language", options.language, "en, pt, or auto: the one that understands most")
      ->capture_default_str();
  app.add_option("--grammar", options.grammars,
                 "grammar files (YAML) of one language instead of the shipped ones; later ones add "
                 "to the first");
  app.add_option("--ask-strange-names", options.params.ask_strange_names,
                 "do not take down what names no kind of place until it is accepted")
      ->capture_default_str();
  app.add_option("--accept-name", options.accepted, "names of places, whatever they look like");
  app.add_flag("--tour", options.tour,
               "read the text as running talk of somebody who shows the robot round, from the "
               "beginning of a corridor: no sentence has to be understood, sides and order have a "
               "certainty");
  app.add_option("--speaker", options.speaker, "who speaks: 'my office' is theirs");
  return hyselam::runTool(argc, argv, app, [&] { return run(options); });
}
