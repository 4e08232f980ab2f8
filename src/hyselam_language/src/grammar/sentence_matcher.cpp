#include "sentence_matcher.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "asides.hpp"
#include "hyselam_common/utf8.hpp"
#include "matching_costs.hpp"
#include "name_finder.hpp"
#include "proposals.hpp"
#include "sentence_parts.hpp"
#include "sentence_reader.hpp"
#include "sentence_words.hpp"
#include "token_meanings.hpp"
#include "told_anyway.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// Whether clauses may follow one another with nothing between: not where a word like "no" would
/// be taken for a clause of its own.
bool mayRunOn(const std::vector<Token>& tokens, const CompiledGrammar& grammar) {
  return tokens.size() >= kShortestRunOn && tokens.size() <= kLongestRunOn &&
         std::none_of(tokens.begin(), tokens.end(), [&](const Token& token) {
           return grammar.refusing_words.count(token.folded) != 0;
         });
}

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
    return readClauses(grammar, text, sentence, std::move(of), expected,
                       {run_on, false, nullptr, nullptr});
  };
  const auto explain = [&](const Sentence& of, Utterance* refused) {
    std::vector<Beginning> beginnings;
    if (refused->reason_code.empty()) {
      *refused = readClauses(grammar, text, of, tokensWithin(tokens, of.range), expected,
                             {false, true, &beginnings, nullptr})
                     .front();
    }
    propose(SentenceWords(grammar, text, of, tokensWithin(tokens, of.range)), beginnings, refused);
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
    const auto beginnings = [&](std::vector<Token> of, const std::vector<std::size_t>& ends) {
      std::vector<Beginning> found;
      const Sentence part{{of.front().range.begin, of.back().range.end}, false};
      readClauses(grammar, text, part, std::move(of), expected, {false, false, &found, &ends});
      return found;
    };
    std::vector<Utterance> parts = readParts(tokens, text, grammar, beginnings);
    refuseStrayPlaces(grammar, &parts);
    for (Utterance& part : parts) {
      if (part.understood()) continue;
      explain({part.range, false}, &part);
    }
    if (!parts.empty()) return parts;
  }
  said.resize(1);
  explain(sentence, &said.front());
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
    // "The lab is on the left, I do not know": nobody says so.
    const bool doubted = at->intent == "unknown_answer" && std::any_of(said.begin(), at, states);
    const bool taken_back = denies(*at) && std::any_of(said.begin(), at, states) &&
                            std::none_of(at, said.end(), states);
    if (!contrary && !taken_back && !put_off && !doubted) continue;
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

std::vector<Utterance> readWhole(const CompiledGrammar& grammar, const std::string& text,
                                 const Sentence& sentence, const std::set<std::string>& expected) {
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

/// Whether a sentence alone says just what the utterance does.
bool saysTheSame(const CompiledGrammar& grammar, const std::string& sentence, const Utterance& of) {
  static const std::set<std::string> kNothing;
  const std::vector<Utterance> said =
      readWhole(grammar, sentence, {{0, sentence.size()}, false}, kNothing);
  return said.size() == 1 && said.front().intent == of.intent && said.front().slots == of.slots &&
         said.front().left_out.empty();
}

}  // namespace

std::vector<Utterance> readSentence(const CompiledGrammar& grammar, const std::string& text,
                                    const Sentence& sentence,
                                    const std::set<std::string>& expected) {
  std::vector<Utterance> said = readWhole(grammar, text, sentence, expected);
  for (Utterance& each : said) {
    const bool asks = !each.to_confirm.empty() && saysTheSame(grammar, each.to_confirm, each);
    if (!asks) each.to_confirm.clear();
  }
  return said;
}

std::optional<Utterance> readPlainly(const CompiledGrammar& grammar, const std::string& text) {
  static const std::set<std::string> kNothing;
  const TokenRules rules = grammar.tokenRules();
  const std::vector<Sentence> sentences = splitSentences(text, rules);
  if (sentences.size() != 1) return std::nullopt;
  const Sentence& sentence = sentences.front();
  std::vector<Utterance> said =
      readClauses(grammar, text, sentence,
                  withMeanings(tokenize(text, sentence.range, rules), grammar), kNothing);
  const bool plain = said.size() == 1 && said.front().understood() && said.front().left_out.empty();
  return plain ? std::optional<Utterance>(std::move(said.front())) : std::nullopt;
}

std::string asSentenceOf(const CompiledGrammar& grammar, const Utterance& utterance) {
  std::string sentence = asSentence(utterance.text);
  return saysTheSame(grammar, sentence, utterance) ? sentence : "";
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
