#include "fact_candidates.hpp"

#include <algorithm>

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::size_t kFarthest = 3;     // mentions between those of a pair
constexpr std::size_t kWordsAround = 8;  // that may tell the relation

std::string kindOf(const Mention& mention) {
  static const char* const kKinds[] = {"<thing>", "<person>", "<value>"};
  return kKinds[static_cast<std::size_t>(mention.kind)];
}

}  // namespace

MentionContext::MentionContext(const ReaderLexicon& lexicon, const HeardText& text,
                               const std::vector<Mention>& mentions)
    : text_(text), mentions_(mentions), mention_at_(text.tokens().size()) {
  for (std::size_t i = 0; i < mentions.size(); ++i) {
    for (std::size_t at = mentions[i].begin; at < mentions[i].end; ++at) mention_at_[at] = i;
    bool goes_on = i > 0 && mentions[i].kind == mentions[i - 1].kind &&
                   mentions[i].begin > mentions[i - 1].end;
    for (std::size_t at = i > 0 ? mentions[i - 1].end : 0; goes_on && at < mentions[i].begin;
         ++at) {
      goes_on = text.tokens()[at].kind == TokenKind::kComma ||
                lexicon.row_words.count(text.word(static_cast<std::ptrdiff_t>(at))) != 0;
    }
    goes_on_.push_back(goes_on);
  }
}

std::vector<FactCandidate> MentionContext::candidates() const {
  std::vector<FactCandidate> all;
  for (std::size_t what = 0; what < mentions_.size(); ++what) {
    all.push_back({what, std::nullopt});
    for (std::size_t by = 0; by < mentions_.size(); ++by) {
      const std::size_t apart = std::max(what, by) - std::min(what, by);
      const bool one_thing = mentions_[what].kind == Mention::Kind::kThing;
      if (by != what && apart <= kFarthest && one_thing) all.push_back({what, by});
    }
  }
  return all;
}

std::string MentionContext::word(std::ptrdiff_t at) const {
  if (at >= 0 && at < static_cast<std::ptrdiff_t>(mention_at_.size())) {
    const auto& mention = mention_at_[static_cast<std::size_t>(at)];
    if (mention) return kindOf(mentions_[*mention]);
  }
  return text_.word(at);
}

std::vector<std::string> MentionContext::words(std::size_t begin, std::size_t end) const {
  std::vector<std::string> found;
  for (std::size_t at = begin; at < end; ++at) {
    const bool inside = mention_at_[at] && mentions_[*mention_at_[at]].begin != at;
    if (!inside || at == begin) found.push_back(word(static_cast<std::ptrdiff_t>(at)));
  }
  return found;
}

std::string MentionContext::headOf(std::size_t mention) const {
  const Mention& m = mentions_[mention];
  for (std::size_t at = m.end; at-- > m.begin;) {
    if (text_.isNoun(static_cast<std::ptrdiff_t>(at)))
      return text_.word(static_cast<std::ptrdiff_t>(at));
  }
  return "-";
}

std::size_t MentionContext::rowBegin(std::size_t mention) const {
  while (goes_on_[mention]) --mention;
  return mention;
}

std::size_t MentionContext::sentenceBegin(std::size_t at) const {
  while (at > 0 && !text_.endsSentence(at - 1)) --at;
  return at;
}

std::size_t MentionContext::sentenceEnd(std::size_t at) const {
  while (at < text_.tokens().size() && !text_.endsSentence(at)) ++at;
  return at;
}

void MentionContext::addUnary(std::size_t what, const std::string& prefix, Features* out) const {
  const Mention& m = mentions_[what];
  const auto add = [&](const std::string& name, const std::string& value) {
    out->push_back(prefix + name + "=" + value);
  };
  const auto first = static_cast<std::ptrdiff_t>(m.begin),
             last = static_cast<std::ptrdiff_t>(m.end);
  const std::string b1 = word(first - 1), b2 = word(first - 2), b3 = word(first - 3);
  const std::string a1 = word(last), a2 = word(last + 1), a3 = word(last + 2);
  add("b1", b1), add("b2", b2), add("b3", b3), add("b21", b2 + "_" + b1),
      add("b321", b3 + "_" + b2 + "_" + b1);
  add("a1", a1), add("a2", a2), add("a3", a3), add("a12", a1 + "_" + a2),
      add("a123", a1 + "_" + a2 + "_" + a3);
  add("ba", b1 + "_" + a1);
  // What is said before and behind it up to the next mentions, and in the whole sentence.
  const std::size_t begin = sentenceBegin(m.begin), end = sentenceEnd(m.begin);
  std::size_t from = m.begin, to = m.end;
  while (from > begin && !mention_at_[from - 1] && m.begin - from < kWordsAround) --from;
  while (to < end && !mention_at_[to] && to - m.end < kWordsAround) ++to;
  const auto addAll = [&](const std::string& name, const std::vector<std::string>& said) {
    for (std::size_t i = 0; i < said.size(); ++i) {
      add(name, said[i]);
      if (i > 0) add(name + "2", said[i - 1] + "_" + said[i]);
    }
  };
  addAll("before", words(from, m.begin));
  addAll("behind", words(m.end, to));
  if (from == begin) add("begins", word(static_cast<std::ptrdiff_t>(begin)));
  add("sentence", word(static_cast<std::ptrdiff_t>(end)));
  for (const std::string& each : words(begin, end)) add("in", each);
  add("first", word(static_cast<std::ptrdiff_t>(begin)) + "_" +
                   word(static_cast<std::ptrdiff_t>(begin) + 1));
}

void MentionContext::addBetween(std::size_t left, std::size_t right, const std::string& prefix,
                                Features* out) const {
  const Mention &a = mentions_[left], &b = mentions_[right];
  const auto add = [&](const std::string& name, const std::string& value) {
    out->push_back(prefix + name + "=" + value);
  };
  const std::vector<std::string> said = words(a.end, b.begin);
  std::string whole;
  for (std::size_t i = 0; i < said.size(); ++i) {
    whole += said[i] + "_";
    if (i >= 2 * kWordsAround) break;
    add("m", said[i]);
    if (i > 0) add("m2", said[i - 1] + "_" + said[i]);
    if (i > 1) add("m3", said[i - 2] + "_" + said[i - 1] + "_" + said[i]);
  }
  if (said.size() <= 6) add("M", whole);
  add("apart", std::to_string(right - left));
  add("words", std::to_string(std::min<std::size_t>(said.size(), 10)));
  add("borders", std::to_string(std::min<std::ptrdiff_t>(
                     3, std::count_if(said.begin(), said.end(),
                                      [](const std::string& w) { return w == "." || w == "?"; }))));
  const auto begin = static_cast<std::ptrdiff_t>(a.begin), end = static_cast<std::ptrdiff_t>(b.end);
  const std::string before = word(begin - 2) + "_" + word(begin - 1);
  const std::string behind = word(end) + "_" + word(end + 1);
  add("l", before), add("l1", word(begin - 1)), add("r", behind), add("r1", word(end));
  add("lM", word(begin - 1) + "|" + (said.empty() ? "" : said.front() + "_" + said.back()));
  for (std::ptrdiff_t at = begin - 1; at >= begin - 6 && at >= 0; --at) {
    if (mention_at_[static_cast<std::size_t>(at)] ||
        text_.endsSentence(static_cast<std::size_t>(at)))
      break;
    add("L", word(at));
    add("L2", word(at - 1) + "_" + word(at));
  }
  for (std::ptrdiff_t at = end; at < end + 5; ++at) {
    const std::string each = word(at);
    add("R", each);
    if (each == "." || each == "?" || each[0] == '<') break;
  }
}

Features MentionContext::features(const FactCandidate& candidate) const {
  Features out{"bias"};
  const std::size_t what = candidate.what;
  if (!candidate.by) {
    out.push_back("kind=" + kindOf(mentions_[what]));
    out.push_back("head=" + headOf(what));
    out.push_back("row=" + std::string(goes_on_[what] ? "1" : "0"));
    addUnary(what, "", &out);
    if (goes_on_[what]) addUnary(rowBegin(what), "row:", &out);
    return out;
  }
  const std::size_t by = *candidate.by;
  const std::string order = what < by ? ">" : "<";
  const std::size_t left = std::min(what, by), right = std::max(what, by);
  out.push_back(order + "kind=" + kindOf(mentions_[what]) + kindOf(mentions_[by]));
  out.push_back(order + "heads=" + headOf(what) + "_" + headOf(by));
  out.push_back(order + "same_row=" + (rowBegin(left) == rowBegin(right) ? "1" : "0"));
  addBetween(left, right, order, &out);
  // The names of a row share what is said of the first of them.
  const std::size_t row_left = rowBegin(left), row_right = rowBegin(right);
  if (row_left != left || row_right != right) {
    if (row_right > left) addBetween(left, row_right, order + "row:", &out);
    if (row_left != left) addBetween(row_left, right, order + "rows:", &out);
  }
  out.push_back(
      order + "sentence=" + word(static_cast<std::ptrdiff_t>(sentenceEnd(mentions_[right].begin))));
  return out;
}

Features MentionContext::textFeatures() const {
  Features out{"bias", "mentions=" + std::to_string(mentions_.size())};
  const auto count = static_cast<std::ptrdiff_t>(text_.tokens().size());
  for (std::ptrdiff_t at = 0; at < count; ++at) {
    out.push_back("t=" + word(at));
    out.push_back("t2=" + word(at - 1) + "_" + word(at));
    out.push_back("t3=" + word(at - 2) + "_" + word(at - 1) + "_" + word(at));
  }
  out.push_back("words=" + std::to_string(std::min<std::ptrdiff_t>(count, 6)));
  return out;
}

}  // namespace language
}  // namespace hyselam_topo
