#include "part_reading.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "fact_labels.hpp"
#include "fact_writer.hpp"
#include "grammar/compiled_grammar.hpp"
#include "grammar/sentence_matcher.hpp"
#include "heard_names.hpp"
#include "hyselam_common/utf8.hpp"

namespace hyselam_topo {
namespace {

using language::CompiledGrammar;

/// Of a question: a "yes" spares saying it all again, a "no" costs a word.
constexpr double kWorthAsking = 0.28;
/// Of a fact that the reader takes for told in a text that denies something.
constexpr double kSureBesideDenial = 0.8;
constexpr double kWorthReading = 0.15;     // beside what is asked
constexpr double kWorthShowing = 0.05;     // as an example of what would be understood
constexpr std::size_t kMostFacts = 4;      // nobody says "yes" to more
constexpr std::size_t kMostQuestions = 2;  // after a "no"

/// A fact that the grammar has a sentence for.
struct SaidFact {
  const ReadFact* fact = nullptr;
  std::string sentence;
};

bool hasName(const Utterance& utterance, const std::string& name) {
  const std::string wanted = hyselam::utf8Lower(name);
  return std::any_of(utterance.slots.begin(), utterance.slots.end(), [&](const Slot& slot) {
    return std::any_of(slot.names.begin(), slot.names.end(), [&](const SaidName& each) {
      return hyselam::utf8Lower(each.text) == wanted;
    });
  });
}

/// The fact in words, if the grammar takes them as a whole and with the very names of the fact.
std::optional<SaidFact> inWords(const FactWriter& writer, const Grammar& grammar,
                                const ReadFact& fact) {
  SaidFact in_words{&fact, writer.sentence(fact)};
  if (in_words.sentence.empty()) return std::nullopt;
  const std::optional<Utterance> said =
      language::readPlainly(grammar.compiled(), in_words.sentence);
  if (!said) return std::nullopt;
  // Owners are named by themselves, values by their numbers.
  const auto& arguments = fact.arguments;
  const bool named = arguments.empty() || arguments.front().isReference() ||
                     hasName(*said, arguments.front().text);
  if (!named) return std::nullopt;
  return in_words;
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

/// All facts that are likely together, then with the least likely ones left out. Returns the fact
/// that is asked for alone at last; nullptr if nothing is asked.
const ReadFact* askTogether(const std::vector<SaidFact>& likely, double least, PartReading* part) {
  std::vector<const SaidFact*> best;
  for (const SaidFact& each : likely) best.push_back(&each);
  std::stable_sort(best.begin(), best.end(), [](const SaidFact* a, const SaidFact* b) {
    return a->fact->probability > b->fact->probability;
  });
  double together = 1.0;
  std::size_t count = 0;
  for (; count < std::min(best.size(), kMostFacts); ++count) {
    if (together * best[count]->fact->probability < least) break;
    together *= best[count]->fact->probability;
  }
  if (count > 0) part->probability = together;
  for (; count > 0; --count) {
    std::string sentences;
    for (const SaidFact& each : likely) {  // in the order said
      if (std::find(best.begin(), best.begin() + static_cast<std::ptrdiff_t>(count), &each) ==
          best.begin() + static_cast<std::ptrdiff_t>(count)) {
        continue;
      }
      sentences += (sentences.empty() ? "" : " ") + each.sentence;
    }
    part->asked.push_back(std::move(sentences));
  }
  return part->asked.empty() ? nullptr : best.front()->fact;
}

/// "A next to B" is "B next to A".
bool saySame(const ReadFact& a, const ReadFact& b) {
  const auto same = [](const FactArgument& x, const FactArgument& y) {
    return x.text == y.text && x.range == y.range;
  };
  const auto &of_a = a.arguments, &of_b = b.arguments;
  if (a.relation != b.relation || a.denied != b.denied || a.asked != b.asked ||
      of_a.size() != of_b.size()) {
    return false;
  }
  return std::equal(of_a.begin(), of_a.end(), of_b.begin(), same) ||
         (language::isSymmetric(a.relation) &&
          std::equal(of_a.begin(), of_a.end(), of_b.rbegin(), same));
}

/// The words between the commas around the last name of the fact; none where that cannot be told.
std::vector<language::Token> clauseOf(const ReadFact& fact, const Utterance& part,
                                      const CompiledGrammar& grammar) {
  if (fact.arguments.empty()) return {};
  const std::size_t begin = fact.arguments.back().range.begin;
  const std::string& text = part.text;
  if (begin < part.range.begin || begin - part.range.begin >= text.size()) return {};
  const std::size_t at = begin - part.range.begin;
  const std::size_t from = text.rfind(',', at), to = text.find(',', at);
  const std::size_t first = from == std::string::npos ? 0 : from;
  const TextRange range{first, to == std::string::npos ? text.size() : to};
  return language::tokenize(text, range, grammar.tokenRules());
}

/// Whether one of them has one of the codes; `unknown`: where that cannot be told.
bool hasWordThere(const ReadFact& fact, const Utterance& part, const CompiledGrammar& grammar,
                  const std::set<std::string>& codes, bool unknown) {
  const auto tokens = clauseOf(fact, part, grammar);
  if (tokens.empty()) return unknown;
  return std::any_of(tokens.begin(), tokens.end(), [&](const language::Token& token) {
    const auto found = grammar.refusing_words.find(token.folded);
    return found != grammar.refusing_words.end() && codes.count(found->second) != 0;
  });
}

bool isDeniedThere(const ReadFact& fact, const Utterance& part, const CompiledGrammar& grammar) {
  static const std::set<std::string> kDenial{"denial"};
  return hasWordThere(fact, part, grammar, kDenial, true);
}

/// "The lab used to be on the left, ...": of the past alone.
bool wasThere(const ReadFact& fact, const Utterance& part, const CompiledGrammar& grammar) {
  static const std::set<std::string> kPast{"not_now", "past"};
  if (hasWordThere(fact, part, grammar, kPast, false)) return true;
  const auto tokens = clauseOf(fact, part, grammar);
  for (std::size_t at = 0; at < tokens.size(); ++at) {
    if (grammar.past_asides.standAt(tokens, at, tokens.size())) return true;
  }
  return false;
}

/// What the form of the part rules out, however likely: orders where anything is denied, what may
/// well be denied, and statements in a question.
bool isRuledOut(const ReadFact& fact, const Utterance& part, const PartOf& of,
                const CompiledGrammar& grammar) {
  static const std::set<std::string> kOrders{"go", "follow_me", "come", "back"};
  const bool order = kOrders.count(fact.relation) != 0;
  // "Three doors past the kitchen" is not right after it.
  static const std::set<std::string> kCounted{"how_far", "doors_down"};
  static const std::set<std::string> kBeside{"after", "before", "next"};
  if (kCounted.count(part.reason_code) != 0 && kBeside.count(fact.relation) != 0) return true;
  static const std::set<std::string> kOfThePast{"alias", "rename", "gone"};
  if (!fact.denied && kOfThePast.count(fact.relation) == 0 && wasThere(fact, part, grammar)) {
    return true;
  }
  if (of.is_denied) {
    const bool sure = fact.denied || fact.probability >= kSureBesideDenial;
    if (order || (!sure && isDeniedThere(fact, part, grammar))) return true;
  }
  return of.is_question && !order && !fact.asked && fact.relation.compare(0, 4, "ask_") != 0;
}

/// Never asked on a mere chance.
bool takesAway(const ReadFact& fact) {
  return fact.relation == "gone" || fact.relation == "forget" || fact.relation == "rename";
}

/// Of names that tell which: no "mine", no "the first".
bool isOfHeardNames(const ReadFact& fact, const CompiledGrammar& grammar) {
  return std::all_of(fact.arguments.begin(), fact.arguments.end(), [&](const FactArgument& each) {
    return each.isReference() || isHeardName(each.text, grammar);
  });
}

/// What may be told of one name, two or three: the relations by whose words an example is chosen.
struct Tellable {
  const char* relation;
  std::size_t names;
};
constexpr std::array<Tellable, 19> kTellable{{{"between", 3},
                                              {"opposite", 2},
                                              {"after", 2},
                                              {"before", 2},
                                              {"behind", 2},
                                              {"end", 2},
                                              {"under", 2},
                                              {"over", 2},
                                              {"joined", 2},
                                              {"next", 2},
                                              {"left", 2},
                                              {"right", 2},
                                              {"on", 2},
                                              {"in", 2},
                                              {"left", 1},
                                              {"right", 1},
                                              {"ahead", 1},
                                              {"upstairs", 1},
                                              {"downstairs", 1}}};

/// The facts of a reading that a part may tell, each put into words at most once.
class FactsOfPart {
 public:
  FactsOfPart(const Utterance& part, const PartOf& of, const Grammar& grammar)
      : part_(part), of_(of), grammar_(grammar), writer_(grammar) {}

  const FactWriter& writer() const { return writer_; }

  /// nullptr for what the part does not tell, what it rules out, and what there is no sentence for.
  const SaidFact* said(const ReadFact& fact) {
    const auto known = said_.find(&fact);
    if (known != said_.end()) return known->second ? &*known->second : nullptr;
    std::optional<SaidFact> in_words;
    if (belongsTo(part_.range, of_.is_whole, fact) &&
        !isRuledOut(fact, part_, of_, grammar_.compiled())) {
      in_words = inWords(writer_, grammar_, fact);
    }
    const auto& kept = said_[&fact] = std::move(in_words);
    return kept ? &*kept : nullptr;
  }

 private:
  const Utterance& part_;
  const PartOf& of_;
  const Grammar& grammar_;
  const FactWriter writer_;
  std::map<const ReadFact*, std::optional<SaidFact>> said_;
};

/// Whether all words by which a sentence places what it names were said, too; without such words
/// only the reader knows what it is about.
enum class Placing { kSaid, kNotSaid, kNone };
Placing placingOf(const std::string& sentence, const ReadFact& fact, const Utterance& part,
                  const CompiledGrammar& grammar) {
  const auto& placing =
      grammar.placing_words.empty() ? grammar.telling_words : grammar.placing_words;
  const auto wordsOf = [&](const std::string& text) {
    std::set<std::string> words;
    for (const auto& token : language::tokenize(text, {0, text.size()}, grammar.tokenRules())) {
      if (placing.count(token.folded) != 0) words.insert(token.folded);
    }
    return words;
  };
  std::set<std::string> words = wordsOf(sentence);
  for (const FactArgument& name : fact.arguments) {
    for (const std::string& word : wordsOf(name.text)) words.erase(word);
  }
  if (words.empty()) return Placing::kNone;
  const std::set<std::string> said = wordsOf(part.text);
  return std::includes(said.begin(), said.end(), words.begin(), words.end()) ? Placing::kSaid
                                                                             : Placing::kNotSaid;
}

/// The likeliest fact of the own names, for an example; nullptr without one.
const SaidFact* likeliestToShow(const Utterance& part, const Reading& reading,
                                const CompiledGrammar& grammar, FactsOfPart* facts) {
  std::vector<const ReadFact*> all;
  for (const auto* each : {&reading.facts, &reading.others}) {
    for (const ReadFact& fact : *each) {
      const bool shown =
          fact.probability >= kWorthShowing && !takesAway(fact) && isOfHeardNames(fact, grammar);
      if (shown) all.push_back(&fact);
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const ReadFact* a, const ReadFact* b) {
    return a->probability > b->probability;
  });
  for (const ReadFact* fact : all) {
    const SaidFact* said = facts->said(*fact);
    if (said == nullptr) continue;
    const Placing placing = placingOf(said->sentence, *fact, part, grammar);
    const bool may = placing == Placing::kSaid ||
                     (placing == Placing::kNone && fact->probability >= kWorthReading);
    if (may) return said;
  }
  return nullptr;
}

/// A sentence of the names that were heard, with a relation of which all words were said. "" where
/// none is understood.
std::string exampleOf(const std::vector<FactArgument>& names, const Utterance& part,
                      bool is_question, const FactWriter& writer, const Grammar& grammar) {
  if (names.empty()) return "";
  const CompiledGrammar& compiled = grammar.compiled();
  std::vector<Tellable> order;
  if (is_question) order.push_back({"ask_where", 1});
  for (const Tellable& each : kTellable) {
    const std::string key = "fact_" + std::string(each.relation) + "_" + std::to_string(each.names);
    if (!grammar.has(key)) continue;
    if (placingOf(grammar.say(key), {}, part, compiled) == Placing::kSaid) order.push_back(each);
  }
  for (const Tellable& each : order) {
    // "Next to A and B": of the first ones of which it can be said.
    for (std::size_t first = 0; first + each.names <= names.size(); ++first) {
      ReadFact fact;
      fact.relation = each.relation;
      if (!grammar.has("fact_" + fact.relation + "_" + std::to_string(each.names))) break;
      const auto begin = names.begin() + static_cast<std::ptrdiff_t>(first);
      fact.arguments.assign(begin, begin + static_cast<std::ptrdiff_t>(each.names));
      for (FactArgument& argument : fact.arguments) {
        // "tool crib" alone is clipped speech, an example is none.
        const bool gendered = grammar.has("feminine_article");
        if (argument.article.empty() && !gendered && argument.text[0] >= 'a' &&
            argument.text[0] <= 'z') {
          argument.article = grammar.say("article");
          argument.article.erase(argument.article.find_last_not_of(' ') + 1);
        }
      }
      if (fact.arguments.size() > 1 && fact.arguments[0].text == fact.arguments[1].text) continue;
      if (const auto in_words = inWords(writer, grammar, fact)) return in_words->sentence;
    }
  }
  return "";
}

/// What the part probably tells, and what a "no" to that makes likely.
void ask(const PartOf& of, FactsOfPart* facts, PartReading* part) {
  const Reading& reading = of.reading;
  const double least = of.is_turned ? kLikelierThanNot : kWorthAsking;
  std::vector<SaidFact> likely;
  for (const ReadFact& fact : reading.facts) {
    if (fact.probability < kWorthReading) continue;
    if (const SaidFact* said = facts->said(fact)) likely.push_back(*said);
  }
  std::vector<const ReadFact*> denied;  // each alone, by a "no" to what is asked before
  if (const ReadFact* alone = askTogether(likely, least, part)) denied.push_back(alone);
  // What a "no" to the best reading makes likely.
  double left = 1.0 - part->probability;
  for (const ReadFact& fact : reading.others) {  // the likeliest first
    if (fact.probability < std::max(kWorthReading, least * left)) break;
    const SaidFact* said = facts->said(fact);
    if (said == nullptr || takesAway(fact)) continue;
    if (std::count(part->asked.begin(), part->asked.end(), said->sentence) != 0 ||
        std::any_of(denied.begin(), denied.end(),
                    [&](const ReadFact* before) { return saySame(*before, fact); })) {
      continue;
    }
    if (part->asked.empty()) part->probability = fact.probability;
    part->asked.push_back(said->sentence);
    denied.push_back(&fact);
    left -= fact.probability;
  }
  if (part->asked.size() > 1 + kMostQuestions) part->asked.resize(1 + kMostQuestions);
}

}  // namespace

PartReading readPart(const Utterance& utterance, const PartOf& of, const Grammar& grammar) {
  const Reading& reading = of.reading;
  const CompiledGrammar& compiled = grammar.compiled();
  FactsOfPart facts(utterance, of, grammar);
  PartReading part;
  if (!of.is_doubted) ask(of, &facts, &part);
  if (!part.asked.empty() || utterance.suggests_meaning) return part;  // no example is shown
  const SaidFact* best = likeliestToShow(utterance, reading, compiled, &facts);
  part.example = best != nullptr ? best->sentence
                                 : exampleOf(heardNames(utterance, reading, compiled), utterance,
                                             of.is_question, facts.writer(), grammar);
  return part;
}

}  // namespace hyselam_topo
