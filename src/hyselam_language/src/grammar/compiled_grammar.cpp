#include "compiled_grammar.hpp"

#include <algorithm>

#include "hyselam_common/utf8.hpp"
#include "matching_costs.hpp"

namespace hyselam_topo {
namespace language {

int Vocabulary::add(const std::string& word) {
  const std::string lower = hyselam::utf8Lower(word);
  const auto [at, is_new] = by_lower_.emplace(lower, static_cast<int>(entries_.size()));
  if (is_new) {
    entries_.push_back({lower, hyselam::utf8Fold(word)});
    const std::string& folded = entries_.back().folded;
    by_folded_.emplace(folded, at->second);
    if (folded.size() >= kShortestMisspelt) slips_.add(folded, at->second);
  }
  return at->second;
}

std::vector<Vocabulary::Match> Vocabulary::matches(const Token& token, bool may_be_misspelt) const {
  std::vector<Match> found;
  if (token.kind != TokenKind::kWord) return found;
  const auto [begin, end] = by_folded_.equal_range(token.folded);
  for (auto each = begin; each != end; ++each) {
    const Entry& entry = entries_[static_cast<std::size_t>(each->second)];
    const bool exact = entry.lower == token.lower;
    // Accents are left out, not put in: "é" is not "e".
    if (!exact && token.has_accents && entry.lower == entry.folded) continue;
    found.push_back({each->second, exact ? 0 : kAccentCost});
  }
  if (!found.empty() || !may_be_misspelt || token.folded.size() < kShortestMisspelt - 1) {
    return found;
  }
  for (const int word : slips_.near(token.folded)) found.push_back({word, kSlipCost});
  return found;
}

PhraseStarts::PhraseStarts(const std::vector<Phrase>& phrases) {
  for (std::size_t i = 0; i < phrases.size(); ++i) {
    const auto word = static_cast<std::size_t>(phrases[i].front());
    if (of_word_.size() <= word) of_word_.resize(word + 1);
    of_word_[word].push_back(i);
  }
}

std::vector<std::size_t> PhraseStarts::beginningWith(
    const std::vector<Vocabulary::Match>& words) const {
  std::vector<std::size_t> found;
  for (const Vocabulary::Match& match : words) {
    const auto word = static_cast<std::size_t>(match.word);
    if (word >= of_word_.size()) continue;
    found.insert(found.end(), of_word_[word].begin(), of_word_[word].end());
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

const NameType* CompiledGrammar::nameType(const std::string& name) const {
  const auto found = std::find_if(name_types.begin(), name_types.end(),
                                  [&](const NameType& type) { return type.name == name; });
  return found == name_types.end() ? nullptr : &*found;
}

bool CompiledGrammar::isNoun(const std::string& word) const {
  return std::any_of(name_types.begin(), name_types.end(),
                     [&](const NameType& type) { return type.nouns.count(word) != 0; });
}

bool CompiledGrammar::isNounOrTitle(const std::string& word) const {
  return isNoun(word) ||
         std::any_of(name_types.begin(), name_types.end(),
                     [&](const NameType& type) { return type.titles.count(word) != 0; });
}

TokenRules CompiledGrammar::tokenRules() const {
  TokenRules rules;
  rules.is_unit = [this](const std::string& word) { return unit_words.count(word) != 0; };
  rules.is_abbreviation = [this](const std::string& word) {
    return abbreviations.count(word) != 0;
  };
  rules.may_begin = [this](const std::string& word) {
    return vocabulary.contains(word) &&
           std::none_of(name_types.begin(), name_types.end(),
                        [&](const NameType& type) { return type.nouns.count(word) != 0; });
  };
  rules.expansion = [this](const std::string& word) -> const Words* {
    const auto found = contractions.find(word);
    return found == contractions.end() ? nullptr : &found->second;
  };
  return rules;
}

std::string CompiledGrammar::reason(const std::string& code, const std::string& word) const {
  const auto found = reasons.find(code);
  if (found == reasons.end()) return code;
  std::string text = found->second;
  const std::size_t at = text.find("{word}");
  if (at != std::string::npos) text.replace(at, 6, word);
  return text;
}

bool WordPhrases::standAt(const std::vector<Token>& tokens, std::size_t at, std::size_t end) const {
  const auto with = of_first_.find(tokens[at].lower);
  return with != of_first_.end() &&
         std::any_of(with->second.begin(), with->second.end(), [&](const Words& phrase) {
           return at + phrase.size() <= end && standsAt(phrase, tokens, at);
         });
}

bool standsAt(const Words& phrase, const std::vector<Token>& tokens, std::size_t at) {
  return at + phrase.size() <= tokens.size() &&
         std::equal(
             phrase.begin(), phrase.end(), tokens.begin() + static_cast<std::ptrdiff_t>(at),
             [](const std::string& word, const Token& token) { return token.lower == word; });
}

}  // namespace language
}  // namespace hyselam_topo
