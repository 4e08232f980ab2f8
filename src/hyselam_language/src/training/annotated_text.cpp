#include "annotated_text.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace language {
namespace {

using Spans = std::vector<std::size_t>;  // numbers of mentions

bool startsWith(const std::string& text, const std::string& with) {
  return text.compare(0, with.size(), with) == 0;
}

ReadFact factOf(const std::vector<std::string>& said) {
  ReadFact fact;
  std::size_t next = 1;
  fact.relation = said.front();
  if (fact.relation == "ask is" && said.size() > 1) {
    fact.asked = true;
    fact.relation = said[next++];
  }
  if (startsWith(fact.relation, "not ")) {
    fact.denied = true;
    fact.relation.erase(0, 4);
  }
  std::replace(fact.relation.begin(), fact.relation.end(), ' ', '_');
  for (; next < said.size(); ++next) {
    FactArgument argument;
    argument.text = said[next];
    // The relation asked for is no name.
    if (fact.relation == "ask_what" && fact.arguments.empty()) {
      std::replace(argument.text.begin(), argument.text.end(), ' ', '_');
    }
    fact.arguments.push_back(std::move(argument));
  }
  return fact;
}

Mention::Kind kindOf(const std::string& relation, std::size_t argument) {
  static const std::map<std::string, std::pair<std::size_t, Mention::Kind>> kOthers{
      {"owner", {1, Mention::Kind::kPerson}},
      {"speaker", {0, Mention::Kind::kPerson}},
      {"ask_where_works", {0, Mention::Kind::kPerson}},
      {"nth_left", {1, Mention::Kind::kValue}},
      {"nth_right", {1, Mention::Kind::kValue}},
      {"length", {1, Mention::Kind::kValue}},
      {"width", {1, Mention::Kind::kValue}},
      {"area", {1, Mention::Kind::kValue}},
      {"distance", {1, Mention::Kind::kValue}},
      {"count", {1, Mention::Kind::kValue}}};
  const auto found = kOthers.find(relation);
  const bool other = found != kOthers.end() && found->second.first == argument;
  return other ? found->second.second : Mention::Kind::kThing;
}

bool isFixed(const ReadFact& fact, std::size_t argument) {
  const std::string& text = fact.arguments[argument].text;
  return text == "HERE" || text == "IT" || text.empty() ||
         (fact.relation == "ask_what" && argument == 0);
}

/// Letters of the alphabet alone: lengths stay.
std::string lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

/// Where a name stands in the text, as rows of whole tokens.
std::vector<Mention> occurrences(const HeardText& text, const std::string& name,
                                 Mention::Kind kind) {
  std::vector<Mention> found;
  const std::string in = lower(text.text()), what = lower(name);
  for (std::size_t at = in.find(what); at != std::string::npos; at = in.find(what, at + 1)) {
    Mention mention{0, 0, kind, 1.0};
    bool begins = false, ends = false;
    for (std::size_t i = 0; i < text.tokens().size(); ++i) {
      const TextRange range = text.tokens()[i].range;
      if (range.begin == range.end || text.endsSentence(i)) continue;
      if (range.begin == at && !begins) {
        begins = true;
        mention.begin = i;
      }
      if (begins && range.begin < at + what.size()) {
        mention.end = i + 1;
        ends = range.end >= at + what.size();
      }
    }
    if (begins && ends) found.push_back(mention);
  }
  return found;
}

bool overlap(const Mention& a, const Mention& b) {
  return a.begin < b.end && b.begin < a.end;
}

std::size_t distance(const Mention& a, const Mention& b) {
  return a.begin < b.begin ? b.begin - a.begin : a.begin - b.begin;
}

/// All places where arguments stand; of those that overlap the longer ones.
std::vector<Mention> mentionsOf(const HeardText& text, const AnnotatedText& annotated) {
  std::vector<Mention> all;
  for (const ReadFact& fact : annotated.facts) {
    for (std::size_t i = 0; i < fact.arguments.size(); ++i) {
      if (isFixed(fact, i)) continue;
      for (const Mention& each :
           occurrences(text, fact.arguments[i].text, kindOf(fact.relation, i))) {
        all.push_back(each);
      }
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Mention& a, const Mention& b) {
    return a.end - a.begin > b.end - b.begin;
  });
  std::vector<Mention> kept;
  for (const Mention& each : all) {
    const bool taken = std::any_of(kept.begin(), kept.end(),
                                   [&](const Mention& other) { return overlap(each, other); });
    if (!taken) kept.push_back(each);
  }
  std::sort(kept.begin(), kept.end(),
            [](const Mention& a, const Mention& b) { return a.begin < b.begin; });
  return kept;
}

/// The mentions that an argument may be.
Spans spansOf(const HeardText& text, const std::vector<Mention>& mentions,
              const FactArgument& argument) {
  Spans spans;
  for (const Mention& each : occurrences(text, argument.text, Mention::Kind::kThing)) {
    for (std::size_t i = 0; i < mentions.size(); ++i) {
      if (mentions[i].begin == each.begin && mentions[i].end == each.end) spans.push_back(i);
    }
  }
  return spans;
}

}  // namespace

std::vector<AnnotatedText> loadAnnotated(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw hyselam::InputError(path, "", "cannot be read");
  std::vector<AnnotatedText> all;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (line.empty()) continue;
    try {
      const auto json = nlohmann::json::parse(line);
      AnnotatedText each;
      each.text = json.at("text").get<std::string>();
      each.language = json.at("lang").get<std::string>();
      each.layer = json.at("layer").get<std::string>();
      each.writer = path.substr(path.rfind('/') + 1);
      for (const auto& fact : json.at("facts")) {
        each.facts.push_back(factOf(fact.get<std::vector<std::string>>()));
      }
      all.push_back(std::move(each));
    } catch (const nlohmann::json::exception& error) {
      throw hyselam::InputError(path, "line " + std::to_string(number), error.what());
    }
  }
  return all;
}

GoldText alignedWith(const HeardText& text, const AnnotatedText& annotated) {
  GoldText gold;
  gold.mentions = mentionsOf(text, annotated);
  for (const ReadFact& fact : annotated.facts) {
    std::vector<Spans> spans;
    std::string label = fact.relation;
    bool lost = false;
    for (std::size_t i = 0; i < fact.arguments.size(); ++i) {
      if (isFixed(fact, i)) {
        label += "/" + fact.arguments[i].text;
        continue;
      }
      spans.push_back(spansOf(text, gold.mentions, fact.arguments[i]));
      lost = lost || spans.back().empty();
      label += "/*";
    }
    if (lost) {
      ++gold.lost;
      continue;
    }
    const std::string modifier = fact.asked ? "asked" : fact.denied ? "denied" : "plain";
    if (spans.empty()) {
      gold.facts.push_back({label, std::nullopt, modifier});
    } else if (spans.size() == 1) {
      gold.facts.push_back({label, FactCandidate{spans[0].front(), std::nullopt}, modifier});
    } else {
      // The nearest of the places where both names stand; "between" as two pairs.
      const std::string pair_label = spans.size() == 3 ? fact.relation + "/*/*" : label;
      for (std::size_t by = 1; by < spans.size(); ++by) {
        std::optional<FactCandidate> nearest;
        for (const std::size_t a : spans[0]) {
          for (const std::size_t b : spans[by]) {
            if (a == b) continue;
            const auto& m = gold.mentions;
            if (!nearest || distance(m[a], m[b]) < distance(m[nearest->what], m[*nearest->by])) {
              nearest = FactCandidate{a, b};
            }
          }
        }
        if (nearest) gold.facts.push_back({pair_label, nearest, modifier});
      }
    }
  }
  return gold;
}

}  // namespace language
}  // namespace hyselam_topo
