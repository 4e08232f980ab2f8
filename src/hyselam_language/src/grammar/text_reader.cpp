#include "text_reader.hpp"

#include <algorithm>
#include <utility>

#include "sentence_matcher.hpp"
#include "sentence_reader.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// "My office is next to the lift. I'm Lisa": whose is known before it is asked.
void speakerFirst(std::vector<Utterance>* utterances) {
  const auto speaks = [](const Utterance& u) { return u.intent == "speaker"; };
  if (std::count_if(utterances->begin(), utterances->end(), speaks) != 1) return;
  std::stable_partition(utterances->begin(), utterances->end(), speaks);
}

/// "The toilets? They're next to the bar.": what a question only brings up, and what is told of it;
/// nothing if the two make no statement together.
std::vector<Utterance> withTopic(const CompiledGrammar& grammar, const std::string& text,
                                 const Sentence& topic, const Sentence& told) {
  const auto tokens = tokenize(text, topic.range, grammar.tokenRules());
  constexpr std::size_t kLongestTopic = 12;
  const bool plain = tokens.size() <= kLongestTopic &&
                     std::none_of(tokens.begin(), tokens.end(), [&](const auto& token) {
                       return grammar.refusing_words.count(token.folded) != 0;
                     });
  if (!plain || told.is_question) return {};
  static const std::set<std::string> kNothing;
  const Sentence both{{topic.range.begin, told.range.end}, false};
  std::vector<Utterance> said = readSentence(grammar, text, both, kNothing);
  const bool states = std::all_of(said.begin(), said.end(), [](const Utterance& u) {
    return u.kind == UtteranceKind::kStatement;
  });
  return states ? said : std::vector<Utterance>{};
}

/// Whether a part that was refused may change what was said of a place beside it, and is not asked
/// about itself: it names a place or a door, and denies nothing.
bool maySayMore(const Utterance& part, const CompiledGrammar& grammar) {
  if (part.understood() || part.suggests_meaning || part.reason_code == "object") return false;
  const auto tokens = tokenize(part.text, {0, part.text.size()}, grammar.tokenRules());
  const bool denies = std::any_of(tokens.begin(), tokens.end(), [&](const Token& token) {
    const auto found = grammar.refusing_words.find(token.folded);
    return found != grammar.refusing_words.end() && found->second == "denial";
  });
  const NameType* places = grammar.nameType("place");
  return !denies && places != nullptr &&
         std::any_of(tokens.begin(), tokens.end(), [&](const Token& token) {
           return grammar.isNounOrTitle(token.folded) || places->parts.count(token.folded) != 0;
         });
}

}  // namespace

std::vector<Utterance> readText(const CompiledGrammar& compiled, const std::string& text,
                                const std::set<std::string>& expected) {
  std::vector<Utterance> all;
  bool corrects = false;
  const auto sentences = splitSentences(text, compiled.tokenRules());
  for (std::size_t i = 0; i < sentences.size(); ++i) {
    std::vector<Utterance> said = readSentence(compiled, text, sentences[i], expected);
    if (sentences[i].is_question && i + 1 < sentences.size() && !isUnderstood(said)) {
      std::vector<Utterance> both = withTopic(compiled, text, sentences[i], sentences[i + 1]);
      if (!both.empty()) {
        said = std::move(both);
        ++i;
      }
    }
    for (Utterance& utterance : said) {
      if (corrects && utterance.kind == UtteranceKind::kStatement) utterance.correction = true;
      const auto intent =
          std::find_if(compiled.intents.begin(), compiled.intents.end(),
                       [&](const auto& each) { return each.name == utterance.intent; });
      corrects = intent != compiled.intents.end() && intent->corrects_next;
      all.push_back(std::move(utterance));
    }
  }
  speakerFirst(&all);
  return all;
}

void confirmParts(const CompiledGrammar& grammar, const std::string& text,
                  std::vector<Utterance>* utterances) {
  for (const Sentence& sentence : splitSentences(text, grammar.tokenRules())) {
    const auto isInside = [&](const Utterance& each) {
      return sentence.range.begin <= each.range.begin && each.range.begin < sentence.range.end;
    };
    const bool lost = std::any_of(utterances->begin(), utterances->end(), [&](const auto& each) {
      return isInside(each) && maySayMore(each, grammar);
    });
    for (Utterance& each : *utterances) {
      const bool states = each.kind == UtteranceKind::kStatement && !each.correction &&
                          each.intent != "robot_in" && each.intent != "this_is";
      if (lost && states && isInside(each) && each.to_confirm.empty()) {
        each.to_confirm = asSentenceOf(grammar, each);
      }
    }
  }
}

}  // namespace language
}  // namespace hyselam_topo
