#include "hyselam_language/grammar/grammar.hpp"

#include <algorithm>

#include "compiled_grammar.hpp"
#include "grammar_reader.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "sentence_matcher.hpp"
#include "shipped_grammars.hpp"

namespace hyselam_topo {

Grammar Grammar::fromYaml(const std::vector<GrammarSource>& sources) {
  return Grammar(language::readGrammar(sources));
}

Grammar Grammar::load(const std::vector<std::string>& paths) {
  constexpr std::size_t kMaxBytes = 4u << 20;
  std::vector<GrammarSource> sources;
  sources.reserve(paths.size());
  for (const std::string& path : paths) {
    sources.push_back({path, hyselam::readTextFile(path, kMaxBytes)});
  }
  return fromYaml(sources);
}

GrammarSource Grammar::shippedSource(const std::string& language) {
  for (const auto& shipped : language::kShippedGrammars) {
    if (language == shipped.key) return {language + ".yaml", shipped.text};
  }
  std::string known;
  for (const std::string& each : shippedLanguages()) known += (known.empty() ? "" : ", ") + each;
  throw hyselam::InputError("language '" + language + "'", "",
                            "there is no grammar of it, only: " + known);
}

Grammar Grammar::shipped(const std::string& language) {
  return fromYaml({shippedSource(language)});
}

std::vector<std::string> Grammar::shippedLanguages() {
  std::vector<std::string> languages;
  for (const auto& shipped : language::kShippedGrammars) languages.push_back(shipped.key);
  return languages;
}

const std::string& Grammar::language() const {
  return compiled_->language;
}
const std::string& Grammar::title() const {
  return compiled_->title;
}

std::vector<Grammar::Intent> Grammar::intents() const {
  std::vector<Intent> intents;
  for (const language::IntentInfo& each : compiled_->intents) {
    intents.push_back({each.as.empty() ? each.name : each.as, each.kind, each.examples,
                       each.only_expected, !each.refuse.empty()});
  }
  return intents;
}

bool Grammar::has(const std::string& key) const {
  return compiled_->say.count(key) != 0;
}

std::string Grammar::reason(const std::string& code, const std::string& word) const {
  return compiled_->reasons.count(code) != 0 ? compiled_->reason(code, word) : "";
}

const std::string& Grammar::say(const std::string& key) const {
  const auto found = compiled_->say.find(key);
  if (found == compiled_->say.end()) {
    throw hyselam::InputError("grammar '" + language() + "'", "say", "'" + key + "' is missing");
  }
  return found->second;
}

bool Grammar::isPlainName(const std::string& name, const std::string& type) const {
  return language::isPlainName(*compiled_, name, type);
}

std::vector<std::string> Grammar::words() const {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < compiled_->vocabulary.size(); ++i) {
    words.push_back(compiled_->vocabulary.text(static_cast<int>(i)));
  }
  for (const language::NameType& type : compiled_->name_types) {
    for (const auto& [noun, kind] : type.nouns) words.push_back(noun);
  }
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

}  // namespace hyselam_topo
