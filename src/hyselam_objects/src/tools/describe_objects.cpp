// describe_objects (TEXT | -) --map OBJECTS.xml: records what people say about objects in an object
// map, and answers questions.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <iterator>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_objects/language/fill_map.hpp"
#include "hyselam_objects/language/link_places.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace {

bool exists(const std::string& path) {
  return std::ifstream(path).good();
}

hyselam_topo::GrammarSource readText(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw hyselam::InputError(path, "", "cannot be read");
  return {path, std::string(std::istreambuf_iterator<char>(file), {})};
}

hyselam_objects::ObjectParser parserOf(const std::vector<std::string>& grammars) {
  if (grammars.empty()) return hyselam_objects::ObjectParser::shipped();
  if (grammars.size() % 2 != 0) {
    throw hyselam::InputError("--grammar", "", "needs a grammar and a list of words for each");
  }
  std::vector<hyselam_objects::ObjectLanguage> languages;
  for (std::size_t i = 0; i < grammars.size(); i += 2) {
    languages.push_back({readText(grammars[i]), readText(grammars[i + 1])});
  }
  return hyselam_objects::ObjectParser(languages);
}

/// Whether a text was nothing but questions.
bool asksOnly(const std::vector<hyselam_objects::ObjectReply>& replies) {
  return !replies.empty() && std::all_of(replies.begin(), replies.end(), [](const auto& each) {
    return each.kind == hyselam_objects::ReplyKind::kAnswer;
  });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Records what people say about objects in an object map, and answers questions about them.",
      "describe_objects");
  std::string text, map_path, topology_path, dictionary_path, place;
  std::vector<std::string> grammars;
  app.add_option("TEXT", text, "sentences; - reads them from the standard input")->required();
  app.add_option(
         "--map", map_path,
         "object map, loaded if it exists, and written if something was told; the first telling "
         "creates it")
      ->required();
  app.add_option("--topology", topology_path, "topological map whose places are linked");
  app.add_option("--dictionary", dictionary_path, "object dictionary: the kinds that are known");
  app.add_option("--here", place, "the place where the robot is");
  app.add_option("--grammar", grammars,
                 "instead of the shipped ones: pairs of a grammar and its list of words");

  return hyselam::runTool(argc, argv, app, [&] {
    if (text == "-") text.assign(std::istreambuf_iterator<char>(std::cin), {});
    hyselam_objects::ObjectMap map;
    const bool is_new = !exists(map_path);
    if (!is_new) map = hyselam_objects::loadObjectMap(map_path);
    const hyselam_objects::ObjectMap before = map;
    hyselam_objects::ObjectDictionary dictionary;
    if (!dictionary_path.empty()) dictionary = hyselam_objects::loadDictionary(dictionary_path);
    const hyselam_objects::ObjectParser parser = parserOf(grammars);
    hyselam_objects::FillMap fill(parser, map);
    fill.setRobotPlace(place);
    nlohmann::json replies = nlohmann::json::array();
    const auto said = fill.process(text);
    if (is_new && asksOnly(said)) {
      throw hyselam::InputError(map_path, "", "does not exist; a question does not create it");
    }
    for (const hyselam_objects::ObjectReply& reply : said) {
      // There is no camera here: "this is a cup" shows nothing.
      const bool shown = reply.code == "shown";
      const std::string reply_text = shown ? fill.noCameraReply(reply.kind_of_object) : reply.text;
      std::cout << reply_text << "\n";
      replies.push_back({{"kind", toString(reply.kind)},
                         {"code", shown ? "no_camera" : reply.code},
                         {"text", reply_text},
                         {"objects", reply.objects},
                         {"places", reply.places}});
    }
    nlohmann::json unlinked = nullptr;
    if (!topology_path.empty()) {
      unlinked = hyselam_objects::linkPlaces(map, hyselam_topo::loadXml(topology_path),
                                             hyselam_objects::shippedPlaceNames());
    }
    const std::vector<std::string> unknown = fill.unknownKinds(dictionary);
    const std::string to_show = fill.kindToShow(dictionary, said);
    if (!dictionary_path.empty() && !to_show.empty()) {
      std::cout << fill.showRequest(to_show) << "\n";
    }
    if (!(map == before)) hyselam_objects::saveXml(map_path, map);
    return nlohmann::json{{"replies", replies},
                          {"objects", hyselam_objects::summaryLines(map)},
                          {"unknown_kinds", unknown},
                          {"places_without_topology", unlinked}};
  });
}
