#include "mention_tagger.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::array<const char*, 3> kKinds{{"thing", "person", "value"}};

const char* nameOf(Mention::Kind kind) {
  return kKinds[static_cast<std::size_t>(kind)];
}

bool isInside(const std::string& tag) {
  return tag[0] == 'I';
}

/// Whether one tag may follow another: inside only behind the same kind.
bool mayFollow(const std::string& before, const std::string& tag) {
  return !isInside(tag) || (before != "O" && before.substr(1) == tag.substr(1));
}

std::string ending(const std::string& word, std::size_t letters) {
  return word.size() <= letters ? word : word.substr(word.size() - letters);
}

std::string shapeOf(const HeardText& text, std::ptrdiff_t at) {
  if (at < 0 || at >= static_cast<std::ptrdiff_t>(text.tokens().size())) return "_";
  const Token& token = text.tokens()[static_cast<std::size_t>(at)];
  std::string shape = token.starts_upper ? "A" : "a";
  for (const char c : token.text) {
    if (c >= '0' && c <= '9') shape = "0";
    if (c == '\'') return shape + "'";
  }
  return token.kind == TokenKind::kWord ? shape : token.kind == TokenKind::kNumber ? "0" : "-";
}

}  // namespace

std::vector<std::string> tagsOf(const HeardText& text, const std::vector<Mention>& mentions) {
  std::vector<std::string> tags(text.tokens().size(), "O");
  for (const Mention& mention : mentions) {
    for (std::size_t at = mention.begin; at < mention.end; ++at) {
      tags[at] = std::string(at == mention.begin ? "B-" : "I-") + nameOf(mention.kind);
    }
  }
  return tags;
}

Features tokenFeatures(const HeardText& text, std::size_t token) {
  const auto at = static_cast<std::ptrdiff_t>(token);
  Features features{"bias"};
  const auto add = [&](const char* name, const std::string& value) {
    features.push_back(name + ("=" + value));
  };
  static constexpr std::array<const char*, 7> kPlaces{
      {"w-3", "w-2", "w-1", "w", "w+1", "w+2", "w+3"}};
  static constexpr std::array<const char*, 5> kKindsOf{{"k-2", "k-1", "k", "k+1", "k+2"}};
  for (std::ptrdiff_t i = -3; i <= 3; ++i) {
    add(kPlaces[static_cast<std::size_t>(i + 3)], text.word(at + i));
  }
  std::array<std::string, 5> kinds;
  for (std::ptrdiff_t i = -2; i <= 2; ++i) {
    auto& kind = kinds[static_cast<std::size_t>(i + 2)];
    kind = std::string(text.isNoun(at + i)      ? "n"
                       : text.isKeyword(at + i) ? "k"
                                                : "u") +
           shapeOf(text, at + i);
    add(kKindsOf[static_cast<std::size_t>(i + 2)], kind);
  }
  add("w-1w", text.word(at - 1) + "_" + text.word(at));
  add("ww+1", text.word(at) + "_" + text.word(at + 1));
  add("w-2w-1", text.word(at - 2) + "_" + text.word(at - 1));
  add("w+1w+2", text.word(at + 1) + "_" + text.word(at + 2));
  add("w-1w+1", text.word(at - 1) + "_" + text.word(at + 1));
  add("w-1k", text.word(at - 1) + "_" + kinds[2]);
  add("kw+1", kinds[2] + "_" + text.word(at + 1));
  add("k-1k", kinds[1] + "_" + kinds[2]);
  add("kk+1", kinds[2] + "_" + kinds[3]);
  add("k-1kk+1", kinds[1] + "_" + kinds[2] + "_" + kinds[3]);
  add("w-2w-1k", text.word(at - 2) + "_" + text.word(at - 1) + "_" + kinds[2]);
  add("end2", ending(text.word(at), 2));
  add("end3", ending(text.word(at), 3));
  return features;
}

double nameProbability(const LinearClassifier& tagger, const HeardText& text, std::size_t at) {
  if (text.endsSentence(at)) return 0.0;
  const auto& tags = tagger.classes();
  const std::vector<double> all = tagger.probabilities(tokenFeatures(text, at));
  double p = 0.0;
  for (std::size_t tag = 0; tag < tags.size(); ++tag) p += tags[tag] == "O" ? 0.0 : all[tag];
  return p;
}

std::vector<Mention> findMentions(const LinearClassifier& tagger, const HeardText& text) {
  const auto& tags = tagger.classes();
  const std::size_t count = text.tokens().size();
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> probability(count);
  std::vector<std::vector<double>> best(count, std::vector<double>(tags.size(), kNever));
  std::vector<std::vector<std::size_t>> from(count, std::vector<std::size_t>(tags.size(), 0));
  for (std::size_t at = 0; at < count; ++at) {
    probability[at] = tagger.probabilities(tokenFeatures(text, at));
    for (std::size_t tag = 0; tag < tags.size(); ++tag) {
      if (text.endsSentence(at) && tags[tag] != "O") continue;
      const double own = std::log(std::max(probability[at][tag], 1e-12));
      if (at == 0) {
        best[at][tag] = isInside(tags[tag]) ? kNever : own;
        continue;
      }
      for (std::size_t before = 0; before < tags.size(); ++before) {
        const double sum = best[at - 1][before] + own;
        if (mayFollow(tags[before], tags[tag]) && sum > best[at][tag]) {
          best[at][tag] = sum;
          from[at][tag] = before;
        }
      }
    }
  }
  std::vector<std::size_t> path(count, 0);
  for (std::size_t at = count; at-- > 0;) {
    path[at] = at + 1 == count
                   ? static_cast<std::size_t>(std::max_element(best[at].begin(), best[at].end()) -
                                              best[at].begin())
                   : from[at + 1][path[at + 1]];
  }
  std::vector<Mention> mentions;
  for (std::size_t at = 0; at < count; ++at) {
    const std::string& tag = tags[path[at]];
    const double likely = probability[at][path[at]];
    if (tag[0] == 'B') {
      Mention mention{at, at + 1, Mention::Kind::kThing, likely};
      for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
        if (tag.substr(2) == kKinds[kind]) mention.kind = static_cast<Mention::Kind>(kind);
      }
      mentions.push_back(mention);
    } else if (isInside(tag)) {
      mentions.back().end = at + 1;
      mentions.back().probability = std::min(mentions.back().probability, likely);
    } else if (!mentions.empty() && mentions.back().end == at) {
      mentions.back().probability = std::min(mentions.back().probability, likely);
    }
  }
  return mentions;
}

}  // namespace language
}  // namespace hyselam_topo
