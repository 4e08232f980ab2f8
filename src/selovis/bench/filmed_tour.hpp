// Tours through simulated buildings as the robot's camera and laser see them, kept in memory.
#pragma once

#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_sim/film.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/plan_ray_caster.hpp"
#include "hyselam_sim/simulation.hpp"
#include "selovis/learning/place_model.hpp"

namespace selovis {
namespace bench {

struct FilmedFrame {
  double stamp = 0.0;  ///< [s]
  hyselam::Pose2 base;
  int place = -1;                   ///< index into the plan's places; -1: none
  std::vector<unsigned char> jpeg;  ///< as a camera driver would hand it out, quality 92
  std::vector<float> scan;
  hyselam::Pose2 camera = kNoPose;         ///< in the plan frame
  std::optional<hyselam::Pose2> odometry;  ///< of the camera

  cv::Mat image() const { return cv::imdecode(jpeg, cv::IMREAD_COLOR); }
  SensorReadings readings() const {
    SensorReadings r;
    r.scan = scan;
    r.stamp = stamp;
    r.odometry = odometry;
    return r;
  }
};

struct FilmedTour {
  std::vector<FilmedFrame> frames;  ///< those in a place
  hyselam_sim::Simulation run;
};

inline hyselam_sim::FilmParams filmParams(double hour, double rate) {
  hyselam_sim::FilmParams params;
  params.camera.width = 320;
  params.camera.height = 240;
  params.light.hour = hour;
  params.rate = rate;
  return params;
}

/// A way of somebody in a place, between points halfway to two of its corners; empty where each
/// such way would go through a wall (rooms are not all convex).
inline std::vector<hyselam_sim::Point2> wayIn(const hyselam_sim::PlanPlace& place,
                                              const hyselam_sim::PlanRayCaster& walls) {
  using hyselam_sim::operator+, hyselam_sim::operator-, hyselam_sim::operator*;
  const auto halfway = [&](std::size_t corner) {
    return place.at + 0.5 * (place.outline[corner] - place.at);
  };
  const std::size_t n = place.outline.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {  // not the next corner: a longer way
      const hyselam::Point2 a = halfway(i), b = halfway(j);
      const double l = hyselam_sim::length(b - a);
      if (l > 0.0 && !(walls.cast(a, (1.0 / l) * (b - a), l) < l)) {
        return {a, b};
      }
    }
  }
  return {};
}

/// There and back through all places of a made-up plan, with somebody in every third.
inline hyselam_sim::Route roundTrip(const hyselam_sim::FloorPlan& plan) {
  hyselam_sim::Route route;
  route.name = "round trip";
  route.source = plan.name;
  route.start.place = plan.places.front().name;
  const auto go = [&](const hyselam_sim::PlanPlace& place) {
    hyselam_sim::RouteStep step;
    step.spot.place = place.name;
    step.where = place.name;
    route.steps.push_back(step);
  };
  for (std::size_t i = 1; i < plan.places.size(); ++i) go(plan.places[i]);
  for (std::size_t i = plan.places.size(); i-- > 0;) go(plan.places[i]);
  const hyselam_sim::PlanRayCaster walls(hyselam_sim::edges(hyselam_sim::wallSolids(plan)));
  for (std::size_t i = 0; i < plan.places.size(); i += 3) {
    const hyselam_sim::PlanPlace& place = plan.places[i];
    hyselam_sim::Person person;
    person.name = "somebody in " + place.name;
    person.points = wayIn(place, walls);
    if (person.points.empty()) continue;
    person.speed = 0.8;
    route.people.push_back(person);
  }
  return route;
}

/// The tour the other way about, for learning: pictures from other poses than those asked for.
inline hyselam_sim::Route reversed(const hyselam_sim::Route& route) {
  hyselam_sim::Route back = route;
  back.steps.clear();
  for (auto step = route.steps.rbegin(); step != route.steps.rend(); ++step) {
    if (step->kind == hyselam_sim::RouteStep::Kind::kGo) back.steps.push_back(*step);
  }
  back.start = back.steps.front().spot;
  back.steps.erase(back.steps.begin());
  return back;
}

/// Drives and films the route; its people are there if `with_people`.
inline FilmedTour filmTour(const hyselam_sim::Scene& scene, hyselam_sim::Route route,
                           std::uint64_t seed, const hyselam_sim::FilmParams& params,
                           bool with_people) {
  if (!with_people) route.people.clear();
  FilmedTour tour;
  tour.run = hyselam_sim::simulate(scene.plan(), route, seed);
  const auto& scans = tour.run.log.scans;
  std::size_t at = 0;
  hyselam_sim::film(
      scene, tour.run.log, route.people, seed, params, [&](const hyselam_sim::FilmFrame& f) {
        if (f.place < 0) return;
        while (at + 1 < scans.size() && scans[at + 1].stamp <= f.stamp + 1e-6) ++at;
        FilmedFrame frame;
        frame.stamp = f.stamp;
        frame.base = f.base;
        frame.place = f.place;
        frame.scan = scans[at].ranges;
        frame.camera = f.base * params.camera.camera_in_base;
        const auto odometry = hyselam::poseAt(tour.run.log.odometry, f.stamp, 0.1);
        if (odometry) frame.odometry = *odometry * params.camera.camera_in_base;
        cv::imencode(".jpg", f.picture.color, frame.jpeg, {cv::IMWRITE_JPEG_QUALITY, 92});
        tour.frames.push_back(std::move(frame));
      });
  return tour;
}

/// Trains on filmed tours.
inline PlaceModel trainOn(const std::vector<FilmedTour>& tours,
                          const std::vector<hyselam_sim::PlanPlace>& places,
                          const TrainingOptions& options) {
  std::vector<std::size_t> sizes;
  for (const auto& tour : tours) sizes.push_back(tour.frames.size());
  return trainPlaceModel(
      sizes,
      [&](std::size_t t, std::size_t i) -> TrainingFrame {
        const FilmedFrame& f = tours[t].frames[i];
        return {f.image(), f.readings(), places[static_cast<std::size_t>(f.place)].name, f.camera};
      },
      options);
}

}  // namespace bench
}  // namespace selovis
