// evaluate: how well a model recognizes the places of a labeled tour.
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <iomanip>
#include <iostream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/confusion_csv.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "selovis/learning/error_source.hpp"
#include "selovis/places/topological_places.hpp"
#include "selovis/recognition/image_recognizer.hpp"
#include "tours.hpp"

namespace {

using namespace selovis;  // NOLINT: a program, not a header

constexpr const char* kUnknown = "unknown";

struct Options {
  std::string model, labels, topology, filter = toString(PlaceFilterKind::kAuto), images = "none",
                                       predictions, plots;
  ImageRecognizerParams recognizer;
};

double cpuMilliseconds() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Median; 0 of nothing.
double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The filters over places, all fed with the same frames, for comparison.
class FilterComparison {
 public:
  FilterComparison(const PlaceTransitions& transitions, PlaceFilterParams params) {
    for (const PlaceFilterKind kind : {PlaceFilterKind::kNone, PlaceFilterKind::kLowPass,
                                       PlaceFilterKind::kMarkov, PlaceFilterKind::kBayes}) {
      params.kind = kind;
      filters_.emplace_back(transitions, params);
      names_.emplace_back(toString(kind));
    }
    right_.assign(filters_.size(), 0);
  }

  void add(const Recognition& recognition, const std::vector<double>& frame, int truth) {
    for (std::size_t k = 0; k < filters_.size(); ++k) {
      if (recognition.descriptive && !recognition.novel) filters_[k].update(frame);
      right_[k] += filters_[k].estimate().place == truth;
    }
  }

  nlohmann::json accuracies(double frames) const {
    nlohmann::json result;
    for (std::size_t k = 0; k < filters_.size(); ++k) {
      result[names_[k]] = static_cast<double>(right_[k]) / frames;
    }
    return result;
  }

 private:
  std::vector<PlaceFilter> filters_;
  std::vector<std::string> names_;
  std::vector<std::size_t> right_;
};

struct Row {
  int truth;  // -1: a place that the model does not have
  Recognition recognition;
};

struct Evaluation {
  std::vector<Row> rows;
  std::vector<double> descriptor_ms, frame_ms;
  std::vector<std::string> unknown_places;  // of the tour, not in the model
  nlohmann::json accuracy_by_filter;
  std::string warning;
};

/// What keeps poses from being used although the filter is for them; empty: nothing.
std::string warningOf(const ImageRecognizer& recognizer, PlaceFilterKind filter, bool odometry) {
  if (!recognizer.posesProblem().empty()) {
    return "filtered by places alone: the learned frames " + recognizer.posesProblem();
  }
  return filter == PlaceFilterKind::kPoses && !odometry
             ? "the filter poses has no odometry (odom_x, odom_y, odom_theta): without it auto and "
               "bayes do better"
             : "";
}

Evaluation evaluateTour(const PlaceModel& model, const PlaceTransitions& transitions,
                        const Options& o, const Tours& tours) {
  ImageRecognizer recognizer(model, transitions, o.recognizer);
  FilterComparison filters(transitions, o.recognizer.filter);
  const auto descriptor = model.makeDescriptor();
  std::vector<float> signature(static_cast<std::size_t>(descriptor->size()));
  Evaluation result;
  const std::size_t frames = tours.sizes().front();
  bool odometry = false;
  hyselam::Progress progress("frames", frames);
  for (std::size_t i = 0; i < frames; ++i) {
    progress.update(i);
    const TrainingFrame frame = tours.load(0, i);
    const int truth = model.transitions.indexOf(frame.place);
    odometry = odometry || frame.readings.odometry;
    withSource(tours.frame(0, i).image, [&] {
      const double start = cpuMilliseconds();
      descriptor->compute(frame.image, frame.readings, signature.data());
      const double described = cpuMilliseconds();
      const Recognition r = recognizer.update(frame.image, frame.readings);
      result.descriptor_ms.push_back(described - start);
      result.frame_ms.push_back(cpuMilliseconds() - described);
      result.rows.push_back({truth, r});
      filters.add(r, recognizer.frameProbabilities(), truth);
    });
    auto& unknown = result.unknown_places;
    if (truth < 0 && std::find(unknown.begin(), unknown.end(), frame.place) == unknown.end()) {
      unknown.push_back(frame.place);
    }
  }
  result.accuracy_by_filter = filters.accuracies(static_cast<double>(frames));
  result.warning = warningOf(recognizer, o.recognizer.filter.kind, odometry);
  return result;
}

/// Counts [truth][answer]; the last of both is "unknown". A place that the model does not have is
/// right where the answer is "unknown".
using Confusion = std::vector<std::vector<std::size_t>>;

Confusion confusionOf(const std::vector<Row>& rows, std::size_t places) {
  Confusion confusion(places + 1, std::vector<std::size_t>(places + 1, 0));
  for (const Row& row : rows) {
    const int answer = row.recognition.estimate.place;
    ++confusion[row.truth < 0 ? places : static_cast<std::size_t>(row.truth)]
               [answer < 0 ? places : static_cast<std::size_t>(answer)];
  }
  return confusion;
}

void addConfusion(const Confusion& confusion, const std::vector<std::string>& names,
                  nlohmann::json& result) {
  nlohmann::json per_place = nlohmann::json::object(), matrix = nlohmann::json::object();
  for (std::size_t t = 0; t < names.size(); ++t) {
    std::size_t all = 0;
    for (const std::size_t c : confusion[t]) all += c;
    if (t + 1 == names.size() && all == 0) continue;
    per_place[names[t]] = {
        {"frames", all},
        {"accuracy",
         all > 0 ? nlohmann::json(static_cast<double>(confusion[t][t]) / static_cast<double>(all))
                 : nlohmann::json(nullptr)}};
    for (std::size_t p = 0; p < names.size(); ++p) {
      if (confusion[t][p] > 0) matrix[names[t]][names[p]] = confusion[t][p];
    }
  }
  result["per_place"] = per_place;
  result["confusion"] = matrix;
}

nlohmann::json summaryOf(const PlaceModel& model, const Options& o, const Evaluation& evaluation) {
  std::size_t right = 0, right_alone = 0, right_with_second = 0, descriptive = 0, novel = 0;
  for (const Row& row : evaluation.rows) {
    const Recognition& r = row.recognition;
    right += r.estimate.place == row.truth;
    right_with_second +=
        r.estimate.place == row.truth || (r.estimate.second >= 0 && r.estimate.second == row.truth);
    right_alone += r.frame_place == row.truth;
    descriptive += r.descriptive;
    novel += r.novel;
  }
  const double all = static_cast<double>(evaluation.rows.size());
  nlohmann::json by_filter = evaluation.accuracy_by_filter;
  const PlaceFilterKind filter = o.recognizer.filter.kind;
  if (filter == PlaceFilterKind::kPoses || filter == PlaceFilterKind::kAuto) {
    by_filter[toString(filter)] = static_cast<double>(right) / all;
  }
  std::cout << right << " of " << evaluation.rows.size() << " frames right (" << std::fixed
            << std::setprecision(1) << 100.0 * static_cast<double>(right) / all << " %)\n";
  return {{"accuracy", static_cast<double>(right) / all},
          {"accuracy_frame_alone", static_cast<double>(right_alone) / all},
          {"accuracy_with_transitions", static_cast<double>(right_with_second) / all},
          {"frames", evaluation.rows.size()},
          {"descriptive_frames", descriptive},
          {"novel_frames", novel},
          {"accuracy_by_filter", by_filter},
          {"descriptor_ms", median(evaluation.descriptor_ms)},
          {"frame_ms", median(evaluation.frame_ms)},
          {"descriptor", model.descriptor},
          {"kernel", toString(model.classifier.kernel)},
          {"filter", o.filter},
          {"unknown_places", evaluation.unknown_places}};
}

void writePredictions(const std::string& path, const Tours& tours, const std::vector<Row>& rows,
                      const std::vector<std::string>& places) {
  const auto name = [&](int place) {
    return csvCell(place < 0 ? std::string(kUnknown) : places[static_cast<std::size_t>(place)]);
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

/// The tables that scripts/plot_confusion and scripts/plot_places draw.
void writePlotTables(const std::string& folder, const Tours& tours, const Evaluation& evaluation,
                     const PlaceModel& model, const Confusion& confusion,
                     const std::vector<std::string>& names) {
  hyselam::makeFolder(folder);
  const auto file = [&](const char* name) {
    return (std::filesystem::path(folder) / name).string();
  };
  hyselam::writeConfusionCsv(file("confusion.csv"), {names, names, confusion});
  writePredictions(file("predictions.csv"), tours, evaluation.rows, model.transitions.places);
}

nlohmann::json run(Options& o) {
  o.recognizer.filter.kind = placeFilterKindFromString(o.filter);
  o.recognizer.descriptive.kind = descriptiveFilterKindFromString(o.images);
  const PlaceModel model = loadPlaceModel(o.model);
  const std::vector<std::string>& places = model.transitions.places;
  const Tours tours({o.labels});
  PlaceTransitions transitions = model.transitions;
  std::vector<std::string> not_on_map;
  if (!o.topology.empty()) {
    const PlaceTransitions topology = readTopology(o.topology);
    not_on_map = missingPlaces(topology, places);
    if (not_on_map.size() == places.size()) {
      throw hyselam::InputError(o.topology, "", "has none of the places of the model");
    }
    transitions = reordered(topology, places);
  }
  const Evaluation evaluation = evaluateTour(model, transitions, o, tours);
  const Confusion confusion = confusionOf(evaluation.rows, places.size());
  std::vector<std::string> names = places;
  names.emplace_back(kUnknown);
  nlohmann::json result = summaryOf(model, o, evaluation);
  result["places_not_on_map"] = not_on_map;
  if (!evaluation.warning.empty()) std::cerr << "warning: " << evaluation.warning << '\n';
  addConfusion(confusion, names, result);
  if (!o.predictions.empty()) writePredictions(o.predictions, tours, evaluation.rows, places);
  if (!o.plots.empty()) writePlotTables(o.plots, tours, evaluation, model, confusion, names);
  return result;
}

void addFilterOptions(CLI::App& app, PlaceFilterParams& f) {
  app.add_option("--alpha", f.low_pass_alpha, "of the low-pass filter (Eq. 6.15)");
  app.add_option("--rho1", f.markov.rho1, "of the Markov chain (Eq. 6.23)");
  app.add_option("--rho2", f.markov.rho2, "of the Markov chain (Eq. 6.23)");
  app.add_option("--stay-min", f.markov.min_stay_probability, "of the Markov chain (Eq. 6.24)");
  app.add_option("--stay", f.bayes.stay_probability, "Bayes filter: of staying in a place");
  app.add_option("--trust", f.bayes.likelihood_exponent, "Bayes filter: likelihood exponent");
  app.add_option("--unknown-below", f.min_place_probability,
                 "probability below which a place is unknown");
}

void addPoseFilterOptions(CLI::App& app, PoseFilterParams& p) {
  app.add_option("--particles", p.particles, "of the filter over poses");
  app.add_option("--pose-beta", p.similarity_beta, "poses: beta of the similarity");
  app.add_option("--pose-trust", p.likelihood_exponent,
                 "poses: likelihood exponent of a second of frames");
  app.add_option("--pose-reach", p.kernel_radius, "poses: radius of the kernel [m]");
  app.add_option("--pose-turn", p.kernel_angle, "poses: angle of the kernel [rad]");
  app.add_option("--pose-doubt", p.prior_weight, "poses: weight of the mean similarity");
  app.add_option("--pose-jump", p.injection_rate, "poses: share of particles redrawn a second");
  app.add_option("--pose-seed", p.seed, "poses: of the particles");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Recognizes the places of a labeled tour and counts the right answers.", "evaluate"};
  Options o;
  app.add_option("model", o.model, "model directory")->required();
  app.add_option("--labels", o.labels, "CSV: image_path,place[,sensor columns], in time order")
      ->required();
  app.add_option("--topology", o.topology,
                 "places and transitions: topo.xml, JSON or CSV; default: those seen in training");
  app.option_defaults()->always_capture_default();
  app.add_option("--filter", o.filter,
                 "auto (poses with odometry, else bayes), none, lowpass, markov, bayes or poses");
  app.add_option("--images", o.images, "images rejected: none, or by their sift or corners");
  app.add_option("--min-features", o.recognizer.descriptive.min_features,
                 "below which an image is rejected; 0: 10 by sift, 20 by corners");
  addFilterOptions(app, o.recognizer.filter);
  addPoseFilterOptions(app, o.recognizer.poses);
  app.add_option("--novelty-max", o.recognizer.max_novelty,
                 "distance, in typical ones, beyond which a frame is unknown; 0: never");
  app.option_defaults()->always_capture_default(false);
  app.add_option("--predictions", o.predictions, "CSV of all frames");
  app.add_option("--plots", o.plots,
                 "directory for confusion.csv and predictions.csv, see scripts/plot_confusion and "
                 "scripts/plot_places");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
