#include "heard_text.hpp"

#include "grammar/token_meanings.hpp"

namespace hyselam_topo {
namespace language {
namespace {

std::string wordOf(const Token& token) {
  switch (token.kind) {
    case TokenKind::kWord:
      return token.folded;
    case TokenKind::kNumber:
      return "<number>";
    case TokenKind::kQuoted:
      return "<quoted>";
    case TokenKind::kComma:
      return token.text.empty() ? "," : token.text;
    case TokenKind::kMark:
      return "<mark>";
  }
  return "";
}

/// "Mary's" as "Mary" and "'s": a possession or a verb, which is for the model to tell. Known: of
/// tokens of three bytes without an apostrophe of three bytes the comparison wraps around, and four
/// bytes are taken for the mark; the shipped models have learnt from texts split so.
std::vector<Token> withoutClitics(std::vector<Token> tokens) {
  std::vector<Token> apart;
  for (Token& token : tokens) {
    const std::string& folded = token.folded;
    const bool clitic = token.kind == TokenKind::kWord && folded.size() > 2 &&
                        folded.compare(folded.size() - 2, 2, "'s") == 0;
    const std::size_t marks = token.text.rfind("\xe2\x80\x99") == token.text.size() - 4 ? 4 : 2;
    if (!clitic || token.range.end - token.range.begin <= marks) {
      apart.push_back(std::move(token));
      continue;
    }
    Token end = wordToken("'s", {token.range.end - marks, token.range.end});
    token.text.resize(token.text.size() - marks);
    token.lower.resize(token.lower.size() - 2);
    token.folded.resize(token.folded.size() - 2);
    token.range.end -= marks;
    apart.push_back(std::move(token));
    apart.push_back(std::move(end));
  }
  return apart;
}

}  // namespace

HeardText::HeardText(const CompiledGrammar& grammar, const ReaderLexicon& lexicon,
                     const std::string& text)
    : text_(text) {
  for (const Sentence& sentence : splitSentences(text, grammar.tokenRules())) {
    auto tokens = withMeanings(tokenize(text, sentence.range, grammar.tokenRules()), grammar);
    for (Token& token : withoutClitics(std::move(tokens))) {
      std::string word = wordOf(token);
      add(lexicon, std::move(token), std::move(word), false);
    }
    Token end;
    end.kind = TokenKind::kMark;
    end.range = {sentence.range.end, sentence.range.end};
    add(lexicon, std::move(end), sentence.is_question ? "?" : ".", true);
  }
}

void HeardText::add(const ReaderLexicon& lexicon, Token token, std::string word, bool ends) {
  const bool is_word = token.kind == TokenKind::kWord;
  nouns_.push_back(is_word && lexicon.nouns.count(token.folded) != 0);
  keywords_.push_back(is_word && lexicon.keywords.count(token.folded) != 0);
  ends_.push_back(ends);
  words_.push_back(std::move(word));
  tokens_.push_back(std::move(token));
}

const std::string& HeardText::word(std::ptrdiff_t at) const {
  static const std::string kBefore = "<begin>", kAfter = "<end>";
  if (at < 0) return kBefore;
  const auto index = static_cast<std::size_t>(at);
  return index < words_.size() ? words_[index] : kAfter;
}

bool HeardText::isNoun(std::ptrdiff_t at) const {
  return at >= 0 && at < static_cast<std::ptrdiff_t>(nouns_.size()) &&
         nouns_[static_cast<std::size_t>(at)];
}

bool HeardText::isKeyword(std::ptrdiff_t at) const {
  return at >= 0 && at < static_cast<std::ptrdiff_t>(keywords_.size()) &&
         keywords_[static_cast<std::size_t>(at)];
}

TextRange HeardText::rangeOf(const Mention& mention) const {
  return {tokens_[mention.begin].range.begin, tokens_[mention.end - 1].range.end};
}

std::string HeardText::textOf(const Mention& mention) const {
  const TextRange range = rangeOf(mention);
  return text_.substr(range.begin, range.end - range.begin);
}

std::string HeardText::nameOf(const Mention& mention) const {
  std::string name = textOf(mention);
  const bool begins = mention.begin == 0 || endsSentence(mention.begin - 1);
  char& first = name.front();
  if (begins && isNoun(static_cast<std::ptrdiff_t>(mention.begin)) && first >= 'A' && first <= 'Z')
    first = static_cast<char>(first - 'A' + 'a');
  return name;
}

}  // namespace language
}  // namespace hyselam_topo
