#include "hyselam_sim/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <sstream>

#include "hyselam_common/errors.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/rasterize.hpp"

namespace hyselam_sim {
namespace {

constexpr double kPlannerResolution = 0.05;
constexpr double kPlanAhead = 2.0;                     // [m] before the end of a leg
constexpr double kTurnBack = hyselam::radians(100.0);  // sharper turns are made on the spot
constexpr double kPlaceRadius = 1.2;                   // who comes this near passes a place [m]
constexpr double kExactBelow = 0.1;  // the grid's clearance is checked exactly below radius + this

std::string text(Point2 p) {
  std::ostringstream out;
  out << "[" << p.x << ", " << p.y << "]";
  return out.str();
}

// The building as it is between two movements of doors.
struct World {
  World(const FloorPlan& plan, double time)
      : bodies(solids(plan, time)),
        rays(edges(bodies)),
        clearance(rasterize(plan, kPlannerResolution, time)),
        valid_until(plan.nextDoorChange(time)) {}

  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  // 0 inside
    const Solid* solid = nullptr;
  };
  Nearest nearest(Point2 p) const {
    Nearest best;
    for (const Solid& body : bodies) {
      double d = contains(body.outline, p) ? 0.0 : std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < body.outline.size(); ++i) {
        d = std::min(
            d, distance(p, Segment{body.outline[i], body.outline[(i + 1) % body.outline.size()]}));
      }
      if (d < best.distance) best = {d, &body};
    }
    return best;
  }

  std::vector<Solid> bodies;
  PlanRayCaster rays;
  ClearanceMap clearance;
  double valid_until;
  std::map<std::pair<std::string, std::string>, std::vector<Point2>> ways;  // by names of places
};

class Run {
 public:
  Run(const FloorPlan& plan, const Route& route, std::uint64_t seed, const SimulationParams& params)
      : plan_(withDoors(plan, route)),
        route_(route),
        params_(withRoute(params, route)),
        laser_rng_(seed, 1),
        world_(std::make_unique<World>(plan_, 0.0)),
        follower_(params_.follower, params_.robot),
        robot_(params_.robot, startPose()),
        odometry_(params_.odometry, params_.robot.wheel_base, hyselam::Rng(seed, 2)) {
    checkPeople();
  }

  Simulation run(const std::function<void(std::size_t)>& progress) {
    sample();
    for (std::size_t i = 0; i < route_.steps.size(); ++i) {
      const RouteStep& step = route_.steps[i];
      if (!step.doors.empty()) setDoors(step);
      switch (step.kind) {
        case RouteStep::Kind::kGo:
          go(i);
          break;
        case RouteStep::Kind::kWait:
          stand(step.seconds);
          break;
        case RouteStep::Kind::kTeleport:
          teleport(i);
          break;
      }
      result_.visits.push_back({i, stamp()});
      if (progress) progress(i + 1);
    }
    stand(1.0);  // comes to rest
    result_.duration = time();
    return std::move(result_);
  }

 private:
  static SimulationParams withRoute(SimulationParams params, const Route& route) {
    if (route.speed) params.follower.speed = *route.speed;
    params.validate();
    return params;
  }

  static FloorPlan withDoors(FloorPlan plan, const Route& route) {
    if (route.doors.empty()) return plan;
    try {
      plan.setDoors(route.doors);
    } catch (const hyselam::InputError& e) {
      throw hyselam::InputError(route.source, "key 'doors'",
                                "does not fit the plan: " + std::string(e.what()));
    }
    return plan;
  }

  void setDoors(const RouteStep& step) {
    try {
      plan_.setDoors(step.doors);
    } catch (const hyselam::InputError& e) {
      fail(step.where, "does not fit the plan: " + std::string(e.what()));
    }
    world_ = std::make_unique<World>(plan_, time());
  }

  double time() const { return static_cast<double>(ticks_) / params_.odometry_rate; }
  double stamp() const { return params_.start_time + time(); }
  Point2 position() const { return {robot_.pose().x, robot_.pose().y}; }

  [[noreturn]] void fail(const std::string& where, const std::string& reason) const {
    throw hyselam::InputError(route_.source, where, reason);
  }

  Point2 resolve(const Spot& spot, const std::string& where) const {
    if (spot.place.empty()) return spot.point;
    try {
      return plan_.place(spot.place).at;
    } catch (const hyselam::InputError& e) {
      fail(where, "does not fit the plan: " + std::string(e.what()));
    }
  }

  static std::string nameOf(const Spot& spot) {
    return spot.place.empty() ? text(spot.point) : "'" + spot.place + "'";
  }

  // The heading given, or towards the next point of the route.
  Pose2 poseOf(const Spot& spot, const std::string& where, std::size_t next_step) const {
    const Point2 p = resolve(spot, where);
    const World::Nearest near = world_->nearest(p);
    if (near.solid && near.distance < params_.robot.radius) {
      fail(where, "the robot does not fit at " + nameOf(spot) + ": " +
                      describe(plan_, *near.solid) + " is in the way");
    }
    if (!(world_->clearance.at(p) > 0.0)) {
      fail(where, nameOf(spot) + " lies outside the building");
    }
    if (spot.heading) return {p.x, p.y, *spot.heading};
    if (next_step >= route_.steps.size() || route_.steps[next_step].kind != RouteStep::Kind::kGo) {
      return {p.x, p.y, 0.0};
    }
    const std::vector<Point2> way = plan(p, spot.place, next_step);
    const Point2 ahead = way[std::min<std::size_t>(way.size() - 1, 5)] - way.front();
    return {p.x, p.y, std::atan2(ahead.y, ahead.x)};
  }

  Pose2 startPose() const { return poseOf(route_.start, "key 'start'", 0); }

  void checkPeople() const {
    const PlanRayCaster walls(edges(wallSolids(plan_)));
    for (std::size_t i = 0; i < route_.people.size(); ++i) {
      const Person& person = route_.people[i];
      const std::string where = "key 'people[" + std::to_string(i) + "].points'";
      const std::size_t n = person.points.size();
      for (std::size_t k = 0; k < (person.mode == Person::Mode::kLoop ? n : n - 1); ++k) {
        const Point2 a = person.points[k], b = person.points[(k + 1) % n];
        const double l = length(b - a);
        if (l > 0.0 && walls.cast(a, (1.0 / l) * (b - a), l) < l) {
          fail(where, "the way from " + text(a) + " to " + text(b) + " goes through a wall");
        }
      }
    }
  }

  std::string leg(std::size_t step) const {
    const std::string from = step == 0 ? nameOf(route_.start) : nameOf(previousSpot(step));
    return route_.steps[step].where + ", leg from " + from + " to " +
           nameOf(route_.steps[step].spot);
  }

  // Where the robot stands before a step.
  const Spot& previousSpot(std::size_t step) const {
    while (step-- > 0) {
      if (route_.steps[step].kind != RouteStep::Kind::kWait) return route_.steps[step].spot;
    }
    return route_.start;
  }

  // The way of one leg, from where the leg before ends.
  std::vector<Point2> plan(Point2 from, const std::string& from_place, std::size_t step) const {
    const Spot& spot = route_.steps[step].spot;
    const Point2 to = resolve(spot, route_.steps[step].where);
    if (spot.place.empty()) {
      std::vector<Point2> way = straightPath(from, to, params_.planner.spacing);
      for (const Point2& p : way) {
        const World::Nearest near = world_->nearest(p);
        if (near.solid && near.distance < params_.robot.radius) {
          fail(leg(step), "blocked at " + text(p) + " by " + describe(plan_, *near.solid));
        }
      }
      return way;
    }
    const bool known = !from_place.empty();
    const auto key = std::make_pair(from_place, spot.place);
    if (known) {
      const auto found = world_->ways.find(key);
      if (found != world_->ways.end()) return found->second;
    }
    std::optional<std::vector<Point2>> way =
        planPath(route_.direct ? withoutPlaces(world_->clearance, from, to) : world_->clearance,
                 from, to, params_.planner);
    if (!way && route_.direct && planPath(world_->clearance, from, to, params_.planner)) {
      fail(leg(step), "no way leads there without passing another place (key 'direct')");
    }
    if (!way) fail(leg(step), whyNoWay(from, to));
    if (known) world_->ways.emplace(key, *way);
    return *way;
  }

  // The other places as obstacles.
  ClearanceMap withoutPlaces(const ClearanceMap& clearance, Point2 from, Point2 to) const {
    std::vector<Point2> others;
    for (const PlanPlace& place : plan_.places) {
      if (length(place.at - from) > kPlaceRadius && length(place.at - to) > kPlaceRadius) {
        others.push_back(place.at);
      }
    }
    return clearance.without(others, kPlaceRadius);
  }

  std::string whyNoWay(Point2 from, Point2 to) const {
    FloorPlan open = plan_;
    for (PlanDoor& door : open.doors) {
      door.initially_open = true;
      door.schedule.clear();
    }
    const auto way =
        planPath(ClearanceMap(rasterize(open, kPlannerResolution, 0.0)), from, to, params_.planner);
    if (!way) return "blocked: no way is wide enough for the robot";
    std::string shut;
    for (const Solid& body : world_->bodies) {
      if (body.kind != Solid::Kind::kDoor || plan_.doors[body.index].isOpen(time())) continue;
      const bool crossed = std::any_of(way->begin(), way->end(), [&](Point2 p) {
        return distance(p, Segment{body.outline[0], body.outline[1]}) < params_.robot.radius;
      });
      if (crossed) shut += (shut.empty() ? "" : ", ") + describe(plan_, body);
    }
    std::ostringstream out;
    out << "blocked at " << time() << " s: closed " << (shut.empty() ? "doors" : shut);
    return out.str();
  }

  void refreshWorld() {
    if (time() >= world_->valid_until) world_ = std::make_unique<World>(plan_, time());
  }

  void sample() {
    result_.log.odometry.push_back({stamp(), odometry_.pose()});
    result_.log.ground_truth.push_back({stamp(), robot_.pose()});
    const double ratio = params_.scan_rate / params_.odometry_rate;
    const auto due = [&](double tick) { return std::floor(tick * ratio + 1e-9); };
    const double tick = static_cast<double>(ticks_);
    if (ticks_ > 0 && due(tick) <= due(tick - 1.0)) return;
    std::vector<Disc> people;
    for (const Person& person : route_.people) {
      if (auto at = person.at(time())) people.push_back({makeRoom(*at, position()), person.radius});
    }
    result_.log.scans.push_back(
        takeScan(params_.laser, world_->rays, people, robot_.pose(), stamp(), laser_rng_));
  }

  void tick(double speed, double turn_rate, std::size_t step) {
    const Point2 before = position();
    odometry_.update(robot_.step(speed, turn_rate, 1.0 / params_.odometry_rate));
    result_.distance += length(position() - before);
    ++ticks_;
    if (time() > params_.max_duration) {
      std::ostringstream reason;
      reason << "takes longer than " << params_.max_duration << " s";
      fail(step < route_.steps.size() ? route_.steps[step].where : "", reason.str());
    }
    refreshWorld();
    if (world_->clearance.at(position()) < params_.robot.radius + kExactBelow) {
      const World::Nearest near = world_->nearest(position());
      if (near.solid && near.distance < params_.robot.radius) {
        fail(step < route_.steps.size() ? leg(step) : "",
             "the robot hits " + describe(plan_, *near.solid) + " at " + text(position()));
      }
    }
    sample();
  }

  void stand(double seconds) {
    const auto until =
        ticks_ + static_cast<std::uint64_t>(std::ceil(seconds * params_.odometry_rate));
    while (ticks_ < until || robot_.speed() != 0.0 || robot_.turnRate() != 0.0) {
      tick(0.0, 0.0, route_.steps.size());
    }
  }

  void teleport(std::size_t i) {
    stand(0.0);
    const RouteStep& step = route_.steps[i];
    robot_.teleport(poseOf(step.spot, step.where, i + 1));
    tick(0.0, 0.0, i);
    result_.teleport_stamps.push_back(stamp());
    stand(params_.stand_after_teleport);
  }

  // Drives to the end of leg `i`; the leg after it is joined on in time, so that the robot need not
  // stop at places on its way.
  void go(std::size_t i) {
    if (joined_ != i) {
      follower_.start(
          plan(resolve(previousSpot(i), route_.steps[i].where), previousSpot(i).place, i));
    }
    std::optional<double> next_leg;  // length of the leg that follows on the path, once joined
    bool asked = false;
    const double patience = follower_.remaining() / params_.follower.speed * 10.0 + 120.0;
    const double begin = time();
    while (!follower_.arrived() && !(next_leg && follower_.remaining() <= *next_leg)) {
      if (!asked && follower_.remaining() < kPlanAhead) {
        next_leg = joinAfter(i);
        asked = true;
      }
      const DriveCommand c = follower_.command(robot_.pose(), world_->clearance.at(position()));
      tick(c.speed, c.turn_rate, i);
      if (time() - begin > patience) fail(leg(i), "the robot does not get ahead");
    }
  }

  // Appends the leg after `i` to the path unless the robot has to stop or to turn back before it.
  std::optional<double> joinAfter(std::size_t i) {
    const std::size_t next = i + 1;
    if (next >= route_.steps.size() || route_.steps[next].kind != RouteStep::Kind::kGo) {
      return std::nullopt;
    }
    const Spot& from = route_.steps[i].spot;
    const std::vector<Point2> way = plan(resolve(from, route_.steps[i].where), from.place, next);
    const Point2 ahead = way[std::min<std::size_t>(way.size() - 1, 3)] - way.front();
    const double turn =
        hyselam::normalizeAngle(std::atan2(ahead.y, ahead.x) - follower_.endDirection());
    if (std::abs(turn) > kTurnBack) return std::nullopt;
    const double before = follower_.remaining();
    follower_.extend(way);
    joined_ = next;
    return follower_.remaining() - before;
  }

  FloorPlan plan_;  // its doors move
  const Route& route_;
  const SimulationParams params_;
  std::uint64_t ticks_ = 0;
  hyselam::Rng laser_rng_;
  std::unique_ptr<World> world_;
  PathFollower follower_;
  DifferentialRobot robot_;
  Odometry odometry_;
  Simulation result_;
  std::optional<std::size_t> joined_;  // the leg appended to the path before it began
};

}  // namespace

void SimulationParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit.group("robot_", robot);
  visit.group("odometry_", odometry);
  visit.group("laser_", laser);
  visit.group("follower_", follower);
  visit.group("planner_", planner);
  visit("odometry_rate", odometry_rate, Range::between(1.0, 1000.0), "Hz",
        "also of control and ground truth");
  visit("scan_rate", scan_rate, Range::above(0.0), "Hz", "at most odometry_rate");
  visit("start_time", start_time, Range::inside(0.0, 4e9), "s", "stamp of the first sample");
  visit("max_duration", max_duration, Range::any(), "s", "a longer run is refused");
  visit("stand_after_teleport", stand_after_teleport, Range::any(), "s",
        "before the robot drives on");
}

void SimulationParams::validate() const {
  hyselam::checkParameters(*this);
  laser.validate();
  if (!(scan_rate <= odometry_rate)) {
    throw hyselam::ParameterError("scan_rate", scan_rate, "above 0, at most odometry_rate");
  }
}

Simulation simulate(const FloorPlan& plan, const Route& route, std::uint64_t seed,
                    const SimulationParams& params,
                    const std::function<void(std::size_t)>& progress) {
  return Run(plan, route, seed, params).run(progress);
}

}  // namespace hyselam_sim
