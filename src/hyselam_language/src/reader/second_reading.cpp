#include "second_reading.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "fact_writer.hpp"
#include "grammar/compiled_grammar.hpp"
#include "grammar/sentence_matcher.hpp"
#include "hyselam_common/utf8.hpp"

namespace hyselam_topo {
namespace {

/// A question that is answered with "no" more often costs more than it brings.
constexpr double kLeastProbability = 0.5;  // of a fact
constexpr double kWorthShowing = 0.15;     // of a fact, as an example of what would be understood
constexpr double kComplete = 0.6;          // of a reading, that it misses nothing
constexpr std::size_t kShortestTalk = 3;   // words: a single one may be a name
constexpr std::size_t kMostFacts = 4;      // nobody says "yes" to more

bool hasName(const std::vector<Utterance>& said, const std::string& name) {
  const std::string wanted = hyselam::utf8Lower(name);
  for (const Utterance& utterance : said) {
    for (const Slot& slot : utterance.slots) {
      for (const SaidName& each : slot.names) {
        if (hyselam::utf8Lower(each.text) == wanted) return true;
      }
    }
  }
  return false;
}

/// Whether the grammar takes the sentence as a whole and with the very names of the fact.
bool isUnderstood(const Grammar& grammar, const std::string& sentence, const ReadFact& fact) {
  const language::CompiledGrammar& compiled = grammar.compiled();
  std::vector<Utterance> said;
  for (const auto& each : language::splitSentences(sentence, compiled.tokenRules())) {
    for (Utterance& u : language::readSentence(compiled, sentence, each, {})) said.push_back(u);
  }
  const bool all =
      std::all_of(said.begin(), said.end(), [](const auto& u) { return u.understood(); });
  if (!all || said.size() != 1) return false;
  // Owners are named by themselves, values by their numbers.
  const auto& arguments = fact.arguments;
  return arguments.empty() || arguments.front().isReference() ||
         hasName(said, arguments.front().text);
}

/// Whether what the fact tells stands within the range: its last name does. Without a name it is
/// of the whole text.
bool belongsTo(const TextRange& range, bool is_whole, const ReadFact& fact) {
  std::size_t last = std::string::npos;
  for (const FactArgument& each : fact.arguments) {
    if (!each.isReference() && (last == std::string::npos || each.range.begin > last)) {
      last = each.range.begin;
    }
  }
  if (last == std::string::npos) return is_whole;
  return range.begin <= last && last < range.end;
}

/// The facts told in the utterance, as sentences of the grammar; "" for none or too many.
std::string proposalFor(const Utterance& utterance, const Reading& reading, bool is_whole,
                        const Grammar& grammar) {
  const FactWriter writer(grammar);
  std::string proposal;
  std::size_t count = 0;
  for (const ReadFact& fact : reading.facts) {
    if (fact.probability < kLeastProbability || !belongsTo(utterance.range, is_whole, fact))
      continue;
    const std::string sentence = writer.sentence(fact);
    if (sentence.empty() || !isUnderstood(grammar, sentence, fact)) continue;
    proposal += (proposal.empty() ? "" : " ") + sentence;
    ++count;
  }
  return count > kMostFacts ? "" : proposal;
}

/// The likeliest of the facts that are too unlikely to ask for, as a sentence of the grammar: it
/// shows how such a thing is said; "" for none.
std::string exampleFor(const Utterance& utterance, const Reading& reading, bool is_whole,
                       const Grammar& grammar) {
  const FactWriter writer(grammar);
  std::string example;
  double best = kWorthShowing;
  for (const ReadFact& fact : reading.facts) {
    if (fact.probability < best || !belongsTo(utterance.range, is_whole, fact)) continue;
    const std::string sentence = writer.sentence(fact);
    if (sentence.empty() || !isUnderstood(grammar, sentence, fact)) continue;
    example = sentence;
    best = fact.probability;
  }
  return example;
}

std::vector<std::string> wordsOf(const std::string& text,
                                 const language::CompiledGrammar& grammar) {
  std::vector<std::string> words;
  for (const auto& token : language::tokenize(text, {0, text.size()}, grammar.tokenRules())) {
    words.push_back(token.folded);
  }
  return words;
}

bool hasAny(const std::vector<std::string>& words, const std::set<std::string>& of) {
  return std::any_of(words.begin(), words.end(),
                     [&](const auto& word) { return of.count(word) != 0; });
}

/// What is only supposed must not be asked as if it were said, nor what stands beside it; nor what
/// is denied twice.
bool isDoubted(const std::string& text, const language::CompiledGrammar& grammar) {
  int denials = 0;
  for (const std::string& word : wordsOf(text, grammar)) {
    const auto found = grammar.refusing_words.find(word);
    if (found == grammar.refusing_words.end()) continue;
    if (found->second == "uncertain" || found->second == "choice") return true;
    denials += found->second == "denial" ? 1 : 0;
  }
  return denials > 1;
}

/// Whether nothing is named there and nothing told of what was named elsewhere: "you have to wait".
bool isBesideTheMatter(const Utterance& utterance, const Reading& reading,
                       const language::CompiledGrammar& grammar) {
  static const std::set<std::string> kGuesses{"no_pattern", "no_name", "misspelt", "ambiguous",
                                              "not_now"};
  const auto isInside = [&](const TextRange& each) {
    return utterance.range.begin <= each.begin && each.begin < utterance.range.end;
  };
  if (kGuesses.count(utterance.reason_code) == 0 ||
      std::any_of(reading.mentions.begin(), reading.mentions.end(), isInside)) {
    return false;
  }
  const std::vector<std::string> words = wordsOf(utterance.text, grammar);
  return words.size() >= kShortestTalk && !hasAny(words, grammar.placing_words) &&
         (reading.probability >= kComplete || !hasAny(words, grammar.telling_words));
}

/// The refused parts without matter become words left out of the statement before them.
void dropTalk(const Reading& reading, const language::CompiledGrammar& grammar,
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
  if (isDoubted(text, grammar.compiled())) return;
  const Reading reading = reader.read(text);
  const bool is_whole = utterances->size() == 1;
  for (Utterance& utterance : *utterances) {
    if (utterance.understood()) continue;
    const std::string proposal = proposalFor(utterance, reading, is_whole, grammar);
    if (!proposal.empty()) {
      utterance.suggestion = proposal;
      utterance.suggests_meaning = true;
    } else if (!utterance.suggests_meaning) {
      const std::string example = exampleFor(utterance, reading, is_whole, grammar);
      if (!example.empty()) utterance.suggestion = example;
    }
  }
  dropTalk(reading, grammar.compiled(), utterances);
}

}  // namespace hyselam_topo
