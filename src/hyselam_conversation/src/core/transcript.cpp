#include "hyselam_conversation/transcript.hpp"

#include <algorithm>
#include <map>
#include <sstream>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"

namespace hyselam_conversation {
namespace {

constexpr const char* kSpace = " \t\r";

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

/// The first word, and the rest.
std::pair<std::string, std::string> cutWord(const std::string& text) {
  const std::size_t end = text.find_first_of(kSpace);
  if (end == std::string::npos) return {text, ""};
  return {text.substr(0, end), trimmed(text.substr(end))};
}

/// Of a line that begins with @. False if it is none.
bool readDirective(const std::string& line, Step* step) {
  using Kind = Step::Kind;
  static const std::map<std::string, Kind> kinds{
      {"@", Kind::kPlace},        {"@pose", Kind::kPose},   {"@ask", Kind::kAsk},
      {"@name", Kind::kName},     {"@guess", Kind::kGuess}, {"@drive", Kind::kDrive},
      {"@arrive", Kind::kArrive}, {"@id", Kind::kId},       {"@reset", Kind::kReset}};
  const auto [word, rest] = cutWord(line);
  const auto found = kinds.find(word);
  if (found == kinds.end()) return false;
  step->kind = found->second;
  switch (step->kind) {
    case Kind::kAsk:
    case Kind::kArrive:
      return rest.empty();
    case Kind::kReset:
      step->text = rest;
      return true;
    case Kind::kPose:
      return parsePose(rest, &step->pose);
    case Kind::kId:
      step->text = rest;
      return !rest.empty();
    case Kind::kName:
    case Kind::kGuess:
      step->place = cutWord(rest).first;
      step->names = partsOf(cutWord(rest).second, ';');
      return !step->names.empty();
    default:
      step->place = rest;
      return !rest.empty();
  }
}

}  // namespace

std::vector<std::string> partsOf(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) {
    if (!trimmed(part).empty()) parts.push_back(trimmed(part));
  }
  return parts;
}

bool parsePose(const std::string& text, hyselam::Pose2* pose) {
  std::string spaced = text;
  std::replace(spaced.begin(), spaced.end(), ',', ' ');
  std::istringstream in(spaced);
  std::vector<double> values;
  for (std::string word; in >> word;) {
    const auto number = hyselam::parseNumber(word);
    if (!number) return false;
    values.push_back(*number);
  }
  if (values.size() != 3) return false;
  *pose = {values[0], values[1], values[2]};
  return true;
}

std::vector<Step> stepsOf(const std::string& text, const std::string& source) {
  std::vector<Step> steps;
  std::istringstream in(text);
  std::size_t number = 0;
  for (std::string raw; std::getline(in, raw);) {
    ++number;
    const std::string line = trimmed(raw);
    if (line.empty() || line[0] == '#') continue;
    Step step;
    step.line = number;
    if (line[0] == '>') {
      step.kind = Step::Kind::kExpect;
      step.text = trimmed(line.substr(1));
    } else if (line[0] != '@') {
      step.text = line;
    } else if (!readDirective(line, &step)) {
      throw hyselam::InputError(source, "line " + std::to_string(number),
                                "'" + line + "' is no step of a talk");
    }
    steps.push_back(step);
  }
  return steps;
}

}  // namespace hyselam_conversation
