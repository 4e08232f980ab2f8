#include "mention_tagger.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "hyselam_common/errors.hpp"

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

/// That it is inside or at the beginning of a name.
double nameProbability(const std::vector<std::string>& tags, const std::vector<double>& scores) {
  const std::vector<double> all = LinearClassifier::probabilitiesOf(scores);
  double p = 0.0;
  for (std::size_t tag = 0; tag < tags.size(); ++tag) p += tags[tag] == "O" ? 0.0 : all[tag];
  return p;
}

/// A noun, a keyword, or unknown.
std::string kindOf(const HeardText& text, std::ptrdiff_t at) {
  return text.isNoun(at) ? "n" : text.isKeyword(at) ? "k" : "u";
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
    kind = kindOf(text, at + i) + shapeOf(text, at + i);
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

void addTagBefore(const HeardText& text, std::size_t token, const std::string& tag,
                  Features* features) {
  const auto at = static_cast<std::ptrdiff_t>(token);
  features->push_back("t-1=" + tag);
  features->push_back("t-1w=" + tag + "_" + text.word(at));
  features->push_back("t-1w-1=" + tag + "_" + text.word(at - 1));
  features->push_back("t-1k=" + tag + "_" + kindOf(text, at) + shapeOf(text, at) +
                      kindOf(text, at + 1));
}

void checkTags(const std::string& source, const LinearClassifier& tagger) {
  const auto& tags = tagger.classes();
  const auto has = [&](const std::string& tag) {
    return std::find(tags.begin(), tags.end(), tag) != tags.end();
  };
  if (!has("O")) throw hyselam::InputError(source, "'O'", "no such tag");
  for (const std::string& tag : tags) {
    const bool is_of_kind = std::any_of(kKinds.begin(), kKinds.end(), [&](const std::string& kind) {
      return tag == "B-" + kind || tag == "I-" + kind;
    });
    if (tag != "O" && !is_of_kind) throw hyselam::InputError(source, "'" + tag + "'", "is no tag");
  }
}

FoundMentions findMentions(const LinearClassifier& tagger, const HeardText& text,
                           const std::vector<Features>& more, double eager) {
  const auto& tags = tagger.classes();
  const std::size_t count = text.tokens().size(), kinds = tags.size();
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  const std::size_t outside =
      static_cast<std::size_t>(std::find(tags.begin(), tags.end(), "O") - tags.begin());
  struct Cell {
    double best = kNever;
    double own = 0.0;  // its probability behind the best tag before it
    std::size_t before = 0;
  };
  FoundMentions found;
  std::vector<std::vector<Cell>> cells(count, std::vector<Cell>(kinds));
  for (std::size_t at = 0; at < count; ++at) {
    Features features = tokenFeatures(text, at);
    if (!more.empty()) features.insert(features.end(), more[at].begin(), more[at].end());
    const std::vector<double> own = tagger.scores(features);
    found.name_probabilities.push_back(text.endsSentence(at) ? 0.0 : nameProbability(tags, own));
    for (std::size_t before = 0; before < kinds; ++before) {
      const double so_far =
          at == 0 ? (before == outside ? 0.0 : kNever) : cells[at - 1][before].best;
      if (so_far == kNever) continue;
      Features behind;
      addTagBefore(text, at, tags[before], &behind);
      std::vector<double> scores = tagger.scores(behind);
      for (std::size_t tag = 0; tag < kinds; ++tag) scores[tag] += own[tag];
      const auto p = LinearClassifier::probabilitiesOf(std::move(scores));
      for (std::size_t tag = 0; tag < kinds; ++tag) {
        if ((text.endsSentence(at) && tag != outside) || !mayFollow(tags[before], tags[tag]))
          continue;
        const double sum = so_far +
                           (text.endsSentence(at) ? 0.0 : std::log(std::max(p[tag], 1e-12))) +
                           (tag == outside ? 0.0 : eager);
        if (sum > cells[at][tag].best) cells[at][tag] = {sum, p[tag], before};
      }
    }
  }
  std::vector<std::size_t> path(count, 0);
  for (std::size_t at = count; at-- > 0;) {
    const auto better = [](const Cell& a, const Cell& b) { return a.best < b.best; };
    path[at] =
        at + 1 == count
            ? static_cast<std::size_t>(
                  std::max_element(cells[at].begin(), cells[at].end(), better) - cells[at].begin())
            : cells[at + 1][path[at + 1]].before;
  }
  std::vector<Mention>& mentions = found.mentions;
  for (std::size_t at = 0; at < count; ++at) {
    const std::string& tag = tags[path[at]];
    const double likely = cells[at][path[at]].own;
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
  return found;
}

}  // namespace language
}  // namespace hyselam_topo
