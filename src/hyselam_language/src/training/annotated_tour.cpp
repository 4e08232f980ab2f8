#include "annotated_tour.hpp"

#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace language {
namespace {

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {}

  std::vector<AnnotatedTour> read() {
    std::istringstream lines(hyselam::readTextFile(path_));
    std::string line;
    while (std::getline(lines, line)) {
      ++number_;
      if (line.compare(0, 3, "## ") == 0) {
        begin(line.substr(3));
      } else if (!line.empty()) {
        if (tours_.empty()) fail("stands before the first tour");
        if (!tours_.back().text.empty()) tours_.back().text += '\n';
        addLine(line);
      }
    }
    return std::move(tours_);
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw hyselam::InputError(path_, "line " + std::to_string(number_), reason);
  }

  void begin(const std::string& head) {
    std::istringstream parts(head);
    AnnotatedTour tour;
    std::string doors;
    std::getline(parts, tour.id, '|');
    std::getline(parts, tour.kind, '|');
    std::getline(parts, doors);
    std::istringstream each(doors);
    for (std::string door; each >> door;) {
      const std::size_t at = door.find('@');
      if (at == std::string::npos || (door[0] != 'L' && door[0] != 'R'))
        fail("'" + door + "' is no door such as L1@4.4");
      std::istringstream along(door.substr(at + 1));
      TourDoor made{door[0] == 'L', 0.0};
      if (!(along >> made.along)) fail("'" + door + "' is nowhere");
      tour.doors[door.substr(0, at)] = made;
    }
    if (tour.doors.empty()) fail("names no doors");
    tours_.push_back(std::move(tour));
  }

  /// A line of text, marks taken out.
  void addLine(const std::string& line) {
    AnnotatedTour& tour = tours_.back();
    for (std::size_t at = 0; at < line.size();) {
      if (line[at] != '[') {
        tour.text += line[at++];
        continue;
      }
      const std::size_t close = line.find("](", at);
      const std::size_t end = close == std::string::npos ? close : line.find(')', close);
      if (end == std::string::npos) fail("a mark has no end");
      const std::string room = line.substr(close + 2, end - close - 2);
      if (tour.doors.count(room) == 0) fail("there is no room '" + room + "'");
      const std::size_t begin = tour.text.size();
      tour.text += line.substr(at + 1, close - at - 1);
      tour.said.push_back({{begin, tour.text.size()}, room});
      at = end + 1;
    }
  }

  std::string path_;
  std::size_t number_ = 0;
  std::vector<AnnotatedTour> tours_;
};

}  // namespace

std::vector<AnnotatedTour> loadTours(const std::string& path) {
  return Reader(path).read();
}

MarkedMentions markedMentions(const CompiledGrammar& grammar, const HeardText& text,
                              const AnnotatedTour& tour) {
  const NameType* places = grammar.nameType("place");
  MarkedMentions marked;
  const auto& tokens = text.tokens();
  for (const AnnotatedTour::Said& said : tour.said) {
    std::size_t begin = tokens.size(), end = 0;
    for (std::size_t at = 0; at < tokens.size(); ++at) {
      const TextRange& range = tokens[at].range;
      if (range.begin == range.end || range.end <= said.range.begin ||
          range.begin >= said.range.end)
        continue;
      begin = std::min(begin, at);
      end = at + 1;
    }
    while (begin + 1 < end && places != nullptr && places->isArticle(tokens[begin].folded)) ++begin;
    if (begin >= end) continue;
    if (!marked.mentions.empty() && marked.mentions.back().end > begin) continue;
    marked.mentions.push_back({begin, end, Mention::Kind::kThing, 1.0});
    marked.rooms.push_back(said.room);
  }
  return marked;
}

}  // namespace language
}  // namespace hyselam_topo
