#include "reader_training.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>

#include "grammar/text_reader.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_language/reader/fact_reader.hpp"
#include "linear_training.hpp"
#include "reader/fact_candidates.hpp"
#include "reader/fact_labels.hpp"
#include "reader/mention_tagger.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr std::size_t kLeastExamples = 3;  // of a class of facts

std::string inWords(const ReadFact& fact) {
  std::string words =
      (fact.asked ? "? " : "") + std::string(fact.denied ? "not " : "") + fact.relation;
  std::vector<std::string> arguments;
  for (const FactArgument& each : fact.arguments)
    arguments.push_back(hyselam::utf8Lower(each.text));
  // Its grounds are in no order.
  if (fact.relation == "between" && arguments.size() == 3) {
    std::sort(arguments.begin() + 1, arguments.end());
  }
  if (isSymmetric(fact.relation)) std::sort(arguments.begin(), arguments.end());
  for (const std::string& each : arguments) words += " | " + each;
  return words;
}

std::multiset<std::string> inWords(const std::vector<ReadFact>& facts) {
  std::multiset<std::string> words;
  for (const ReadFact& each : facts) words.insert(inWords(each));
  return words;
}

/// What a text says of each candidate; candidates with several facts give several examples.
void addExamples(const CompiledGrammar& grammar, const ReaderLexicon& lexicon,
                 const AnnotatedText& annotated, std::array<TrainingSet, 5>* sets) {
  auto& [tagger, of_one, of_two, of_text, modifiers] = *sets;
  const HeardText text(grammar, lexicon, annotated.text);
  const GoldText gold = alignedWith(text, annotated);
  const auto tags = tagsOf(text, gold.mentions);
  for (std::size_t at = 0; at < tags.size(); ++at) {
    if (text.endsSentence(at)) continue;
    Features features = tokenFeatures(text, at);
    addTagBefore(text, at, at == 0 ? "O" : tags[at - 1], &features);
    tagger.add(features, tags[at]);
  }
  const MentionContext context(lexicon, text, gold.mentions);
  std::string whole = kNoFact;
  for (const GoldFact& fact : gold.facts) {
    if (!fact.candidate) {
      if (whole == kNoFact) whole = fact.label;
      continue;
    }
    modifiers.add(context.features(*fact.candidate), fact.modifier);
  }
  of_text.add(context.textFeatures(), whole);
  for (const FactCandidate& candidate : context.candidates()) {
    std::vector<std::string> labels;
    for (const GoldFact& fact : gold.facts) {
      if (fact.candidate && fact.candidate->what == candidate.what &&
          fact.candidate->by == candidate.by) {
        labels.push_back(fact.label);
      }
    }
    if (labels.empty()) labels.push_back(kNoFact);
    const Features features = context.features(candidate);
    (candidate.by ? of_two : of_one).add(features, labels.front());
  }
}

/// Negative logarithm of how likely what was right is.
double lossOf(const std::vector<ReaderEvaluation::Guess>& guesses, const Eigen::Vector3d& w) {
  double loss = 0.0;
  for (const ReaderEvaluation::Guess& each : guesses) {
    const double z = w.dot(Eigen::Vector3d(each.own, each.whole, 1.0));
    loss += std::log1p(std::exp(-std::abs(z))) + std::max(0.0, each.right ? -z : z);
  }
  return loss;
}

}  // namespace

Odds fittedOdds(const std::vector<ReaderEvaluation::Guess>& guesses) {
  constexpr double kRidge = 1e-3;  // where a variable says nothing
  Eigen::Vector3d w(1.0, 0.0, 0.0);
  for (int round = 0; round < 50; ++round) {
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    Eigen::Matrix3d curvature = kRidge * Eigen::Matrix3d::Identity();
    for (const ReaderEvaluation::Guess& each : guesses) {
      const Eigen::Vector3d x(each.own, each.whole, 1.0);
      const double p = 1.0 / (1.0 + std::exp(-w.dot(x)));
      gradient += ((each.right ? 1.0 : 0.0) - p) * x;
      curvature += p * (1.0 - p) * x * x.transpose();
    }
    const Eigen::Vector3d step = curvature.ldlt().solve(gradient);
    // A whole step may go too far where most is sure.
    double share = 1.0;
    while (share > 1e-6 && lossOf(guesses, w + share * step) > lossOf(guesses, w)) share *= 0.5;
    w += share * step;
  }
  return {w[0], w[1], w[2]};
}

ReaderModel trainReader(const Grammar& grammar, const ReaderLexicon& lexicon,
                        const std::vector<const AnnotatedText*>& texts,
                        const ReaderTrainingParams& params) {
  std::array<TrainingSet, 5> sets;
  for (const AnnotatedText* each : texts) addExamples(grammar.compiled(), lexicon, *each, &sets);
  ReaderModel model;
  model.origin.language = grammar.language();
  model.lexicon = lexicon;
  model.tagger = sets[0].train(params.cost, params.least_seen);
  model.of_one = sets[1].train(params.cost, params.least_seen);
  model.of_two = sets[2].train(params.cost, params.least_seen);
  model.of_text = sets[3].train(params.cost, params.least_seen);
  model.modifiers = sets[4].train(params.cost, params.least_seen);
  return model;
}

ReaderEvaluation evaluateReader(const Grammar& grammar, const ReaderLexicon& lexicon,
                                const std::vector<const AnnotatedText*>& texts,
                                const ReaderTrainingParams& params) {
  std::set<std::string> names;
  for (const AnnotatedText* each : texts) names.insert(each->writer);
  const std::vector<std::string> writers(names.begin(), names.end());
  const auto foldOf = [&](const AnnotatedText& text) {
    const auto at = std::lower_bound(writers.begin(), writers.end(), text.writer);
    return static_cast<std::size_t>(at - writers.begin()) % params.folds;
  };
  ReaderEvaluation result;
  for (std::size_t fold = 0; fold < params.folds; ++fold) {
    std::vector<const AnnotatedText*> others;
    for (const AnnotatedText* each : texts) {
      if (foldOf(*each) != fold) others.push_back(each);
    }
    const ReaderModel model = trainReader(grammar, lexicon, others, params);
    const FactReader reader(grammar, "fold " + std::to_string(fold), model.toText());
    for (const AnnotatedText* each : texts) {
      if (foldOf(*each) != fold) continue;
      // Of texts that are too long nothing is read.
      const Reading reading = reader.read(each->text).value_or(Reading{});
      const auto wanted = inWords(each->facts), read = inWords(reading.facts);
      std::vector<std::string> both;
      std::set_intersection(wanted.begin(), wanted.end(), read.begin(), read.end(),
                            std::back_inserter(both));
      ReaderScore& score = result.by_layer[each->layer];
      const HeardText text(grammar.compiled(), lexicon, each->text);
      const auto named = alignedWith(text, *each).mentions;
      const auto found = findMentions(model.tagger, text).mentions;
      score.mentions += named.size();
      score.mentions_found += found.size();
      score.mentions_right += static_cast<std::size_t>(
          std::count_if(found.begin(), found.end(), [&](const Mention& mention) {
            return std::any_of(named.begin(), named.end(), [&](const Mention& other) {
              return other.begin == mention.begin && other.end == mention.end;
            });
          }));
      ++score.texts;
      score.exact += wanted == read ? 1 : 0;
      score.facts += wanted.size();
      score.read += read.size();
      score.right += both.size();
      std::string words;
      for (const std::string& fact : read)
        words += "\n    read    " + fact + (wanted.count(fact) != 0 ? "" : "   <-- wrong");
      for (const std::string& fact : wanted) {
        if (read.count(fact) == 0) words += "\n    missed  " + fact;
      }
      // What the grammar understands is never asked of the reader, and is easier.
      const auto said = readText(grammar.compiled(), each->text, {});
      const bool refused =
          std::any_of(said.begin(), said.end(), [](const Utterance& u) { return !u.understood(); });
      if (!refused) continue;
      // The model that is not calibrated yet has the odds themselves.
      const double whole = logOdds(reading.probability);
      const auto add = [&](const std::vector<ReadFact>& facts,
                           std::vector<ReaderEvaluation::Guess>* guesses) {
        for (const ReadFact& fact : facts) {
          guesses->push_back({logOdds(fact.probability), whole, wanted.count(inWords(fact)) != 0});
        }
      };
      add(reading.facts, &result.facts);
      add(reading.others, &result.others);
      result.readings.push_back({{whole, 0.0, wanted == read}, !read.empty(), each, words});
    }
  }
  return result;
}

void calibrate(const ReaderEvaluation& evaluation, ReaderModel* model) {
  std::vector<ReaderEvaluation::Guess> readings;
  for (const auto& each : evaluation.readings) {
    if (each.any) readings.push_back(each.guess);
  }
  model->of_reading = fittedOdds(readings);
  model->of_fact = fittedOdds(evaluation.facts);
  model->of_other = fittedOdds(evaluation.others);
}

}  // namespace language
}  // namespace hyselam_topo
