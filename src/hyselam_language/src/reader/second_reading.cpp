#include "second_reading.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "grammar/compiled_grammar.hpp"
#include "heard_names.hpp"
#include "hyselam_language/grammar/words_left_out.hpp"
#include "part_reading.hpp"

namespace hyselam_topo {
namespace {

using language::CompiledGrammar;

constexpr double kComplete = 0.6;         // of a reading, that it misses nothing
constexpr std::size_t kShortestTalk = 3;  // words: a single one may be a name

/// Refusals for want of a pattern; others have a reason that stands.
const std::set<std::string> kWithoutReason{"no_pattern", "no_name", "misspelt", "ambiguous",
                                           "not_now"};

std::vector<std::string> wordsOf(const std::string& text, const CompiledGrammar& grammar) {
  std::vector<std::string> words;
  for (const auto& token : language::tokenize(text, {0, text.size()}, grammar.tokenRules())) {
    words.push_back(token.folded);
  }
  return words;
}

bool hasAny(const std::vector<std::string>& words, const language::WordSet& of) {
  return std::any_of(words.begin(), words.end(),
                     [&](const auto& word) { return of.count(word) != 0; });
}

/// What is only supposed must not be asked as if it were said, nor what stands beside it; nor what
/// is denied twice.
bool isDoubted(const std::string& text, const CompiledGrammar& grammar) {
  int denials = 0;
  for (const std::string& word : wordsOf(text, grammar)) {
    const auto found = grammar.refusing_words.find(word);
    if (found == grammar.refusing_words.end()) continue;
    static const std::set<std::string> kDoubt{"uncertain", "choice"};
    if (kDoubt.count(found->second) != 0) return true;
    denials += found->second == "denial" ? 1 : 0;
  }
  return denials > 1;
}

/// Whether the text has a word that the grammar refuses for one of the reasons.
bool hasWordOf(const std::string& text, const std::set<std::string>& reasons,
               const CompiledGrammar& grammar) {
  const std::vector<std::string> words = wordsOf(text, grammar);
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    const auto found = grammar.refusing_words.find(word);
    return found != grammar.refusing_words.end() && reasons.count(found->second) != 0;
  });
}

/// Whether nothing is named there and nothing told of what was named elsewhere: "you have to wait".
bool isBesideTheMatter(const Utterance& utterance, const Reading& reading,
                       const CompiledGrammar& grammar) {
  const auto isInside = [&](const TextRange& each) {
    return utterance.range.begin <= each.begin && each.begin < utterance.range.end;
  };
  if (kWithoutReason.count(utterance.reason_code) == 0 ||
      std::any_of(reading.mentions.begin(), reading.mentions.end(), isInside)) {
    return false;
  }
  const std::vector<std::string> words = wordsOf(utterance.text, grammar);
  return words.size() >= kShortestTalk && !hasAny(words, grammar.placing_words) &&
         (reading.probability >= kComplete || !hasAny(words, grammar.telling_words));
}

std::set<std::string> sentencesOf(const std::string& text, const CompiledGrammar& grammar) {
  std::set<std::string> sentences;
  for (const auto& each : language::splitSentences(text, grammar.tokenRules())) {
    std::string words;
    for (const auto& token : language::tokenize(text, each.range, grammar.tokenRules())) {
      words += token.folded + " ";
    }
    sentences.insert(std::move(words));
  }
  return sentences;
}

/// Whether one proposal tells all that another does: a "no" to that is one to it.
bool includes(const std::string& proposal, const std::string& denied,
              const CompiledGrammar& grammar) {
  const auto all = sentencesOf(proposal, grammar), some = sentencesOf(denied, grammar);
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

/// The readings become what is asked; the grammar's own proposal, without the words
/// in its way, goes before unlikely ones.
void propose(const PartReading& part, const CompiledGrammar& grammar, Utterance* utterance) {
  if (part.asked.empty()) {
    if (!utterance->suggests_meaning && !part.example.empty()) {
      utterance->suggestion = part.example;
      utterance->suggests_own_words = true;
    }
    return;
  }
  utterance->alternatives = part.asked;
  const bool keeps = utterance->suggests_meaning && part.probability < kLikelierThanNot;
  if (!keeps) {
    utterance->suggestion = part.asked.front();
    utterance->left_out.clear();
    utterance->alternatives.erase(utterance->alternatives.begin());
  }
  auto& next = utterance->alternatives;  // each is asked after a "no" to the suggestion
  next.erase(std::remove_if(next.begin(), next.end(),
                            [&](const std::string& each) {
                              return includes(each, utterance->suggestion, grammar);
                            }),
             next.end());
  utterance->suggests_meaning = true;
}

/// Reasons that only tell where reading came to an end, and not why.
const std::set<std::string> kGuesses{"no_pattern",       "no_name", "misspelt",
                                     "not_a_known_kind", "bare",    "quantity"};

/// The text with {names} and {word} filled in; what people said is left as it is.
std::string filled(const std::string& text, const std::string& names, const std::string& word) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    if (text.compare(at, 7, "{names}") == 0) {
      result += names;
      at += 7;
    } else if (text.compare(at, 6, "{word}") == 0) {
      result += word;
      at += 6;
    } else {
      result += text[at++];
    }
  }
  return result;
}

/// Instead of a guess: what was heard, and what was not understood beside it.
void tellHeard(const Reading& reading, const CompiledGrammar& grammar, Utterance* utterance) {
  if (kGuesses.count(utterance->reason_code) == 0) return;
  const std::vector<FactArgument> names = heardNames(*utterance, reading, grammar);
  const std::string beside = wordsBeside(names, *utterance, grammar);
  const std::string key = names.empty() ? "nothing_heard" : "heard";
  const auto template_text = grammar.reasons.find(key);
  if (template_text == grammar.reasons.end() || (beside.empty() && !names.empty())) return;
  std::vector<std::string> texts;
  texts.reserve(names.size());
  for (const FactArgument& name : names) texts.push_back(name.text);
  utterance->reason = filled(template_text->second, quotedInARow(texts), beside);
}

/// The refused parts without matter become words left out of the statement before them.
void dropTalk(const Reading& reading, const CompiledGrammar& grammar,
              std::vector<Utterance>* utterances) {
  const auto isStatement = [](const Utterance& u) { return u.kind == UtteranceKind::kStatement; };
  if (std::none_of(utterances->begin(), utterances->end(), isStatement)) return;
  std::vector<Utterance> kept;
  std::vector<std::string> before;  // the first statement
  Utterance* statement = nullptr;
  kept.reserve(utterances->size());
  for (Utterance& each : *utterances) {
    if (!each.understood() && isBesideTheMatter(each, reading, grammar)) {
      (statement != nullptr ? statement->left_out : before).push_back(each.text);
      continue;
    }
    kept.push_back(std::move(each));
    if (!isStatement(kept.back())) continue;
    statement = &kept.back();
    statement->left_out.insert(statement->left_out.begin(), before.begin(), before.end());
    before.clear();
  }
  *utterances = std::move(kept);
}

}  // namespace

void readAgain(const FactReader& reader, const Grammar& grammar, const std::string& text,
               std::vector<Utterance>* utterances) {
  const auto isRefused = [](const Utterance& u) { return !u.understood(); };
  if (std::none_of(utterances->begin(), utterances->end(), isRefused)) return;
  const std::optional<Reading> read = reader.read(text);
  if (!read) return;  // not known to state or name nothing
  const Reading& reading = *read;
  const bool doubted = isDoubted(text, grammar.compiled());
  const bool is_whole = utterances->size() == 1;
  const bool is_turned =
      hasWordOf(text, {"denial", "not_now", "condition", "comparison"}, grammar.compiled());
  for (Utterance& utterance : *utterances) {
    if (utterance.understood()) continue;
    const bool has_reason = kWithoutReason.count(utterance.reason_code) == 0;
    const bool is_question = !utterance.text.empty() && utterance.text.back() == '?';
    const bool is_denied = hasWordOf(utterance.text, {"denial"}, grammar.compiled());
    const PartOf of{reading, is_whole, is_turned || has_reason, is_question, doubted, is_denied};
    const PartReading part = readPart(utterance, of, grammar);
    propose(part, grammar.compiled(), &utterance);
    if (!utterance.suggests_meaning) tellHeard(reading, grammar.compiled(), &utterance);
  }
  if (doubted) return;
  dropTalk(reading, grammar.compiled(), utterances);
}

}  // namespace hyselam_topo
