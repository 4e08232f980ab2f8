#include "selovis/places/place_transitions.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <queue>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"

namespace selovis {
namespace {

constexpr std::size_t kMaxPlaces = 10000;

int findOrAdd(PlaceTransitions& transitions, const std::string& name) {
  const int known = transitions.indexOf(name);
  if (known >= 0) return known;
  transitions.places.push_back(name);
  return static_cast<int>(transitions.places.size()) - 1;
}

void join(PlaceTransitions& transitions, int a, int b) {
  if (a != b && !transitions.connected(a, b))
    transitions.pairs.emplace_back(std::min(a, b), std::max(a, b));
}

PlaceTransitions readJson(const std::string& path, const std::string& text) {
  PlaceTransitions transitions;
  try {
    const auto json = nlohmann::json::parse(text);
    for (const auto& place : json.at("places")) {
      const auto name = place.get<std::string>();
      if (transitions.indexOf(name) >= 0) {
        throw hyselam::InputError(path, "places", "'" + name + "' is there twice");
      }
      transitions.places.push_back(name);
      if (transitions.places.size() > kMaxPlaces) {
        throw hyselam::InputError(path, "places", "more than " + std::to_string(kMaxPlaces));
      }
    }
    std::size_t line = 0;
    for (const auto& pair : json.at("transitions")) {
      const std::string where = "transitions[" + std::to_string(line++) + "]";
      if (!pair.is_array() || pair.size() != 2) {
        throw hyselam::InputError(path, where, "must be two names");
      }
      const int a = transitions.indexOf(pair[0].get<std::string>()),
                b = transitions.indexOf(pair[1].get<std::string>());
      if (a < 0 || b < 0)
        throw hyselam::InputError(path, where, "names a place that is not listed");
      join(transitions, a, b);
    }
  } catch (const nlohmann::json::exception& e) {
    throw hyselam::InputError(path, "", std::string("is no place graph: ") + e.what());
  }
  return transitions;
}

PlaceTransitions readEdgeList(const std::string& path, const std::string& text) {
  PlaceTransitions transitions;
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
    const int first = findOrAdd(transitions, a);
    if (comma != std::string::npos) {
      const std::string b = line.substr(comma + 1);
      if (b.empty() || b.find(',') != std::string::npos) {
        throw hyselam::InputError(path, where, "must be 'place,place' or 'place'");
      }
      join(transitions, first, findOrAdd(transitions, b));
    }
    if (transitions.places.size() > kMaxPlaces) {
      throw hyselam::InputError(path, where, "more than " + std::to_string(kMaxPlaces) + " places");
    }
  }
  return transitions;
}

}  // namespace

int PlaceTransitions::indexOf(const std::string& name) const {
  const auto at = std::find(places.begin(), places.end(), name);
  return at == places.end() ? -1 : static_cast<int>(at - places.begin());
}

bool PlaceTransitions::connected(int a, int b) const {
  const std::pair<int, int> edge(std::min(a, b), std::max(a, b));
  return std::any_of(pairs.begin(), pairs.end(), [&](const std::pair<int, int>& t) {
    return std::min(t.first, t.second) == edge.first && std::max(t.first, t.second) == edge.second;
  });
}

std::size_t renamePlaces(const std::vector<PlaceRenaming>& renamings,
                         PlaceTransitions& transitions) {
  std::size_t changed = 0;
  for (const auto& renaming : renamings) {
    const int place = transitions.indexOf(renaming.from);
    if (place < 0 || transitions.indexOf(renaming.to) >= 0) continue;
    transitions.places[static_cast<std::size_t>(place)] = renaming.to;
    ++changed;
  }
  return changed;
}

PlaceDistances shortestPaths(const PlaceTransitions& transitions) {
  PlaceDistances result;
  const std::size_t n = result.size = transitions.places.size();
  result.distance.assign(n * n, -1);
  result.first_step.assign(n * n, -1);
  std::vector<std::vector<int>> next(n);
  for (const auto& t : transitions.pairs) {
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

PlaceTransitions readPlaceTransitions(const std::string& path) {
  const std::string text = hyselam::readTextFile(path, std::size_t{16} << 20);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  PlaceTransitions transitions = first != std::string::npos && text[first] == '{'
                                     ? readJson(path, text)
                                     : readEdgeList(path, text);
  if (transitions.places.empty()) throw hyselam::InputError(path, "", "has no places");
  return transitions;
}

PlaceTransitions transitionsOfTours(const std::vector<std::string>& places,
                                    const std::vector<std::vector<int>>& tours) {
  PlaceTransitions transitions;
  transitions.places = places;
  for (const auto& tour : tours) {
    for (std::size_t i = 1; i < tour.size(); ++i) join(transitions, tour[i - 1], tour[i]);
  }
  return transitions;
}

PlaceTransitions reordered(const PlaceTransitions& transitions,
                           const std::vector<std::string>& places) {
  PlaceTransitions result;
  result.places = places;
  std::vector<int> index;
  for (const auto& name : transitions.places) index.push_back(result.indexOf(name));
  for (const auto& [first, second] : transitions.pairs) {
    const int a = index[static_cast<std::size_t>(first)],
              b = index[static_cast<std::size_t>(second)];
    if (a >= 0 && b >= 0) join(result, a, b);
  }
  return result;
}

std::vector<std::string> missingPlaces(const PlaceTransitions& transitions,
                                       const std::vector<std::string>& names) {
  std::vector<std::string> missing;
  for (const auto& name : names) {
    if (transitions.indexOf(name) < 0) missing.push_back(name);
  }
  return missing;
}

}  // namespace selovis
