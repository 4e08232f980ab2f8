#include "model_text.hpp"

#include <array>
#include <sstream>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::array<std::pair<const char*, std::string ModelOrigin::*>, 4> kHead{
    {{"language", &ModelOrigin::language},
     {"command", &ModelOrigin::command},
     {"data", &ModelOrigin::data},
     {"left_out", &ModelOrigin::left_out}}};

/// Takes the lines of the head off.
ModelOrigin takeHead(const std::string& source, const std::string& format,
                     const std::string& retrain, std::istream* lines) {
  const auto fail = [&](std::size_t at, const std::string& reason) {
    throw hyselam::InputError(source, "line " + std::to_string(at), reason);
  };
  std::string line;
  std::getline(*lines, line);
  if (line.empty() || line.front() == '#' || line.front() == '[') {
    fail(1, "is no '" + format +
                "': models without that head are of an older format, which is not read; train it "
                "again (" +
                retrain + ")");
  }
  if (line != format) fail(1, hyselam::formatRefusal(line, format));
  ModelOrigin origin;
  std::size_t number = 1;
  for (const auto& [key, value] : kHead) {
    ++number;
    const std::string begin = std::string(key) + " ";
    if (!std::getline(*lines, line) || line.compare(0, begin.size(), begin) != 0) {
      fail(number, "'" + std::string(key) + "' is expected");
    }
    origin.*value = line.substr(begin.size());
  }
  return origin;
}

}  // namespace

std::string ModelOrigin::toText(const std::string& format) const {
  std::string text = format + '\n';
  for (const auto& [key, value] : kHead) text.append(key).append(" ").append(this->*value) += '\n';
  return text;
}

ModelText ModelText::read(const std::string& source, const std::string& text,
                          const std::string& format, const std::string& retrain) {
  std::istringstream lines(text);
  ModelText read;
  read.origin = takeHead(source, format, retrain, &lines);
  std::string* section = nullptr;
  std::string line;
  for (std::size_t number = kHead.size() + 2; std::getline(lines, line); ++number) {
    if (line.size() > 2 && line.front() == '[' && line.back() == ']') {
      section = &read.sections[line.substr(1, line.size() - 2)];
    } else if (section != nullptr) {
      *section += line + '\n';
    } else {
      throw hyselam::InputError(source, "line " + std::to_string(number),
                                "stands before the first section");
    }
  }
  return read;
}

const std::string& ModelText::section(const std::string& source, const std::string& name) const {
  const auto found = sections.find(name);
  if (found == sections.end()) throw hyselam::InputError(source, "[" + name + "]", "is missing");
  return found->second;
}

}  // namespace language
}  // namespace hyselam_topo
