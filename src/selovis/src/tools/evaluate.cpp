// evaluate: how well a model recognises places in a labelled tour.
#include <ctime>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <opencv2/imgcodecs.hpp>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "options.hpp"
#include "plots.hpp"
#include "selovis/recogniser.hpp"
#include "selovis/topology.hpp"

namespace {

using namespace selovis;  // NOLINT: a program, not a header

struct Options {
  std::string model, labels, topology, filter, images, predictions, plots;
  RecogniserParams recogniser;
};

double cpuMilliseconds() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Row {
  int truth;  // -1: a place that the model does not know
  Recognition recognition;
};

/// Median; 0 of nothing.
double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void writePredictions(const std::string& path, const Tours& tours, const std::vector<Row>& rows,
                      const std::vector<std::string>& places) {
  const auto name = [&](int place) {
    return csvCell(place < 0 ? std::string("unknown") : places[place]);
  };
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << std::setprecision(6)
        << "image_path,place,predicted,second,probability,frame_alone,descriptive,novelty\n";
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Recognition& r = rows[i].recognition;
      out << csvCell(tours.frame(0, i).image) << ',' << csvCell(tours.frame(0, i).place) << ','
          << name(r.estimate.place) << ',' << (r.estimate.second < 0 ? "" : name(r.estimate.second))
          << ',' << r.estimate.probability << ',' << name(r.frame_place) << ',' << r.descriptive
          << ',' << r.novelty << '\n';
    }
  });
}

void writePicture(const std::string& path, const cv::Mat& picture) {
  hyselam::replaceFileAtomically(path, [&](const std::string& temporary) {
    if (!cv::imwrite(temporary, picture)) throw hyselam::InputError(path, "", "cannot be written");
  });
}

nlohmann::json run(Options& o) {
  const Model model = loadModel(o.model);
  const Tours tours({o.labels});
  const std::size_t frames = tours.sizes().front();
  PlaceGraph graph = model.graph;
  std::vector<std::string> not_on_map;
  if (!o.topology.empty()) {
    graph = reordered(readTopology(o.topology), model.graph.places, &not_on_map);
    if (not_on_map.size() == model.graph.places.size()) {
      throw hyselam::InputError(o.topology, "", "has none of the places of the model");
    }
  }
  try {
    o.recogniser.filter.kind = filterKind(o.filter);
    o.recogniser.descriptive.kind = descriptiveKind(o.images);
  } catch (const std::invalid_argument& e) {
    throw hyselam::InputError("command line", "", e.what());
  }
  std::unique_ptr<Recogniser> made;
  try {
    made = std::make_unique<Recogniser>(model, graph, o.recogniser);
  } catch (const hyselam::ParameterError&) {
    throw;
  } catch (const std::invalid_argument& e) {
    throw hyselam::InputError(o.model, "", e.what());
  }
  Recogniser& recogniser = *made;
  std::vector<std::pair<std::string, PlaceFilter>> filters;  // all of them, for comparison
  for (const char* name : {"none", "lowpass", "markov", "bayes"}) {
    PlaceFilterParams params = o.recogniser.filter;
    params.kind = filterKind(name);
    filters.emplace_back(name, PlaceFilter(graph, params));
  }
  std::vector<std::size_t> right_by(filters.size(), 0);
  const auto descriptor = model.makeDescriptor();
  std::vector<float> signature(static_cast<std::size_t>(descriptor->size()));
  std::vector<Row> rows;
  std::vector<double> descriptor_ms, frame_ms;
  std::vector<std::string> unknown_places;
  {
    hyselam::Progress progress("frames", frames);
    for (std::size_t i = 0; i < frames; ++i) {
      progress.update(i);
      const TrainingFrame frame = tours.load(0, i);
      try {
        const double t0 = cpuMilliseconds();
        descriptor->compute(frame.image, frame.readings, signature.data());
        const double t1 = cpuMilliseconds();
        const Recognition r = recogniser.update(frame.image, frame.readings);
        descriptor_ms.push_back(t1 - t0);
        frame_ms.push_back(cpuMilliseconds() - t1);
        rows.push_back({model.graph.find(frame.place), r});
        for (std::size_t k = 0; k < filters.size(); ++k) {
          if (r.descriptive && !r.novel) filters[k].second.update(recogniser.frameProbabilities());
          right_by[k] += filters[k].second.estimate().place == rows.back().truth;
        }
      } catch (const hyselam::ParameterError& e) {
        throw hyselam::InputError(tours.frame(0, i).image, "", e.what());
      } catch (const std::invalid_argument& e) {
        throw hyselam::InputError(tours.frame(0, i).image, "", e.what());
      }
      if (rows.back().truth < 0 && std::find(unknown_places.begin(), unknown_places.end(),
                                             frame.place) == unknown_places.end()) {
        unknown_places.push_back(frame.place);
      }
    }
  }
  const std::size_t n = model.graph.places.size();
  // A place that the model never saw counts as wrong unless the answer is "unknown".
  std::vector<std::vector<int>> confusion(n + 1, std::vector<int>(n + 1, 0));
  std::size_t right = 0, right_alone = 0, right_with_second = 0, descriptive = 0, novel = 0;
  for (const Row& row : rows) {
    const Recognition& r = row.recognition;
    ++confusion[row.truth < 0 ? n : static_cast<std::size_t>(row.truth)]
               [r.estimate.place < 0 ? n : static_cast<std::size_t>(r.estimate.place)];
    right += r.estimate.place == row.truth;
    right_with_second +=
        r.estimate.place == row.truth || (r.estimate.second >= 0 && r.estimate.second == row.truth);
    right_alone += r.frame_place == row.truth;
    descriptive += r.descriptive;
    novel += r.novel;
  }
  nlohmann::json per_place = nlohmann::json::object(), matrix = nlohmann::json::object();
  for (std::size_t t = 0; t <= n; ++t) {
    int all = 0;
    for (const int c : confusion[t]) all += c;
    if (t == n && all == 0) continue;
    const std::string truth = t == n ? "unknown" : model.graph.places[t];
    per_place[truth] = {{"frames", all},
                        {"accuracy", all > 0 ? nlohmann::json(confusion[t][t] / double(all))
                                             : nlohmann::json(nullptr)}};
    for (std::size_t p = 0; p <= n; ++p) {
      if (confusion[t][p] > 0) {
        matrix[truth][p == n ? "unknown" : model.graph.places[p]] = confusion[t][p];
      }
    }
  }
  const double all = static_cast<double>(rows.size());
  nlohmann::json by_filter;
  if (o.recogniser.filter.kind == FilterKind::kPoses) by_filter["poses"] = right / all;
  for (std::size_t k = 0; k < filters.size(); ++k) by_filter[filters[k].first] = right_by[k] / all;
  nlohmann::json result = {{"accuracy", right / all},
                           {"accuracy_frame_alone", right_alone / all},
                           {"accuracy_with_transitions", right_with_second / all},
                           {"frames", rows.size()},
                           {"descriptive_frames", descriptive},
                           {"novel_frames", novel},
                           {"accuracy_by_filter", by_filter},
                           {"per_place", per_place},
                           {"confusion", matrix},
                           {"descriptor_ms", median(descriptor_ms)},
                           {"frame_ms", median(frame_ms)},
                           {"descriptor", model.descriptor},
                           {"kernel", nameOf(model.classifier.kernel)},
                           {"filter", o.filter},
                           {"unknown_places", unknown_places},
                           {"places_not_on_map", not_on_map}};
  std::cout << right << " of " << rows.size() << " frames right (" << std::fixed
            << std::setprecision(1) << 100.0 * right / all << " %)\n";
  if (!o.predictions.empty()) writePredictions(o.predictions, tours, rows, model.graph.places);
  if (!o.plots.empty()) {
    std::error_code error;
    std::filesystem::create_directories(o.plots, error);
    if (error) throw hyselam::InputError(o.plots, "", "cannot be made: " + error.message());
    std::vector<std::string> truths = model.graph.places, answers = model.graph.places;
    bool any_unknown = false;
    for (std::size_t t = 0; t <= n; ++t) any_unknown = any_unknown || confusion[t][n] > 0;
    if (any_unknown) answers.push_back("unknown");
    if (!unknown_places.empty()) truths.push_back("unknown");
    std::vector<int> truth, answer;
    for (const Row& row : rows) {
      truth.push_back(row.truth);
      answer.push_back(row.recognition.estimate.place);
    }
    std::ostringstream title;
    title << model.descriptor << ", " << nameOf(model.classifier.kernel) << ", filter " << o.filter
          << ": " << std::fixed << std::setprecision(1) << 100.0 * right / all << " %";
    writePicture((std::filesystem::path(o.plots) / "confusion.png").string(),
                 drawConfusion(truths, answers, confusion, title.str()));
    writePicture((std::filesystem::path(o.plots) / "timeline.png").string(),
                 drawTimeline(model.graph.places, truth, answer, title.str()));
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Recognises the places of a labelled tour and counts how often rightly.",
               "evaluate"};
  Options o;
  PlaceFilterParams& f = o.recogniser.filter;
  app.add_option("model", o.model, "model directory")->required();
  app.add_option("--labels", o.labels, "CSV: image_path,place[,sensor columns], in time order")
      ->required();
  app.add_option("--topology", o.topology,
                 "places and transitions: topo.xml, JSON or CSV; default: those seen in training");
  app.add_option("--filter", o.filter = "markov", "none, lowpass, markov, bayes or poses")
      ->capture_default_str();
  app.add_option("--images", o.images = "none", "images passed over: none, or by sift or corners")
      ->capture_default_str();
  app.add_option("--min-features", o.recogniser.descriptive.min_features,
                 "below it an image is passed over; 0: 10 by sift, 20 by corners")
      ->capture_default_str();
  app.add_option("--alpha", f.alpha, "of the low-pass filter (Eq. 6.15)")->capture_default_str();
  app.add_option("--rho1", f.rho1, "of the Markov chain (Eq. 6.23)")->capture_default_str();
  app.add_option("--rho2", f.rho2, "of the Markov chain (Eq. 6.23)")->capture_default_str();
  app.add_option("--stay-min", f.stay_min, "least probability of staying")->capture_default_str();
  app.add_option("--stay", f.stay, "of the Bayes filter")->capture_default_str();
  app.add_option("--trust", f.trust, "of the Bayes filter")->capture_default_str();
  PoseFilterParams& p = o.recogniser.poses;
  app.add_option("--particles", p.particles, "of the filter over poses")->capture_default_str();
  app.add_option("--pose-beta", p.beta, "poses: fall of likeness")->capture_default_str();
  app.add_option("--pose-trust", p.trust, "poses: exponent of a second of frames")
      ->capture_default_str();
  app.add_option("--pose-reach", p.reach, "poses: a frame looks like those so near [m]")
      ->capture_default_str();
  app.add_option("--pose-turn", p.turn, "poses: and turned by less [rad]")->capture_default_str();
  app.add_option("--pose-doubt", p.doubt, "poses: weight of the likeness of no pose")
      ->capture_default_str();
  app.add_option("--pose-jump", p.jump, "poses: share set anew, a second")->capture_default_str();
  app.add_option("--pose-seed", p.seed, "poses: of the particles")->capture_default_str();
  app.add_option("--unknown-below", f.unknown_below, "probability below which a place is unknown")
      ->capture_default_str();
  app.add_option("--novelty-max", o.recogniser.novelty_max,
                 "distance, in usual ones, beyond which a frame is unknown; 0: never")
      ->capture_default_str();
  app.add_option("--predictions", o.predictions, "CSV of all frames");
  app.add_option("--plots", o.plots, "directory for confusion.png and timeline.png");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
