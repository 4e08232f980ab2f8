// evaluate_recognition: what is recognised in recorded runs, against reference poses.
#include <iostream>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "ngram_slam/alignment.hpp"
#include "ngram_slam/ngram.hpp"
#include "ngram_slam/recognition_score.hpp"
#include "recognition_options.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header

struct Options {
  RecognitionOptions recognition;
  std::vector<std::string> references;
  ScoreParams score;
  double heading_deg = 45.0;
};

/// Poses of a run in the common frame: a file, or the log's own ground truth.
std::vector<hyselam::StampedPose2> referenceOf(const Options& o, std::size_t run) {
  if (run < o.references.size()) return hyselam::readPoses(o.references[run]).poses;
  const auto truth = hyselam::readRobotLog(o.recognition.logs[run]).ground_truth;
  if (truth.empty())
    throw hyselam::InputError(o.recognition.logs[run], "", "has no ground truth: give --reference");
  return truth;
}

nlohmann::json run(const Options& o) {
  ScoreParams score_params = o.score;
  score_params.heading = hyselam::radians(o.heading_deg);
  score_params.validate();
  if (!o.references.empty() && o.references.size() != o.recognition.logs.size())
    throw hyselam::ParameterError("--reference", o.references.size(), "one file for each log");
  Recogniser r(o.recognition.params());
  std::vector<Match> matches;
  feed(o.recognition, r, [&](const RecogniserUpdate& u) {
    if (u.requantised) matches.clear();
    matches.insert(matches.end(), u.matches.begin(), u.matches.end());
  });

  const ObservationStore& observations = r.observations();
  std::vector<std::vector<hyselam::StampedPose2>> references;
  for (std::size_t i = 0; i < o.recognition.logs.size(); ++i)
    references.push_back(referenceOf(o, i));
  std::vector<std::optional<hyselam::Pose2>> poses;
  std::vector<std::uint32_t> runs;
  for (std::uint32_t i = 0; i < observations.size(); ++i) {
    runs.push_back(observations.runOf(i));
    poses.push_back(hyselam::poseAt(references[runs.back()], observations.stamp(i), 0.5));
  }
  RecognitionScore score(std::move(poses), std::move(runs), score_params);

  std::size_t true_matches = 0, counted_matches = 0;
  std::set<std::pair<WordIndex, WordIndex>> done;
  for (const Match& m : matches) {
    // A match is true if most observations of its last pair of words are.
    int right = 0, wrong = 0;
    const auto ngram =
        longestNgram(r.text(), r.params().matcher.tolerance, {m.newer, m.older}, m.levels, 64);
    for (const WordPair& words : ngram) {
      const bool last = words.newer == m.newer;
      if (!done.insert({words.newer, words.older}).second && !last) continue;
      for (const ObservationPair& p : alignedObservations(r.text(), observations, {words})) {
        const auto verdict = score.add(p.newer, p.older);
        if (last && verdict) ++(*verdict ? right : wrong);
      }
    }
    if (right + wrong == 0) continue;
    ++counted_matches;
    true_matches += right > wrong;
  }
  const nlohmann::json j = {
      {"observations", observations.size()},
      {"words", r.text().positions()},
      {"matches", counted_matches},
      {"match_precision", counted_matches == 0 ? 1.0
                                               : static_cast<double>(true_matches) /
                                                     static_cast<double>(counted_matches)},
      {"pairs", score.pairs()},
      {"precision", score.precision()},
      {"revisits", score.revisits()},
      {"recall", score.recall()},
      {"revisits_any_direction", score.revisitsAnyDirection()},
      {"recall_any_direction", score.recallAnyDirection()}};
  std::cout << j.dump(2) << "\n";
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Recognises places in recorded runs and compares with reference poses. A pair of "
      "observations "
      "is true if they were made within --distance and --heading of each other; a revisit is an "
      "observation for which such an earlier one exists.",
      "evaluate_recognition");
  Options o;
  o.recognition.addTo(app);
  app.add_option(
      "--reference", o.references,
      "true poses of each log (TUM, or a reference table); default: the logs' ground truth");
  app.add_option("--distance", o.score.distance, "of a true pair at most [m]");
  app.add_option("--heading", o.heading_deg, "difference of headings of a true pair at most [deg]");
  app.add_option("--separation", o.score.separation,
                 "observations between the two of a pair in one run at least");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
