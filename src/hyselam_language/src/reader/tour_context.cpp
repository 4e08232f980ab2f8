#include "tour_context.hpp"

#include <algorithm>
#include <optional>

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::size_t kLongGap = 14;  // of words: of longer ones beginning and end count
constexpr std::size_t kGapBegin = 6, kGapEnd = 8;
constexpr std::size_t kBackWithin = 40;  // words ago somebody said that he turns round

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

std::string upTo(std::size_t number, std::size_t most) {
  return std::to_string(std::min(number, most));
}

}  // namespace

TourContext::TourContext(const TourWords& words, const HeardText& text,
                         const std::vector<Mention>& rooms, const std::vector<std::size_t>& room_of)
    : words_(words),
      text_(text),
      rooms_(rooms),
      named_(text.tokens().size(), false),
      room_of_(room_of) {
  std::size_t sentence = 0;
  for (std::size_t at = 0; at < text.tokens().size(); ++at) {
    sentence_.push_back(sentence);
    sentence += text.endsSentence(at) ? 1 : 0;
  }
  for (const Mention& room : rooms)
    std::fill(named_.begin() + static_cast<std::ptrdiff_t>(room.begin),
              named_.begin() + static_cast<std::ptrdiff_t>(room.end), true);
  findCues();
  for (std::size_t m = 0; m < rooms.size(); ++m)
    is_new_.push_back(std::find(room_of.begin(), room_of.begin() + static_cast<std::ptrdiff_t>(m),
                                room_of[m]) == room_of.begin() + static_cast<std::ptrdiff_t>(m));
  rule();
}

/// A word for a side between two names belongs to the first if a clause ends behind it ("the lab is
/// on the left, then ..."), unless that has one already, else to the second.
std::vector<std::size_t> TourContext::ownCues() const {
  std::vector<std::size_t> own(rooms_.size(), kNone);
  for (std::size_t c = 0; c < cues_.size(); ++c) {
    const std::size_t at = cues_[c].at;
    std::size_t next = 0;
    while (next < rooms_.size() && rooms_[next].begin < at) ++next;
    const bool behind_one = next > 0 && sentence_[rooms_[next - 1].begin] == sentence_[at];
    const bool before_one = next < rooms_.size() && sentence_[rooms_[next].begin] == sentence_[at];
    const auto clauseEnds = [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        if (word(k) == "," || words_.and_.count(word(k)) != 0) return true;
      return false;
    };
    bool of_first = behind_one;
    if (behind_one && before_one) {
      of_first = own[next - 1] == kNone && !clauseEnds(rooms_[next - 1].end, at) &&
                 clauseEnds(at + 1, rooms_[next].begin);
    } else if (behind_one && next < rooms_.size()) {
      of_first = own[next - 1] == kNone && !clauseEnds(rooms_[next - 1].end, at);
    }
    if (of_first) {
      own[next - 1] = c;
    } else if (next < rooms_.size()) {
      own[next] = c;  // the last one before it
    }
  }
  return own;
}

bool TourContext::isAcross(std::size_t room) const {
  const Mention& b = rooms_[room];
  const Mention& a = rooms_[room - 1];
  if (countOf(words_.across, a.end, b.begin) > 0) {
    // "The lab. Opposite the shop is ...": of what comes then.
    const bool of_next = room + 1 < rooms_.size() && sentence_[a.begin] != sentence_[b.begin] &&
                         sentence_[rooms_[room + 1].begin] == sentence_[b.begin] &&
                         is_new_[room] == 0;
    return !of_next;
  }
  if (sentence_[a.begin] != sentence_[b.begin]) return false;
  std::size_t begin = a.begin;
  while (begin > 0 && sentence_[begin - 1] == sentence_[a.begin] && !isNamed(begin - 1)) --begin;
  return countOf(words_.across, begin, a.begin) > 0 && is_new_[room - 1] == 0;
}

/// "Anna is across from the workshop", of which the side has been told: the mention of the workshop
/// before; the room itself without.
std::size_t TourContext::acrossFrom(std::size_t room) const {
  if (room + 1 >= rooms_.size()) return room;
  const Mention &a = rooms_[room], &b = rooms_[room + 1];
  if (sentence_[a.begin] != sentence_[b.begin] || countOf(words_.across, a.end, b.begin) == 0)
    return room;
  for (std::size_t k = room; k-- > 0;) {
    if (room_of_[k] == room_of_[room + 1] && ruled_[k].side != Ruled::Side::kUnknown) return k;
  }
  return room;
}

void TourContext::rule() {
  using Side = Ruled::Side;
  const auto turned = [](Side side) {
    return side == Side::kLeft ? Side::kRight : side == Side::kRight ? Side::kLeft : side;
  };
  const std::vector<std::size_t> own = ownCues();
  for (std::size_t m = 0; m < rooms_.size(); ++m) {
    Ruled now;
    std::size_t before = m;
    for (std::size_t k = m; k-- > 0;) {
      if (room_of_[k] == room_of_[m] && ruled_[k].side != Side::kUnknown) {
        before = k;
        break;
      }
    }
    if (own[m] != kNone) {
      now = {cues_[own[m]].left ? Side::kLeft : Side::kRight, "own", 0};
    } else if (before != m) {
      now = {ruled_[before].side, "known", ruled_[before].steps + 1};
    } else if (const std::size_t other = acrossFrom(m); other != m) {
      now = {turned(ruled_[other].side), "across", ruled_[other].steps + 1};
    } else if (m > 0 && ruled_[m - 1].side != Side::kUnknown) {
      const bool across = isAcross(m);
      now = {across ? turned(ruled_[m - 1].side) : ruled_[m - 1].side,
             across ? "across" : "carried", ruled_[m - 1].steps + 1};
    }
    ruled_.push_back(now);
  }
}

void TourContext::findCues() {
  const TourWords& words = words_;
  std::optional<bool> last;
  for (std::size_t at = 0; at < text_.tokens().size(); ++at) {
    if (isNamed(at)) continue;
    const std::string& said = word(at);
    if (words.left.count(said) + words.right.count(said) != 0) {
      last = words.left.count(said) != 0;
      cues_.push_back({at, *last, ""});
    } else if (last && at > 0 && words.side.count(said) != 0) {
      const std::string& before = word(at - 1);
      if (words.other.count(before) != 0) cues_.push_back({at, !*last, "other"});
      if (words.same.count(before) != 0) cues_.push_back({at, *last, "same"});
    }
  }
}

const std::string& TourContext::word(std::size_t at) const {
  return text_.word(static_cast<std::ptrdiff_t>(at));
}

const TourContext::Cue* TourContext::lastCue(std::size_t before) const {
  const Cue* last = nullptr;
  for (const Cue& cue : cues_) {
    if (cue.at < before) last = &cue;
  }
  return last;
}

std::size_t TourContext::namesWithin(std::size_t begin, std::size_t end) const {
  return static_cast<std::size_t>(
      std::count_if(rooms_.begin(), rooms_.end(),
                    [&](const Mention& room) { return room.begin >= begin && room.begin < end; }));
}

std::size_t TourContext::countOf(const WordSet& words, std::size_t begin, std::size_t end) const {
  std::size_t count = 0;
  for (std::size_t at = begin; at < end; ++at) count += words.count(word(at));
  return count;
}

std::size_t TourContext::commasWithin(std::size_t begin, std::size_t end) const {
  std::size_t count = 0;
  for (std::size_t at = begin; at < end; ++at) count += word(at) == "," ? 1 : 0;
  return count;
}

std::vector<std::pair<std::size_t, std::size_t>> TourContext::pairs() const {
  std::vector<std::pair<std::size_t, std::size_t>> all;
  for (std::size_t room = 0; room < rooms_.size(); ++room) {
    for (std::size_t next = room + 1; next < rooms_.size() && next <= room + 2; ++next)
      all.emplace_back(room, next);
  }
  return all;
}

Features TourContext::ofSide(std::size_t room) const {
  const Mention& mention = rooms_[room];
  std::vector<const Cue*> before;
  const Cue* behind = nullptr;
  for (const Cue& cue : cues_) {
    if (cue.at < mention.begin) before.insert(before.begin(), &cue);
    if (cue.at >= mention.end && behind == nullptr) behind = &cue;
  }
  const bool in_sentence = behind != nullptr && sentence_[behind->at] == sentence_[mention.begin] &&
                           namesWithin(mention.end, behind->at) <= 3;
  const auto isNear = [&](const Cue& cue) {
    return sentence_[cue.at] == sentence_[mention.begin] || namesWithin(cue.at, mention.begin) == 0;
  };
  Features features;
  const Ruled& ruled = ruled_[room];
  if (ruled.side != Ruled::Side::kUnknown)
    features.push_back((ruled.side == Ruled::Side::kLeft ? "l|rule:" : "r|rule:") + ruled.how +
                       upTo(ruled.steps, 4));
  // What was said farther away comes to it through the rooms between.
  if (!in_sentence && (before.empty() || !isNear(*before.front()))) return features;
  for (std::size_t rank = 0; rank < before.size() && rank < 2; ++rank) {
    if (rank == 1 && namesWithin(before[rank]->at, mention.begin) > 3) continue;
    addCueBefore(room, rank, *before[rank], &features);
  }
  if (in_sentence) {
    addCueBehind(room, *behind,
                 !before.empty() && sentence_[before.front()->at] == sentence_[mention.begin],
                 &features);
  }
  return features;
}

void TourContext::addCueBefore(std::size_t room, std::size_t rank, const Cue& cue,
                               Features* out) const {
  const Mention& mention = rooms_[room];
  const std::string mark =
      std::string(cue.left ? "l" : "r") + "|before" + std::to_string(rank) + ":";
  const auto add = [&](const std::string& feature) { out->push_back(mark + feature); };
  const std::size_t names = namesWithin(cue.at, mention.begin);
  const std::size_t sentences = sentence_[mention.begin] - sentence_[cue.at];
  const std::size_t begin = cue.at + 1;
  add("n" + upTo(names, 4) + "s" + upTo(sentences, 3));
  add("how" + cue.how);
  add("next=" + (isNamed(begin) ? "<name>" : word(begin)) + upTo(sentences, 1));
  add("previous=" + (cue.at == 0 || isNamed(cue.at - 1) ? "<name>" : word(cue.at - 1)));
  if (names == 0 && sentences == 0 && mention.begin - begin <= 3) add("near");
  add("across" + upTo(countOf(words_.across, begin, mention.begin), 2));
  // Does it stand behind a name of its own clause? "The lab is on the left, then comes ..."
  std::string own = "0";
  for (const Mention& other : rooms_) {
    if (other.end > cue.at || sentence_[other.begin] != sentence_[cue.at]) continue;
    own = cue.at - other.end <= 3 ? "1" : "2";
  }
  add("own" + own + "c" + upTo(commasWithin(begin, mention.begin), 2) + "n" + upTo(names, 2));
}

void TourContext::addCueBehind(std::size_t room, const Cue& cue, bool side_said_before,
                               Features* out) const {
  const Mention& mention = rooms_[room];
  const std::string mark = std::string(cue.left ? "l" : "r") + "|behind:";
  const auto add = [&](const std::string& feature) { out->push_back(mark + feature); };
  const std::string names = upTo(namesWithin(mention.end, cue.at), 3);
  add("n" + names + "d" + upTo((cue.at - mention.end) / 3, 4));
  add("c" + upTo(commasWithin(mention.end, cue.at), 2) + "n" + names);
  add("next=" + (isNamed(cue.at + 1) ? "<name>" : word(cue.at + 1)));
  add("previous=" + (isNamed(cue.at - 1) ? "<name>" : word(cue.at - 1)));
  add("across" + upTo(countOf(words_.across, mention.end, cue.at), 1));
  add(side_said_before ? "second" : "only");
}

Features TourContext::mirrored(Features features) {
  for (std::string& feature : features) {
    if (feature.compare(0, 2, "l|") == 0) {
      feature[0] = 'r';
    } else if (feature.compare(0, 2, "r|") == 0) {
      feature[0] = 'l';
    }
  }
  return features;
}

Features TourContext::ofPair(std::size_t first, std::size_t second) const {
  const Mention &a = rooms_[first], &b = rooms_[second];
  const std::string mark = std::to_string(second - first) + "|";
  Features features{mark + "bias"};
  const std::string news =
      std::string(is_new_[first] != 0 ? "new" : "again") + (is_new_[second] != 0 ? "new" : "again");
  const Ruled &of_first = ruled_[first], &of_second = ruled_[second];
  const bool known =
      of_first.side != Ruled::Side::kUnknown && of_second.side != Ruled::Side::kUnknown;
  const std::string ruled = !known ? "rule?" : of_first.side == of_second.side ? "rule=" : "rule/";
  features.push_back(mark + news);
  features.push_back(mark + ruled);
  features.push_back(mark + ruled + of_first.how + "-" + of_second.how);
  features.push_back(mark + ruled + of_second.how + upTo(of_second.steps, 3));
  features.push_back(mark + ruled + news);
  for (std::size_t at = a.end; at < b.begin; ++at) {
    if (words_.order.count(word(at)) == 0) continue;
    features.push_back(mark + news + "w=" + word(at));
    features.push_back(mark + ruled + "w=" + word(at));
  }
  addGap(a, b, mark, &features);
  addSides(first, second, mark, &features);
  addAround(a, b, mark, &features);
  return features;
}

void TourContext::addGap(const Mention& a, const Mention& b, const std::string& mark,
                         Features* out) const {
  const auto add = [&](const std::string& feature) { out->push_back(mark + feature); };
  const std::string sentences = upTo(sentence_[b.begin] - sentence_[a.begin], 3);
  const std::size_t length = b.begin - a.end;
  add("s" + sentences);
  add("length" + upTo(length / 2, 6));
  const auto said = [&](std::size_t at) { return isNamed(at) ? std::string("<name>") : word(at); };
  for (std::size_t k = 0; k < length; ++k) {
    if (length > kLongGap && k >= kGapBegin && k + kGapEnd < length) continue;
    add("w=" + said(a.end + k));
    if (k + 1 < length) add("ww=" + said(a.end + k) + "_" + said(a.end + k + 1));
    // How near to the second name: "after" right before it is of it, else of what comes before.
    add("w" + upTo(length - 1 - k, 4) + "=" + said(a.end + k));
  }
  add("first=" + (length > 0 ? said(a.end) : "<none>") + sentences);
  add("last=" + (length > 0 ? said(b.begin - 1) : "<none>") + sentences);
  const std::size_t far = b.begin > kBackWithin ? b.begin - kBackWithin : 0;
  add("back" + upTo(countOf(words_.back, far, b.begin), 1) + "s" + sentences);
}

void TourContext::addSides(std::size_t first, std::size_t second, const std::string& mark,
                           Features* out) const {
  const Mention &a = rooms_[first], &b = rooms_[second];
  const auto add = [&](const std::string& feature) { out->push_back(mark + feature); };
  std::size_t between = 0;
  for (const Cue& cue : cues_) between += cue.at >= a.end && cue.at < b.begin ? 1 : 0;
  const std::string across = upTo(countOf(words_.across, a.end, b.begin), 1);
  const std::string sentences = upTo(sentence_[b.begin] - sentence_[a.begin], 2);
  add("cues" + upTo(between, 2) + "s" + sentences + "across" + across);
  const Cue *of_a = lastCue(a.begin), *of_b = lastCue(b.begin);
  if (of_a != nullptr && of_b != nullptr)
    add((of_a->left == of_b->left ? "alike" : "turned") + upTo(between, 2) + across);
  const std::size_t next =
      second + 1 < rooms_.size() ? rooms_[second + 1].begin : text_.tokens().size();
  for (const Cue& cue : cues_) {
    if (cue.at < b.end || cue.at >= next || sentence_[cue.at] != sentence_[b.begin]) continue;
    if (of_b != nullptr) add(cue.left == of_b->left ? "behind_alike" : "behind_turned");
    break;
  }
}

void TourContext::addAround(const Mention& a, const Mention& b, const std::string& mark,
                            Features* out) const {
  const auto add = [&](const std::string& feature) { out->push_back(mark + feature); };
  std::size_t seen = 0;
  for (std::size_t at = a.begin; at-- > 0 && seen < 4; ++seen) {
    if (sentence_[at] != sentence_[a.begin] || isNamed(at)) break;
    add("before=" + word(at));
  }
  seen = 0;
  for (std::size_t at = b.end; at < text_.tokens().size() && seen < 5; ++at, ++seen) {
    if (sentence_[at] != sentence_[b.begin] || isNamed(at)) break;
    add("behind=" + word(at));
  }
}

Features TourContext::ofPosition(std::size_t room) const {
  const Mention& mention = rooms_[room];
  Features features{"bias", room == 0 ? "told_first" : "told_later",
                    room + 1 == rooms_.size() ? "told_last" : "told_before"};
  constexpr std::size_t kNear = 7;
  const auto each = [&](std::size_t at, const std::string& mark, std::size_t away) {
    features.push_back(mark + "=" + word(at));
    if (away < 3) features.push_back(mark + "near=" + word(at));
    if (!isNamed(at + 1)) features.push_back(mark + "2=" + word(at) + "_" + word(at + 1));
  };
  std::size_t seen = 0;
  for (std::size_t at = mention.begin; at-- > 0 && seen < kNear; ++seen) {
    if (sentence_[at] != sentence_[mention.begin] || isNamed(at)) break;
    each(at, "before", seen);
  }
  seen = 0;
  for (std::size_t at = mention.end; at + 1 < text_.tokens().size() && seen < kNear; ++at, ++seen) {
    if (sentence_[at] != sentence_[mention.begin] || isNamed(at)) break;
    each(at, "behind", seen);
  }
  return features;
}

}  // namespace language
}  // namespace hyselam_topo
