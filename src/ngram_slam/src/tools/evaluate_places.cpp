// evaluate_places: places found again in recorded runs, by their signatures or by a peer's
// descriptor, with and without verification by the scans.
#include <chrono>
#include <iostream>
#include <limits>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/tool.hpp"
#include "ngram_slam/slam/loop_confidence.hpp"
#include "ngram_slam/slam/path_segment.hpp"
#include "ngram_slam/slam/slam_score.hpp"
#include "place_logs.hpp"
#include "polar_context.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header
using hyselam::Pose2;

constexpr double kDistance = 2.0;  // of one place [m]
constexpr double kHeading = hyselam::radians(45.0);
constexpr std::uint32_t kSeparation = 20;  // places, 10 m
constexpr std::uint32_t kOld = 80;         // places, 40 m
constexpr std::uint32_t kInterval = 4;     // places from question to question
constexpr double kPairDistance = 1.0;      // of places laid over each other [m]
constexpr double kSure = 0.95;             // least probability of a match that is told as sure
constexpr int kPairs = 4;                  // places before and after a match

struct Options {
  PlaceLogOptions logs;
  std::string method = "signatures", model, matches;
  bool leave_one_out = false, no_verification = false, exact = false;
  int candidates = 8;
};

double seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Which places of a log were visited before.
struct Revisit {
  bool any = false, same = false, old = false;
};

bool isTruePlace(const LogPlace& a, const LogPlace& b) {
  return a.truth && b.truth && distance(*a.truth, *b.truth) <= kDistance;
}

Revisit revisitOf(const PlaceLog& log, std::uint32_t i) {
  Revisit r;
  bool recent = false;
  for (std::uint32_t j = 0; j + kSeparation <= i; ++j) {
    if (!isTruePlace(log.places[i], log.places[j])) continue;
    r.any = true;
    recent |= j + kOld > i;
    const double turn = log.places[i].truth->theta - log.places[j].truth->theta;
    r.same |= std::abs(hyselam::normalizeAngle(turn)) <= kHeading;
  }
  r.old = r.any && !recent;
  return r;
}

/// As the SLAM knows before any loop.
bool odometryAllows(const PlaceLog& log, std::uint32_t newer, std::uint32_t older) {
  const PlaceOnWay &a = log.places[newer].on_way, &b = log.places[older].on_way;
  return a.way < b.way || distance(a.pose, b.pose) <= LoopParams().signatureReach(a.way - b.way);
}

/// Candidates for each question of a log.
using Candidates = std::vector<std::vector<PlaceCandidate>>;

Candidates bySignatures(const Options& o, const PlaceLog& log, const SignatureModel& model) {
  PlaceRecognizerParams params;
  params.max_candidates = std::max(10, o.candidates);
  PlaceRecognizer recognizer(model, params);
  for (const LogPlace& p : log.places) recognizer.add(model.signatureOf(p.features));
  Candidates all;
  for (std::uint32_t i = 0; i < log.places.size(); i += kInterval) {
    const auto may_be = [&](std::uint32_t older) { return odometryAllows(log, i, older); };
    all.push_back(o.exact ? recognizer.candidatesOfAll(i, may_be)
                          : recognizer.candidates(i, may_be));
  }
  return all;
}

/// By the distance of polar contexts of all earlier places.
Candidates byContexts(const Options& o, const PlaceLog& log) {
  std::vector<ngram_slam_peers::PolarContext> contexts;
  for (const LogPlace& p : log.places) {
    const SlamKeyframe& k = log.keyframes[static_cast<std::size_t>(p.on_way.keyframe)];
    contexts.push_back(o.method == "context-scan" ? ngram_slam_peers::contextOf(*k.scan)
                                                  : ngram_slam_peers::contextOf(p.features));
  }
  const PlaceRecognizerParams params;
  Candidates all;
  for (std::uint32_t i = 0; i < contexts.size(); i += kInterval) {
    std::vector<PlaceCandidate> found, told;
    for (std::uint32_t j = 0; j + kSeparation <= i; ++j) {
      if (!odometryAllows(log, i, j)) continue;
      found.push_back(
          {i, j, Direction::kSame, -ngram_slam_peers::contextDistance(contexts[i], contexts[j])});
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
    for (const PlaceCandidate& c : found) {
      if (static_cast<int>(told.size()) == std::max(10, o.candidates)) break;
      const bool near = std::any_of(told.begin(), told.end(), [&](const PlaceCandidate& t) {
        return std::max(t.older, c.older) - std::min(t.older, c.older) <=
               static_cast<std::uint32_t>(params.candidate_spacing);
      });
      if (!near) told.push_back(c);
    }
    all.push_back(told);
  }
  return all;
}

LoopVerification verify(const PlaceLog& log, const PlaceCandidate& c, const SlamParams& params) {
  LoopTask task;
  task.older = static_cast<int>(log.places[c.older].on_way.keyframe);
  task.newer = static_cast<int>(log.places[c.newer].on_way.keyframe);
  task.source = LoopSource::kSignature;
  task.far = true;
  task.any_heading = true;
  task.window = params.loop.signature_search_window;
  task.angle = params.loop.signature_search_angle;
  const double newer_length = log.keyframes[static_cast<std::size_t>(task.newer)].path_length;
  task.old_segment =
      segmentAround(log.keyframes, task.older, params.loop.far_old_segment_half_length,
                    newer_length - params.loop.segment_separation);
  task.new_segment =
      segmentAround(log.keyframes, task.newer, params.loop.far_new_segment_half_length,
                    std::numeric_limits<double>::infinity());
  return verifyLoop(task, params);
}

/// Counts of one log.
struct Figures {
  std::size_t questions = 0, revisits = 0, revisits_same = 0, revisits_old = 0;
  std::array<std::size_t, 3> first{};  // a true place among the first 1, 5, 10
  std::size_t matches = 0, wrong = 0, pairs = 0, true_pairs = 0;
  std::size_t verified_matches = 0, verified_wrong = 0, sure = 0, sure_wrong = 0;
  std::size_t found = 0, found_same = 0, found_old = 0, verified = 0;
  double verification_s = 0.0, retrieval_s = 0.0, recall_unverified = 0.0;

  static double share(std::size_t part, std::size_t of) {
    return of == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(of);
  }
  nlohmann::json json(const std::string& name) const {
    return {
        {"log", name},
        {"questions", questions},
        {"revisits", revisits},
        {"revisits_same", revisits_same},
        {"revisits_old", revisits_old},
        {"first_1", share(first[0], revisits)},
        {"first_5", share(first[1], revisits)},
        {"first_10", share(first[2], revisits)},
        {"recall_unverified_none_wrong", recall_unverified},
        {"verified", verified_matches},
        {"verified_wrong", verified_wrong},
        {"matches", matches},
        {"matches_wrong", wrong},
        {"sure", sure},
        {"sure_wrong", sure_wrong},
        {"pair_precision", pairs == 0 ? 1.0 : share(true_pairs, pairs)},
        {"recall", share(found, revisits)},
        {"recall_same", share(found_same, revisits_same)},
        {"recall_old", share(found_old, revisits_old)},
        {"ms_retrieval", questions == 0 ? 0.0 : 1e3 * retrieval_s / static_cast<double>(questions)},
        {"ms_verification",
         verified == 0 ? 0.0 : 1e3 * verification_s / static_cast<double>(verified)}};
  }
};

/// The pairs of places that a match lays over each other.
void countPairs(const PlaceLog& log, const PlaceCandidate& c, const Pose2& newer_in_older,
                Figures* f) {
  const auto& older_frame =
      log.keyframes[static_cast<std::size_t>(log.places[c.older].on_way.keyframe)].pose;
  const auto& newer_frame =
      log.keyframes[static_cast<std::size_t>(log.places[c.newer].on_way.keyframe)].pose;
  const auto last = static_cast<std::int64_t>(log.places.size()) - 1;
  for (std::int64_t n = std::max<std::int64_t>(0, static_cast<std::int64_t>(c.newer) - kPairs);
       n <= std::min<std::int64_t>(last, static_cast<std::int64_t>(c.newer) + kPairs); ++n) {
    const LogPlace& newer = log.places[static_cast<std::size_t>(n)];
    const Pose2 there = older_frame * newer_in_older * between(newer_frame, newer.on_way.pose);
    const LogPlace* nearest = nullptr;
    for (std::int64_t m = std::max<std::int64_t>(0, static_cast<std::int64_t>(c.older) - 20);
         m <= std::min<std::int64_t>(n - 1, static_cast<std::int64_t>(c.older) + 20); ++m) {
      const LogPlace& older = log.places[static_cast<std::size_t>(m)];
      if (distance(older.on_way.pose, there) > kPairDistance) continue;
      if (nearest == nullptr ||
          distance(older.on_way.pose, there) < distance(nearest->on_way.pose, there)) {
        nearest = &older;
      }
    }
    if (nearest == nullptr || !newer.truth || !nearest->truth) continue;
    ++f->pairs;
    f->true_pairs += isTruePlace(newer, *nearest) ? 1 : 0;
  }
}

/// Recall of the best candidates by themselves, as far as none better than them is wrong.
double recallUnverified(const PlaceLog& log, const Candidates& all, std::size_t revisits) {
  std::vector<std::pair<double, bool>> tops;
  for (const auto& candidates : all) {
    if (candidates.empty() || !log.places[candidates[0].newer].truth) continue;
    tops.emplace_back(candidates[0].score, isTruePlace(log.places[candidates[0].newer],
                                                       log.places[candidates[0].older]));
  }
  std::sort(tops.begin(), tops.end(),
            [](const auto& a, const auto& b) { return a.first > b.first; });
  std::size_t right = 0;
  while (right < tops.size() && tops[right].second) ++right;
  return Figures::share(right, revisits);
}

/// A candidate that the scans fit.
struct Match {
  PlaceCandidate candidate;
  std::size_t rank;
  LoopVerification verification;
  LoopCompany company;
  bool is_right;
};

std::vector<Match> matchesOf(const Options& o, const PlaceLog& log, const Candidates& all,
                             Figures* f) {
  const SlamParams params;
  std::vector<Match> matches;
  std::vector<SlamLoop> loops;
  hyselam::Progress progress("verification in " + log.name, all.size());
  for (std::size_t q = 0; q < all.size(); ++q) {
    progress.update(q + 1);
    if (!log.places[q * kInterval].truth) continue;
    for (std::size_t k = 0; k < all[q].size() && k < static_cast<std::size_t>(o.candidates); ++k) {
      const double begin = seconds();
      const LoopVerification v = verify(log, all[q][k], params);
      f->verification_s += seconds() - begin;
      ++f->verified;
      if (v.score == 0.0) continue;
      const bool is_wrong = loopError(log.keyframes[static_cast<std::size_t>(v.loop.older)],
                                      log.keyframes[static_cast<std::size_t>(v.loop.newer)],
                                      v.loop.measured, log.reference)
                                .isFalse();
      matches.push_back({all[q][k], k, v, {}, !is_wrong});
      if (v.verified) loops.push_back(v.loop);
    }
  }
  for (Match& m : matches) {
    m.company = companyOf(m.verification.loop, loops, log.keyframes, params.loop);
  }
  return matches;
}

void writeRows(const PlaceLog& log, const std::vector<Match>& matches, std::ostream& out) {
  for (const Match& m : matches) {
    const LoopVerification& v = m.verification;
    out << log.name << ',' << m.candidate.newer << ',' << m.candidate.older << ',' << m.rank << ','
        << m.candidate.score << ',' << v.score << ',' << v.loop.inlier_ratio << ','
        << v.new_in_old.observed_ratio << ',' << v.new_in_old.surface_ratio << ','
        << v.old_in_new.surface_ratio << ',' << v.ambiguous_score << ',' << m.company.support << ','
        << m.company.contradiction << ',' << loopProbability(v, m.company) << ','
        << (v.verified ? 1 : 0) << ',' << (m.is_right ? 1 : 0) << '\n';
  }
}

Figures figuresOf(const Options& o, const PlaceLog& log, const Candidates& all,
                  std::ostream* rows) {
  Figures f;
  std::vector<Match> matches;
  if (!o.no_verification) matches = matchesOf(o, log, all, &f);
  if (rows != nullptr) writeRows(log, matches, *rows);
  const LoopParams params;
  std::vector<char> right(all.size(), 0);
  for (const Match& m : matches) {
    if (!m.verification.verified) continue;
    ++f.verified_matches;
    f.verified_wrong += m.is_right ? 0 : 1;
    if (loopProbability(m.verification, m.company) >= kSure) {
      ++f.sure;
      f.sure_wrong += m.is_right ? 0 : 1;
    }
    if (!m.company.isTrusted(params)) continue;
    ++f.matches;
    f.wrong += m.is_right ? 0 : 1;
    if (m.is_right) right[m.candidate.newer / kInterval] = 1;
    countPairs(log, m.candidate, m.verification.loop.measured, &f);
  }
  for (std::size_t q = 0; q < all.size(); ++q) {
    const auto i = static_cast<std::uint32_t>(q * kInterval);
    if (!log.places[i].truth) continue;
    ++f.questions;
    const Revisit revisit = revisitOf(log, i);
    f.revisits += revisit.any ? 1 : 0;
    f.revisits_same += revisit.same ? 1 : 0;
    f.revisits_old += revisit.old ? 1 : 0;
    f.found += right[q] != 0 && revisit.any ? 1 : 0;
    f.found_same += right[q] != 0 && revisit.same ? 1 : 0;
    f.found_old += right[q] != 0 && revisit.old ? 1 : 0;
    for (std::size_t k = 0; k < all[q].size(); ++k) {
      if (!isTruePlace(log.places[i], log.places[all[q][k].older])) continue;
      for (std::size_t n = 0; n < 3; ++n) f.first[n] += k < std::array{1U, 5U, 10U}[n] ? 1 : 0;
      break;
    }
  }
  f.recall_unverified = recallUnverified(log, all, f.revisits);
  return f;
}

nlohmann::json run(const Options& o) {
  if (o.candidates < 1 || o.candidates > 100) {
    throw hyselam::ParameterError("--candidates", o.candidates, "1 to 100");
  }
  const std::vector<PlaceLog> logs = o.logs.read();
  std::vector<std::vector<SignatureExample>> ways;
  if (o.leave_one_out) {
    for (const PlaceLog& log : logs) ways.push_back(examplesOf(log));
  }
  std::ostringstream rows;
  rows << "log,newer,older,rank,likelihood,score,inliers,overlap,new_fit,old_fit,rival,"
          "support,contradiction,probability,verified,right\n";
  nlohmann::json j = nlohmann::json::array();
  for (std::size_t i = 0; i < logs.size(); ++i) {
    std::optional<SignatureModel> own;
    if (o.leave_one_out && o.method == "signatures") {
      auto others = ways;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      own = trainSignatures(others);
    } else if (!o.model.empty()) {
      own = SignatureModel::load(o.model);
    }
    const double begin = seconds();
    const Candidates all = o.method == "signatures"
                               ? bySignatures(o, logs[i], own ? *own : SignatureModel::shipped())
                               : byContexts(o, logs[i]);
    const double retrieval = seconds() - begin;
    Figures f = figuresOf(o, logs[i], all, o.matches.empty() ? nullptr : &rows);
    f.retrieval_s = retrieval;
    j.push_back(f.json(logs[i].name));
    std::cout << j.back().dump() << std::endl;
  }
  if (!o.matches.empty()) {
    hyselam::writeFileAtomically(o.matches, [&](std::ostream& out) { out << rows.str(); });
  }
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Looks for each place of a recorded run, 2 m of way apart, among the earlier ones, and "
      "verifies the best candidates by the scans. A place is a revisit if an earlier one, 10 m of "
      "way or more before, lies within 2 m of it (old: all such ones 40 m or more); recall is the "
      "share of revisits with a right match. A match is wrong if its pose is more than 1 m or 20 "
      "degrees off; a pair of places that a match lays over each other if they are more than 2 m "
      "apart.",
      "evaluate_places");
  Options o;
  o.logs.addTo(app);
  app.add_option("--method", o.method,
                 "signatures, or a peer: context-scan, context-submap (Scan Context, Kim and Kim, "
                 "IROS 2018)")
      ->check(CLI::IsMember({"signatures", "context-scan", "context-submap"}));
  app.add_option("--model", o.model, "file of another model of signatures");
  app.add_flag("--leave-one-out", o.leave_one_out, "learn a model for each log from the others");
  app.add_option("--candidates", o.candidates, "verified for each place");
  app.add_flag("--exact", o.exact, "compare with all places, without the index");
  app.add_flag("--no-verification", o.no_verification, "tell the candidates only");
  app.add_option("--matches", o.matches, "each candidate that was found, as CSV");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
