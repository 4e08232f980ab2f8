// What words and their n-grams recognise by themselves, without the scans' verification, compared
// with reference poses.
#pragma once

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "ngram_slam/matching/match_evaluation.hpp"
#include "ngram_slam/matching/shared_matches.hpp"
#include "recognition_options.hpp"
#include "reference_poses.hpp"
#include "similarity_matrix.hpp"

namespace ngram_slam {

constexpr int kParts = 40;           // rows of precision and recall over time
constexpr int kPoints = 200;         // of a curve
constexpr int kSharedPoints = 1000;  // of the curve of shared matches, which is steep

struct WordRecognitionOptions {
  RecognitionOptions recognition;
  ReferenceFiles references;
  ScoreParams score;
  double heading_deg = 45.0;
  std::string n;                         // to sweep
  std::vector<double> sizes;             // to sweep
  std::string table, curve, similarity;  // files
  bool shared = false;

  void addTo(CLI::App& app) {
    recognition.addTo(app);
    references.addTo(app);
    app.add_option("--distance", score.distance, "of a true pair at most [m]");
    app.add_option("--heading", heading_deg, "difference of headings of a true pair at most [deg]");
    app.add_option("--separation", score.separation,
                   "observations between the two of a pair in one run at least");
    app.add_option("--n", n,
                   "also a table over the least words of the first level, like 1..20 or 5,7; other "
                   "levels keep their distance to it");
    app.add_option("--size-tolerances", sizes, "of the table, like 0.1,0.2,0.3")->delimiter(',');
    app.add_option("--table", table, "the table as CSV");
    app.add_option("--curve", curve,
                   "precision and recall as CSV while ever shorter (with --max-chance: likelier by "
                   "chance; with --probability: less probable) matches are taken in");
    app.add_flag("--shared-matches", shared,
                 "also precision and recall of what the run recognized by the matches that "
                 "observations share, while ever less similar ones are taken in; with "
                 "--probability or --improved, and a small --min-probability");
    app.add_option("--similarity", similarity,
                   "similarity matrix to write (JSON): what is true, and what was recognized; for "
                   "scripts/plot_similarity");
  }
};

using Truth = std::shared_ptr<const RecognitionTruth>;

/// Poses of a run in the common frame.
inline std::vector<hyselam::StampedPose2> posesOf(const WordRecognitionOptions& o,
                                                  std::size_t run) {
  const std::string& path = o.recognition.logs[run];
  auto poses = o.references.of(run, hyselam::readRobotLog(path, o.recognition.bag_options));
  if (poses.empty()) throw hyselam::InputError(path, "", kNoTruth);
  return poses;
}

inline Truth truthOf(const WordRecognitionOptions& o, const ObservationStore& observations,
                     const std::vector<Run>& logs) {
  ScoreParams params = o.score;
  params.heading = hyselam::radians(o.heading_deg);
  std::vector<std::optional<hyselam::Pose2>> poses;
  std::vector<std::uint32_t> runs;  // a log in which the robot was carried off has several
  for (std::size_t log = 0; log < logs.size(); ++log) {
    const std::vector<hyselam::StampedPose2> reference = posesOf(o, log);
    for (const DensityObservation& observation : logs[log].observations) {
      runs.push_back(observations.runOf(static_cast<std::uint32_t>(runs.size())));
      poses.push_back(hyselam::poseAt(reference, observation.stamp, 0.5));
    }
  }
  return std::make_shared<const RecognitionTruth>(std::move(poses), std::move(runs), params);
}

inline nlohmann::json figures(const RecognitionScore& score) {
  const RecognitionFigures f = score.figures();
  return {{"pairs", f.pairs},
          {"precision", f.precision()},
          {"revisits", f.revisits},
          {"recall", f.recall()},
          {"pass_recall", f.passRecall()},
          {"revisits_any_direction", f.revisits_any},
          {"recall_any_direction", f.recallAnyDirection()},
          {"pass_recall_any_direction", f.passRecallAnyDirection()}};
}

inline nlohmann::json summary(const MatchEvaluation& evaluation) {
  nlohmann::json j = figures(evaluation.score());
  j["matches"] = evaluation.matches();
  j["match_precision"] = evaluation.matchPrecision();
  return j;
}

/// "1..20", "7,10,13", "5" as a list. @throws hyselam::ParameterError
inline std::vector<int> listOf(const std::string& name, const std::string& text) {
  std::vector<int> list;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ',');) {
    int first = 0, last = 0;
    char rest = 0;
    const int read = std::sscanf(part.c_str(), "%d..%d%c", &first, &last, &rest);
    if (read == 1 && std::to_string(first) == part) {
      last = first;
    } else if (read != 2) {
      throw hyselam::ParameterError(name, text, "numbers like 7,10 or 1..20");
    }
    if (first < 1 || last < first || last > 65535) {
      throw hyselam::ParameterError(name, text, "rising numbers from 1 to 65535");
    }
    for (int i = first; i <= last; ++i) list.push_back(i);
  }
  if (list.empty()) throw hyselam::ParameterError(name, text, "numbers like 7,10 or 1..20");
  return list;
}

inline std::vector<NgramMatch> recognise(NgramRecognizer& recognizer,
                                         const std::vector<Run>& runs) {
  std::vector<NgramMatch> matches;
  feed(runs, recognizer, [&](const NgramRecognizerUpdate& u) {
    if (u.requantised) matches.clear();
    matches.insert(matches.end(), u.matches.begin(), u.matches.end());
  });
  return matches;
}

/// One row per n and size tolerance, and where the run stood by then.
inline nlohmann::json sweep(const WordRecognitionOptions& o, const std::vector<Run>& runs,
                            const Truth& truth) {
  const NgramRecognizerParams base = o.recognition.params();
  const std::vector<int> list =
      o.n.empty() ? std::vector<int>{base.matcher.min_n.front()} : listOf("--n", o.n);
  const std::vector<double> sizes =
      o.sizes.empty() ? std::vector<double>{base.matcher.tolerance.size} : o.sizes;
  nlohmann::json rows = nlohmann::json::array();
  hyselam::Progress progress("sweep", list.size() * sizes.size());
  for (const double size : sizes) {
    for (const int n : list) {
      NgramRecognizerParams params = base;
      params.matcher.tolerance.size = size;
      for (std::size_t l = 0; l < params.matcher.min_n.size(); ++l) {
        params.matcher.min_n[l] = n + base.matcher.min_n[l] - base.matcher.min_n[0];
      }
      params.validate();
      NgramRecognizer recognizer(params);
      MatchEvaluation evaluation(recognizer, truth);
      evaluation.add(recognise(recognizer, runs));
      nlohmann::json row = summary(evaluation);
      row["n"] = n;
      row["size_tolerance"] = size;
      for (int part = 1; part <= kParts; ++part) {
        const auto until = static_cast<std::uint32_t>(static_cast<std::uint64_t>(truth->size()) *
                                                      static_cast<std::uint64_t>(part) / kParts);
        const RecognitionFigures f = evaluation.score().figures(until);
        row["over_time"].push_back(
            {f.precision(), f.recall(), static_cast<double>(part) / kParts, f.pairs});
      }
      rows.push_back(row);
      progress.update(rows.size());
    }
  }
  if (!o.table.empty()) {
    hyselam::writeFileAtomically(o.table, [&](std::ostream& out) {
      const std::vector<const char*> columns{"n",
                                             "size_tolerance",
                                             "matches",
                                             "match_precision",
                                             "pairs",
                                             "precision",
                                             "recall",
                                             "pass_recall",
                                             "recall_any_direction",
                                             "pass_recall_any_direction"};
      for (const char* column : columns) out << column << (column == columns.back() ? "\n" : ",");
      for (const auto& row : rows) {
        for (const char* column : columns) {
          out << row[column] << (column == columns.back() ? "\n" : ",");
        }
      }
    });
  }
  return rows;
}

/// Which of the items that are taken in one by one are points of the curve of all.
class CurvePoints {
 public:
  CurvePoints(std::size_t items, std::size_t points) : items_(items), points_(points) {}
  bool isLast(std::size_t item) const { return item + 1 == items_; }
  /// @param same_as_next items of one value are one point.
  bool isPoint(std::size_t item, bool same_as_next) {
    if (!isLast(item) && (same_as_next || (item + 1) * points_ < told_ * items_)) return false;
    told_ = (item + 1) * points_ / items_ + 1;
    return true;
  }

 private:
  std::size_t items_, points_, told_ = 0;
};

/// Precision and recall while ever less sure matches are taken in.
inline nlohmann::json curve(const WordRecognitionOptions& o, const NgramRecognizer& recognizer,
                            std::vector<NgramMatch> matches, const Truth& truth) {
  const NgramRecognizerParams& params = recognizer.params();
  const auto key = [&](const NgramMatch& m) {
    if (params.with_probability) return m.probability;
    return params.max_chance > 0.0 ? -m.chance : static_cast<double>(m.n);
  };
  std::stable_sort(matches.begin(), matches.end(),
                   [&](const NgramMatch& a, const NgramMatch& b) { return key(a) > key(b); });
  nlohmann::json points = nlohmann::json::array();
  MatchEvaluation evaluation(recognizer, truth);
  CurvePoints of_curve(matches.size(), kPoints);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    evaluation.add(matches[i]);
    if (!of_curve.isPoint(i, !of_curve.isLast(i) && key(matches[i]) == key(matches[i + 1]))) {
      continue;
    }
    nlohmann::json point = summary(evaluation);
    point["threshold"] = std::abs(key(matches[i]));
    points.push_back(point);
  }
  if (!o.curve.empty()) {
    hyselam::writeFileAtomically(o.curve, [&](std::ostream& out) {
      out << "threshold,matches,precision,recall,pass_recall,recall_any_direction,"
             "pass_recall_any_direction\n";
      for (const auto& p : points) {
        out << p["threshold"] << ',' << p["matches"] << ',' << p["precision"] << ',' << p["recall"]
            << ',' << p["pass_recall"] << ',' << p["recall_any_direction"] << ','
            << p["pass_recall_any_direction"] << '\n';
      }
    });
  }
  return points;
}

/// Precision and recall while observations that share ever fewer of their matches are taken in.
inline nlohmann::json sharedCurve(const NgramRecognizer& recognizer,
                                  const std::vector<NgramMatch>& matches, const Truth& truth) {
  std::vector<SimilarObservations> pairs = SharedMatches(recognizer).of(matches);
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const SimilarObservations& a, const SimilarObservations& b) {
                     return a.similarity > b.similarity;
                   });
  nlohmann::json points = nlohmann::json::array();
  RecognitionScore score(truth);
  CurvePoints of_curve(pairs.size(), kSharedPoints);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const SimilarObservations& p = pairs[i];
    for (std::uint32_t k = 0; k < p.count; ++k) {
      score.add(p.newer + k, p.direction == Direction::kSame ? p.older + k : p.older - k,
                p.direction);
    }
    if (!of_curve.isPoint(i, !of_curve.isLast(i) && p.similarity == pairs[i + 1].similarity)) {
      continue;
    }
    nlohmann::json point = figures(score);
    point["matches"] = i + 1;
    point["threshold"] = p.similarity;
    points.push_back(point);
  }
  return points;
}

inline nlohmann::json recognizeByWords(const WordRecognitionOptions& o) {
  o.references.check(o.recognition.logs.size());
  if (!o.n.empty()) listOf("--n", o.n);  // before the densities are computed
  NgramRecognizer recognizer(o.recognition.params());
  if (o.shared && !recognizer.params().with_probability) {
    throw hyselam::ParameterError("--shared-matches", "given", "used with --probability");
  }
  const std::vector<Run> runs = readRuns(o.recognition);
  const std::clock_t begin = std::clock();
  const std::vector<NgramMatch> matches = recognise(recognizer, runs);
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  const Truth truth = truthOf(o, recognizer.observations(), runs);
  MatchEvaluation evaluation(recognizer, truth);
  evaluation.add(matches);

  nlohmann::json j = summary(evaluation);
  j["recognized_by"] = "words";
  j["observations"] = recognizer.observations().size();
  j["words"] = recognizer.text().positions();
  std::cout << j.dump(2) << "\n";
  j["matching_s"] = seconds;  // words, matches and what judges them, without densities
  if (!o.similarity.empty()) writeSimilarityMatrix(o.similarity, evaluation.score());
  if (!o.table.empty() || !o.n.empty() || !o.sizes.empty()) j["sweep"] = sweep(o, runs, truth);
  if (!o.curve.empty()) j["curve"] = curve(o, recognizer, matches, truth);
  if (o.shared) {
    const std::clock_t start = std::clock();
    j["shared_matches"] = sharedCurve(recognizer, matches, truth);
    j["shared_matches_s"] = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  }
  return j;
}

}  // namespace ngram_slam
