#include "proposals.hpp"

#include <algorithm>
#include <optional>

#include "hyselam_common/utf8.hpp"
#include "matching_costs.hpp"
#include "name_finder.hpp"
#include "shorter_sentence.hpp"

namespace hyselam_topo {
namespace language {
namespace {

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

/// The last vowel of an article: "a" and "da", "as" and "das" go with the same nouns.
char genderOf(const std::string& article) {
  const std::size_t last = article.find_last_not_of('s');
  return last == std::string::npos ? 's' : article[last];
}

/// As it was said: behind which article.
struct OwnPlace {
  SaidName name;
  std::string article;
};

/// The place that is named first, with a noun that the grammar knows and without a number.
std::optional<OwnPlace> firstPlace(const SentenceWords& words, const NameType& places) {
  NameFinder finder(words.grammar, words.text, words.tokens);
  const auto type = static_cast<std::size_t>(&places - words.grammar.name_types.data());
  for (std::size_t at = 0; at < words.tokens.size(); ++at) {
    if (places.definite.count(words.tokens[at].folded) == 0) continue;
    const auto& names = finder.namesAt(at, type);
    if (names.empty()) continue;
    const FoundName& name = names.back();
    const bool noun =
        std::any_of(words.tokens.begin() + static_cast<std::ptrdiff_t>(at),
                    words.tokens.begin() + static_cast<std::ptrdiff_t>(name.end),
                    [&](const Token& token) { return places.nouns.count(token.folded) != 0; });
    if (noun && name.more.empty() && name.name.reference.empty() && !name.name.quoted &&
        !name.name.elliptic && !name.name.speaker) {
      return OwnPlace{name.name, words.tokens[at].folded};
    }
  }
  return std::nullopt;
}

/// An example of what can be said, of the place that the person spoke of: "the kitchen is next to
/// the library" is "the archive is next to the library".
std::string withOwnName(const SentenceWords& words, const std::string& example) {
  const NameType* places = words.grammar.nameType("place");
  if (places == nullptr || example.empty()) return example;
  const std::optional<OwnPlace> own = firstPlace(words, *places);
  const bool has_it = own && hyselam::utf8Lower(example).find(hyselam::utf8Lower(own->name.text)) !=
                                 std::string::npos;
  if (!own || has_it) return example;
  static const std::set<std::string> kNothing;
  const auto read = [&](const std::string& text) {
    const Sentence sentence{{0, text.size()}, words.sentence.is_question};
    return readClauses(words.grammar, text, sentence,
                       tokenize(text, sentence.range, words.grammar.tokenRules()), kNothing);
  };
  const std::vector<Utterance> said = read(example);
  if (!isUnderstood(said) || said.size() != 1) return example;
  const std::vector<std::string> before = namesIn(said);
  for (const Slot& slot : said.front().slots) {
    if (slot.names.empty() || !slot.names.front().reference.empty()) continue;
    const SaidName& name = slot.names.front();
    if (name.range.end > example.size()) return example;
    const auto before_it = tokenize(example, {0, name.range.begin}, words.grammar.tokenRules());
    const std::string article = before_it.empty() ? "" : before_it.back().folded;
    const bool fits =
        places->definite.count(article) != 0 && genderOf(article) == genderOf(own->article) &&
        (article.back() == 's') == (own->article.back() == 's') &&
        example.compare(name.range.begin, name.range.end - name.range.begin, name.text) == 0;
    if (!fits) return example;
    std::string text = example;
    text.replace(name.range.begin, name.range.end - name.range.begin, own->name.text);
    std::vector<std::string> after = before;
    std::replace(after.begin(), after.end(), name.text, own->name.text);
    const std::vector<Utterance> again = read(text);
    const bool same = isUnderstood(again) && again.size() == 1 &&
                      again.front().intent == said.front().intent &&
                      sameNames(namesIn(again), after);
    return same ? text : example;
  }
  return example;
}

bool isRefusing(const SentenceWords& words, const Token& token, bool denial_alone) {
  const auto code = words.grammar.refusing_words.find(token.folded);
  if (code == words.grammar.refusing_words.end()) return false;
  if (denial_alone) return code->second == "denial";
  return code->second != "comparison" && code->second != "pointing";
}

/// Whether what was understood before a token may stand without what follows: no name and no
/// phrase goes on there ("before the stage | door", "two doors down | from the lift"), and nothing
/// that follows is doubt, choice, condition or denial.
bool mayEndBefore(const SentenceWords& words, std::size_t at) {
  const auto& tokens = words.tokens;
  const CompiledGrammar& grammar = words.grammar;
  const NameType* places = grammar.nameType("place");
  const auto places_it = [&](const Token& token) {
    return grammar.telling_words.count(token.folded) != 0 ||
           grammar.placing_words.count(token.folded) != 0;
  };
  const auto isThing = [&](const Token& token) {
    return grammar.isNounOrTitle(token.folded) ||
           (places != nullptr && places->parts.count(token.folded) != 0);
  };
  if (!isComma(tokens[at])) {
    const bool border =
        places_it(tokens[at]) || (places != nullptr && places->stop.count(tokens[at].lower) != 0);
    const bool joins = places != nullptr && places->joiners.count(tokens[at].folded) != 0;
    const bool begins = places_it(tokens[at - 1]) && !isThing(tokens[at - 1]);
    if (!border || joins || begins || isThing(tokens[at])) return false;
  }
  return std::none_of(tokens.begin() + static_cast<std::ptrdiff_t>(at), tokens.end(),
                      [&](const Token& each) { return isRefusing(words, each, false); });
}

/// Something that tells of what is named, and denies nothing.
bool isWorthAsking(const SentenceWords& words, const std::vector<Utterance>& said) {
  const TextRange range{said.front().range.begin, said.back().range.end};
  const auto tokens = tokensWithin(words.tokens, range);
  if (std::any_of(tokens.begin(), tokens.end(),
                  [&](const Token& each) { return isRefusing(words, each, true); })) {
    return false;
  }
  return !namesIn(said).empty() && std::all_of(said.begin(), said.end(), [](const Utterance& each) {
    const bool command = each.kind == UtteranceKind::kCommand && !each.slots.empty();
    return (each.kind == UtteranceKind::kStatement || command) && !each.correction &&
           each.left_out.empty();
  });
}

/// The longest beginning that is understood: "Somebody has left a laptop on the table[ nearest to
/// the door]". What follows is told as left out.
bool proposeBeginning(const SentenceWords& words, const std::vector<Beginning>& beginnings,
                      Utterance* refused) {
  constexpr std::size_t kFewest = 4;  // words that are worth a question
  const auto& tokens = words.tokens;
  if (words.sentence.is_question || tokens.size() > kLongestRunOn) return false;
  for (const auto& [end, said] : beginnings) {
    if (end < kFewest || 5 * end < 2 * tokens.size()) return false;
    if (!mayEndBefore(words, end)) continue;
    if (!isWorthAsking(words, said)) continue;
    const TextRange range{tokens.front().range.begin, tokens[end - 1].range.end};
    const TextRange rest{
        tokens[isComma(tokens[end]) ? std::min(end + 1, tokens.size() - 1) : end].range.begin,
        tokens.back().range.end};
    refused->suggestion = asSentence(words.textOf(range));
    refused->suggests_meaning = true;
    refused->left_out = {words.textOf(rest)};
    if (isGuess(refused->reason_code) && words.grammar.reasons.count("in_the_way") != 0) {
      refused->reason_code = "in_the_way";
      refused->culprit = rest;
      refused->reason = words.grammar.reason("in_the_way", words.textOf(rest));
    }
    return true;
  }
  return false;
}

}  // namespace

void propose(const SentenceWords& words, const std::vector<Beginning>& beginnings,
             Utterance* refused) {
  if (words.isTooLong()) return;
  // Doubt and denial are no matter of words to leave out.
  static const std::set<std::string> kNothing;
  if (const auto shorter = shorterSentence(words)) {
    const std::string& text = shorter->text;
    const Sentence sentence{{0, text.size()}, words.sentence.is_question};
    const auto tokens = tokenize(text, sentence.range, words.grammar.tokenRules());
    const auto again = readClauses(words.grammar, text, sentence, tokens, kNothing);
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
  if (proposeBeginning(words, beginnings, refused)) return;
  refused->suggestion =
      withOwnName(words, words.grammar.examples.nearest(words.tokens, words.sentence.is_question));
}

}  // namespace language
}  // namespace hyselam_topo
