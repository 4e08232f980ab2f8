#include "selovis/place_graph.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <queue>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr std::size_t kMaxPlaces = 10000;

int findOrAdd(PlaceGraph& graph, const std::string& name) {
  const int known = graph.find(name);
  if (known >= 0) return known;
  graph.places.push_back(name);
  return static_cast<int>(graph.places.size()) - 1;
}

void join(PlaceGraph& graph, int a, int b) {
  if (a != b && !graph.connected(a, b))
    graph.transitions.emplace_back(std::min(a, b), std::max(a, b));
}

PlaceGraph readJson(const std::string& path, const std::string& text) {
  PlaceGraph graph;
  try {
    const auto json = nlohmann::json::parse(text);
    for (const auto& place : json.at("places")) {
      const auto name = place.get<std::string>();
      if (graph.find(name) >= 0) {
        throw hyselam::InputError(path, "places", "'" + name + "' is there twice");
      }
      graph.places.push_back(name);
      if (graph.places.size() > kMaxPlaces) {
        throw hyselam::InputError(path, "places", "more than " + std::to_string(kMaxPlaces));
      }
    }
    std::size_t line = 0;
    for (const auto& pair : json.at("transitions")) {
      const std::string where = "transitions[" + std::to_string(line++) + "]";
      if (!pair.is_array() || pair.size() != 2) {
        throw hyselam::InputError(path, where, "must be two names");
      }
      const int a = graph.find(pair[0].get<std::string>()),
                b = graph.find(pair[1].get<std::string>());
      if (a < 0 || b < 0)
        throw hyselam::InputError(path, where, "names a place that is not listed");
      join(graph, a, b);
    }
  } catch (const nlohmann::json::exception& e) {
    throw hyselam::InputError(path, "", std::string("is no place graph: ") + e.what());
  }
  return graph;
}

PlaceGraph readEdgeList(const std::string& path, const std::string& text) {
  PlaceGraph graph;
  std::istringstream in(text);
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#' || (number == 1 && line == "from,to")) continue;
    const std::string where = "line " + std::to_string(number);
    const std::size_t comma = line.find(',');
    const std::string a = line.substr(0, comma);
    if (a.empty() || line.find('\0') != std::string::npos) {
      throw hyselam::InputError(path, where, "must be 'place,place' or 'place'");
    }
    const int first = findOrAdd(graph, a);
    if (comma != std::string::npos) {
      const std::string b = line.substr(comma + 1);
      if (b.empty() || b.find(',') != std::string::npos) {
        throw hyselam::InputError(path, where, "must be 'place,place' or 'place'");
      }
      join(graph, first, findOrAdd(graph, b));
    }
    if (graph.places.size() > kMaxPlaces) {
      throw hyselam::InputError(path, where, "more than " + std::to_string(kMaxPlaces) + " places");
    }
  }
  return graph;
}

}  // namespace

int PlaceGraph::find(const std::string& name) const {
  const auto at = std::find(places.begin(), places.end(), name);
  return at == places.end() ? -1 : static_cast<int>(at - places.begin());
}

bool PlaceGraph::connected(int a, int b) const {
  const std::pair<int, int> edge(std::min(a, b), std::max(a, b));
  return std::any_of(transitions.begin(), transitions.end(), [&](const std::pair<int, int>& t) {
    return std::min(t.first, t.second) == edge.first && std::max(t.first, t.second) == edge.second;
  });
}

std::size_t rename(const std::vector<Renaming>& renamings, PlaceGraph* graph) {
  std::size_t changed = 0;
  for (const auto& renaming : renamings) {
    const int place = graph->find(renaming.from);
    if (place < 0 || graph->find(renaming.to) >= 0) continue;
    graph->places[static_cast<std::size_t>(place)] = renaming.to;
    ++changed;
  }
  return changed;
}

PlaceDistances shortestPaths(const PlaceGraph& graph) {
  PlaceDistances result;
  const std::size_t n = result.size = graph.places.size();
  result.distance.assign(n * n, -1);
  result.first_step.assign(n * n, -1);
  std::vector<std::vector<int>> next(n);
  for (const auto& t : graph.transitions) {
    next[static_cast<std::size_t>(t.first)].push_back(t.second);
    next[static_cast<std::size_t>(t.second)].push_back(t.first);
  }
  for (auto& list : next) std::sort(list.begin(), list.end());
  for (std::size_t i = 0; i < n; ++i) {  // breadth first from i; all paths lead to it
    int* distance = result.distance.data() + i * n;
    std::queue<int> open;
    distance[i] = 0;
    result.first_step[i * n + i] = static_cast<int>(i);
    open.push(static_cast<int>(i));
    while (!open.empty()) {
      const int at = open.front();
      open.pop();
      for (const int to : next[static_cast<std::size_t>(at)]) {
        if (distance[to] >= 0) continue;
        distance[to] = distance[at] + 1;
        open.push(to);
      }
    }
    for (std::size_t j = 0; j < n; ++j) {
      if (j == i || distance[j] < 0) continue;
      for (const int step : next[j]) {
        if (distance[step] == distance[j] - 1) {
          result.first_step[i * n + j] = step;
          break;
        }
      }
    }
  }
  return result;
}

PlaceGraph readPlaceGraph(const std::string& path) {
  const std::string text = hyselam::readTextFile(path, std::size_t{16} << 20);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  PlaceGraph graph = first != std::string::npos && text[first] == '{' ? readJson(path, text)
                                                                      : readEdgeList(path, text);
  if (graph.places.empty()) throw hyselam::InputError(path, "", "has no places");
  return graph;
}

PlaceGraph graphOfTours(const std::vector<std::string>& places,
                        const std::vector<std::vector<int>>& tours) {
  PlaceGraph graph;
  graph.places = places;
  for (const auto& tour : tours) {
    for (std::size_t i = 1; i < tour.size(); ++i) join(graph, tour[i - 1], tour[i]);
  }
  return graph;
}

PlaceGraph reordered(const PlaceGraph& graph, const std::vector<std::string>& places,
                     std::vector<std::string>* missing) {
  PlaceGraph result;
  result.places = places;
  std::vector<int> index(graph.places.size(), -1);
  for (std::size_t i = 0; i < graph.places.size(); ++i) index[i] = result.find(graph.places[i]);
  for (const auto& t : graph.transitions) {
    const int a = index[static_cast<std::size_t>(t.first)],
              b = index[static_cast<std::size_t>(t.second)];
    if (a >= 0 && b >= 0) join(result, a, b);
  }
  if (missing != nullptr) {
    for (const auto& place : places) {
      if (graph.find(place) < 0) missing->push_back(place);
    }
  }
  return result;
}

}  // namespace selovis
