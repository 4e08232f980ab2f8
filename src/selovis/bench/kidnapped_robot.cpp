// kidnapped_robot: a robot that is teleported again and again in a simulated building. The camera
// tests the pose of the laser's localization: how soon is a teleport noticed, how often are there
// false alarms, and does the localization find the pose again?
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "filmed_tour.hpp"
#include "fsd_localization/localizer.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "kept_signatures.hpp"
#include "selovis/places/topological_places.hpp"
#include "selovis/recognition/image_recognizer.hpp"
#include "selovis/recognition/pose_supervisor.hpp"

namespace {

using namespace selovis;  // NOLINT: a program, not a header
using fsd_localization::Localizer;
using hyselam::Pose2;

struct Options {
  std::string plan = "office", descriptor = "FUSION-LEARNT", keep;
  int teleports = 20, unnamed = 0;
  double between = 15.0, hour = 13.0, reach = 1.0, patience = 3.0, clouds = 0.3;
  std::vector<double> learn{9.0, 20.0}, rates{5.0};
  std::uint64_t seed = 1, generate = 0, look = 1;
  PoseSupervisorParams supervisor;
  bool without_camera = false, without_scan = false, by_places = false;
};

constexpr double kLeastFilmed = 10.0;  // [s] of a film after a teleport

/// Wanted hours between false alarms that the evidence at right poses is held against.
const double kWantedHours[] = {0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 24.0};

struct Building {
  hyselam_sim::FloorPlan plan;
  hyselam_sim::Route people;  ///< a route, for those who walk there
};

Building buildingOf(const Options& o) {
  Building b;
  if (o.generate > 0) {
    hyselam_sim::PlanParams params;
    params.min_door = 0.9;  // wide enough for the robot
    b.plan = hyselam_sim::generatePlan(o.generate, params);
    b.people = bench::roundTrip(b.plan);
  } else {
    b.plan = hyselam_sim::loadFloorPlan(hyselam_sim::planFile(o.plan));
    b.people = hyselam_sim::loadRoute(hyselam_sim::routeFile(o.plan));
  }
  for (auto& door : b.plan.doors) {  // all rooms can be driven to
    door.initially_open = true;
    door.schedule.clear();
  }
  return b;
}

/// From place to place at random; after some distance the robot is teleported to another place.
hyselam_sim::Route kidnapRoute(const Building& building, const Options& o) {
  const hyselam_sim::FloorPlan& plan = building.plan;
  hyselam_sim::Route route = building.people;
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
  double rival_error = -1.0;  // [m] of the pose that the camera proposed; -1: none
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

hyselam_sim::FilmParams filmParamsOf(const Options& o, double hour, double rate) {
  hyselam_sim::FilmParams params = bench::filmParams(hour, rate);
  params.light.clouds = o.clouds;
  return params;
}

PlaceModel learnPlan(const hyselam_sim::Scene& scene, const hyselam_sim::FloorPlan& plan,
                     const Options& o) {
  hyselam::Progress progress("learning", 2);
  hyselam_sim::Route tour = bench::roundTrip(plan);
  tour.steps.resize(plan.places.size() - 1);  // without the way back
  std::vector<bench::FilmedTour> tours;
  tours.push_back(bench::filmTour(scene, tour, 101, filmParamsOf(o, o.learn[0], 1.0), false));
  progress.update(1);
  tours.push_back(
      bench::filmTour(scene, bench::reversed(tour), 102, filmParamsOf(o, o.learn[1], 1.0), false));
  TrainingOptions t;
  t.descriptor = o.descriptor;
  if (o.descriptor.compare(0, 6, "FUSION") != 0) t.classifier.kernel = SvmKernel::kExemplar;
  return bench::trainOn(tours, plan.places, t);
}

fsd_localization::LocalizerParams laserParams(const Options& o) {
  fsd_localization::LocalizerParams params;
  params.seed = o.seed;
  return params;
}

struct Totals {
  double tested_seconds = 0.0, right_seconds = 0.0, seconds = 0.0;
  int false_alarms = 0, alarms = 0, started_at_pose = 0, started_in_place = 0,
      started_everywhere = 0;
  int frames = 0, frames_right = 0;
  nlohmann::json wrong_alarms = nlohmann::json::array();
};

/// Alarms that other thresholds would have raised at right poses. One that was raised is over when
/// nothing speaks against the pose any more.
class OtherThresholds {
 public:
  explicit OtherThresholds(double correlation_time) {
    for (const double hours : kWantedHours) {
      levels_.push_back({hours, ViewTest::thresholdFor(hours, correlation_time)});
    }
  }
  void add(double evidence, double seconds) {
    seconds_ += seconds;
    for (Level& l : levels_) {
      if (evidence <= 0.0) l.armed = true;
      if (l.armed && evidence >= l.threshold) {
        ++l.alarms;
        l.armed = false;
      }
    }
  }
  /// What speaks against the pose now may still do so when it has just become right.
  void poseIsWrong() {
    for (Level& l : levels_) l.armed = false;
  }
  nlohmann::json result() const {
    nlohmann::json list = nlohmann::json::array();
    for (const Level& l : levels_) {
      list.push_back({{"wanted_hours", l.hours},
                      {"threshold", l.threshold},
                      {"alarms", l.alarms},
                      {"hours", seconds_ / 3600.0}});
    }
    return list;
  }

 private:
  struct Level {
    double hours, threshold;
    int alarms = 0;
    bool armed = true;
  };
  std::vector<Level> levels_;
  double seconds_ = 0.0;
};

/// What the camera says of one frame.
struct SeenFrame {
  double stamp = 0.0;
  Pose2 base;      // true
  int place = -1;  // true, of the plan
  const std::vector<double>* places = nullptr;
  const std::vector<float>* distances = nullptr;
};

/// The drive with its teleports at one rate of the camera: the laser localizes, the camera tests
/// the pose.
class Experiment {
 public:
  Experiment(const Building& building, const hyselam_topo::AugmentedTopologicalMap& map,
             const hyselam::OccupancyGrid& grid, std::shared_ptr<const ScanFit> fit,
             const hyselam_sim::Simulation& run, const PlaceModel& model, const Options& o,
             double rate)
      : o_(o),
        rate_(rate),
        plan_(building.plan),
        model_(model),
        map_(map),
        run_(run),
        laser_(grid, laserParams(o)),
        supervisor_(model, model.transitions, o.supervisor),
        others_(o.supervisor.views.correlation_time) {
    if (!o.without_scan) supervisor_.setMap(std::move(fit));
    for (const double stamp : run_.teleport_stamps) {
      teleports_.push_back({stamp, -1.0, -1.0, -1.0});
    }
    last_stamp_ = run_.log.ground_truth.front().stamp;
    next_frame_ = last_stamp_;
  }

  /// Frames that come faster than the rate are left out.
  void addFrame(const SeenFrame& f) {
    if (f.stamp < next_frame_ - 1e-6) return;
    next_frame_ += 1.0 / rate_;
    addScansUntil(f.stamp);
    const double dt = f.stamp - last_stamp_;
    last_stamp_ = f.stamp;
    totals_.seconds += dt;
    totals_.right_seconds += pose_right_ ? dt : 0.0;
    const auto odom = hyselam::poseAt(run_.log.odometry, f.stamp, 0.1);
    if (!odom || o_.without_camera) return;
    ++totals_.frames;
    const int truth =
        f.place < 0
            ? -1
            : model_.transitions.indexOf(plan_.places[static_cast<std::size_t>(f.place)].name);
    totals_.frames_right +=
        std::max_element(f.places->begin(), f.places->end()) - f.places->begin() == truth;
    const SupervisionState state = supervisor_.update(supervised(f, *odom, dt));
    totals_.tested_seconds += state.tested ? dt : 0.0;
    if (pose_right_) {
      others_.add(state.tested ? state.evidence : 0.0, dt);
    } else {
      others_.poseIsWrong();
    }
    if (state.alarm) countAlarm(f, state);
    if (pending_ && state.kidnapped) relocalize(state, f.stamp);
    if (!state.kidnapped) pending_ = false;
  }

  /// Teleports that the film shows too little of are not counted.
  nlohmann::json finish() {
    while (!teleports_.empty() && teleports_.back().at + kLeastFilmed > last_stamp_) {
      teleports_.pop_back();
    }
    return result();
  }

 private:
  SupervisedFrame supervised(const SeenFrame& f, const Pose2& odom, double dt) {
    SupervisedFrame frame;
    frame.places = f.places;
    if (!o_.by_places) frame.view.distances = f.distances;
    frame.view.seconds = dt;
    frame.view.camera_in_base = hyselam_sim::CameraParams().camera_in_base;
    frame.view.odometry = odom;
    if (scan_ > 0) {
      points_ = scanPoints(run_.log.scans[scan_ - 1]);
      frame.view.scan = &points_;
    }
    if (laser_.tracking() && !restarted_) {
      const Pose2 pose = laser_.pose(odom);
      frame.view.base = pose;
      frame.expected = expectedPlaces(map_, model_.transitions, {pose.x, pose.y}, o_.reach);
    }
    return frame;
  }

  void addScansUntil(double stamp) {
    const auto& scans = run_.log.scans;
    for (; scan_ < scans.size() && scans[scan_].stamp <= stamp + 1e-6; ++scan_) {
      const auto& s = scans[scan_];
      while (next_ < teleports_.size() && teleports_[next_].at <= s.stamp + 1e-6) {
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
      supervisor_.reset();
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

  void countAlarm(const SeenFrame& f, const SupervisionState& state) {
    ++totals_.alarms;
    alarm_at_ = f.stamp;
    pending_ = true;
    if (pose_right_) {
      ++totals_.false_alarms;
      totals_.wrong_alarms.push_back({{"stamp", f.stamp},
                                      {"x", f.base.x},
                                      {"y", f.base.y},
                                      {"heading", f.base.theta},
                                      {"coverage", state.coverage},
                                      {"place", state.place}});
    } else if (next_ > 0 && teleports_[next_ - 1].noticed < 0.0) {
      teleports_[next_ - 1].noticed = f.stamp - teleports_[next_ - 1].at;
      if (state.pose) {
        teleports_[next_ - 1].rival_error = hyselam::distance(state.pose->mean, f.base);
      }
    }
  }

  /// Of a place that is known, and has its name on the map.
  std::optional<PlacePosePrior> priorOf(int place) const {
    if (place < 0) return {};
    return posePriorOf(map_, model_.transitions.places[static_cast<std::size_t>(place)]);
  }

  void relocalize(const SupervisionState& state, double stamp) {
    if (state.pose) {
      laser_.startIn(*state.pose);
      ++totals_.started_at_pose;
    } else if (const auto prior = priorOf(state.place)) {
      laser_.startIn(*prior);
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
    std::vector<double> noticed, by_camera, found;
    for (const auto& t : teleports_) {
      list.push_back({{"noticed_s", t.noticed},
                      {"laser_lost_s", t.lost},
                      {"found_s", t.found},
                      {"rival_error_m", t.rival_error}});
      if (t.noticed >= 0.0) by_camera.push_back(t.noticed);
      if (t.noticed >= 0.0 || t.lost >= 0.0) {
        noticed.push_back(t.noticed < 0.0 || (t.lost >= 0.0 && t.lost < t.noticed) ? t.lost
                                                                                   : t.noticed);
      }
      if (t.found >= 0.0) found.push_back(t.found);
    }
    // Those that were never noticed count as later than any.
    std::vector<double> all = noticed;
    all.resize(teleports_.size(), 1e9);
    std::cout << rate_ << " Hz: " << noticed.size() << " of " << teleports_.size()
              << " teleports noticed (" << by_camera.size() << " by camera), median " << median(all)
              << " s; pose found again in " << found.size() << ", median " << median(found)
              << " s; " << totals_.false_alarms << " false alarms in " << totals_.right_seconds
              << " s\n";
    return {{"plan", plan_.name},
            {"seed", o_.seed},
            {"rate", rate_},
            {"teleports", teleports_.size()},
            {"noticed", noticed.size()},
            {"noticed_by_camera", by_camera.size()},
            {"noticed_median_s", median(all)},
            {"found", found.size()},
            {"found_median_s", median(found)},
            {"alarms", totals_.alarms},
            {"false_alarms", totals_.false_alarms},
            {"false_alarms_per_hour",
             totals_.false_alarms / std::max(1e-9, totals_.right_seconds / 3600.0)},
            {"driven_s", totals_.seconds},
            {"pose_right_s", totals_.right_seconds},
            {"judged_s", totals_.tested_seconds},
            {"started_at_pose", totals_.started_at_pose},
            {"started_in_place", totals_.started_in_place},
            {"started_everywhere", totals_.started_everywhere},
            {"frames", totals_.frames},
            {"frame_accuracy",
             totals_.frames_right / std::max(1.0, static_cast<double>(totals_.frames))},
            {"places", model_.transitions.places.size()},
            {"wanted", others_.result()},
            {"wrong_alarms", totals_.wrong_alarms},
            {"each", list}};
  }

  const Options& o_;
  const double rate_;
  const hyselam_sim::FloorPlan& plan_;
  const PlaceModel& model_;
  const hyselam_topo::AugmentedTopologicalMap& map_;
  const hyselam_sim::Simulation& run_;
  Laser laser_;
  PoseSupervisor supervisor_;
  OtherThresholds others_;
  std::vector<Teleport> teleports_;
  ScanPoints points_;
  std::size_t scan_ = 0, next_ = 0;  // of the scans and teleports
  // The localization was started again and has not converged; it is still to be started again.
  bool restarted_ = false, pending_ = false;
  bool pose_right_ = false;
  double last_stamp_ = 0.0, next_frame_ = 0.0, alarm_at_ = 0.0;
  Totals totals_;
};

/// Films the drive, or reads what was kept of it, and gives each frame to `use`.
void watch(const hyselam_sim::Scene& scene, const hyselam_sim::Route& route,
           const hyselam_sim::Simulation& run, const PlaceModel& model, const Options& o,
           const std::function<void(const SeenFrame&)>& use) {
  ImageRecognizer recognizer(model, model.transitions, {});
  const auto give = [&](double stamp, const Pose2& base, int place) {
    use({stamp, base, place, &recognizer.frameProbabilities(), recognizer.distances()});
  };
  hyselam_sim::FilmParams film =
      filmParamsOf(o, o.hour, *std::max_element(o.rates.begin(), o.rates.end()));
  film.start_time = run.log.ground_truth.front().stamp;
  const std::size_t frames = hyselam_sim::filmLength(run.log, film);
  hyselam::Progress progress("driving", frames);
  std::size_t done = 0;
  if (!o.keep.empty() && bench::holdsSignatures(o.keep)) {
    bench::readSignatures(o.keep, recognizer.signature().size(), [&](const bench::KeptFrame& f) {
      progress.update(++done);
      recognizer.updateWithSignature(f.signature.data());
      give(f.stamp, f.base, f.place);
    });
    return;
  }
  std::optional<bench::SignatureFile> kept;
  if (!o.keep.empty()) kept.emplace(o.keep);
  hyselam_sim::film(scene, run.log, route.people, o.seed, film,
                    [&](const hyselam_sim::FilmFrame& f) {
                      progress.update(++done);
                      recognizer.update(f.picture.color);
                      if (kept) kept->add({f.stamp, f.base, f.place, recognizer.signature()});
                      give(f.stamp, f.base, f.place);
                    });
  if (kept) kept->close();
}

nlohmann::json run(const Options& o) {
  if (o.learn.size() != 2 || o.rates.empty()) {
    throw hyselam::InputError("command line", "--learn, --rates",
                              "two hours, and one rate or more are needed");
  }
  const Building building = buildingOf(o);
  hyselam_sim::SceneParams look;
  look.seed = o.look;
  const hyselam_sim::Scene scene(building.plan, look);
  PlaceModel model;
  const std::string kept_model = o.keep.empty() ? "" : o.keep + "/model";
  if (!o.keep.empty() && holdsPlaceModel(kept_model)) {
    model = loadPlaceModel(kept_model);
  } else {
    model = learnPlan(scene, building.plan, o);
    if (!o.keep.empty()) {
      std::filesystem::create_directories(o.keep);
      savePlaceModel(model, kept_model);
    }
  }
  const hyselam_topo::AugmentedTopologicalMap map = topologyOf(scene, o);
  const hyselam::OccupancyGrid grid = hyselam_sim::rasterize(building.plan, {});
  const auto fit = std::make_shared<const ScanFit>(grid);
  const hyselam_sim::Route route = kidnapRoute(building, o);
  const hyselam_sim::Simulation drive = hyselam_sim::simulate(building.plan, route, o.seed);
  std::vector<std::unique_ptr<Experiment>> experiments;
  for (const double rate : o.rates) {
    experiments.push_back(
        std::make_unique<Experiment>(building, map, grid, fit, drive, model, o, rate));
  }
  watch(scene, route, drive, model, o, [&](const SeenFrame& f) {
    for (auto& e : experiments) e->addFrame(f);
  });
  nlohmann::json results = nlohmann::json::array();
  for (auto& e : experiments) results.push_back(e->finish());
  return results;
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
  app.add_option("--generate", o.generate, "seed of a made-up plan instead; 0: none");
  app.add_option("--look", o.look, "seed of paint, windows and posters");
  app.add_option("--clouds", o.clouds, "0 to 1");
  app.add_option("--descriptor", o.descriptor, "name");
  app.add_option("--teleports", o.teleports, "how often")->check(CLI::NonNegativeNumber);
  app.add_option("--unnamed", o.unnamed, "learned places without a name on the map")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--between", o.between, "distance driven between them [m]");
  app.add_option("--hour", o.hour, "of the day");
  app.add_option("--learn", o.learn, "two hours of the day")->delimiter(',');
  app.add_option("--rates", o.rates, "pictures per second: one run each, of the same film")
      ->delimiter(',');
  app.add_option("--reach", o.reach, "places so near to the pose agree with it [m]");
  app.add_option("--hours", o.supervisor.views.false_alarm_hours, "wanted between false alarms");
  app.add_option("--correlation", o.supervisor.views.correlation_time, "time of looks [s]");
  app.add_flag("!--forget", o.supervisor.views.remember, "without memory of where the camera errs");
  app.add_flag("--without-scan", o.without_scan, "the camera alone tests the pose");
  app.add_flag("--by-places", o.by_places, "by places, not by views");
  app.add_option("--keep", o.keep,
                 "directory for what was learned and for the signatures of the drive: a second run "
                 "with equal plan, seed, hours, rates, teleports does not film again");
  app.add_option("--seed", o.seed, "of route, run and pictures");
  app.add_flag("--without-camera", o.without_camera, "the laser's localisation alone");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
