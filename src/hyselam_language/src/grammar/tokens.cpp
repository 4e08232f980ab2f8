#include "tokens.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "hyselam_common/numbers.hpp"
#include "hyselam_common/utf8.hpp"

namespace hyselam_topo {
namespace language {
namespace {

struct Quotes {
  const char* open;
  const char* close;
};
// Both ways of using “ and „; straight ones last.
constexpr std::array<Quotes, 6> kQuotes{{{"\xe2\x80\x9c", "\xe2\x80\x9d"},
                                         {"\xe2\x80\x9e", "\xe2\x80\x9c"},
                                         {"\xc2\xab", "\xc2\xbb"},
                                         {"\xe2\x80\x98", "\xe2\x80\x99"},
                                         {"\"", "\""},
                                         {"'", "'"}}};
constexpr std::size_t kMaxQuoted = 200;
// Longer words are no measures and no abbreviations: texts of one word take no longer than others.
constexpr std::size_t kMaxMeasure = 200;
constexpr std::size_t kMaxAbbreviation = 64;

bool startsWith(const std::string& text, std::size_t at, const char* what) {
  return text.compare(at, std::strlen(what), what) == 0;
}

/// The quotation that opens at `i`: the range between the marks and its end behind them.
struct Quoted {
  TextRange inside;
  std::size_t end = 0;
};

std::optional<Quoted> quotedAt(const std::string& text, std::size_t i, std::size_t end) {
  for (const Quotes& quotes : kQuotes) {
    if (!startsWith(text, i, quotes.open)) continue;
    // "the nurses' room": an apostrophe behind a word opens nothing.
    if (quotes.open[0] == '\'' && i > 0 &&
        hyselam::isUnicodeLetterOrDigit(hyselam::utf8CodeAt(text, i - 1, end)))
      continue;
    const std::size_t begin = i + std::strlen(quotes.open);
    const std::size_t limit = std::min(end, begin + kMaxQuoted);
    // Not to the end of a long text for each mark that is never closed.
    for (std::size_t at = begin; at < limit; ++at) {
      if (!startsWith(text, at, quotes.close)) continue;
      const std::size_t after = at + std::strlen(quotes.close);
      // An apostrophe within a word closes nothing.
      if (std::strcmp(quotes.close, "\"") != 0 &&
          hyselam::isUnicodeLetterOrDigit(hyselam::utf8CodeAt(text, after, end))) {
        continue;
      }
      if (text.substr(begin, at - begin).find('\n') != std::string::npos) break;
      return Quoted{{begin, at}, after};
    }
  }
  return std::nullopt;
}

/// The end of the word that begins at `i`: letters and digits, with single - ' . / _ between them.
std::size_t wordEnd(const std::string& text, std::size_t i, std::size_t end) {
  std::size_t length = 0;
  while (true) {
    while (hyselam::isUnicodeLetterOrDigit(hyselam::utf8CodeAt(text, i, end, &length)) &&
           length > 0)
      i += length;
    const std::uint32_t joint = hyselam::utf8CodeAt(text, i, end, &length);
    const bool joins = joint == '-' || joint == '\'' || joint == '.' || joint == '/' ||
                       joint == '_' || joint == 0x2019 || joint == 0x2010 || joint == 0x2011;
    if (!joins || !hyselam::isUnicodeLetterOrDigit(hyselam::utf8CodeAt(text, i + length, end)))
      return i;
    i += length;
  }
}

/// A decimal number at the start of `word`: its length, 0 for none.
std::size_t numberLength(const std::string& word) {
  std::size_t n = 0;
  while (n < word.size() && hyselam::isUnicodeDigit(static_cast<unsigned char>(word[n]))) ++n;
  if (n == 0 || n + 1 >= word.size() || (word[n] != '.' && word[n] != ',')) return n;
  std::size_t k = n + 1;
  while (k < word.size() && hyselam::isUnicodeDigit(static_cast<unsigned char>(word[k]))) ++k;
  return k > n + 1 ? k : n;
}

class Tokenizer {
 public:
  Tokenizer(const std::string& text, TextRange range, const TokenRules& rules)
      : text_(text), end_(range.end), rules_(rules), at_(range.begin) {}

  std::vector<Token> tokens() {
    while (at_ < end_) next();
    return std::move(tokens_);
  }

 private:
  void next() {
    std::size_t length = 0;
    const std::uint32_t code = hyselam::utf8CodeAt(text_, at_, end_, &length);
    if (hyselam::isUnicodeSpace(code)) {
      at_ += length;
    } else if (hyselam::isUnicodeLetterOrDigit(code)) {
      word();
    } else if (const auto quoted = quotedAt(text_, at_, end_)) {
      Token token;
      token.kind = TokenKind::kQuoted;
      token.range = {at_, quoted->end};
      token.text = hyselam::singleSpaced(
          text_.substr(quoted->inside.begin, quoted->inside.end - quoted->inside.begin));
      tokens_.push_back(std::move(token));
      at_ = quoted->end;
    } else {
      mark(code, length);
    }
  }

  void mark(std::uint32_t code, std::size_t length) {
    const bool alone =
        (at_ == 0 || hyselam::isUnicodeSpace(hyselam::utf8CodeAt(text_, at_ - 1, end_))) &&
        hyselam::isUnicodeSpace(hyselam::utf8CodeAt(text_, at_ + length, end_));
    const bool dash = code == '-' || (code >= 0x2010 && code <= 0x2015) || code == 0x2212;
    const bool long_dash = code == 0x2013 || code == 0x2014;
    if (code == 0xd7) {
      tokens_.push_back(wordToken("x", {at_, at_ + length}));
    } else if (code == '&') {
      tokens_.push_back(wordToken("&", {at_, at_ + length}));
    } else if (std::strchr(".!?;'", static_cast<int>(code < 0x80 ? code : 1)) != nullptr ||
               code == 0x2026 || code == 0x2019) {
      // Ends of the sentence, stray apostrophes: nothing to say.
    } else {
      Token token;
      const bool comma =
          code == ',' || code == ':' || code == '(' || code == ')' || long_dash || (dash && alone);
      token.kind = comma ? TokenKind::kComma : TokenKind::kMark;
      token.range = {at_, at_ + length};
      token.text = dash ? "-" : text_.substr(at_, length);
      token.lower = token.folded = token.text;
      tokens_.push_back(std::move(token));
    }
    at_ += length;
  }

  void word() {
    std::size_t end = wordEnd(text_, at_, end_);
    // "1,5", but not "1,2,3".
    const auto digitsFrom = [&](std::size_t i) {
      while (hyselam::isUnicodeDigit(hyselam::utf8CodeAt(text_, i, end_))) ++i;
      return i;
    };
    if (digitsFrom(at_) == end && hyselam::utf8CodeAt(text_, end, end_) == ',') {
      const std::size_t more = digitsFrom(end + 1);
      const bool list = hyselam::utf8CodeAt(text_, more, end_) == ',' &&
                        hyselam::isUnicodeDigit(hyselam::utf8CodeAt(text_, more + 1, end_));
      if (more > end + 1 && !list) end = std::max(more, wordEnd(text_, more, end_));
    }
    const std::string word = text_.substr(at_, end - at_);
    if (hyselam::isUnicodeDigit(static_cast<unsigned char>(word[0])) && measures(word)) {
      at_ = end;
      return;
    }
    // Digits with a comma that are no measure after all: "1,5b".
    end = wordEnd(text_, at_, end_);
    const std::string plain = text_.substr(at_, end - at_);
    const TextRange range{at_, end};
    if (const auto* expansion = rules_.expansion(hyselam::utf8Lower(plain))) {
      for (const std::string& each : *expansion) tokens_.push_back(wordToken(each, range));
    } else {
      tokens_.push_back(wordToken(plain, range));
    }
    at_ = end;
  }

  /// "6", "1,5", "6m", "6x8", "6x8m": adds the tokens; false if it is something else ("3B").
  bool measures(const std::string& word) {
    if (word.size() > kMaxMeasure) return false;
    std::vector<Token> parts;
    std::size_t i = 0;
    while (true) {
      const std::size_t length = numberLength(word.substr(i));
      if (length == 0) return false;
      std::string digits = word.substr(i, length);
      Token token = wordToken(digits, {at_ + i, at_ + i + length});
      std::replace(digits.begin(), digits.end(), ',', '.');
      const auto number = hyselam::parseNumber(digits);
      if (!number) return false;
      token.kind = TokenKind::kNumber;
      token.number = *number;
      parts.push_back(token);
      i += length;
      if (i == word.size()) break;
      const std::string rest = word.substr(i);
      if (rules_.is_unit(hyselam::utf8Fold(rest))) {
        parts.push_back(wordToken(rest, {at_ + i, at_ + word.size()}));
        break;
      }
      // Between two numbers; a unit may stand before: "6mx8m".
      const std::size_t x = rest.find_first_of("xX");
      if (x == std::string::npos ||
          (x > 0 && !rules_.is_unit(hyselam::utf8Fold(rest.substr(0, x))))) {
        return false;
      }
      if (x > 0) parts.push_back(wordToken(rest.substr(0, x), {at_ + i, at_ + i + x}));
      parts.push_back(wordToken("x", {at_ + i + x, at_ + i + x + 1}));
      i += x + 1;
    }
    tokens_.insert(tokens_.end(), parts.begin(), parts.end());
    return true;
  }

  const std::string& text_;
  const std::size_t end_;
  const TokenRules& rules_;
  std::size_t at_;
  std::vector<Token> tokens_;
};

/// Whether the full stop at `i` is part of a number, a name or an abbreviation.
bool isInnerStop(const std::string& text, std::size_t i, std::size_t begin,
                 const TokenRules& rules) {
  std::size_t word = i;
  while (word > begin && i - word <= kMaxAbbreviation &&
         !hyselam::isUnicodeSpace(static_cast<unsigned char>(text[word - 1]))) {
    --word;
  }
  const std::string before = text.substr(word, i - word);
  std::size_t length = 0;
  const std::uint32_t next = hyselam::utf8CodeAt(text, i + 1, text.size(), &length);
  if (hyselam::isUnicodeLetterOrDigit(next)) {
    // "I-109.On your left": a forgotten space; "B.Lab" and "Dr.No" stay whole.
    const std::uint32_t after = hyselam::utf8CodeAt(text, i + 1 + length, text.size());
    const bool begins_sentence = hyselam::isUnicodeUpper(next) &&
                                 hyselam::isUnicodeLetterOrDigit(after) &&
                                 !hyselam::isUnicodeUpper(after) && !hyselam::isUnicodeDigit(after);
    if (!begins_sentence || rules.is_abbreviation(hyselam::utf8Lower(before))) return true;
    if (before.size() >= 2) return false;
    const std::size_t end = wordEnd(text, i + 1, text.size());
    return !rules.may_begin(hyselam::utf8Fold(text.substr(i + 1, end - i - 1)));
  }
  return hyselam::isUnicodeSpace(next) && rules.is_abbreviation(hyselam::utf8Lower(before));
}

}  // namespace

Token wordToken(const std::string& text, TextRange range) {
  Token token;
  token.range = range;
  token.text = text;
  token.lower = hyselam::utf8Lower(text);
  token.folded = hyselam::utf8Fold(text);
  token.has_accents =
      token.lower != token.folded && std::all_of(token.folded.begin(), token.folded.end(),
                                                 [](char c) { return c >= 'a' && c <= 'z'; });
  token.starts_upper = hyselam::isUnicodeUpper(hyselam::utf8CodeAt(text, 0, text.size()));
  token.only_lower_letters =
      token.lower == text && std::all_of(token.folded.begin(), token.folded.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || c == '\'';
      });
  return token;
}

std::vector<Sentence> splitSentences(const std::string& text, const TokenRules& rules) {
  std::vector<Sentence> sentences;
  std::size_t begin = 0;
  bool question = false;
  const auto end = [&](std::size_t at) {
    std::size_t from = begin, length = 0;
    while (from < at && hyselam::isUnicodeSpace(hyselam::utf8CodeAt(text, from, at, &length)))
      from += length;
    std::size_t to = at;
    while (to > from && hyselam::isUnicodeSpace(static_cast<unsigned char>(text[to - 1]))) --to;
    const bool says_something =
        std::any_of(text.begin() + static_cast<std::ptrdiff_t>(from),
                    text.begin() + static_cast<std::ptrdiff_t>(to),
                    [](char c) { return std::strchr(" .!?;\t\r\n", c) == nullptr || c == '\0'; });
    if (says_something) sentences.push_back({{from, to}, question});
    begin = at;
    question = false;
  };
  std::size_t length = 0;
  for (std::size_t i = 0; i < text.size(); i += length) {
    const std::uint32_t code = hyselam::utf8CodeAt(text, i, text.size(), &length);
    const bool quote_may_open =
        i == 0 || !hyselam::isUnicodeLetterOrDigit(hyselam::utf8CodeAt(text, i - 1, text.size()));
    if (quote_may_open && !hyselam::isUnicodeLetterOrDigit(code) &&
        !hyselam::isUnicodeSpace(code)) {
      if (const auto quoted = quotedAt(text, i, text.size())) {
        length = quoted->end - i;
        continue;
      }
    }
    const bool empty_line = code == '\n' &&
                            text.find_first_not_of(" \t\r", i + 1) != std::string::npos &&
                            text[text.find_first_not_of(" \t\r", i + 1)] == '\n';
    bool ends = code == '!' || code == '?' || code == ';' || code == 0x2026 || empty_line;
    ends = ends || (code == '.' && !isInnerStop(text, i, begin, rules));
    if (!ends) continue;
    // All of "?!..." belongs to this sentence.
    std::size_t at = i + length;
    question = code == '?';
    while (at < text.size() && std::strchr(".!?;", text[at]) != nullptr && text[at] != '\0') {
      question = question || text[at] == '?';
      ++at;
    }
    length = at - i;
    end(at);
  }
  end(text.size());
  return sentences;
}

std::vector<Token> tokenize(const std::string& text, TextRange range, const TokenRules& rules) {
  return Tokenizer(text, range, rules).tokens();
}

}  // namespace language
}  // namespace hyselam_topo
