// simulated_places: learns a simulated building at two hours of the day, asks for its places at two
// others with people about.
#include <ctime>
#include <iostream>

#include "filmed_tour.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "selovis/recogniser.hpp"

namespace {

using namespace selovis;      // NOLINT: a program, not a header
using namespace hyselam_sim;  // NOLINT

struct Options {
  std::string route = "office";
  std::uint64_t generate = 0, look = 1;
  std::vector<double> learn{9.0, 20.0}, ask{12.0, 17.0};
  std::vector<std::string> descriptors{"LBPbyHSV-U8N", "SLBP", "LGOP", "GLANCE", "GLANCE+scan"};
  std::vector<std::string> kernels{"exemplar"};
  double rate = 2.0;
};

const char* const kFilters[] = {"none", "lowpass", "markov", "bayes"};

nlohmann::json run(const Options& o) {
  Route route;
  FloorPlan plan;
  if (o.generate > 0) {
    PlanParams params;
    params.min_door = 0.9;  // that the robot comes through; furniture may bar its way
    plan = generatePlan(o.generate, params);
    route = bench::roundTrip(plan);
  } else {
    route = loadRoute(routeFile(o.route));
    plan = loadFloorPlan(planFile(route.plan));
  }
  SceneParams look;
  look.seed = o.look;
  const Scene scene(plan, look);
  if (o.learn.size() != 2 || o.ask.empty()) {
    throw hyselam::InputError("command line", "", "two hours to learn, one or more to ask for");
  }
  std::vector<bench::FilmedTour> learnt, asked;
  {
    hyselam::Progress progress("filming", o.learn.size() + o.ask.size());
    std::uint64_t seed = 1;
    for (const double hour : o.learn) {
      progress.update(seed - 1);
      const Route& way = seed == 1 ? route : bench::reversed(route);
      learnt.push_back(bench::filmTour(scene, way, seed, bench::filmParams(hour, o.rate), false));
      ++seed;
    }
    for (const double hour : o.ask) {
      progress.update(seed - 1);
      asked.push_back(bench::filmTour(scene, route, seed, bench::filmParams(hour, o.rate), true));
      ++seed;
    }
  }
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& descriptor : o.descriptors) {
    for (const auto& kernel : o.kernels) {
      TrainingOptions t;
      t.descriptor = descriptor;
      t.classifier.kernel = kernelOf(kernel);
      if (t.classifier.kernel == Kernel::kExemplar) t.views = exemplarViews();
      const Model model = bench::trainOn(learnt, plan.places, t);
      nlohmann::json row = {{"plan", plan.name},
                            {"descriptor", descriptor},
                            {"kernel", kernel},
                            {"places", model.graph.places.size()}};
      for (std::size_t k = 0; k < asked.size(); ++k) {
        std::vector<std::unique_ptr<PlaceFilter>> filters;
        for (const char* name : kFilters) {
          PlaceFilterParams params;
          params.kind = filterKind(name);
          filters.push_back(std::make_unique<PlaceFilter>(model.graph, params));
        }
        Recogniser recogniser(model, model.graph, {});
        // The filter over poses without and with the odometry of the tour that is asked for.
        std::vector<std::unique_ptr<Recogniser>> moved;
        if (model.classifier.kernel == Kernel::kExemplar) {
          RecogniserParams params;
          params.filter.kind = FilterKind::kPoses;
          for (int i = 0; i < 2; ++i) {
            moved.push_back(std::make_unique<Recogniser>(model, model.graph, params));
          }
        }
        std::vector<int> right(filters.size(), 0), right_moved(moved.size(), 0);
        for (const auto& frame : asked[k].frames) {
          recogniser.update(frame.image(), frame.readings());
          const int truth =
              model.graph.find(plan.places[static_cast<std::size_t>(frame.place)].name);
          for (std::size_t f = 0; f < filters.size(); ++f) {
            filters[f]->update(recogniser.frameProbabilities());
            right[f] += filters[f]->estimate().place == truth;
          }
          for (std::size_t m = 0; m < moved.size(); ++m) {
            Readings readings = frame.readings();
            if (m == 0) readings.odometry.reset();
            right_moved[m] += moved[m]
                                  ->updateWithSignature(recogniser.signature().data(), readings)
                                  .estimate.place == truth;
          }
        }
        nlohmann::json shares;
        for (std::size_t f = 0; f < filters.size(); ++f) {
          shares[kFilters[f]] = right[f] / static_cast<double>(asked[k].frames.size());
        }
        for (std::size_t m = 0; m < moved.size(); ++m) {
          shares[m == 0 ? "poses" : "poses, odometry"] =
              right_moved[m] / static_cast<double>(asked[k].frames.size());
        }
        row["asked"].push_back(
            {{"hour", o.ask[k]}, {"frames", asked[k].frames.size()}, {"accuracy", shares}});
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
      "to "
      "ask for its places.",
      "simulated_places"};
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("--route", o.route, "route that hyselam_sim comes with");
  app.add_option("--generate", o.generate, "seed of a made-up plan instead; 0: none");
  app.add_option("--look", o.look, "seed of paint, windows and posters");
  app.add_option("--learn", o.learn, "two hours of the day")->delimiter(',');
  app.add_option("--ask", o.ask, "hours of the day")->delimiter(',');
  app.add_option("--descriptors", o.descriptors, "names")->delimiter(',');
  app.add_option("--kernels", o.kernels, "names")->delimiter(',');
  app.add_option("--rate", o.rate, "pictures per second");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
