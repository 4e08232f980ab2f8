// simulated_places: learns a simulated building at two hours of the day, recognizes its places at
// two others with people in it.
#include <ctime>
#include <filesystem>
#include <iomanip>
#include <iostream>

#include "filmed_tour.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "selovis/learning/labeled_frames.hpp"
#include "selovis/recognition/image_recognizer.hpp"

namespace {

using namespace selovis;      // NOLINT: a program, not a header
using namespace hyselam_sim;  // NOLINT

struct Options {
  std::string route = "office";
  std::uint64_t generate = 0, look = 1;
  std::vector<double> learn{9.0, 20.0}, ask{12.0, 17.0};
  std::vector<std::string> descriptors{"FUSION-LEARNT", "FUSION", "GLANCE"};
  std::vector<std::string> kernels{"auto"};
  double rate = 2.0;
  bool furniture = false;
  hyselam_sim::CameraParams camera = bench::filmParams(12.0, 1.0).camera;
  double clouds = 0.3;
  std::string film;
  bool true_poses = false;
};

const char* const kFilters[] = {"none", "lowpass", "markov", "bayes"};

struct Building {
  FloorPlan plan;
  Route route;
};

Building buildingOf(const Options& o) {
  Building building;
  if (o.generate > 0) {
    PlanParams params;
    params.min_door = 0.9;  // wide enough for the robot
    params.furniture = o.furniture;
    building.plan = generatePlan(o.generate, params);
    building.route = bench::roundTrip(building.plan);
  } else {
    building.route = loadRoute(routeFile(o.route));
    building.plan = loadFloorPlan(planFile(building.route.plan));
  }
  return building;
}

struct Tours {
  std::vector<bench::FilmedTour> learned, asked;
};

FilmParams filmParamsOf(const Options& o, double hour) {
  FilmParams params = bench::filmParams(hour, o.rate);
  params.camera = o.camera;
  params.light.clouds = o.clouds;
  return params;
}

Tours filmTours(const Scene& scene, const Route& route, const Options& o) {
  Tours tours;
  hyselam::Progress progress("filming", o.learn.size() + o.ask.size());
  std::uint64_t seed = 1;
  for (const double hour : o.learn) {
    progress.update(seed - 1);
    const Route& way = seed == 1 ? route : bench::reversed(route);
    tours.learned.push_back(bench::filmTour(scene, way, seed, filmParamsOf(o, hour), false));
    ++seed;
  }
  for (const double hour : o.ask) {
    progress.update(seed - 1);
    tours.asked.push_back(bench::filmTour(scene, route, seed, filmParamsOf(o, hour), true));
    ++seed;
  }
  return tours;
}

/// Share of the frames whose place is right, by filter.
nlohmann::json accuraciesOf(const PlaceModel& model, const std::vector<PlanPlace>& places,
                            const bench::FilmedTour& tour) {
  std::vector<std::unique_ptr<PlaceFilter>> filters;
  for (const char* name : kFilters) {
    PlaceFilterParams params;
    params.kind = placeFilterKindFromString(name);
    filters.push_back(std::make_unique<PlaceFilter>(model.transitions, params));
  }
  ImageRecognizer recognizer(model, model.transitions, {});
  // The filter over poses without and with the odometry of the tour.
  std::vector<std::unique_ptr<ImageRecognizer>> by_poses;
  if (comparesExemplars(model.classifier.kernel)) {
    ImageRecognizerParams params;
    params.filter.kind = PlaceFilterKind::kPoses;
    for (int i = 0; i < 2; ++i) {
      by_poses.push_back(std::make_unique<ImageRecognizer>(model, model.transitions, params));
    }
  }
  std::vector<int> right(filters.size(), 0), right_by_poses(by_poses.size(), 0);
  for (const auto& frame : tour.frames) {
    recognizer.update(frame.image(), frame.readings());
    const int truth = model.transitions.indexOf(places[static_cast<std::size_t>(frame.place)].name);
    for (std::size_t f = 0; f < filters.size(); ++f) {
      filters[f]->update(recognizer.frameProbabilities());
      right[f] += filters[f]->estimate().place == truth;
    }
    for (std::size_t m = 0; m < by_poses.size(); ++m) {
      SensorReadings readings = frame.readings();
      if (m == 0) readings.odometry.reset();
      right_by_poses[m] += by_poses[m]
                               ->updateWithSignature(recognizer.signature().data(), readings)
                               .estimate.place == truth;
    }
  }
  const double frames = static_cast<double>(tour.frames.size());
  nlohmann::json shares;
  for (std::size_t f = 0; f < filters.size(); ++f) shares[kFilters[f]] = right[f] / frames;
  for (std::size_t m = 0; m < by_poses.size(); ++m) {
    shares[m == 0 ? "poses" : "poses, odometry"] = right_by_poses[m] / frames;
  }
  return shares;
}

/// The pictures of a tour and their list, as `train` and `evaluate` read it. True poses are for
/// learning, odometry is for asking.
void writeTour(const std::string& folder, const std::string& name, bool true_poses,
               const bench::FilmedTour& tour, const std::vector<PlanPlace>& places) {
  const std::filesystem::path base(folder);
  hyselam::makeFolder((base / name).string());
  hyselam::writeFileAtomically((base / (name + ".csv")).string(), [&](std::ostream& out) {
    out << "image_path,place,stamp,x,y,theta,odom_x,odom_y,odom_theta";
    for (std::size_t k = 0; k < tour.frames.front().scan.size(); ++k) out << ",scan_" << k;
    out << '\n' << std::setprecision(9);
    const auto pose = [&](bool known, const hyselam::Pose2& p) {
      if (known) {
        out << ',' << p.x << ',' << p.y << ',' << p.theta;
      } else {
        out << ",,,";
      }
    };
    for (std::size_t i = 0; i < tour.frames.size(); ++i) {
      const bench::FilmedFrame& f = tour.frames[i];
      const std::string file = name + "/" + std::to_string(100000 + i).substr(1) + ".jpg";
      hyselam::writeFileAtomically((base / file).string(), [&](std::ostream& image) {
        image.write(reinterpret_cast<const char*>(f.jpeg.data()),
                    static_cast<std::streamsize>(f.jpeg.size()));
      });
      out << file << ',' << csvCell(places[static_cast<std::size_t>(f.place)].name) << ','
          << f.stamp;
      pose(true_poses, f.camera);
      pose(!true_poses && f.odometry, f.odometry.value_or(hyselam::Pose2{}));
      for (const float range : f.scan) out << ',' << range;
      out << '\n';
    }
  });
}

nlohmann::json writeTours(const Options& o, const Building& building, const Tours& tours) {
  nlohmann::json lists = nlohmann::json::array();
  const auto write = [&](const std::string& kind, const std::vector<bench::FilmedTour>& all,
                         const std::vector<double>& hours) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::string name = kind + "_" + std::to_string(static_cast<int>(hours[k])) + "h";
      writeTour(o.film, name, o.true_poses || kind == "learn", all[k], building.plan.places);
      lists.push_back({{"list", name + ".csv"}, {"frames", all[k].frames.size()}});
    }
  };
  write("learn", tours.learned, o.learn);
  write("ask", tours.asked, o.ask);
  return lists;
}

nlohmann::json run(const Options& o) {
  if (o.learn.empty() || o.learn.size() > 2 || o.ask.empty()) {
    throw hyselam::InputError("command line", "",
                              "one or two hours to learn, one or more to ask for");
  }
  const Building building = buildingOf(o);
  SceneParams look;
  look.seed = o.look;
  const Scene scene(building.plan, look);
  const Tours tours = filmTours(scene, building.route, o);
  if (!o.film.empty()) return writeTours(o, building, tours);
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& descriptor : o.descriptors) {
    for (const auto& kernel : o.kernels) {
      TrainingOptions t;
      t.descriptor = descriptor;
      if (kernel != "auto") {
        t.classifier.kernel = svmKernelFromString(kernel);
      } else if (descriptor.compare(0, 6, "FUSION") != 0) {
        t.classifier.kernel = SvmKernel::kExemplar;
      }
      const PlaceModel model = bench::trainOn(tours.learned, building.plan.places, t);
      nlohmann::json row = {{"plan", building.plan.name},
                            {"descriptor", descriptor},
                            {"kernel", kernel},
                            {"places", model.transitions.places.size()}};
      for (std::size_t k = 0; k < tours.asked.size(); ++k) {
        row["asked"].push_back(
            {{"hour", o.ask[k]},
             {"frames", tours.asked[k].frames.size()},
             {"accuracy", accuraciesOf(model, building.plan.places, tours.asked[k])}});
      }
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Films a simulated building at two hours of the day to learn it and at others, with people, "
      "to recognize its places.",
      "simulated_places"};
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("--route", o.route, "route that hyselam_sim comes with");
  app.add_option("--generate", o.generate, "seed of a made-up plan instead; 0: none");
  app.add_option("--look", o.look, "seed of paint, windows and posters");
  app.add_option("--learn", o.learn,
                 "one or two hours of the day; the second tour goes the other way")
      ->delimiter(',');
  app.add_option("--ask", o.ask, "hours of the day")->delimiter(',');
  app.add_option("--descriptors", o.descriptors, "names")->delimiter(',');
  app.add_option("--kernels", o.kernels, "names")->delimiter(',');
  app.add_option("--rate", o.rate, "pictures per second");
  app.add_flag("--furniture", o.furniture, "in a made-up plan");
  app.add_option("--width", o.camera.width, "of a picture [pixels]");
  app.add_option("--height", o.camera.height, "of a picture [pixels]");
  app.add_option("--view", o.camera.view, "horizontal field of view of the camera [rad]");
  app.add_option("--exposure", o.camera.exposure, "how far it follows the light");
  app.add_option("--white-balance", o.camera.white_balance,
                 "how far it follows the colour of light");
  app.add_option("--clouds", o.clouds, "0: clear sky, 1: no direct sun");
  app.option_defaults()->always_capture_default(false);
  app.add_option("--film", o.film,
                 "only write the pictures and lists of all tours into this directory");
  app.add_flag("--true-poses", o.true_poses,
               "with --film: true poses instead of odometry in the lists of the tours asked for");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
