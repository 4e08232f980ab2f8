// train_fact_reader: learns the second reader of a language from annotated sentences.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/checksum.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_common/utf8.hpp"
#include "reader_training.hpp"

namespace {

using namespace hyselam_topo;            // NOLINT: a program, not a header
using namespace hyselam_topo::language;  // NOLINT

struct Options {
  std::vector<std::string> files;
  std::string language = "en", out, nouns;
  bool evaluate = false, show = false;
  ReaderTrainingParams params;
};

std::string percent(std::size_t part, std::size_t of) {
  std::ostringstream out;
  out.precision(1);
  out << std::fixed
      << (of == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(of));
  return out.str() + " %";
}

/// How often what is told as so probable is right.
void printTold(const std::string& what, const std::vector<ReaderEvaluation::Guess>& guesses,
               const Odds& odds) {
  struct Bin {
    std::size_t count = 0, right = 0;
    double sum = 0.0;
  };
  std::array<Bin, 20> bins;
  for (const auto& each : guesses) {
    const double p = odds.of(each.own, each.whole);
    Bin& bin = bins[static_cast<std::size_t>(
        std::min<double>(bins.size() - 1.0, std::floor(p * bins.size())))];
    ++bin.count;
    bin.sum += p;
    bin.right += each.right ? 1 : 0;
  }
  std::cout << what << ": told as, right, number\n";
  for (const Bin& bin : bins) {
    if (bin.count == 0) continue;
    std::cout << "  "
              << percent(static_cast<std::size_t>(std::lround(bin.sum * 10)), bin.count * 10)
              << "  " << percent(bin.right, bin.count) << "  " << bin.count << '\n';
  }
}

void print(const ReaderEvaluation& evaluation, const ReaderModel& calibrated, bool show) {
  for (const auto& [layer, score] : evaluation.by_layer) {
    std::cout << layer << ": " << score.texts << " texts, exact "
              << percent(score.exact, score.texts) << ", mentions " << score.mentions
              << ", precision " << percent(score.mentions_right, score.mentions_found)
              << ", recall " << percent(score.mentions_right, score.mentions) << ", facts "
              << score.facts << ", precision " << percent(score.right, score.read) << ", recall "
              << percent(score.right, score.facts) << '\n';
  }
  std::vector<ReaderEvaluation::Guess> readings;
  for (const auto& each : evaluation.readings) {
    if (!each.any) continue;
    readings.push_back(each.guess);
    if (show && !each.guess.right) {
      std::cout << calibrated.of_reading.of(each.guess.own, each.guess.whole) << "  "
                << each.text->text << each.read << '\n';
    }
  }
  printTold("readings, all right and complete", readings, calibrated.of_reading);
  printTold("facts", evaluation.facts, calibrated.of_fact);
  printTold("others that may be meant", evaluation.others, calibrated.of_other);
}

/// What the model says of itself.
ModelOrigin originOf(const Options& o, std::size_t sentences, const ReaderEvaluation& evaluation) {
  ModelOrigin origin;
  origin.language = o.language;
  std::ostringstream command;
  command << "train_fact_reader FILE... --language " << o.language << " --nouns NOUNS --cost "
          << o.params.cost << " --least-seen " << o.params.least_seen << " --folds "
          << o.params.folds << " (bench/readers --retrain)";
  origin.command = command.str();
  std::string contents;
  for (const std::string& file : o.files) contents += hyselam::readTextFile(file);
  origin.data = std::to_string(sentences) + " annotated sentences of " +
                std::to_string(o.files.size()) + " files (CRC-32 " + hyselam::crc32Text(contents) +
                ")";
  for (const auto& [layer, score] : evaluation.by_layer) {
    origin.left_out +=
        (origin.left_out.empty() ? "" : "; ") + layer + ": " + std::to_string(score.texts) +
        " texts, exact " + percent(score.exact, score.texts) + ", facts precision " +
        percent(score.right, score.read) + ", recall " + percent(score.right, score.facts);
  }
  return origin;
}

nlohmann::json run(const Options& o) {
  std::vector<AnnotatedText> all;
  for (const std::string& file : o.files) {
    for (AnnotatedText& each : loadAnnotated(file)) all.push_back(std::move(each));
  }
  std::vector<const AnnotatedText*> texts;
  for (const AnnotatedText& each : all) {
    if (each.language == o.language) texts.push_back(&each);
  }
  const Grammar grammar = Grammar::shipped(o.language);
  ReaderLexicon lexicon = ReaderLexicon::of(grammar.compiled());
  if (!o.nouns.empty()) {
    std::istringstream nouns(hyselam::readTextFile(o.nouns));
    for (std::string noun; nouns >> noun;) lexicon.nouns.insert(hyselam::utf8Fold(noun));
  }
  const ReaderEvaluation evaluation = evaluateReader(grammar, lexicon, texts, o.params);
  ReaderModel model;
  if (!o.out.empty()) model = trainReader(grammar, lexicon, texts, o.params);
  calibrate(evaluation, &model);
  print(evaluation, model, o.show);
  if (!o.out.empty()) {
    model.origin = originOf(o, texts.size(), evaluation);
    hyselam::writeFileAtomically(o.out, [&](std::ostream& out) { out << model.toText(); });
  }
  nlohmann::json json;
  for (const auto& [layer, score] : evaluation.by_layer) {
    json[layer] = {{"texts", score.texts},
                   {"exact", score.exact},
                   {"facts", score.facts},
                   {"read", score.read},
                   {"right", score.right}};
  }
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Learns the second reader of a language from annotated sentences, and tells how it fares on "
      "writers left out.");
  Options o;
  app.add_option("files", o.files, "Annotated sentences (JSON lines)")->required();
  app.add_option("--language", o.language, "Language of the sentences to use")
      ->capture_default_str();
  app.add_option("--nouns", o.nouns, "More nouns than the grammar has, one a line");
  app.add_option("--out", o.out, "Model to write");
  app.add_option("--cost", o.params.cost, "C of the regression: smaller gives fewer weights")
      ->capture_default_str();
  app.add_option("--least-seen", o.params.least_seen, "Features of fewer examples are left out")
      ->capture_default_str();
  app.add_option("--folds", o.params.folds, "Parts of the writers, each left out once")
      ->capture_default_str();
  app.add_flag("--show", o.show, "Print the texts that were read wrongly");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
