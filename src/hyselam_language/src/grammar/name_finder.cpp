#include "name_finder.hpp"

#include <algorithm>
#include <cstring>

#include "hyselam_common/utf8.hpp"
#include "matching_costs.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr char kMarksInNames[] = "-/#+_";
constexpr std::size_t kLongestNoun = 3;  // words
constexpr int kLongestRange = 50;        // rooms

bool isMarkOfNames(const Token& token) {
  return token.kind == TokenKind::kMark && token.text.size() == 1 &&
         std::string(kMarksInNames).find(token.text) != std::string::npos;
}

bool isWordLike(const Token& token) {
  return token.kind == TokenKind::kWord || token.kind == TokenKind::kNumber;
}

bool isStop(const Token& token, const NameType& type) {
  return type.stop.count(token.lower) != 0 ||
         (token.lower != token.folded && token.folded.size() > 3 &&
          type.stop.count(token.folded) != 0);
}

std::optional<int> wholeNumber(const std::string& text) {
  constexpr std::size_t kMaxDigits = 6;
  const bool digits = !text.empty() && text.size() <= kMaxDigits &&
                      text.find_first_not_of("0123456789") == std::string::npos;
  return digits ? std::optional<int>(std::stoi(text)) : std::nullopt;
}

/// "mary's"
bool endsWithAny(const std::string& word, const NameType& type) {
  return std::any_of(type.elliptic_suffix.begin(), type.elliptic_suffix.end(),
                     [&](const std::string& suffix) {
                       return word.size() > suffix.size() &&
                              word.compare(word.size() - suffix.size(), suffix.size(), suffix) == 0;
                     });
}

/// Nothing but letters a .. z.
bool isAscii(const std::string& word) {
  return std::all_of(word.begin(), word.end(), [](char c) { return c >= 'a' && c <= 'z'; });
}

}  // namespace

NameFinder::NameFinder(const CompiledGrammar& grammar, const std::string& text,
                       const std::vector<Token>& tokens)
    : grammar_(grammar),
      text_(text),
      tokens_(tokens),
      cache_(tokens.size() * grammar.name_types.size()) {}

const std::vector<FoundName>& NameFinder::namesAt(std::size_t at, std::size_t type) {
  Cached& cached = cache_[at * grammar_.name_types.size() + type];
  if (!cached.known) {
    cached.known = true;
    cached.names = find(at, grammar_.name_types[type]);
  }
  return cached.names;
}

bool NameFinder::mayBeArticle(std::size_t at, const NameType& type) const {
  const Token& token = tokens_[at];
  if (token.kind != TokenKind::kWord || !type.isArticle(token.folded)) return false;
  // "à sala" is not "a sala".
  if (token.lower != token.folded && type.stop.count(token.lower) != 0) return false;
  // "room A", but "A kitchen is on your left".
  return !(token.starts_upper && token.text.size() == 1 && at > 0);
}

std::size_t NameFinder::codeEnd(std::size_t at) const {
  const auto isCode = [&](std::size_t k) {
    if (k >= tokens_.size()) return false;
    const Token& token = tokens_[k];
    if (token.kind == TokenKind::kNumber) return true;
    return token.kind == TokenKind::kWord &&
           ((token.text.size() == 1 && token.starts_upper) ||
            std::any_of(token.text.begin(), token.text.end(),
                        [](char c) { return c >= '0' && c <= '9'; }));
  };
  if (!isCode(at)) return 0;
  std::size_t end = at + 1;
  while (end + 1 < tokens_.size() && isMarkOfNames(tokens_[end]) && isCode(end + 1)) end += 2;
  return end;
}

std::string NameFinder::titleOfRow(std::size_t at, const NameType& type) const {
  for (std::size_t k = at; k > 0;) {
    const auto plural = type.plurals.find(tokens_[k - 1].folded);
    if (plural != type.plurals.end()) {
      // "two rooms A and B" counts, and names A and B.
      const bool counted = k > 1 && (tokens_[k - 2].kind == TokenKind::kNumber ||
                                     grammar_.number_words.count(tokens_[k - 2].folded) != 0);
      return counted ? "" : plural->second;
    }
    std::size_t behind = k;
    while (behind > 0 && (tokens_[behind - 1].kind == TokenKind::kComma ||
                          type.between.count(tokens_[behind - 1].lower) != 0)) {
      --behind;
    }
    if (behind == k) return "";
    std::size_t begin = behind;
    while (begin > 0 && codeEnd(begin - 1) == behind) --begin;
    if (begin == behind) return "";
    k = begin;
  }
  return "";
}

std::optional<FoundName> NameFinder::inRow(std::size_t at, const NameType& type) const {
  std::size_t begin = at;
  if (mayBeArticle(begin, type)) ++begin;
  const std::size_t noun = begin;
  const bool plural = begin < tokens_.size() && type.plurals.count(tokens_[begin].folded) != 0;
  begin = plural ? begin + 1 : at;
  const std::size_t end = codeEnd(begin);
  if (end == 0) return rangeInWords(noun, type);
  const std::string title = titleOfRow(begin, type);
  if (title.empty()) return std::nullopt;
  SaidName name = nameOf(begin, end);
  name.text = title + " " + name.text;
  FoundName found{end, kNameCost + kNameWordCost, name, {}};
  addRange(type, title, &found);
  return found;
}

std::optional<int> NameFinder::numberAt(std::size_t at) const {
  const Token& token = tokens_[at];
  if (token.kind == TokenKind::kNumber) return wholeNumber(token.text);
  const auto word = grammar_.number_words.find(token.folded);
  if (token.kind != TokenKind::kWord || word == grammar_.number_words.end()) return std::nullopt;
  return static_cast<int>(word->second.first);
}

std::optional<FoundName> NameFinder::rangeInWords(std::size_t begin, const NameType& type) const {
  constexpr std::size_t kTokens = 4;  // "rooms", "one", "to", "four"
  std::size_t at = begin;
  while (at < begin + kLongestNoun - 1 && at + kTokens < tokens_.size() &&
         type.plurals.count(tokens_[at].folded) == 0) {
    ++at;
  }
  const std::size_t end = at + kTokens;
  if (end > tokens_.size() || type.range_words.count(tokens_[at + 2].lower) == 0) return {};
  const auto plural = type.plurals.find(tokens_[at].folded);
  const auto first = numberAt(at + 1), last = numberAt(end - 1);
  if (plural == type.plurals.end() || !first || !last || *last <= *first ||
      *last - *first > kLongestRange) {
    return {};
  }
  // "rooms two to three metres long"
  const bool goes_on = end < tokens_.size() && tokens_[end].kind == TokenKind::kWord;
  if (goes_on && (grammar_.unit_words.count(tokens_[end].folded) != 0 || numberAt(end))) return {};
  std::string title;
  for (std::size_t k = begin; k < at; ++k) title += tokens_[k].lower + " ";
  title += plural->second;
  if (at > begin && type.nouns.count(hyselam::utf8Fold(title)) == 0) return {};
  FoundName found{end, kNameCost + kNameWordCost, nameOf(at, at + 2), {}};
  SaidName each = found.name;
  each.range = tokens_[end - 1].range;
  found.name.text = title + " " + std::to_string(*first);
  for (int number = *first + 1; number <= *last; ++number) {
    each.text = title + " " + std::to_string(number);
    found.more.push_back(each);
  }
  return found;
}

void NameFinder::addRange(const NameType& type, const std::string& title, FoundName* first) const {
  const Token& from = tokens_[first->end - 1];
  std::optional<int> begin = wholeNumber(from.text), last;
  std::size_t end = first->end;
  const std::size_t dash = from.text.find('-');
  if (dash != std::string::npos) {
    begin = wholeNumber(from.text.substr(0, dash));
    last = wholeNumber(from.text.substr(dash + 1));
  } else if (end + 1 < tokens_.size() && type.range_words.count(tokens_[end].lower) != 0) {
    last = wholeNumber(tokens_[end + 1].text);
    end += 2;
  }
  if (!begin || !last || *last <= *begin || *last - *begin > kLongestRange) return;
  SaidName each = first->name;
  first->name.text = title + " " + std::to_string(*begin);
  each.range = tokens_[end - 1].range;
  for (int number = *begin + 1; number <= *last; ++number) {
    each.text = title + " " + std::to_string(number);
    first->more.push_back(each);
  }
  first->end = end;
}

std::string NameFinder::nounBefore(std::size_t at, const NameType& type) const {
  const auto isNoun = [&](std::size_t k) {
    return type.nouns.count(tokens_[k].folded) != 0 || type.titles.count(tokens_[k].folded) != 0;
  };
  for (std::size_t k = at; k-- > 0;) {
    const auto plural = type.plurals.find(tokens_[k].folded);
    // "Three offices: Tom's, ..." but "the girls' toilets and the boys'".
    const bool owned_row = k > 0 && isPossessive(k - 1, type);
    if (plural != type.plurals.end()) return owned_row ? tokens_[k].text : plural->second;
    if (!isNoun(k)) continue;
    // "gabinete do Rui", "Paul's office": an owner's, too.
    const bool owned_behind = !type.elliptic_prefix.empty() && k + 1 < at &&
                              type.elliptic_prefix.count(tokens_[k + 1].folded) != 0;
    std::size_t begin = k;
    while (begin > 0 && tokens_[begin - 1].kind == TokenKind::kWord &&
           !isStop(tokens_[begin - 1], type) && !endsWithAny(tokens_[begin - 1].lower, type)) {
      --begin;
    }
    const bool owned_before = begin > 0 && endsWithAny(tokens_[begin - 1].lower, type);
    if (owned_behind) return tokens_[k].text;
    if (owned_before) return nameOf(begin, k + 1).text;
  }
  return "";
}

std::size_t NameFinder::apostropheBehind(std::size_t at, const NameType& type) const {
  const Token& token = tokens_[at];
  if (type.elliptic_suffix.empty() || token.kind != TokenKind::kWord || token.folded.size() < 3 ||
      token.folded.back() != 's') {
    return 0;
  }
  for (const char* apostrophe : {"'", "\xe2\x80\x99"}) {
    const std::size_t length = std::strlen(apostrophe);
    if (text_.compare(token.range.end, length, apostrophe) == 0) return length;
  }
  return 0;
}

bool NameFinder::isPossessive(std::size_t at, const NameType& type) const {
  return endsWithAny(tokens_[at].lower, type) || apostropheBehind(at, type) > 0;
}

bool NameFinder::isElliptic(std::size_t begin, std::size_t end, const NameType& type) const {
  if (type.elliptic_prefix.count(tokens_[begin].folded) != 0) return end > begin + 1;
  return isPossessive(end - 1, type);
}

bool NameFinder::endsHere(std::size_t at, const NameType& type) const {
  return at >= tokens_.size() || !isWordLike(tokens_[at]) || isStop(tokens_[at], type) ||
         refuses(tokens_[at]);
}

/// Words that tell which of several, if the noun is put in: "big", "chemistry", "the boys'".
bool NameFinder::tellsWhich(std::size_t begin, std::size_t end, const NameType& type) const {
  if (begin == end || hasNoun(begin, end, type)) return false;
  for (std::size_t k = begin; k < end; ++k) {
    const std::string& word = tokens_[k].folded;
    if (type.elliptic_adjectives.count(word) != 0) continue;
    const bool no_quality = tokens_[k].kind != TokenKind::kWord || type.generic.count(word) != 0 ||
                            type.quantities.count(word) != 0 ||
                            grammar_.number_words.count(word) != 0 || isStop(tokens_[k], type);
    if (no_quality) return false;
  }
  return true;
}

std::optional<FoundName> NameFinder::withoutNoun(std::size_t at, std::size_t begin,
                                                 const NameType& type) const {
  const bool article = begin > at;
  const auto found = [&](std::size_t end, std::size_t words, bool speaker) {
    SaidName name = nameOf(begin, begin + words);
    name.text.append(text_, name.range.end, apostropheBehind(begin + words - 1, type));
    name.range.end = tokens_[end - 1].range.end;
    name.elliptic = true;
    name.speaker = speaker;
    const int cost = kNameCost + kNameWordCost * static_cast<int>(end - begin);
    return FoundName{end, cost, std::move(name), {}};
  };
  const Token& first = tokens_[begin];
  if (first.kind != TokenKind::kWord) return std::nullopt;
  // "mine", "o meu": an article where the noun comes first.
  if (article == type.head_first && type.speaker_alone.count(first.folded) != 0 &&
      endsHere(begin + 1, type)) {
    return found(begin + 1, 1, true);
  }
  if (type.head_first) {  // "a grande"
    const bool adjective = article && type.elliptic_adjectives.count(first.folded) != 0;
    if (!adjective || !endsHere(begin + 1, type)) return std::nullopt;
    return found(begin + 1, 1, false);
  }
  for (std::size_t k = begin + 1; k < tokens_.size() && k < begin + type.max_words; ++k) {
    if (!isWordLike(tokens_[k])) break;
    if (type.elliptic_nouns.count(tokens_[k].folded) == 0) continue;
    if (!endsHere(k + 1, type) || !tellsWhich(begin, k, type)) break;
    return found(k + 1, k - begin, false);
  }
  return std::nullopt;
}

/// "o da Teresa", "ao do Rui", but not "of the corridor", "depois da sala": there what stands
/// before it is missing.
bool NameFinder::isOwnersAlone(std::size_t begin, const NameType& type) const {
  if (begin == 0 || type.elliptic_prefix.count(tokens_[begin].folded) == 0) return false;
  const std::string& before = tokens_[begin - 1].folded;
  if (!type.isArticle(before) && type.elliptic_after.count(before) == 0) return false;
  return begin + 1 < tokens_.size() && !beginsWithNoun(begin + 1, tokens_.size(), type);
}

/// "sala", of "14" in "A sala 12 fica em frente à 14"; "" where a number is no name.
std::string NameFinder::titleOfNumber(std::size_t begin, std::size_t end,
                                      const NameType& type) const {
  const bool alone = end == begin + 1 && tokens_[begin].kind == TokenKind::kNumber;
  if (!alone || begin == 0 || type.elliptic_after.empty()) return "";
  const std::string& before = tokens_[begin - 1].folded;
  if (!type.isArticle(before) && type.elliptic_after.count(before) == 0) return "";
  // "a 14 metros", "a 3 passos"
  const bool counts = end < tokens_.size() && tokens_[end].kind == TokenKind::kWord &&
                      (grammar_.unit_words.count(tokens_[end].folded) != 0 ||
                       grammar_.telling_words.count(tokens_[end].folded) != 0);
  if (counts) return "";
  for (std::size_t k = begin; k-- > 0;) {
    const auto plural = type.plurals.find(tokens_[k].folded);
    if (plural != type.plurals.end()) return plural->second;
    if (type.titles.count(tokens_[k].folded) != 0) return tokens_[k].lower;
  }
  return "";
}

void NameFinder::complete(std::size_t begin, std::size_t end, const NameType& type,
                          SaidName* name) const {
  if (name->quoted || !isElliptic(begin, end, type)) return;
  name->text.append(text_, name->range.end, apostropheBehind(end - 1, type));
  const std::string noun = nounBefore(begin, type);
  if (noun.empty()) {
    name->elliptic = true;
  } else {
    name->text = type.head_first ? noun + " " + name->text : name->text + " " + noun;
  }
}

bool NameFinder::isPart(std::size_t begin, std::size_t end, const NameType& type) const {
  for (std::size_t k = begin; k + 1 < end; ++k) {
    if (type.parts.count(tokens_[k].folded) != 0 &&
        type.part_joiners.count(tokens_[k + 1].folded) != 0) {
      return true;
    }
  }
  const std::string& last = tokens_[end - 1].folded;
  return !type.head_first && type.parts.count(last) != 0 && type.nouns.count(last) == 0 &&
         hasNoun(begin, end - 1, type);
}

std::vector<FoundName> NameFinder::find(std::size_t at, const NameType& type) {
  std::vector<FoundName> found;
  if (const auto in_row = inRow(at, type)) return {*in_row};
  std::size_t begin = at;
  bool indefinite = false;
  if (mayBeArticle(at, type) && at + 1 < tokens_.size()) {
    const Token& next = tokens_[at + 1];
    const bool goes_on = next.kind == TokenKind::kQuoted ||
                         (isWordLike(next) && !isStop(next, type)) || isSpeakers(at + 1, type) ||
                         type.speaker_alone.count(next.folded) != 0;
    if (goes_on) {
      indefinite = type.indefinite.count(tokens_[at].folded) != 0 &&
                   type.definite.count(tokens_[at].folded) == 0;
      ++begin;
    }
  }
  const bool speaker = isSpeakers(begin, type);
  if (const auto short_name = speaker ? std::nullopt : withoutNoun(at, begin, type)) {
    return {*short_name};
  }
  if (speaker) ++begin;
  std::size_t words = 0;
  for (std::size_t k = begin; k < tokens_.size() && words < type.max_words; ++k) {
    const Token& token = tokens_[k];
    bool is_last = false, may_end = true;
    if (token.kind == TokenKind::kQuoted) {
      is_last = true;
    } else if (isMarkOfNames(token) && k > begin) {
      may_end = false;
    } else if (!isWordLike(token) || beginsWithArticle(begin, k, type)) {
      break;
    } else if (refuses(token) && !isCompassOfName(begin, k, type)) {
      break;
    } else if (isStop(token, type)) {
      const bool number =
          k > begin && type.titles.count(tokens_[k - 1].folded) != 0 && isNumberOfTitle(k, type);
      if (!number && !isLetterOfTitle(begin, k, type)) break;
      is_last = number;  // "room one"
    } else if (k > begin && mayBeArticle(k, type)) {
      const std::string& before = tokens_[k - 1].folded;
      if (type.joiners.count(before) != 0) {
        may_end = false;
      } else if (type.titles.count(before) != 0 &&
                 (token.folded.size() == 1 || isNumberOfTitle(k, type))) {
        is_last = true;  // "room a", "sala um"
      } else {
        break;
      }
    }
    ++words;
    if (type.joiners.count(token.folded) != 0) may_end = false;
    if (may_end) {
      const std::string wrong = whatIsWrong(begin, k + 1, indefinite, type);
      const std::string title = wrong.empty() ? "" : titleOfNumber(begin, k + 1, type);
      if (!title.empty()) {
        found.push_back({k + 1, kNameCost + kNameWordCost, nameOf(begin, k + 1), {}});
        found.back().name.text = title + " " + found.back().name.text;
      } else if (wrong.empty() || (speaker && wrong == "no_name" && k == begin)) {
        // "my room": whose it is tells which.
        found.push_back(
            {k + 1, kNameCost + kNameWordCost * static_cast<int>(words), nameOf(begin, k + 1), {}});
        found.back().name.speaker = speaker || type.of_speaker;
        complete(begin, k + 1, type, &found.back().name);
      } else if (!type.silent) {
        failures_.push_back({begin, wrong, k + 1});
      }
    }
    if (is_last) break;
  }
  return found;
}

/// "my office", "o meu gabinete": not "my" alone.
bool NameFinder::isSpeakers(std::size_t at, const NameType& type) const {
  return at + 1 < tokens_.size() && tokens_[at].kind == TokenKind::kWord &&
         type.speaker.count(tokens_[at].folded) != 0 && tokens_[at + 1].kind == TokenKind::kWord &&
         !isStop(tokens_[at + 1], type);
}

/// "hardly never": but "May's office".
bool NameFinder::refuses(const Token& token) const {
  return token.only_lower_letters && grammar_.refusing_words.count(token.folded) != 0;
}

/// "Corredor norte", not "norte do corredor".
bool NameFinder::isCompassOfName(std::size_t begin, std::size_t at, const NameType& type) const {
  const auto code = grammar_.refusing_words.find(tokens_[at].folded);
  return at > begin && code != grammar_.refusing_words.end() && code->second == "compass" &&
         grammar_.isNounOrTitle(tokens_[at - 1].folded) && type.head_first;
}

/// More than a letter, which may be a name of its own.
bool NameFinder::beginsWithArticle(std::size_t begin, std::size_t at, const NameType& type) const {
  const Token& token = tokens_[at];
  return at == begin && token.folded.size() > 1 && mayBeArticle(at, type) && !isStop(token, type);
}

/// "Ao lado da sala um", not "na sala um sofá".
bool NameFinder::isNumberOfTitle(std::size_t at, const NameType& type) const {
  if (grammar_.number_words.count(tokens_[at].folded) == 0) return false;
  return at + 1 == tokens_.size() || !isWordLike(tokens_[at + 1]) || isStop(tokens_[at + 1], type);
}

bool NameFinder::isLetterOfTitle(std::size_t begin, std::size_t at, const NameType& type) const {
  if (at == begin || tokens_[at].folded.size() != 1) return false;
  if (type.titles.count(tokens_[at - 1].folded) == 0) return false;
  return at + 1 == tokens_.size() || tokens_[at + 1].kind != TokenKind::kWord;
}

bool NameFinder::beginsWithNoun(std::size_t begin, std::size_t end, const NameType& type) const {
  std::string phrase;
  for (std::size_t k = begin; k < std::min(end, begin + kLongestNoun); ++k) {
    phrase += (k > begin ? " " : "") + tokens_[k].folded;
    if (type.nouns.count(phrase) != 0) return true;
  }
  return false;
}

bool NameFinder::hasNoun(std::size_t begin, std::size_t end, const NameType& type) const {
  for (std::size_t i = begin; i < end; ++i) {
    if (beginsWithNoun(i, end, type)) return true;
  }
  return false;
}

bool NameFinder::endsWithNoun(std::size_t begin, std::size_t end, const NameType& type) const {
  std::string phrase;
  for (std::size_t k = end; k > begin && k + kLongestNoun > end; --k) {
    phrase = tokens_[k - 1].folded + (phrase.empty() ? "" : " ") + phrase;
    if (type.nouns.count(phrase) != 0) return true;
  }
  return false;
}

bool NameFinder::mayBeMisspelt(std::size_t at, const NameType& type) const {
  const Token& token = tokens_[at];
  const bool plain = token.only_lower_letters || (at == 0 && isAscii(token.folded));
  if (!plain || token.folded.size() < 2 || grammar_.known_words.count(token.folded) != 0) {
    return false;
  }
  return type.stop_slips.hasNear(token.folded);
}

std::string NameFinder::whatIsWrong(std::size_t begin, std::size_t end, bool indefinite,
                                    const NameType& type) {
  const Token& first = tokens_[begin];
  const Token& last = tokens_[end - 1];
  // "a mirror image of the lab" is no lab.
  std::size_t head_end = end;
  for (std::size_t k = end; !type.head_first && k-- > begin + 1;) {
    if (type.joiners.count(tokens_[k].folded) != 0) head_end = k;
  }
  // "o da Teresa" is a place of hers, though Teresa is none.
  const bool has_noun = hasNoun(begin, head_end, type) || isPossessive(end - 1, type) ||
                        (end > begin + 1 && isElliptic(begin, end, type));
  const bool quoted = last.kind == TokenKind::kQuoted;
  if (end - begin > 1) {
    // A quotation may follow "room", nothing else.
    for (std::size_t k = begin; quoted && k + 1 < end; ++k) {
      const std::string& word = tokens_[k].folded;
      const bool noun = type.nouns.count(word) != 0 || type.titles.count(word) != 0;
      if (!noun && type.generic.count(word) == 0) return "no_name";
    }
  }
  if (type.only_elliptic) return isElliptic(begin, end, type) ? "" : "no_name";
  const bool joined = end - begin > 1 && type.joiners.count(first.folded) != 0;
  if (joined && !isOwnersAlone(begin, type)) return "no_name";
  const std::string& name = nameOf(begin, end).text;
  if (!hyselam::wordError(name).empty() || name.size() > kMaxNameBytes) return "no_name";
  if (quoted) return "";
  if (isPart(begin, end, type)) return "part_of_place";
  const bool number_word =
      first.kind == TokenKind::kWord && grammar_.number_words.count(first.folded) != 0;
  const bool small_number =
      end - begin == 1 && first.kind == TokenKind::kNumber && first.text.size() < 3;
  if (number_word || small_number || type.quantities.count(first.folded) != 0) return "quantity";
  // "a mesa da cozinha"
  const auto head = type.forbidden.find(first.folded);
  if (type.head_first && head != type.forbidden.end() && !beginsWithNoun(begin, end, type)) {
    return head->second;
  }
  // "the kitchen table", but "the front desk"
  const auto last_word = type.forbidden.find(tokens_[head_end - 1].folded);
  const bool thing = !type.head_first && head_end > begin + 1 &&
                     last_word != type.forbidden.end() && last_word->second == "object";
  if (thing && !endsWithNoun(begin, head_end, type)) return last_word->second;
  bool only_generic = true;
  for (std::size_t k = begin; k < end; ++k) {
    const auto forbidden = type.forbidden.find(tokens_[k].folded);
    if (forbidden != type.forbidden.end() && !has_noun) return forbidden->second;
    const bool numbered = k > begin && type.titles.count(tokens_[k - 1].folded) != 0 &&
                          isNumberOfTitle(k, type);  // "room one"
    only_generic = only_generic && type.generic.count(tokens_[k].folded) != 0 && !numbered;
  }
  // "clean room", though "clean" and "room" tell nothing alone.
  std::string phrase;
  for (std::size_t k = begin; k < end; ++k) phrase += (k > begin ? " " : "") + tokens_[k].folded;
  if (only_generic && (end - begin < 2 || type.nouns.count(phrase) == 0)) return "no_name";
  if (mayBeMisspelt(begin, type) || mayBeMisspelt(end - 1, type)) return "misspelt";
  if (!has_noun && (type.needs_noun || (indefinite && type.indefinite_needs_noun))) {
    return "not_a_known_kind";
  }
  return "";
}

bool NameFinder::isCommonNoun(const std::string& word) const {
  return std::any_of(grammar_.name_types.begin(), grammar_.name_types.end(),
                     [&](const NameType& type) {
                       return type.titles.count(word) != 0 || type.noun_beginnings.count(word) != 0;
                     });
}

SaidName NameFinder::nameOf(std::size_t begin, std::size_t end) const {
  SaidName name;
  name.range = {tokens_[begin].range.begin, tokens_[end - 1].range.end};
  const Token& last = tokens_[end - 1];
  if (last.kind == TokenKind::kQuoted) {
    name.quoted = true;
    const std::string before = text_.substr(name.range.begin, last.range.begin - name.range.begin);
    name.text = hyselam::singleSpaced(before + " " + last.text);
    if (name.text.compare(0, 1, " ") == 0) name.text.erase(0, 1);
  } else {
    name.text =
        hyselam::singleSpaced(text_.substr(name.range.begin, name.range.end - name.range.begin));
  }
  // "Room A" at the beginning of a sentence is "room A".
  const Token& first = tokens_[begin];
  // "Conference Room A" is written so on purpose.
  const bool title_case = begin + 1 < end && tokens_[begin + 1].starts_upper &&
                          tokens_[begin + 1].text.size() > 1 &&
                          isAscii(tokens_[begin + 1].text.substr(1));
  const bool common = begin == 0 && !title_case && first.starts_upper &&
                      first.kind == TokenKind::kWord && isCommonNoun(first.folded) &&
                      first.text.substr(1) == first.lower.substr(1) && first.text[0] >= 'A' &&
                      first.text[0] <= 'Z';
  if (common) name.text[0] = static_cast<char>(name.text[0] - 'A' + 'a');
  return name;
}

}  // namespace language
}  // namespace hyselam_topo
