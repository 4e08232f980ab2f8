// search_limit: how many metres of scans tell a place, by exhaustive search of the whole map. One
// record per start and length; the judge of the localiser is fitted to them.
#include <algorithm>
#include <ctime>
#include <iostream>

#include "fsd_localization/search/place_search.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/ros/bag_tool.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "hyselam_scan_matching/scan_odometry.hpp"
#include "log_moments.hpp"

namespace {

using namespace fsd_localization;  // NOLINT: a program, not a header
using hyselam::Pose2;

struct Options {
  std::string map, log, reference;
  std::size_t starts = 20;
  double from = 0.0, right_m = 0.5, right_deg = 15.0;
  std::vector<double> lengths{0.0, 1.0, 2.0, 5.0, 10.0};
  hyselam::BagOptions bag_options;
};

/// Whether the search finds the truth best, by how much, and how sure that looks from within.
nlohmann::json record(const PlaceSearch& search, const Submap& submap, const Pose2& truth,
                      const Options& o) {
  const std::clock_t cpu = std::clock();
  const std::vector<Place> places = search.search(submap);
  const double cpu_s = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  const Place right = search.refine(submap, truth);
  double rival = 0.0;
  for (const Place& p : places) {
    if (!isSamePlace(p.base, truth)) rival = std::max(rival, p.seen);
  }
  nlohmann::json j = {{"length", submap.length},
                      {"turned", submap.turned},
                      {"points", submap.points.size()},
                      {"views", submap.views.size()},
                      {"cpu_s", cpu_s},
                      {"truth", right.seen},
                      {"rival", rival},
                      {"places", places.size()},
                      {"best_right", false}};
  if (places.empty()) return j;
  const Place& best = places.front();
  j["best"] = best.seen;
  j["best_ends"] = best.ends;
  j["second"] = places.size() > 1 ? places[1].seen : 0.0;
  j["second_ends"] = places.size() > 1 ? places[1].ends : 0.0;
  j["near"] = std::count_if(places.begin(), places.end(),
                            [&](const Place& p) { return p.seen > best.seen - 0.05; });
  j["best_right"] = distance(best.base, truth) < o.right_m &&
                    std::abs(hyselam::normalizeAngle(best.base.theta - truth.theta)) <
                        hyselam::radians(o.right_deg);
  return j;
}

nlohmann::json run(const Options& o) {
  const hyselam::OccupancyGrid map = hyselam::loadMap(o.map);
  const hyselam::RobotLog log = hyselam::readRobotLog(o.log, o.bag_options);
  const auto truth = o.reference.empty() ? log.ground_truth : hyselam::readPoses(o.reference).poses;
  const std::vector<LogMoment> all = momentsOf(log, truth);
  if (all.empty()) throw hyselam::InputError(o.log, "", "no scan with odometry and a true pose");
  const std::clock_t cpu = std::clock();
  const PlaceSearch search(map);
  const double prepared_s = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  const double longest = *std::max_element(o.lengths.begin(), o.lengths.end());
  const double first = o.from * all.back().way;
  const double room = std::max(0.0, all.back().way - first - 1.2 * longest);
  nlohmann::json records = nlohmann::json::array();
  hyselam::Progress progress("searching", o.starts);
  for (std::size_t k = 0; k < o.starts; ++k) {
    const double at = first + room * static_cast<double>(k) /
                                  static_cast<double>(std::max<std::size_t>(1, o.starts - 1));
    auto i = static_cast<std::size_t>(
        std::find_if(all.begin(), all.end(), [&](const LogMoment& m) { return m.way >= at; }) -
        all.begin());
    hyselam_scan_matching::ScanOdometry odometry;
    SubmapBuilder submap;
    double travelled = 0.0;
    std::size_t next = 0;
    for (std::size_t begin = i; i < all.size() && next < o.lengths.size(); ++i) {
      if (i > begin) travelled += distance(all[i - 1].odometry, all[i].odometry);
      const auto step = odometry.add(*all[i].scan, all[i].odometry);
      if (step.broken) submap.reset();
      submap.add(*all[i].scan, step.pose);
      if (travelled < o.lengths[next]) continue;
      Pose2 in_grid = map.geometry.origin.inverse() * all[i].truth;
      nlohmann::json j = record(search, submap.build(), in_grid, o);
      j["start"] = k;
      j["wanted"] = o.lengths[next++];
      records.push_back(std::move(j));
    }
    progress.update(k + 1);
  }
  const nlohmann::json j = {
      {"prepared_s", prepared_s}, {"bytes", search.bytes()}, {"records", records}};
  std::cout << j.dump(1) << "\n";
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Searches whole maps for submaps of a log with true poses.", "search_limit");
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("--map", o.map, "map (map_server YAML)")->required();
  app.add_option("--bag", o.log, "bag or CARMEN log, plain or gzip")->required();
  hyselam::addBagOptions(app, &o.bag_options);
  app.add_option("--reference", o.reference,
                 "true poses (TUM, or a reference table); default: the bag's ground truth");
  app.add_option("--starts", o.starts, "places to start from, evenly over the way");
  app.add_option("--from", o.from, "share of the way that is left out at the beginning")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--lengths", o.lengths, "metres of scans, ascending")->delimiter(',');
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
