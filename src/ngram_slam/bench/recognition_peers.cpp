// recognition_peers: the same logs, the same truth, but single places compared instead of words.
#include <algorithm>
#include <chrono>
#include <functional>
#include <iostream>
#include <memory>
#include <numeric>

#include "../src/tools/reference_poses.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "ngram_slam/matching/recognition_score.hpp"
#include "peers/icp_distance.hpp"
#include "peers/polar_context.hpp"

namespace {

using namespace ngram_slam_peers;  // NOLINT: a program, not a header
using ngram_slam::Direction;
using ngram_slam::RecognitionFigures;
using ngram_slam::RecognitionScore;
using ngram_slam::RecognitionTruth;

struct Options {
  std::vector<std::string> logs;
  ngram_slam::ReferenceFiles references;
  std::string method = "icp";
  StationParams stations;
  int queries = 150;
};

struct Compared {
  double distance;
  std::uint32_t query, older;
};

nlohmann::json run(const Options& o) {
  o.references.check(o.logs.size());
  if (o.queries < 1) throw hyselam::ParameterError("--queries", o.queries, ">= 1");
  if (!(o.stations.stride > 0.0)) {
    throw hyselam::ParameterError("--stride", o.stations.stride, "> 0 [m]");
  }
  std::vector<Station> stations;
  std::vector<std::optional<hyselam::Pose2>> poses;
  std::vector<std::uint32_t> runs;
  for (std::size_t i = 0; i < o.logs.size(); ++i) {
    const hyselam::RobotLog log = hyselam::readRobotLog(o.logs[i]);
    const auto reference = o.references.of(i, log);
    for (Station& station : stationsOf(log, o.stations)) {
      poses.push_back(hyselam::poseAt(reference, station.stamp, 0.5));
      runs.push_back(static_cast<std::uint32_t>(i));
      stations.push_back(std::move(station));
    }
  }
  ngram_slam::ScoreParams params;  // 10 m and 2 m of way, as for observations every 0.1 m
  params.separation = static_cast<std::uint32_t>(std::ceil(10.0 / o.stations.stride));
  params.pass_gap = static_cast<std::uint32_t>(std::ceil(2.0 / o.stations.stride)) + 1;
  const auto truth = std::make_shared<const RecognitionTruth>(poses, runs, params);

  std::function<double(std::uint32_t, std::uint32_t)> distance;
  std::vector<Cloud::Ptr> clouds;
  std::vector<PolarContext> contexts;
  IcpDistance icp;
  if (o.method == "icp") {
    for (const Station& s : stations) clouds.push_back(cloudOf(s.points));
    distance = [&](std::uint32_t a, std::uint32_t b) { return icp(clouds[a], clouds[b]); };
  } else {
    for (const Station& s : stations)
      contexts.push_back(contextOf(returnsOf(s.scan), kContextRange));
    distance = [&](std::uint32_t a, std::uint32_t b) {
      return contextDistance(contexts[a], contexts[b]);
    };
  }

  std::vector<std::uint32_t> queries;
  const auto n = static_cast<std::uint32_t>(stations.size());
  const std::uint32_t step = std::max<std::uint32_t>(1, n / static_cast<std::uint32_t>(o.queries));
  for (std::uint32_t i = step / 2; i < n; i += step) queries.push_back(i);
  std::vector<Compared> all;
  hyselam::Progress progress(o.method, queries.size());
  const std::clock_t begin = std::clock();
  for (std::size_t k = 0; k < queries.size(); ++k) {
    const std::uint32_t query = queries[k];
    for (std::uint32_t older = 0; older < query; ++older) {
      if (!truth->isTrue(query, older, Direction::kSame)) continue;
      all.push_back({distance(query, older), query, older});
    }
    progress.update(k + 1);
  }
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::sort(all.begin(), all.end(), [](const Compared& a, const Compared& b) {
    return std::tie(a.distance, a.query, a.older) < std::tie(b.distance, b.query, b.older);
  });

  // Of the queries only.
  RecognitionScore score(truth);
  const auto figures = [&] {
    RecognitionFigures f;
    for (const std::uint32_t q : queries) {
      const RecognitionFigures before = score.figures(q), with = score.figures(q + 1);
      f.pairs += with.pairs - before.pairs;
      f.true_pairs += with.true_pairs - before.true_pairs;
      f.revisits += with.revisits - before.revisits;
      f.recognized += with.recognized - before.recognized;
      f.passes += with.passes - before.passes;
      f.recognized_passes += with.recognized_passes - before.recognized_passes;
    }
    return f;
  };
  nlohmann::json curve = nlohmann::json::array();
  std::size_t due = 1;
  for (std::size_t i = 0; i < all.size(); ++i) {
    score.add(all[i].query, all[i].older);
    if (i + 1 < due && i + 1 < all.size()) continue;
    due = std::max(due + 1, static_cast<std::size_t>(static_cast<double>(due) * 1.05));
    const RecognitionFigures f = figures();
    curve.push_back({{"threshold", all[i].distance},
                     {"precision", f.precision()},
                     {"recall", f.recall()},
                     {"pass_recall", f.passRecall()}});
  }
  const auto comparisons = static_cast<double>(std::max<std::size_t>(1, all.size()));
  return {{"method", o.method},
          {"stations", n},
          {"queries", queries.size()},
          {"comparisons", all.size()},
          {"ms_per_query", 1e3 * seconds / static_cast<double>(queries.size())},
          {"comparisons_per_100_ms", 0.1 * comparisons / std::max(1e-9, seconds)},
          {"curve", curve}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares places of recorded runs one by one, as a peer of words.",
               "recognition_peers");
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("logs", o.logs, "bags or CARMEN logs, one run each")->required();
  o.references.addTo(app);
  app.add_option("--method", o.method, "icp or context")->check(CLI::IsMember({"icp", "context"}));
  app.add_option("--stride", o.stations.stride, "way between places [m]");
  app.add_option("--radius", o.stations.radius, "of the local map [m]");
  app.add_option("--points", o.stations.points, "of a place, for icp");
  app.add_option("--queries", o.queries, "places that are looked up, evenly spread");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
