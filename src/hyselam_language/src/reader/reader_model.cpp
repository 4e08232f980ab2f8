#include "reader_model.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include "fact_labels.hpp"
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

constexpr const char* kFormat = "hyselam_fact_reader 1";

}  // namespace

ReaderModel ReaderModel::fromText(const std::string& source, const std::string& text) {
  const ModelText read = ModelText::read(source, text, kFormat, "bench/readers --retrain");
  const auto section = [&](const std::string& name) { return read.section(source, name); };
  ReaderModel model;
  model.origin = read.origin;
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
    model.*odds = readOdds(&calibration, source, name);
  }
  return model;
}

std::string ReaderModel::toText() const {
  std::ostringstream out;
  out << origin.toText(kFormat);
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
