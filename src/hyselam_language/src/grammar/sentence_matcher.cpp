#include "sentence_matcher.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "asides.hpp"
#include "capture.hpp"
#include "clause.hpp"
#include "clause_borders.hpp"
#include "hyselam_common/utf8.hpp"
#include "matching_costs.hpp"
#include "pattern_run.hpp"
#include "refusal.hpp"
#include "sentence_parts.hpp"
#include "sentence_words.hpp"
#include "shorter_sentence.hpp"
#include "token_meanings.hpp"
#include "told_anyway.hpp"

namespace hyselam_topo {
namespace language {

bool isUnderstood(const std::vector<Utterance>& said) {
  return std::all_of(said.begin(), said.end(), [](const Utterance& u) { return u.understood(); });
}

namespace {

/// Finds the cheapest row of clauses that covers the sentence.
class SentenceReader {
 public:
  /// `run_on`: clauses may follow one another without a word or comma between them, as speech
  /// recognisers write them. `explain`: follows more patterns, whose way tells why the sentence is
  /// not understood; without it nothing is said about that.
  SentenceReader(const CompiledGrammar& grammar, const std::string& text, const Sentence& sentence,
                 std::vector<Token> tokens, const std::set<std::string>& expected, bool run_on,
                 bool explain = false)
      : expected_(expected),
        run_on_(run_on),
        explain_(explain),
        words_(grammar, text, sentence, std::move(tokens)),
        pattern_run_(&words_, {}, explain) {}

  std::vector<Utterance> read() {
    if (words_.isTooLong()) return {refusal(words_, "too_long", words_.sentence.range, "")};
    findClauses();
    return assemble();
  }

 private:
  /// The cheapest row of clauses that ends at a token.
  struct Reading {
    int cost = kNever;
    int clause = -1;           ///< the last one; -1: none
    std::size_t begin = 0;     ///< before its fillers
    std::size_t from_end = 0;  ///< where the clause before it ended
    bool ambiguous = false;
    int other = -1;  ///< then what the last clause may be as well
  };

  void findClauses() {
    const std::size_t n = words_.tokens.size();
    ends_.assign(n + 1, {});
    // Begin of a clause: cost, and the end of the clause before.
    std::vector<std::pair<int, std::size_t>> begins(n + 1, {kNever, 0});
    begins[0] = {0, 0};
    for (std::size_t at = 0; at <= n; ++at) {
      if (ends_[at].cost < kNever && at < n) {
        for (const auto& [to, cost] : separatorsAt(words_, at)) {
          const int total = ends_[at].cost + cost;
          if (total < begins[to].first) begins[to] = {total, at};
        }
        if (run_on_ && at > 0 && ends_[at].cost + kRunOnCost < begins[at].first) {
          begins[at] = {ends_[at].cost + kRunOnCost, at};
        }
      }
      if (begins[at].first >= kNever || at == n) continue;
      for (const Entry& entry : entriesAt(words_, at)) {
        const int before = begins[at].first + entry.cost + kClauseCost;
        clausesAt(entry, [&](const Clause& clause) {
          for (const auto& [end, cost] : exitsAt(words_, clause.end)) {
            addReading(before + clause.cost + cost, end, at, begins[at].second, clause);
          }
        });
      }
    }
  }

  void addReading(int cost, std::size_t end, std::size_t begin, std::size_t from_end,
                  const Clause& clause) {
    Reading& best = ends_[end];
    if (cost > best.cost) return;
    if (cost == best.cost) {
      const Clause& other = clauses_[static_cast<std::size_t>(best.clause)];
      if (clause.meansTheSameAs(other) || best.ambiguous) return;
      clauses_.push_back(clause);
      best.ambiguous = true;
      best.other = static_cast<int>(clauses_.size()) - 1;
      return;
    }
    clauses_.push_back(clause);
    best = {cost, static_cast<int>(clauses_.size()) - 1, begin, from_end, false, -1};
  }

  /// Calls f(clause) for all that may begin there.
  template <typename F>
  void clausesAt(const Entry& entry, F&& f) {
    for (const IntentInfo& intent : words_.grammar.intents) {
      if (!isPossible(intent, entry)) continue;
      // "Isto é ótimo" is not "isto" and "é" and "ótimo".
      if (run_on_ && intent.kind == UtteranceKind::kAnswer) continue;
      const int bonus = expected_.count(intent.name) != 0 ? kExpectedBonus : 0;
      for (const Automaton& pattern : intent.patterns) {
        if (!pattern_run_.mayBegin(pattern, entry.at)) continue;
        for (const PatternRun::End& end : pattern_run_.run(pattern, entry.at)) {
          const auto path = pattern_run_.path(end.at);
          if (!path) continue;
          Clause clause;
          clause.intent = &intent;
          clause.begin = entry.at;
          clause.end = end.at;
          clause.cost = end.cost + intent.cost - bonus;
          clause.correction = entry.correction;
          clause.tied = end.tied;
          if (!capture(pattern, *path, &words_, &clause)) continue;
          if (deniesBeforeComma(clause)) continue;
          if (clause.correction || !clause.only_corrects) f(clause);
        }
      }
    }
  }

  /// "À esquerda, não, é à direita" corrects, "à esquerda, não é à direita" denies.
  bool deniesBeforeComma(const Clause& clause) const {
    const bool denies = std::any_of(clause.slots.begin(), clause.slots.end(), [](const Slot& slot) {
      return slot.name == "denied" || slot.name == "was_side" ||
             (slot.name == "instead" && slot.names.empty());
    });
    for (std::size_t at = clause.begin; denies && at + 1 < clause.end; ++at) {
      const auto code = words_.grammar.refusing_words.find(words_.tokens[at].folded);
      const bool no = code != words_.grammar.refusing_words.end() && code->second == "denial";
      if (no && isComma(words_.tokens[at + 1])) return true;
    }
    return false;
  }

  bool isPossible(const IntentInfo& intent, const Entry& entry) const {
    if (intent.only_correction && !entry.correction) return false;
    if (intent.only_expected && expected_.count(intent.name) == 0) return false;
    const bool asks =
        intent.kind == UtteranceKind::kQuestion || intent.kind == UtteranceKind::kCommand;
    if (words_.sentence.is_question && !asks) return false;
    return !entry.correction || intent.kind == UtteranceKind::kStatement;
  }

  std::vector<Utterance> assemble() const {
    const Reading& whole = ends_.back();
    const auto& tokens = words_.tokens;
    if (tokens.empty() || whole.cost >= kNever) {
      return {explain_ ? whyNot(words_, pattern_run_.furthest()) : unexplained()};
    }
    std::vector<Utterance> utterances;
    for (const Reading* reading = &whole;;) {
      const Clause& clause = clauses_[static_cast<std::size_t>(reading->clause)];
      const TextRange range{tokens[clause.begin].range.begin, tokens[clause.end - 1].range.end};
      if (!clause.intent->refuse.empty()) return {refusal(words_, clause.intent->refuse, range)};
      if (clause.tied) return {refusal(words_, "ambiguous", range)};
      if (reading->ambiguous) {
        const Clause& other = clauses_[static_cast<std::size_t>(reading->other)];
        return {
            refusal(words_, "ambiguous", range, examplesOf(*clause.intent, *other.intent, range))};
      }
      utterances.push_back(utteranceOf(clause, range));
      if (reading->begin == 0) break;
      reading = &ends_[reading->from_end];
    }
    std::reverse(utterances.begin(), utterances.end());
    return utterances;
  }

  Utterance unexplained() const {
    Utterance utterance;
    utterance.range = words_.sentence.range;
    return utterance;
  }

  Utterance utteranceOf(const Clause& clause, TextRange range) const {
    Utterance utterance;
    utterance.kind = clause.intent->kind;
    utterance.intent = clause.intent->as.empty() ? clause.intent->name : clause.intent->as;
    utterance.slots = clause.slots;
    utterance.correction = clause.correction;
    utterance.spelling = clause.spelling;
    utterance.range = range;
    utterance.text = words_.textOf(range);
    return utterance;
  }

  /// What people may say instead: a sentence of each kind.
  std::string examplesOf(const IntentInfo& a, const IntentInfo& b, TextRange range) const {
    if (&a == &b || a.examples.empty() || b.examples.empty()) return words_.textOf(range);
    return "\"" + a.examples.front() + "\", \"" + b.examples.front() + "\"";
  }

  const std::set<std::string>& expected_;
  const bool run_on_;
  const bool explain_;
  SentenceWords words_;
  PatternRun pattern_run_;
  std::vector<Reading> ends_;  ///< at each token
  std::vector<Clause> clauses_;
};

/// Whether clauses may follow one another with nothing between: not where a word like "no" would
/// be taken for a clause of its own.
bool mayRunOn(const std::vector<Token>& tokens, const CompiledGrammar& grammar) {
  return tokens.size() >= kShortestRunOn && tokens.size() <= kLongestRunOn &&
         std::none_of(tokens.begin(), tokens.end(), [&](const Token& token) {
           return grammar.refusing_words.count(token.folded) != 0;
         });
}

std::vector<Token> tokensWithin(const std::vector<Token>& tokens, TextRange range) {
  std::vector<Token> within;
  std::copy_if(tokens.begin(), tokens.end(), std::back_inserter(within), [&](const Token& token) {
    return range.begin <= token.range.begin && token.range.end <= range.end;
  });
  return within;
}

std::vector<std::string> namesIn(const std::vector<Utterance>& said) {
  std::vector<std::string> names;
  for (const Utterance& utterance : said) {
    for (const Slot& slot : utterance.slots) {
      for (const SaidName& name : slot.names) {
        if (name.reference.empty()) names.push_back(name.text);
      }
    }
  }
  return names;
}

/// Whatever the case of their first letters, which the beginning of a sentence changes.
bool sameNames(std::vector<std::string> a, std::vector<std::string> b) {
  for (auto* names : {&a, &b}) {
    for (std::string& name : *names) name = hyselam::utf8Lower(name);
    std::sort(names->begin(), names->end());
  }
  return a == b;
}

/// Reasons that only tell where reading came to an end.
bool isGuess(const std::string& code) {
  return code == "no_pattern" || code == "no_name" || code == "misspelt" || code == "question";
}

/// What the person might have meant, or how such things are said.
void propose(const SentenceWords& words, Utterance* refused) {
  if (words.isTooLong()) return;
  // Doubt and denial are no matter of words to leave out.
  static const std::set<std::string> kNothing;
  if (const auto shorter = shorterSentence(words)) {
    const std::string& text = shorter->text;
    const Sentence sentence{{0, text.size()}, words.sentence.is_question};
    const auto tokens = tokenize(text, sentence.range, words.grammar.tokenRules());
    const auto again =
        SentenceReader(words.grammar, text, sentence, tokens, kNothing, false).read();
    if (isUnderstood(again) && sameNames(namesIn(again), shorter->names)) {
      refused->suggestion = text;
      refused->suggests_meaning = true;
      const bool is_reason_of_its_own =
          words.grammar.reasons.count("in_the_way") == 0 || !isGuess(refused->reason_code);
      if (is_reason_of_its_own || shorter->left_out.end == 0) return;
      refused->reason_code = "in_the_way";
      refused->culprit = shorter->left_out;
      refused->reason = words.grammar.reason("in_the_way", words.textOf(shorter->left_out));
      return;
    }
  }
  refused->suggestion = words.grammar.examples.nearest(words.tokens, words.sentence.is_question);
}

}  // namespace

namespace {

/// "A pasta é da Rute e está na tesouraria": behind words that were not understood, nobody knows
/// what is there; it need not be the robot.
void refuseStrayPlaces(const CompiledGrammar& grammar, std::vector<Utterance>* parts) {
  for (std::size_t i = 0; i < parts->size(); ++i) {
    Utterance& part = (*parts)[i];
    const bool stray = (i > 0 && !(*parts)[i - 1].understood()) || !part.left_out.empty();
    if (!stray || part.intent != "robot_in") continue;
    Utterance refused;
    refused.text = part.text;
    refused.range = refused.culprit = part.range;
    refused.reason_code = "whose_place";
    refused.reason = grammar.reason(refused.reason_code);
    part = std::move(refused);
  }
}

std::vector<Utterance> readTokens(const CompiledGrammar& grammar, const std::string& text,
                                  const Sentence& sentence, const std::vector<Token>& tokens,
                                  const std::set<std::string>& expected) {
  const auto read = [&](std::vector<Token> of, bool run_on) {
    return SentenceReader(grammar, text, sentence, std::move(of), expected, run_on).read();
  };
  const auto explained = [&](const Sentence& of) {
    return SentenceReader(grammar, text, of, tokensWithin(tokens, of.range), expected, false, true)
        .read();
  };
  std::vector<Utterance> said = read(tokens, false);
  if (isUnderstood(said)) return said;
  const auto readWithout = [&](const std::vector<Aside>& asides) {
    std::vector<Utterance> rest = read(without(tokens, asides), false);
    for (const Aside& aside : asides) {
      const std::size_t begin = tokens[aside.begin].range.begin;
      const std::size_t end = tokens[aside.end - 1].range.end;
      rest.front().left_out.push_back(text.substr(begin, end - begin));
    }
    return rest;
  };
  const std::vector<Aside> asides = asidesOf(tokens, grammar);
  if (!asides.empty()) {
    std::vector<Utterance> rest = readWithout(asides);
    if (isUnderstood(rest)) return rest;
  }
  for (const std::vector<Aside>& reasons : asidesOfCorrections(tokens, grammar)) {
    std::vector<Utterance> rest = readWithout(reasons);
    const bool corrected = std::any_of(rest.begin(), rest.end(),
                                       [](const Utterance& each) { return each.correction; });
    if (isUnderstood(rest) && corrected) return rest;
  }
  if (mayRunOn(tokens, grammar)) {
    std::vector<Utterance> clauses = read(tokens, true);
    if (isUnderstood(clauses)) return clauses;
  }
  if (tokens.size() <= kLongestRunOn && !sentence.is_question) {
    std::vector<Utterance> parts = readParts(tokens, text, grammar, [&](std::vector<Token> of) {
      const Sentence part{{of.front().range.begin, of.back().range.end}, false};
      return SentenceReader(grammar, text, part, std::move(of), expected, false).read();
    });
    refuseStrayPlaces(grammar, &parts);
    for (Utterance& part : parts) {
      if (part.understood()) continue;
      const Sentence alone{part.range, false};
      if (part.reason_code.empty()) part = explained(alone).front();
      propose(SentenceWords(grammar, text, alone, tokensWithin(tokens, part.range)), &part);
    }
    if (!parts.empty()) return parts;
  }
  if (said.front().reason_code.empty()) said = explained(sentence);
  propose(SentenceWords(grammar, text, sentence, tokens), &said.front());
  return said;
}

/// What an utterance tells, by the values of its slots.
std::set<std::string> valuesOf(const Utterance& utterance, bool with_subject) {
  std::set<std::string> values;
  for (const Slot& slot : utterance.slots) {
    const bool subject = slot.name == "places" || slot.name == "place" || slot.name == "a";
    if (slot.name == "denied" || (subject && !with_subject)) continue;
    if (!slot.word.empty()) values.insert(slot.word);
    for (const SaidName& name : slot.names) values.insert(hyselam::utf8Lower(name.text));
  }
  return values;
}

/// "The lab is on the left and it is not on the left."
bool isContrary(const Utterance& denial, const Utterance& told) {
  if (told.kind != UtteranceKind::kStatement || !told.word("denied").empty()) return false;
  if (denial.word("denied").empty() || denial.correction) return false;
  const std::set<std::string> all = valuesOf(told, true), denied = valuesOf(denial, false);
  const std::vector<std::string> subjects = namesIn({denial});
  const bool same = subjects.empty() ||
                    std::any_of(subjects.begin(), subjects.end(), [&](const std::string& name) {
                      return all.count(hyselam::utf8Lower(name));
                    });
  return same && !denied.empty() &&
         std::includes(all.begin(), all.end(), denied.begin(), denied.end());
}

/// Refuses a sentence that takes back what it tells: "the lab is on the left, that's not true".
std::vector<Utterance> consistent(const CompiledGrammar& grammar, const std::string& text,
                                  const Sentence& sentence, std::vector<Utterance> said) {
  const auto denies = [&](const Utterance& u) {
    return std::any_of(grammar.intents.begin(), grammar.intents.end(), [&](const IntentInfo& each) {
      return each.corrects_next && each.name == u.intent;
    });
  };
  const auto states = [](const Utterance& u) { return u.kind == UtteranceKind::kStatement; };
  for (std::size_t i = 1; i < said.size(); ++i) {
    const auto at = said.begin() + static_cast<std::ptrdiff_t>(i);
    const bool contrary =
        std::any_of(said.begin(), at, [&](const Utterance& u) { return isContrary(*at, u); });
    // "Go to the kitchen, but not now": nowhere.
    const bool put_off = (at->intent == "unknown_answer" || at->intent == "no") &&
                         std::any_of(said.begin(), at, [](const Utterance& u) {
                           return u.kind == UtteranceKind::kCommand && !u.slots.empty();
                         });
    const bool taken_back = denies(*at) && std::any_of(said.begin(), at, states) &&
                            std::none_of(at, said.end(), states);
    if (!contrary && !taken_back && !put_off) continue;
    Utterance refused;
    refused.range = sentence.range;
    refused.text = text.substr(sentence.range.begin, sentence.range.end - sentence.range.begin);
    refused.culprit = at->range;
    refused.reason_code = grammar.reasons.count("contrary") != 0 ? "contrary" : "denial";
    refused.reason = grammar.reason(refused.reason_code, at->text);
    refused.suggestion = grammar.examples.nearest(
        tokenize(text, sentence.range, grammar.tokenRules()), sentence.is_question);
    return {refused};
  }
  return said;
}

}  // namespace

std::vector<Utterance> readSentence(const CompiledGrammar& grammar, const std::string& text,
                                    const Sentence& sentence,
                                    const std::set<std::string>& expected) {
  const std::vector<Token> tokens =
      withMeanings(tokenize(text, sentence.range, grammar.tokenRules()), grammar);
  std::vector<Token> rest = tokens;
  std::vector<Utterance> stated;
  if (sentence.is_question && dropToldAnyway(grammar, &rest)) {
    const TextRange range{rest.front().range.begin, rest.back().range.end};
    stated = consistent(grammar, text, sentence,
                        readTokens(grammar, text, {range, false}, rest, expected));
    if (isUnderstood(stated)) return stated;
  }
  std::vector<Utterance> said =
      consistent(grammar, text, sentence, readTokens(grammar, text, sentence, tokens, expected));
  const bool partly =
      std::any_of(stated.begin(), stated.end(), [](const Utterance& u) { return u.understood(); });
  return partly && !isUnderstood(said) ? stated : said;
}

bool isPlainName(const CompiledGrammar& grammar, const std::string& name, const std::string& type) {
  const auto& types = grammar.name_types;
  const auto found = std::find_if(types.begin(), types.end(),
                                  [&](const NameType& each) { return each.name == type; });
  if (found == types.end()) return false;
  const TokenRules rules = grammar.tokenRules();
  const std::vector<Sentence> sentences = splitSentences(name, rules);
  if (sentences.size() != 1 || sentences[0].range.end != name.size()) return false;
  const std::vector<Token> tokens = tokenize(name, {0, name.size()}, rules);
  if (tokens.empty()) return false;
  NameFinder finder(grammar, name, tokens);
  const auto& names = finder.namesAt(0, static_cast<std::size_t>(found - types.begin()));
  return std::any_of(names.begin(), names.end(), [&](const FoundName& each) {
    return each.end == tokens.size() && each.name.text == name && !each.name.quoted;
  });
}

}  // namespace language
}  // namespace hyselam_topo
