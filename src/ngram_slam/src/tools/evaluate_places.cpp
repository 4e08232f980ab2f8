// evaluate_places: places found again in recorded runs, by their signatures or by a peer's
// descriptor, with and without verification by the scans.
#include <algorithm>
#include <iostream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/tool.hpp"
#include "place_figures.hpp"
#include "word_candidates.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header
struct Options {
  PlaceLogOptions logs;
  CandidateOptions candidates;
  std::vector<std::string> methods{"signatures"};
  std::string model, matches;
  bool leave_one_out = false, no_verification = false;
};

bool asks(const Options& o, const std::string& method) {
  return std::find(o.methods.begin(), o.methods.end(), method) != o.methods.end();
}

/// Options that would be ignored are refused.
void check(const Options& o) {
  const CandidateOptions& c = o.candidates;
  const auto refuse = [](const std::string& option, const std::string& value, const char* why) {
    throw hyselam::ParameterError(option, value, why);
  };
  if (c.candidates < 1 || c.candidates > 100) {
    refuse("--candidates", std::to_string(c.candidates), "1 to 100");
  }
  if (!asks(o, "signatures") && !asks(o, "chains")) {
    const char* why = "used with --method signatures or chains only";
    if (!o.model.empty()) refuse("--model", o.model, why);
    if (o.leave_one_out) refuse("--leave-one-out", "given", why);
    if (c.exact) refuse("--exact", "given", why);
  }
  if (!asks(o, "signatures") && !o.matches.empty()) {
    refuse("--matches", o.matches, "used with --method signatures only");
  }
  if (o.leave_one_out && !o.model.empty()) {
    refuse("--model", o.model, "not used with --leave-one-out, which learns its own");
  }
  if (o.leave_one_out && o.logs.logs.size() < 2) {
    refuse("--leave-one-out", "1 log", "two logs or more: the others are learnt from");
  }
  if (o.no_verification && !o.matches.empty()) {
    refuse("--matches", o.matches, "not used with --no-verification");
  }
}

Candidates candidatesOf(const Options& o, const std::string& method, const PlaceLog& log,
                        const std::optional<SignatureModel>& own) {
  if (method == "signatures" || method == "chains") {
    return bySignatures(o.candidates, log, own ? *own : SignatureModel::shipped(),
                        method == "chains" ? kChainLength : 0);
  }
  if (method.rfind("words", 0) == 0) return byWords(o.candidates, log, method);
  return byContexts(o.candidates, log, method == "context-scan");
}

/// The model that a log is asked with; nothing: the shipped one.
std::optional<SignatureModel> modelFor(const Options& o, std::size_t log,
                                       std::vector<std::vector<SignatureExample>> ways) {
  if (o.leave_one_out) {
    ways.erase(ways.begin() + static_cast<std::ptrdiff_t>(log));
    return trainSignatures(ways);
  }
  if (o.model.empty()) return std::nullopt;
  return SignatureModel::load(o.model);
}

nlohmann::json run(const Options& o) {
  check(o);
  const std::vector<PlaceLog> logs = o.logs.read();
  std::vector<std::vector<SignatureExample>> ways;
  if (o.leave_one_out) {
    for (const PlaceLog& log : logs) ways.push_back(examplesOf(log));
  }
  std::ostringstream rows;
  rows << "log,newer,older,rank,likelihood,score,inliers,overlap,new_fit,old_fit,rival,"
          "support,contradiction,probability,verified,told,right\n";
  nlohmann::json j = nlohmann::json::array();
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const std::optional<SignatureModel> own = modelFor(o, i, ways);
    for (const std::string& method : o.methods) {
      const double begin = cpuSeconds();
      const Candidates all = candidatesOf(o, method, logs[i], own);
      const double retrieval = cpuSeconds() - begin;
      const std::size_t verified =
          o.no_verification ? 0 : static_cast<std::size_t>(o.candidates.candidates);
      // A context tells of one place only, and not which way the robot went.
      const int reach = method.rfind("context", 0) == 0 ? 0 : kPairs;
      const bool wants_rows = method == "signatures" && !o.matches.empty();
      Figures f = figuresOf(logs[i], all, reach, verified, wants_rows ? &rows : nullptr);
      f.retrieval_s = retrieval;
      j.push_back(f.json(logs[i].name, method));
      std::cout << j.back().dump() << std::endl;
    }
    if (o.matches.empty()) continue;
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
      "share of revisits with a right match that is believed as in SLAM. A match is wrong if its "
      "pose is more than 1 m or 20 "
      "degrees off; a pair of places that a match lays over each other if they are more than 2 m "
      "apart.",
      "evaluate_places");
  Options o;
  o.logs.addTo(app);
  app.add_option(
         "--method", o.methods,
         "signatures; chains (of 12 m, see chain_length); or peers: context-scan, context-submap "
         "(Scan Context, Kim and Kim, "
         "IROS 2018), words (as SLAM makes them), words-thesis, words-thesis-wide (t_o = 3, "
         "size tolerance 30 %); several, by commas, are asked the same")
      ->delimiter(',')
      ->check(CLI::IsMember({"signatures", "chains", "context-scan", "context-submap", "words",
                             "words-thesis", "words-thesis-wide"}));
  app.add_option("--model", o.model, "file of another model of signatures");
  app.add_flag("--leave-one-out", o.leave_one_out, "learn a model for each log from the others");
  app.add_option("--candidates", o.candidates.candidates, "verified for each place");
  app.add_flag("--exact", o.candidates.exact, "compare with all places, without the index");
  app.add_flag("--no-verification", o.no_verification, "tell the candidates only");
  app.add_option("--matches", o.matches,
                 "each candidate of the signatures that the search of the scans found, as CSV");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
