// kidnapped_robot: a robot that is teleported again and again in a simulated building. The camera
// tests the pose of the laser's localization: how soon is a teleport noticed, how often are there
// false alarms, and does the localization find the pose again?
#include <algorithm>
#include <iostream>

#include "filmed_tour.hpp"
#include "fsd_localization/localizer.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "selovis/places/topological_places.hpp"
#include "selovis/recognition/image_recognizer.hpp"
#include "selovis/recognition/kidnapping_detector.hpp"

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
  KidnappingDetectorParams detector;
  bool without_camera = false;
};

/// From place to place at random; after some distance the robot is teleported to another place.
hyselam_sim::Route kidnapRoute(const hyselam_sim::FloorPlan& plan, const Options& o) {
  hyselam_sim::Route route =
      hyselam_sim::loadRoute(hyselam_sim::routeFile(o.plan));  // for its people
  route.start = bench::roundTrip(plan).start;
  route.steps.clear();
  hyselam::Rng rng(o.seed);
  const auto n = static_cast<std::uint32_t>(plan.places.size());
  std::uint32_t at = 0;
  const auto drive = [&] {
    for (double length = 0.0; length < o.between;) {
      const std::uint32_t to = (at + 1 + rng.below(n - 1)) % n;
      const auto &a = plan.places[at].at, &b = plan.places[to].at;
      length += 1.2 * std::hypot(a.x - b.x, a.y - b.y);
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
  void startIn(const PlacePosePrior& spread) {
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

PlaceModel learnPlan(const hyselam_sim::Scene& scene, const hyselam_sim::FloorPlan& plan,
                     const Options& o) {
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
  t.classifier.kernel = SvmKernel::kExemplar;
  t.views = exemplarViews();
  return bench::trainOn(tours, plan.places, t);
}

ImageRecognizerParams recognizerParams() {
  ImageRecognizerParams params;
  params.filter.kind = PlaceFilterKind::kBayes;
  return params;
}

fsd_localization::LocalizerParams laserParams(const Options& o) {
  fsd_localization::LocalizerParams params;
  params.seed = o.seed;
  return params;
}

struct Totals {
  double tested_seconds = 0.0, right_seconds = 0.0, seconds = 0.0;
  int false_alarms = 0, alarms = 0, started_in_place = 0, started_everywhere = 0;
  int frames = 0, frames_right = 0;
  nlohmann::json wrong_alarms = nlohmann::json::array();
};

/// The drive with its teleports: the laser localizes, the camera tests the pose.
class Experiment {
 public:
  Experiment(const hyselam_sim::FloorPlan& plan, const hyselam_sim::Scene& scene,
             const PlaceModel& model, const Options& o)
      : o_(o),
        plan_(plan),
        scene_(scene),
        model_(model),
        map_(topologyOf(scene, o)),
        route_(kidnapRoute(plan, o)),
        run_(hyselam_sim::simulate(plan, route_, o.seed)),
        laser_(hyselam_sim::rasterize(plan, {}), laserParams(o)),
        recognizer_(model, model.transitions, recognizerParams()),
        detector_(model.transitions, o.detector) {
    for (const double stamp : run_.teleport_stamps) {
      teleports_.push_back({stamp, -1.0, -1.0, -1.0});
    }
  }

  nlohmann::json run() {
    hyselam_sim::FilmParams film = bench::filmParams(o_.hour, o_.rate);
    film.start_time = last_stamp_ = run_.log.ground_truth.front().stamp;
    hyselam::Progress progress("driving", hyselam_sim::filmLength(run_.log, film));
    hyselam_sim::film(scene_, run_.log, route_.people, o_.seed, film,
                      [&](const hyselam_sim::FilmFrame& f) {
                        progress.update(static_cast<std::size_t>(++totals_.frames));
                        addFrame(f);
                      });
    addScansUntil(1e18);
    if (!teleports_.empty()) print(teleports_.size() - 1);
    return result();
  }

 private:
  void print(std::size_t i) const {
    const Teleport& t = teleports_[i];
    std::cout << "teleport " << i + 1 << ": noticed after " << t.noticed << " s, found after "
              << t.found << " s; false alarms so far: " << totals_.false_alarms << " in "
              << totals_.right_seconds << " s" << std::endl;
  }

  void addScansUntil(double stamp) {
    const auto& scans = run_.log.scans;
    for (; scan_ < scans.size() && scans[scan_].stamp <= stamp + 1e-6; ++scan_) {
      const auto& s = scans[scan_];
      while (next_ < teleports_.size() && teleports_[next_].at <= s.stamp + 1e-6) {
        if (next_ > 0) print(next_ - 1);
        ++next_;
        pose_right_ = false;
      }
      const auto odom = hyselam::poseAt(run_.log.odometry, s.stamp, 0.1);
      const auto truth = hyselam::poseAt(run_.log.ground_truth, s.stamp, 0.1);
      if (odom && truth) addScan(s, *odom, *truth);
    }
  }

  void addScan(const hyselam::LaserScan& scan, const Pose2& odom, const Pose2& truth) {
    if (laser_.scan(scan, odom) && restarted_ && laser_.tracking()) {
      restarted_ = false;  // found again: the new pose is tested
      detector_.reset();
    }
    const Pose2 pose = laser_.pose(odom);
    pose_right_ =
        laser_.tracking() && hyselam::distance(pose, truth) < 0.5 &&
        std::abs(hyselam::normalizeAngle(pose.theta - truth.theta)) < hyselam::radians(15.0);
    if (next_ == 0) return;
    Teleport& t = teleports_[next_ - 1];
    if (laser_.lost() && t.lost < 0.0) t.lost = scan.stamp - t.at;
    if (pose_right_ && t.found < 0.0) t.found = scan.stamp - t.at;
    if (!pose_right_) t.found = -1.0;  // found means: and not lost again
  }

  void addFrame(const hyselam_sim::FilmFrame& f) {
    addScansUntil(f.stamp);
    const double dt = f.stamp - last_stamp_;
    last_stamp_ = f.stamp;
    totals_.seconds += dt;
    totals_.right_seconds += pose_right_ ? dt : 0.0;
    const auto odom = hyselam::poseAt(run_.log.odometry, f.stamp, 0.1);
    if (!odom || o_.without_camera) return;
    recognizer_.update(f.picture.color);
    const int truth =
        f.place < 0
            ? -1
            : model_.transitions.indexOf(plan_.places[static_cast<std::size_t>(f.place)].name);
    const auto& p = recognizer_.frameProbabilities();
    totals_.frames_right += std::max_element(p.begin(), p.end()) - p.begin() == truth;
    ExpectedPlaces expected;
    if (laser_.tracking() && !restarted_) {
      const Pose2 pose = laser_.pose(*odom);
      expected = expectedPlaces(map_, model_.transitions, {pose.x, pose.y}, o_.reach);
    }
    const KidnappingState state = detector_.update(p, expected.agreeing, expected.unmapped);
    totals_.tested_seconds += state.tested ? dt : 0.0;
    if (state.alarm) countAlarm(f);
    if (pending_ && state.kidnapped) relocalize(state, f.stamp);
  }

  void countAlarm(const hyselam_sim::FilmFrame& f) {
    ++totals_.alarms;
    alarm_at_ = f.stamp;
    pending_ = true;
    if (pose_right_) {
      ++totals_.false_alarms;
      totals_.wrong_alarms.push_back({{"stamp", f.stamp}, {"x", f.base.x}, {"y", f.base.y}});
    } else if (next_ > 0 && teleports_[next_ - 1].noticed < 0.0) {
      teleports_[next_ - 1].noticed = f.stamp - teleports_[next_ - 1].at;
    }
  }

  void relocalize(const KidnappingState& state, double stamp) {
    if (state.place >= 0) {
      laser_.startIn(
          *posePriorOf(map_, model_.transitions.places[static_cast<std::size_t>(state.place)]));
      ++totals_.started_in_place;
    } else if (stamp - alarm_at_ >= o_.patience) {
      laser_.startAnywhere();
      ++totals_.started_everywhere;
    } else {
      return;
    }
    pending_ = false;
    restarted_ = true;
  }

  nlohmann::json result() const {
    nlohmann::json list = nlohmann::json::array();
    std::vector<double> noticed, found;
    int lost_first = 0;
    for (const auto& t : teleports_) {
      list.push_back({{"noticed_s", t.noticed}, {"laser_lost_s", t.lost}, {"found_s", t.found}});
      if (t.noticed >= 0.0) noticed.push_back(t.noticed);
      if (t.found >= 0.0) found.push_back(t.found);
      lost_first += t.lost >= 0.0 && (t.noticed < 0.0 || t.lost < t.noticed);
    }
    // Those that were never noticed count as later than any.
    std::vector<double> all = noticed;
    all.resize(teleports_.size(), 1e9);
    std::cout << noticed.size() << " of " << teleports_.size() << " teleports noticed, median "
              << median(all) << " s; pose found again in " << found.size() << "; "
              << totals_.false_alarms << " false alarms in " << totals_.right_seconds << " s\n";
    return {{"plan", o_.plan},
            {"teleports", teleports_.size()},
            {"noticed", noticed.size()},
            {"noticed_median_s", median(all)},
            {"laser_first", lost_first},
            {"found", found.size()},
            {"found_median_s", median(found)},
            {"alarms", totals_.alarms},
            {"false_alarms", totals_.false_alarms},
            {"false_alarms_per_hour",
             totals_.false_alarms / std::max(1e-9, totals_.right_seconds / 3600.0)},
            {"driven_s", totals_.seconds},
            {"pose_right_s", totals_.right_seconds},
            {"judged_s", totals_.tested_seconds},
            {"started_in_place", totals_.started_in_place},
            {"started_everywhere", totals_.started_everywhere},
            {"frames", totals_.frames},
            {"frame_accuracy",
             totals_.frames_right / std::max(1.0, static_cast<double>(totals_.frames))},
            {"places", model_.transitions.places.size()},
            {"wrong_alarms", totals_.wrong_alarms},
            {"each", list}};
  }

  const Options& o_;
  const hyselam_sim::FloorPlan& plan_;
  const hyselam_sim::Scene& scene_;
  const PlaceModel& model_;
  hyselam_topo::AugmentedTopologicalMap map_;
  hyselam_sim::Route route_;
  hyselam_sim::Simulation run_;
  Laser laser_;
  ImageRecognizer recognizer_;
  KidnappingDetector detector_;
  std::vector<Teleport> teleports_;
  std::size_t scan_ = 0, next_ = 0;  // of the scans and teleports
  // The localization was started again and has not converged; it is still to be started again.
  bool restarted_ = false, pending_ = false;
  bool pose_right_ = false;
  double last_stamp_ = 0.0, alarm_at_ = 0.0;
  Totals totals_;
};

nlohmann::json run(const Options& o) {
  if (o.learn.size() != 2) {
    throw hyselam::InputError("command line", "--learn", "needs two hours");
  }
  hyselam_sim::FloorPlan plan = hyselam_sim::loadFloorPlan(hyselam_sim::planFile(o.plan));
  for (auto& door : plan.doors) {  // all rooms can be driven to
    door.initially_open = true;
    door.schedule.clear();
  }
  const hyselam_sim::Scene scene(plan);
  const PlaceModel model = learnPlan(scene, plan, o);
  return Experiment(plan, scene, model, o).run();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Teleports a simulated robot again and again; measures how soon the camera notices, how many "
      "alarms are false, and whether the laser's localization finds the pose again.",
      "kidnapped_robot"};
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("--plan", o.plan, "plan that hyselam_sim comes with");
  app.add_option("--descriptor", o.descriptor, "name");
  app.add_option("--teleports", o.teleports, "how often")->check(CLI::NonNegativeNumber);
  app.add_option("--unnamed", o.unnamed, "learned places without a name on the map")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--between", o.between, "distance driven between them [m]");
  app.add_option("--hour", o.hour, "of the day");
  app.add_option("--learn", o.learn, "two hours of the day")->delimiter(',');
  app.add_option("--rate", o.rate, "pictures per second");
  app.add_option("--reach", o.reach, "places so near to the pose agree with it [m]");
  app.add_option("--threshold", o.detector.threshold, "of the evidence [nats]");
  app.add_option("--trust", o.detector.likelihood_exponent, "likelihood exponent of a frame");
  app.add_option("--seed", o.seed, "of route, run and pictures");
  app.add_flag("--without-camera", o.without_camera, "the laser's localisation alone");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
