// evaluate_recognition: what is recognized in recorded runs, against reference poses: by the
// stack's default, or by words alone.
#include <algorithm>
#include <array>
#include <iostream>
#include <string>

#include "place_figures.hpp"
#include "word_candidates.hpp"
#include "word_recognition.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header

/// Options that both ways of recognizing have.
constexpr std::array kCommon{"logs",       "reference", "scan-topic", "odom-topic", "odom-frame",
                             "base-frame", "by",        "model",      "help"};

/// Marks the options of words in the help; whether one of them was given is asked after parsing.
std::vector<const CLI::Option*> wordOptions(CLI::App& app) {
  std::vector<const CLI::Option*> options;
  for (CLI::Option* option : app.get_options()) {
    const std::string name = option->get_single_name();
    if (std::find(kCommon.begin(), kCommon.end(), name) != kCommon.end()) continue;
    option->group("Words");
    options.push_back(option);
  }
  return options;
}

/// The best signatures of each question, and what SLAM's words propose beside them.
Candidates byDefault(const PlaceLog& log, const SignatureModel& model, std::size_t* words_made) {
  const CandidateOptions options;
  Candidates all = bySignatures(options, log, model);
  const Candidates words = byWords(options, log, "words", words_made);
  const auto most = static_cast<std::size_t>(options.candidates);
  for (std::size_t q = 0; q < all.size(); ++q) {
    all[q].resize(std::min(all[q].size(), most));
    const std::vector<PlaceCandidate> signatures = all[q];
    for (const PlaceCandidate& c : words[q]) {
      if (!isNearOne(c, signatures)) all[q].push_back(c);
    }
  }
  return all;
}

/// Figures of all logs together; with several also of each.
nlohmann::json recognizePlaces(const WordRecognitionOptions& o, const std::string& model_file) {
  const SignatureModel model =
      model_file.empty() ? SignatureModel::shipped() : SignatureModel::load(model_file);
  const PlaceLogOptions source{o.recognition.logs, o.references, o.recognition.bag_options};
  Figures sum;
  nlohmann::json each = nlohmann::json::array();
  for (const PlaceLog& log : source.read()) {
    const double begin = cpuSeconds();
    std::size_t words = 0;
    const Candidates candidates = byDefault(log, model, &words);
    const double retrieval = cpuSeconds() - begin;
    Figures f =
        figuresOf(log, candidates, kPairs, std::numeric_limits<std::size_t>::max(), nullptr);
    f.retrieval_s = retrieval;
    f.words = words;
    each.push_back(f.recognition());
    each.back()["log"] = log.name;
    sum += f;
  }
  nlohmann::json j = sum.recognition();
  if (each.size() > 1) j["logs"] = each;
  std::cout << j.dump(2) << "\n";
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Recognizes places in recorded runs and compares with reference poses.\n\n"
      "By places (the default, as SLAM recognizes): every 2 m of way the places with the likest "
      "signatures and those that words propose are verified by the scans, and believed by SLAM's "
      "rule. A place is a revisit if an earlier one, 10 m of way or more before, lies within 2 m; "
      "recall is the share of revisits with a believed match that is right (1 m, 20 degrees), pass "
      "recall the share of all their earlier passes.\n\n"
      "By words (if any of their options is given): a pair of observations is true if they were "
      "made "
      "within --distance and --heading of each other (or of the opposite heading, where a match in "
      "reverse is told). A revisit is an observation for which such an earlier one exists; recall "
      "is "
      "the share of revisits recognized, pass recall the share of all earlier passes of all "
      "revisits.",
      "evaluate_recognition");
  WordRecognitionOptions options;
  options.addTo(app);
  const std::vector<const CLI::Option*> of_words = wordOptions(app);
  std::string by, model;
  app.add_option("--by", by, "places or words; default: words if one of their options is given")
      ->check(CLI::IsMember({"places", "words"}));
  app.add_option("--model", model, "file of another model of signatures, for places");
  return hyselam::runTool(argc, argv, app, [&] {
    const auto given = std::find_if(of_words.begin(), of_words.end(),
                                    [](const CLI::Option* option) { return option->count() > 0; });
    if (by == "places" && given != of_words.end()) {
      throw hyselam::ParameterError((*given)->get_name(), "given", "used with --by words only");
    }
    if (by != "words" && given == of_words.end()) return recognizePlaces(options, model);
    if (!model.empty()) throw hyselam::ParameterError("--model", model, "used for places only");
    return recognizeByWords(options);
  });
}
