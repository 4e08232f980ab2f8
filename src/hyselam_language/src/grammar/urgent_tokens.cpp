#include "urgent_tokens.hpp"

#include <array>
#include <cstring>

#include "hyselam_common/utf8.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::size_t kMaxWord = 64;      // [bytes] of a word that is looked at
constexpr std::size_t kSpelled = 3;       // so many letters in a row are a word spelt out
constexpr std::uint32_t kSigns = 0x2600;  // pictures begin here

bool isApostrophe(std::uint32_t code) {
  return code == '\'' || code == 0x2019 || code == 0x2018 || code == '`' || code == 0xb4;
}

bool isJoiner(std::uint32_t code) {
  return hyselam::isUnicodeSpace(code) || code == '-' || code == '_' || code == '/' ||
         (code >= 0x2010 && code <= 0x2012);
}

class Splitter {
 public:
  explicit Splitter(const std::string& text) : text_(text) {}

  std::vector<UrgentToken> tokens() {
    std::size_t length = 0;
    for (std::size_t i = 0; i < text_.size(); i += length) {
      const std::uint32_t code = hyselam::utf8CodeAt(text_, i, text_.size(), &length);
      if (length == 0) length = 1;
      if (hyselam::isUnicodeLetterOrDigit(code)) {
        length = word(i);
      } else if (code >= kSigns && code != 0xfe0f && code != 0x200d && code != 0xfeff) {
        add({i, i + length}, text_.substr(i, length));
        tokens_.back().sign = true;
      } else if (!isJoiner(code) && !isApostrophe(code)) {
        mark_ = true;
      }
    }
    markQuoted();
    joinLetters();
    return std::move(tokens_);
  }

 private:
  void add(TextRange range, const std::string& word) {
    UrgentToken token;
    token.range = range;
    token.word = urgentWord(word);
    token.after_mark = mark_;
    mark_ = false;
    tokens_.push_back(std::move(token));
  }

  /// The word that begins at byte `begin`; returns its length.
  std::size_t word(std::size_t begin) {
    std::string letters;
    std::size_t i = begin, length = 0;
    while (i < text_.size()) {
      const std::uint32_t code = hyselam::utf8CodeAt(text_, i, text_.size(), &length);
      if (length == 0) break;
      if (hyselam::isUnicodeLetterOrDigit(code)) {
        if (letters.size() < kMaxWord) letters += text_.substr(i, length);
      } else if (!isApostrophe(code) || !hyselam::isUnicodeLetterOrDigit(
                                            hyselam::utf8CodeAt(text_, i + length, text_.size()))) {
        break;
      }
      i += length;
    }
    add({begin, i}, letters);
    return i - begin;
  }

  void markQuoted() {
    constexpr std::array<std::pair<const char*, const char*>, 4> kPairs{
        {{"\xe2\x80\x9c", "\xe2\x80\x9d"},
         {"\xe2\x80\x9e", "\xe2\x80\x9c"},
         {"\xc2\xab", "\xc2\xbb"},
         {"\"", "\""}}};
    for (const auto& [open, close] : kPairs) {
      std::size_t next = 0;
      for (std::size_t at = text_.find(open); at != std::string::npos; at = text_.find(open, at)) {
        const std::size_t inside = at + std::strlen(open);
        const std::size_t end = text_.find(close, inside);
        if (end == std::string::npos) break;
        while (next < tokens_.size() && tokens_[next].range.begin < inside) ++next;
        for (; next < tokens_.size() && tokens_[next].range.end <= end; ++next) {
          tokens_[next].quoted = true;
        }
        at = end + std::strlen(close);
      }
    }
  }

  /// "s t o p", "S.T.O.P."
  void joinLetters() {
    std::vector<UrgentToken> joined;
    const auto isLetter = [&](std::size_t i) {
      return i < tokens_.size() && tokens_[i].word.lower.size() == 1 &&
             (tokens_[i].word.lower[0] < '0' || tokens_[i].word.lower[0] > '9');
    };
    for (std::size_t i = 0; i < tokens_.size();) {
      std::size_t end = i;
      std::string letters;
      while (isLetter(end) && letters.size() < kMaxWord) letters += tokens_[end++].word.lower;
      if (letters.size() < kSpelled) {
        joined.push_back(tokens_[i++]);
        continue;
      }
      UrgentToken token = tokens_[i];
      token.range.end = tokens_[end - 1].range.end;
      token.word = urgentWord(letters);
      joined.push_back(std::move(token));
      i = end;
    }
    tokens_ = std::move(joined);
  }

  const std::string& text_;
  std::vector<UrgentToken> tokens_;
  bool mark_ = false;
};

}  // namespace

std::vector<UrgentToken> urgentTokens(const std::string& text) {
  return Splitter(text).tokens();
}

}  // namespace language
}  // namespace hyselam_topo
