#include "hyselam_language/reader/fact_reader.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "fact_candidates.hpp"
#include "fact_labels.hpp"
#include "hyselam_common/embedded_text.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"
#include "mention_tagger.hpp"
#include "reader_model.hpp"
#include "shipped_readers.hpp"

namespace hyselam_topo {

using namespace language;  // NOLINT: the implementation of a class of its parent

struct FactReader::Model {
  Grammar grammar;
  ReaderModel learnt;
};

namespace {

constexpr std::size_t kLongest = 120;       // tokens
constexpr std::size_t kLongestText = 4000;  // bytes
constexpr double kMayName = 0.15;           // of a word
constexpr double kSmallest = 1e-6;          // of probabilities, so that one decision is never all

constexpr double kMayBeMeant = 0.1;  // of what is less likely than another

struct Decision {
  FactCandidate candidate;
  std::string label;
  double probability = 0.0;
};

using Likely = std::pair<std::string, double>;  // a class and its probability

/// The likeliest class, and the one after it.
std::pair<Likely, Likely> likeliestTwo(const LinearClassifier& classifier,
                                       const Features& features) {
  const std::vector<double> all = classifier.probabilities(features);
  Likely first{"", -1.0}, second{kNoFact, 0.0};
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i] > first.second) {
      if (i > 0) second = std::move(first);
      first = {classifier.classes()[i], all[i]};
    } else if (all[i] > second.second) {
      second = {classifier.classes()[i], all[i]};
    }
  }
  return {std::move(first), std::move(second)};
}

Likely likeliest(const LinearClassifier& classifier, const Features& features) {
  return likeliestTwo(classifier, features).first;
}

/// Of two facts about the same pair the likelier stays: "A next to B" is "B next to A".
std::vector<Decision> withoutMirrors(const std::vector<Decision>& all) {
  std::map<std::pair<std::size_t, std::size_t>, const Decision*> best;
  for (const Decision& each : all) {
    const std::size_t by = each.candidate.by.value_or(each.candidate.what);
    auto*& kept = best[std::minmax(each.candidate.what, by)];
    if (kept == nullptr || each.probability > kept->probability) kept = &each;
  }
  std::vector<Decision> left;
  for (const Decision& each : all) {
    const std::size_t by = each.candidate.by.value_or(each.candidate.what);
    if (best[std::minmax(each.candidate.what, by)] == &each) left.push_back(each);
  }
  return left;
}

/// The article before a name, also from a word that it has grown together with ("na": "em a").
std::string articleBefore(const Grammar& grammar, const HeardText& text, std::size_t name) {
  const NameType* type = grammar.compiled().nameType("place");
  if (name == 0 || type == nullptr) return "";
  const std::string& before = text.word(static_cast<std::ptrdiff_t>(name) - 1);
  if (type->isArticle(before)) return before;
  for (const auto& [key, said] : grammar.compiled().say) {
    const std::size_t space = key.find(' ');
    if (space == std::string::npos || hyselam::utf8Fold(said) != before + " ") continue;
    const std::string article = key.substr(space + 1);
    if (type->isArticle(article)) return article;
  }
  return "";
}

FactArgument argumentOf(const Grammar& grammar, const HeardText& text, const Mention& mention) {
  return {text.nameOf(mention), articleBefore(grammar, text, mention.begin), text.rangeOf(mention)};
}

/// "between" comes as two pairs of one thing: one fact with both grounds.
std::vector<ReadFact> withBetweenJoined(std::vector<ReadFact> facts) {
  std::vector<ReadFact> joined;
  for (ReadFact& fact : facts) {
    const auto first = std::find_if(joined.begin(), joined.end(), [&](const ReadFact& each) {
      return fact.relation == "between" && each.relation == "between" &&
             each.arguments.size() == 2 &&
             each.arguments.front().range == fact.arguments.front().range;
    });
    if (first == joined.end()) {
      joined.push_back(std::move(fact));
    } else {
      first->arguments.push_back(fact.arguments.back());
      first->probability = std::min(first->probability, fact.probability);
    }
  }
  return joined;
}

}  // namespace

FactReader::FactReader(const Grammar& grammar, const std::string& source, const std::string& model)
    : model_(std::make_shared<const Model>(Model{grammar, ReaderModel::fromText(source, model)})) {
  const std::string& language = model_->learnt.origin.language;
  if (language != grammar.language()) {
    throw hyselam::InputError(source, "language",
                              "is '" + language + "', not '" + grammar.language() + "'");
  }
}

bool FactReader::isShipped(const std::string& language) {
  const auto& all = language::kShippedReaders;
  return std::any_of(std::begin(all), std::end(all),
                     [&](const hyselam::EmbeddedText& each) { return language == each.key; });
}

FactReader FactReader::shipped(const Grammar& grammar) {
  const std::string& language = grammar.language();
  for (const hyselam::EmbeddedText& each : language::kShippedReaders) {
    if (language == each.key) {
      return FactReader(grammar, "reader_" + language + ".txt", each.text);
    }
  }
  throw hyselam::InputError("reader", language, "no such model is shipped");
}

std::optional<Reading> FactReader::read(const std::string& said) const {
  const ReaderModel& learnt = model_->learnt;
  const CompiledGrammar& grammar = model_->grammar.compiled();
  if (said.size() > kLongestText) return std::nullopt;
  const HeardText text(grammar, learnt.lexicon, said);
  if (text.tokens().size() > kLongest) return std::nullopt;
  Reading reading;
  if (text.tokens().empty()) return reading;
  const FoundMentions found = findMentions(learnt.tagger, text);
  const std::vector<Mention>& mentions = found.mentions;
  const MentionContext context(learnt.lexicon, text, mentions);
  double log_p = 0.0;  // that all decisions are right, were they independent
  const auto count = [&](double p) {
    log_p += std::log(std::min(std::max(p, kSmallest), 1.0 - kSmallest));
  };
  for (const Mention& mention : mentions) {
    count(mention.probability);
  }

  for (std::size_t at = 0; at < text.tokens().size(); ++at) {
    if (found.name_probabilities[at] < kMayName) continue;
    reading.mentions.push_back(text.tokens()[at].range);
  }

  std::vector<Decision> decisions, others;
  for (const FactCandidate& candidate : context.candidates()) {
    const LinearClassifier& classifier = candidate.by ? learnt.of_two : learnt.of_one;
    auto [first, second] = likeliestTwo(classifier, context.features(candidate));
    count(first.second);
    for (Likely* each : {&first, &second}) {
      if (each->first == kNoFact || each->second < kMayBeMeant) continue;
      (each == &first ? decisions : others).push_back({candidate, each->first, each->second});
    }
  }
  const auto [text_label, text_p] = likeliest(learnt.of_text, context.textFeatures());
  count(text_p);
  if (text_label != kNoFact) {
    reading.facts.push_back(factOf(text_label, {}));
    reading.facts.back().probability = text_p;
  }
  const auto factFrom = [&](const Decision& each, bool counts) {
    std::vector<FactArgument> arguments{
        argumentOf(model_->grammar, text, mentions[each.candidate.what])};
    double p = each.probability * mentions[each.candidate.what].probability;
    if (each.candidate.by) {
      arguments.push_back(argumentOf(model_->grammar, text, mentions[*each.candidate.by]));
      p *= mentions[*each.candidate.by].probability;
    }
    ReadFact fact = factOf(each.label, arguments);
    const auto [modifier, modifier_p] =
        likeliest(learnt.modifiers, context.features(each.candidate));
    if (counts) count(modifier_p);
    fact.denied = modifier == "denied";
    fact.asked = modifier == "asked";
    fact.probability = p * modifier_p;
    return fact;
  };
  for (const Decision& each : withoutMirrors(decisions)) {
    reading.facts.push_back(factFrom(each, true));
  }
  reading.facts = withBetweenJoined(std::move(reading.facts));
  for (const Decision& each : others) reading.others.push_back(factFrom(each, false));
  const double whole = std::exp(log_p);
  for (ReadFact& each : reading.facts) {
    each.probability = learnt.of_fact.probability(each.probability, whole);
  }
  for (ReadFact& each : reading.others) {
    each.probability = learnt.of_other.probability(each.probability, whole);
  }
  std::stable_sort(
      reading.others.begin(), reading.others.end(),
      [](const ReadFact& a, const ReadFact& b) { return a.probability > b.probability; });
  reading.probability = learnt.of_reading.probability(whole, whole);
  return reading;
}

}  // namespace hyselam_topo
