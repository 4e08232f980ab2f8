// icp_places: the questions of evaluate_places, answered by ICP over the points of places as the
// thesis compares with (Maffei 2017, 4.3.2).
#include <deque>
#include <iostream>

#include "../src/tools/place_figures.hpp"
#include "hyselam_common/tool.hpp"
#include "peers/icp_distance.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header
namespace peers = ngram_slam_peers;

/// The points of the places that are asked for, one each 2 m; of the others none.
std::vector<peers::Cloud::Ptr> cloudsOf(const PlaceLog& log) {
  const peers::StationParams params;
  std::vector<peers::Cloud::Ptr> clouds;
  std::deque<peers::Seen> recent;
  std::size_t next = 0;
  double way = 0.0;
  for (std::size_t i = 0; i < log.places.size(); i += kQuestionInterval) {
    const PlaceOnWay& at = log.places[i].on_way;
    for (; next <= static_cast<std::size_t>(at.keyframe); ++next) {
      const SlamKeyframe& k = log.keyframes[next];
      if (!recent.empty()) way += distance(recent.back().pose, k.pose);
      recent.push_back({way, k.pose, k.scan.get()});
    }
    while (way - recent.front().way > params.memory) recent.pop_front();
    clouds.push_back(peers::cloudOf(peers::pointsAround(at.pose, recent, params)));
  }
  return clouds;
}

Candidates byIcp(const CandidateOptions& o, const PlaceLog& log) {
  const std::vector<peers::Cloud::Ptr> clouds = cloudsOf(log);
  peers::IcpDistance distance;
  Candidates all;
  hyselam::Progress progress("ICP in " + log.name, clouds.size());
  for (std::size_t q = 0; q < clouds.size(); ++q) {
    progress.update(q + 1);
    const auto newer = static_cast<std::uint32_t>(q) * kQuestionInterval;
    std::vector<PlaceCandidate> found;
    for (std::uint32_t older = 0; older + kPlaceSeparation <= newer; older += kQuestionInterval) {
      if (!odometryAllows(log, newer, older)) continue;
      const double apart = distance(clouds[q], clouds[older / kQuestionInterval]);
      if (std::isfinite(apart)) found.push_back({newer, older, Direction::kSame, -apart});
    }
    all.push_back(spaced(std::move(found), o.told()));
  }
  return all;
}

nlohmann::json run(const PlaceLogOptions& logs, const CandidateOptions& o, bool verify) {
  nlohmann::json j = nlohmann::json::array();
  for (const PlaceLog& log : logs.read()) {
    const double begin = cpuSeconds();
    const Candidates all = byIcp(o, log);
    const double retrieval = cpuSeconds() - begin;
    const std::size_t verified = verify ? static_cast<std::size_t>(o.candidates) : 0;
    Figures f = figuresOf(log, all, 0, verified, nullptr);
    f.retrieval_s = retrieval;
    j.push_back(f.json(log.name, "icp"));
    std::cout << j.back().dump() << std::endl;
  }
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Asks what evaluate_places asks, and answers by ICP: 150 points within 4 m of each place, "
      "compared with those of all earlier places 2 m apart, from equal headings.",
      "icp_places");
  PlaceLogOptions logs;
  CandidateOptions candidates;
  bool verify = false;
  logs.addTo(app);
  app.add_flag("--verify", verify, "verify the best eight by the scans as well");
  return hyselam::runTool(argc, argv, app, [&] { return run(logs, candidates, verify); });
}
