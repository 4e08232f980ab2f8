// kidnapped_robot: a robot that is carried away again and again in a simulated building. The camera
// watches over the pose of the laser's localisation: how soon is it noticed, how often wrongly, and
// does the localisation find its way again?
#include <iostream>

#include "filmed_tour.hpp"
#include "fsd_localization/localizer.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/rasterise.hpp"
#include "selovis/recogniser.hpp"
#include "selovis/supervisor.hpp"
#include "selovis/topology.hpp"

namespace {

using namespace selovis;  // NOLINT: a program, not a header
using fsd_localization::Localizer;
using hyselam::Pose2;

struct Options {
  std::string plan = "office", descriptor = "GLANCE";
  int teleports = 20, unnamed = 0;
  double between = 15.0, hour = 13.0, rate = 5.0, reach = 1.0, patience = 3.0;
  std::vector<double> learn{9.0, 20.0};
  std::uint64_t seed = 1;
  SupervisorParams supervisor;
  bool without_camera = false;
};

/// From place to place at random; after some way the robot is carried to another place.
hyselam_sim::Route kidnapRoute(const hyselam_sim::FloorPlan& plan, const Options& o) {
  hyselam_sim::Route route =
      hyselam_sim::loadRoute(hyselam_sim::routeFile(o.plan));  // for its people
  route.start = bench::roundTrip(plan).start;
  route.steps.clear();
  hyselam::Rng rng(o.seed);
  const auto n = static_cast<std::uint32_t>(plan.places.size());
  std::uint32_t at = 0;
  const auto drive = [&] {
    for (double way = 0.0; way < o.between;) {
      const std::uint32_t to = (at + 1 + rng.below(n - 1)) % n;
      const auto &a = plan.places[at].at, &b = plan.places[to].at;
      way += 1.2 * std::hypot(a.x - b.x, a.y - b.y);
      hyselam_sim::RouteStep step;
      step.spot.place = plan.places[to].name;
      step.where = "leg";
      route.steps.push_back(step);
      at = to;
    }
  };
  drive();
  for (int i = 0; i < o.teleports; ++i) {
    at = (at + 1 + rng.below(n - 1)) % n;
    hyselam_sim::RouteStep step;
    step.kind = hyselam_sim::RouteStep::Kind::kTeleport;
    step.spot.place = plan.places[at].name;
    step.spot.heading = hyselam::radians(-180.0 + rng.below(360));
    step.where = "teleport";
    route.steps.push_back(step);
    drive();
  }
  return route;
}

/// The plan's places as a topological map with a grid; so many, drawn at random, without their
/// names.
hyselam_topo::AugmentedTopologicalMap topologyOf(const hyselam_sim::Scene& scene,
                                                 const Options& o) {
  hyselam_topo::AugmentedTopologicalMap map;
  hyselam_topo::PlaceGrid grid;
  grid.geometry = scene.regions().geometry();
  for (const auto& p : scene.plan().places) {
    hyselam_topo::Place place;
    place.id = static_cast<hyselam_topo::Id>(map.places.size() + 1);
    place.words.push_back({p.name, true});
    grid.places.push_back(place.id);
    map.places.push_back(place);
  }
  for (int row = 0; row < grid.geometry.height; ++row) {
    for (int col = 0; col < grid.geometry.width; ++col) {
      const double r = grid.geometry.resolution;
      const hyselam::Point2 p =
          grid.geometry.origin * hyselam::Point2{(col + 0.5) * r, (row + 0.5) * r};
      const int place = scene.regions().onFloor(p) ? scene.regions().placeAt(p) : -1;
      grid.labels.push_back(static_cast<std::uint16_t>(place + 1));
    }
  }
  map.grid = grid;
  hyselam::Rng rng(o.seed);
  const auto n = static_cast<std::uint32_t>(map.places.size());
  for (int left = std::min(o.unnamed, static_cast<int>(n)); left > 0;) {
    auto& words = map.places[rng.below(n)].words;
    left -= !words.empty();
    words.clear();
  }
  return map;
}

struct Teleport {
  double at = 0.0;
  double noticed = -1.0, lost = -1.0, found = -1.0;  // [s] after it; -1: not
};

/// The laser's localisation with its pose between updates.
class Laser {
 public:
  Laser(const hyselam::OccupancyGrid& map, const fsd_localization::LocalizerParams& params)
      : localizer_(map, params) {}

  /// Whether the filter ran.
  bool scan(const hyselam::LaserScan& scan, const Pose2& odom) {
    const auto result = localizer_.update(scan, odom);
    if (!result) return false;
    tracking_ = result->converged;
    lost_ = result->phase == fsd_localization::Phase::kLost;
    if (tracking_) odom_in_map_ = result->base_in_map * odom.inverse();
    return true;
  }
  bool tracking() const { return tracking_; }
  bool lost() const { return lost_; }
  Pose2 pose(const Pose2& odom) const { return odom_in_map_ * odom; }
  void startIn(const PlaceSpread& spread) {
    localizer_.setInitialPose(spread.mean, spread.stddev);
    tracking_ = lost_ = false;
  }
  void startAnywhere() {
    localizer_.relocalizeGlobally();
    tracking_ = lost_ = false;
  }

 private:
  Localizer localizer_;
  bool tracking_ = false, lost_ = false;
  Pose2 odom_in_map_;
};

double median(std::vector<double> v) {
  if (v.empty()) return -1.0;
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

nlohmann::json run(const Options& o) {
  hyselam_sim::FloorPlan plan = hyselam_sim::loadFloorPlan(hyselam_sim::planFile(o.plan));
  for (auto& door : plan.doors) {  // all rooms can be driven to
    door.initially_open = true;
    door.schedule.clear();
  }
  const hyselam_sim::Scene scene(plan);
  const auto map = topologyOf(scene, o);
  if (o.learn.size() != 2) {
    throw hyselam::InputError("command line", "--learn", "needs two hours");
  }
  Model model;
  {
    hyselam::Progress progress("learning", 2);
    hyselam_sim::Route tour = bench::roundTrip(plan);
    tour.steps.resize(plan.places.size() - 1);  // without the way back
    std::vector<bench::FilmedTour> tours;
    tours.push_back(bench::filmTour(scene, tour, 101, bench::filmParams(o.learn[0], 1.0), false));
    progress.update(1);
    tours.push_back(bench::filmTour(scene, bench::reversed(tour), 102,
                                    bench::filmParams(o.learn[1], 1.0), false));
    TrainingOptions t;
    t.descriptor = o.descriptor;
    t.classifier.kernel = Kernel::kExemplar;
    t.views = exemplarViews();
    model = bench::trainOn(tours, plan.places, t);
  }
  const hyselam_sim::Route route = kidnapRoute(plan, o);
  const hyselam_sim::Simulation run = hyselam_sim::simulate(plan, route, o.seed);
  fsd_localization::LocalizerParams laser_params;
  laser_params.seed = o.seed;
  Laser laser(hyselam_sim::rasterise(plan, {}), laser_params);
  RecogniserParams recogniser_params;
  recogniser_params.filter.kind = FilterKind::kBayes;
  Recogniser recogniser(model, model.graph, recogniser_params);
  Supervisor supervisor(model.graph, o.supervisor);

  std::vector<Teleport> teleports;
  for (const double stamp : run.teleport_stamps) teleports.push_back({stamp, -1.0, -1.0, -1.0});
  std::size_t scan = 0, next = 0;
  bool set = false, to_act = false, good = false;
  double alarm_at = 0.0, judged_seconds = 0.0, right_seconds = 0.0, seconds = 0.0;
  int false_alarms = 0, alarms = 0, in_place = 0, everywhere = 0, frames = 0, frame_right = 0;
  nlohmann::json wrong_alarms = nlohmann::json::array();
  const auto tell = [&](std::size_t i) {
    const Teleport& t = teleports[i];
    std::cout << "teleport " << i + 1 << ": noticed after " << t.noticed << " s, found after "
              << t.found << " s; false alarms so far: " << false_alarms << " in " << right_seconds
              << " s" << std::endl;
  };
  const auto catchUp = [&](double stamp) {
    for (; scan < run.log.scans.size() && run.log.scans[scan].stamp <= stamp + 1e-6; ++scan) {
      const auto& s = run.log.scans[scan];
      while (next < teleports.size() && teleports[next].at <= s.stamp + 1e-6) {
        if (next > 0) tell(next - 1);
        ++next;
        good = false;
      }
      const auto odom = hyselam::poseAt(run.log.odometry, s.stamp, 0.1);
      const auto truth = hyselam::poseAt(run.log.ground_truth, s.stamp, 0.1);
      if (!odom || !truth) continue;
      if (laser.scan(s, *odom) && set && laser.tracking()) {
        set = false;  // found again: the new pose is judged
        supervisor.reset();
      }
      const Pose2 pose = laser.pose(*odom);
      good = laser.tracking() && hyselam::distance(pose, *truth) < 0.5 &&
             std::abs(hyselam::normalizeAngle(pose.theta - truth->theta)) < hyselam::radians(15.0);
      if (next > 0) {
        Teleport& t = teleports[next - 1];
        if (laser.lost() && t.lost < 0.0) t.lost = s.stamp - t.at;
        if (good && t.found < 0.0) t.found = s.stamp - t.at;
        if (!good) t.found = -1.0;  // found means: and not lost again
      }
    }
  };
  hyselam_sim::FilmParams film = bench::filmParams(o.hour, o.rate);
  film.start_time = run.log.ground_truth.front().stamp;
  hyselam::Progress progress("driving", hyselam_sim::filmLength(run.log, film));
  double last_stamp = film.start_time;
  hyselam_sim::film(
      scene, run.log, route.people, o.seed, film, [&](const hyselam_sim::FilmFrame& f) {
        progress.update(static_cast<std::size_t>(++frames));
        catchUp(f.stamp);
        const double dt = f.stamp - last_stamp;
        last_stamp = f.stamp;
        seconds += dt;
        right_seconds += good ? dt : 0.0;
        const auto odom = hyselam::poseAt(run.log.odometry, f.stamp, 0.1);
        if (!odom) return;
        if (o.without_camera) return;
        recogniser.update(f.picture.colour);
        const int truth =
            f.place < 0 ? -1
                        : model.graph.find(plan.places[static_cast<std::size_t>(f.place)].name);
        const auto& p = recogniser.frameProbabilities();
        frame_right += std::max_element(p.begin(), p.end()) - p.begin() == truth;
        ExpectedPlaces expected;
        if (laser.tracking() && !set) {
          const Pose2 pose = laser.pose(*odom);
          expected = expectedPlaces(map, model.graph, {pose.x, pose.y}, o.reach);
        }
        const Supervision s = supervisor.update(p, expected.agree, expected.unmapped);
        judged_seconds += s.judged ? dt : 0.0;
        if (s.alarm) {
          ++alarms;
          alarm_at = f.stamp;
          to_act = true;
          if (good) {
            ++false_alarms;
            wrong_alarms.push_back({{"stamp", f.stamp}, {"x", f.base.x}, {"y", f.base.y}});
          } else if (next > 0 && teleports[next - 1].noticed < 0.0) {
            teleports[next - 1].noticed = f.stamp - teleports[next - 1].at;
          }
        }
        if (to_act && s.kidnapped) {
          if (s.place >= 0) {
            laser.startIn(*spreadOf(map, model.graph.places[static_cast<std::size_t>(s.place)]));
            ++in_place;
          } else if (f.stamp - alarm_at >= o.patience) {
            laser.startAnywhere();
            ++everywhere;
          } else {
            return;
          }
          to_act = false;
          set = true;
        }
      });
  catchUp(1e18);
  if (!teleports.empty()) tell(teleports.size() - 1);
  nlohmann::json list = nlohmann::json::array();
  std::vector<double> noticed, found;
  int lost_first = 0;
  for (const auto& t : teleports) {
    list.push_back({{"noticed_s", t.noticed}, {"laser_lost_s", t.lost}, {"found_s", t.found}});
    if (t.noticed >= 0.0) noticed.push_back(t.noticed);
    if (t.found >= 0.0) found.push_back(t.found);
    lost_first += t.lost >= 0.0 && (t.noticed < 0.0 || t.lost < t.noticed);
  }
  // Those that were never noticed count as later than any.
  std::vector<double> all = noticed;
  all.resize(teleports.size(), 1e9);
  const nlohmann::json result = {
      {"plan", o.plan},
      {"teleports", teleports.size()},
      {"noticed", noticed.size()},
      {"noticed_median_s", median(all)},
      {"laser_first", lost_first},
      {"found", found.size()},
      {"found_median_s", median(found)},
      {"alarms", alarms},
      {"false_alarms", false_alarms},
      {"false_alarms_per_hour", false_alarms / std::max(1e-9, right_seconds / 3600.0)},
      {"driven_s", seconds},
      {"pose_right_s", right_seconds},
      {"judged_s", judged_seconds},
      {"started_in_place", in_place},
      {"started_everywhere", everywhere},
      {"frames", frames},
      {"frame_accuracy", frame_right / std::max(1.0, static_cast<double>(frames))},
      {"places", model.graph.places.size()},
      {"wrong_alarms", wrong_alarms},
      {"each", list}};
  std::cout << noticed.size() << " of " << teleports.size() << " teleports noticed, median "
            << median(all) << " s; pose found again in " << found.size() << "; " << false_alarms
            << " false alarms in " << right_seconds << " s\n";
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Carries a simulated robot away again and again; tells how soon the camera notices, how "
      "often "
      "wrongly, and whether the laser's localisation finds the pose again.",
      "kidnapped_robot"};
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("--plan", o.plan, "plan that hyselam_sim comes with");
  app.add_option("--descriptor", o.descriptor, "name");
  app.add_option("--teleports", o.teleports, "how often")->check(CLI::NonNegativeNumber);
  app.add_option("--unnamed", o.unnamed, "places that are learnt and have no name on the map")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--between", o.between, "way driven between them [m]");
  app.add_option("--hour", o.hour, "of the day");
  app.add_option("--learn", o.learn, "two hours of the day")->delimiter(',');
  app.add_option("--rate", o.rate, "pictures per second");
  app.add_option("--reach", o.reach, "places so near to the pose are as good as its own [m]");
  app.add_option("--threshold", o.supervisor.threshold, "of the evidence [nats]");
  app.add_option("--trust", o.supervisor.trust, "exponent of a frame's likelihoods");
  app.add_option("--seed", o.seed, "of route, run and pictures");
  app.add_flag("--without-camera", o.without_camera, "the laser's localisation alone");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
