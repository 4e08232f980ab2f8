#include "reader_model.hpp"

#include <array>
#include <map>
#include <sstream>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "mention_tagger.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::array<std::pair<const char*, LinearClassifier ReaderModel::*>, 5> kSections{
    {{"tagger", &ReaderModel::tagger},
     {"of_one", &ReaderModel::of_one},
     {"of_two", &ReaderModel::of_two},
     {"of_text", &ReaderModel::of_text},
     {"modifiers", &ReaderModel::modifiers}}};

/// The lines of each section "[name]"; lines that begin with '#' before the first are comments.
std::map<std::string, std::string> sectionsOf(const std::string& source, const std::string& text) {
  std::map<std::string, std::string> sections;
  std::string* section = nullptr;
  std::istringstream lines(text);
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    if (line.size() > 2 && line.front() == '[' && line.back() == ']') {
      section = &sections[line.substr(1, line.size() - 2)];
    } else if (section != nullptr) {
      *section += line + '\n';
    } else if (line.empty() || line[0] != '#') {
      throw hyselam::InputError(source, "line " + std::to_string(number),
                                "stands before the first section");
    }
  }
  return sections;
}

}  // namespace

ReaderModel ReaderModel::fromText(const std::string& source, const std::string& text) {
  const auto sections = sectionsOf(source, text);
  const auto section = [&](const std::string& name) {
    const auto found = sections.find(name);
    if (found == sections.end()) throw hyselam::InputError(source, "[" + name + "]", "is missing");
    return found->second;
  };
  ReaderModel model;
  for (const auto& [name, classifier] : kSections) {
    model.*classifier =
        LinearClassifier::fromText(source + " [" + std::string(name) + "]", section(name));
  }
  checkTags(source + " [tagger]", model.tagger);
  model.lexicon = ReaderLexicon::fromText(source + " [lexicon]", section("lexicon"));
  std::istringstream calibration(section("calibration"));
  if (!(calibration >> model.slope >> model.offset)) {
    throw hyselam::InputError(source, "[calibration]", "needs slope and offset");
  }
  return model;
}

std::string ReaderModel::toText() const {
  std::ostringstream out;
  out << "[lexicon]\n" << lexicon.toText();
  for (const auto& [name, classifier] : kSections) {
    out << '[' << name << "]\n" << (this->*classifier).toText();
  }
  out << "[calibration]\n" << slope << ' ' << offset << '\n';
  return out.str();
}

}  // namespace language
}  // namespace hyselam_topo
