#include "reader_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "fact_labels.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"
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

constexpr double kMostOdds = 1000.0;  // of a calibration: more is a mistake

constexpr std::array<std::pair<const char*, Odds ReaderModel::*>, 3> kOdds{
    {{"reading", &ReaderModel::of_reading},
     {"fact", &ReaderModel::of_fact},
     {"other", &ReaderModel::of_other}}};

constexpr const char* kFormat = "hyselam_fact_reader 1";

constexpr std::array<std::pair<const char*, std::string ReaderOrigin::*>, 4> kHead{
    {{"language", &ReaderOrigin::language},
     {"command", &ReaderOrigin::command},
     {"data", &ReaderOrigin::data},
     {"left_out", &ReaderOrigin::left_out}}};

/// Takes the lines of the head off.
ReaderOrigin takeHead(const std::string& source, std::istream* lines) {
  const auto fail = [&](std::size_t at, const std::string& reason) {
    throw hyselam::InputError(source, "line " + std::to_string(at), reason);
  };
  std::string line;
  std::getline(*lines, line);
  if (line.empty() || line.front() == '#' || line.front() == '[') {
    fail(1, std::string("is no '") + kFormat +
                "': models without that head are of an older format, which is not read; train it "
                "again (bench/readers --retrain)");
  }
  if (line != kFormat) fail(1, hyselam::formatRefusal(line, kFormat));
  ReaderOrigin origin;
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

/// The lines of each section "[name]".
std::map<std::string, std::string> sectionsOf(const std::string& source, std::istream* lines) {
  std::map<std::string, std::string> sections;
  std::string* section = nullptr;
  std::string line;
  for (std::size_t number = kHead.size() + 2; std::getline(*lines, line); ++number) {
    if (line.size() > 2 && line.front() == '[' && line.back() == ']') {
      section = &sections[line.substr(1, line.size() - 2)];
    } else if (section != nullptr) {
      *section += line + '\n';
    } else {
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
  std::istringstream lines(text);
  const ReaderOrigin origin = takeHead(source, &lines);
  const auto sections = sectionsOf(source, &lines);
  const auto section = [&](const std::string& name) {
    const auto found = sections.find(name);
    if (found == sections.end()) throw hyselam::InputError(source, "[" + name + "]", "is missing");
    return found->second;
  };
  ReaderModel model;
  model.origin = origin;
  for (const auto& [name, classifier] : kSections) {
    model.*classifier =
        LinearClassifier::fromText(source + " [" + std::string(name) + "]", section(name));
  }
  checkTags(source + " [tagger]", model.tagger);
  checkLabels(source + " [of_one]", model.of_one, 1);
  checkLabels(source + " [of_two]", model.of_two, 2);
  checkLabels(source + " [of_text]", model.of_text, 0);
  for (const std::string& each : model.modifiers.classes()) {
    if (each != "plain" && each != "denied" && each != "asked") {
      throw hyselam::InputError(source + " [modifiers]", "'" + each + "'", "is no modifier");
    }
  }
  model.lexicon = ReaderLexicon::fromText(source + " [lexicon]", section("lexicon"));
  std::istringstream calibration(section("calibration"));
  for (const auto& [name, odds] : kOdds) {
    Odds& of = model.*odds;
    std::string said;
    if (!(calibration >> said >> of.own >> of.whole >> of.offset) || said != name) {
      throw hyselam::InputError(source, "[calibration]",
                                "needs '" + std::string(name) + "' and three numbers");
    }
    for (const double each : {of.own, of.whole, of.offset}) {
      if (std::abs(each) > kMostOdds) {
        throw hyselam::InputError(source, "[calibration]",
                                  "the numbers of '" + std::string(name) + "' are too large");
      }
    }
  }
  return model;
}

std::string ReaderModel::toText() const {
  std::ostringstream out;
  out << kFormat << '\n';
  for (const auto& [key, value] : kHead) out << key << ' ' << origin.*value << '\n';
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
