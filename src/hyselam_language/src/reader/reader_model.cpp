#include "reader_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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

constexpr std::array<std::pair<const char*, Odds ReaderModel::*>, 3> kOdds{
    {{"reading", &ReaderModel::of_reading},
     {"fact", &ReaderModel::of_fact},
     {"other", &ReaderModel::of_other}}};

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

double logOdds(double probability) {
  constexpr double kSmallest = 1e-12;  // no decision is ever all
  const double p = std::min(std::max(probability, kSmallest), 1.0 - kSmallest);
  return std::log(p / (1.0 - p));
}

double Odds::of(double own_log_odds, double whole_log_odds) const {
  return 1.0 / (1.0 + std::exp(-(own * own_log_odds + whole * whole_log_odds + offset)));
}

double Odds::probability(double own_p, double whole_p) const {
  return of(logOdds(own_p), logOdds(whole_p));
}

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
  for (const auto& [name, odds] : kOdds) {
    Odds& of = model.*odds;
    std::string said;
    if (!(calibration >> said >> of.own >> of.whole >> of.offset) || said != name) {
      throw hyselam::InputError(source, "[calibration]",
                                "needs '" + std::string(name) + "' and three numbers");
    }
  }
  return model;
}

std::string ReaderModel::toText() const {
  std::ostringstream out;
  out << "[lexicon]\n" << lexicon.toText();
  for (const auto& [name, classifier] : kSections) {
    out << '[' << name << "]\n" << (this->*classifier).toText();
  }
  out << "[calibration]\n";
  for (const auto& [name, odds] : kOdds) {
    const Odds& of = this->*odds;
    out << name << ' ' << of.own << ' ' << of.whole << ' ' << of.offset << '\n';
  }
  return out.str();
}

}  // namespace language
}  // namespace hyselam_topo
