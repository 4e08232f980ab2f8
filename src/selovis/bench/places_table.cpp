// places_table: one descriptor's rows of a table of kernels and filters. The signatures are made
// once; every kernel learns from them and is asked with them.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <iostream>
#include <map>

#include "../src/tools/tours.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "selovis/recognition/image_recognizer.hpp"

namespace {

using namespace selovis;  // NOLINT: a program, not a header

struct Options {
  std::vector<std::string> learn, ask;
  std::string descriptor = "LBPbyHSV-U8N";
  std::vector<std::string> kernels{"linear",    "poly",     "rbf",     "linear:grid",
                                   "poly:grid", "rbf:grid", "exemplar"};
};

const char* const kFilters[] = {"none", "lowpass", "markov", "bayes"};

double cpuMilliseconds() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// How often the most likely place is right, by how likely it is said to be; and the mean negative
/// logarithm of the right place's probability.
class Reliability {
 public:
  void add(const std::vector<double>& probabilities, int truth) {
    const auto most = std::max_element(probabilities.begin(), probabilities.end());
    const double right = truth >= 0 ? probabilities[static_cast<std::size_t>(truth)] : 0.0;
    loss_ -= std::log(std::max(kLeast, right));
    const auto bin = std::min<std::size_t>(kBins - 1, static_cast<std::size_t>(*most * kBins));
    frames_[bin] += 1.0;
    said_[bin] += *most;
    right_[bin] += most - probabilities.begin() == truth;
  }
  nlohmann::json toJson() const {
    nlohmann::json bins = nlohmann::json::array();
    double all = 0.0, error = 0.0;
    for (int b = 0; b < kBins; ++b) {
      all += frames_[b];
      error += std::abs(said_[b] - right_[b]);
      if (frames_[b] > 0.0) {
        bins.push_back({{"frames", frames_[b]},
                        {"said", said_[b] / frames_[b]},
                        {"right", right_[b] / frames_[b]}});
      }
    }
    return {{"bins", bins},
            {"expected_calibration_error", error / std::max(1.0, all)},
            {"log_loss", loss_ / std::max(1.0, all)}};
  }

 private:
  static constexpr int kBins = 10;
  static constexpr double kLeast = 1e-6;  // a place that was ruled out, or never learned
  double loss_ = 0.0;
  double frames_[kBins] = {}, said_[kBins] = {}, right_[kBins] = {};
};

struct Asked {
  std::vector<std::vector<float>> signatures;
  std::vector<SensorReadings> readings;  // what the filter over poses needs
  std::vector<std::string> places;
};

/// "auto": fusion for FUSION and what is joined to it, else exemplar.
std::string kernelOf(const std::string& kernel, const std::string& descriptor) {
  if (kernel != "auto") return kernel;
  return toString(descriptor.compare(0, 6, "FUSION") == 0 ? SvmKernel::kFusion
                                                          : SvmKernel::kExemplar);
}

/// The filter over poses on the same frames, with and without odometry.
void addPoses(const PlaceModel& model, const Asked& tour, nlohmann::json* shares,
              nlohmann::json* reliabilities) {
  if (!comparesExemplars(model.classifier.kernel) || !model.samples.poses.front().isFinite()) {
    return;
  }
  for (const bool odometry : {false, true}) {
    if (odometry && !tour.readings.front().odometry) return;
    ImageRecognizerParams params;
    params.filter.kind = PlaceFilterKind::kPoses;
    ImageRecognizer recognizer(model, model.transitions, params);
    int right = 0;
    Reliability reliability;
    for (std::size_t i = 0; i < tour.signatures.size(); ++i) {
      SensorReadings readings = tour.readings[i];
      if (!odometry) readings.odometry.reset();
      const Recognition r = recognizer.updateWithSignature(tour.signatures[i].data(), readings);
      const int truth = model.transitions.indexOf(tour.places[i]);
      right += r.estimate.place == truth;
      reliability.add(recognizer.probabilities(), truth);
    }
    const char* const name = odometry ? "poses, odometry" : "poses";
    (*shares)[name] = right / static_cast<double>(tour.signatures.size());
    (*reliabilities)[name] = reliability.toJson();
  }
}

PlaceModel learn(const Options& o, const std::string& kernel, bool grid,
                 const PlaceModel* described) {
  TrainingOptions t;
  t.descriptor = o.descriptor;
  t.classifier.kernel = svmKernelFromString(kernel);
  t.grid_search = grid;
  if (described != nullptr) {
    PlaceModel model = *described;
    model.classifier = t.classifier;
    model = extendPlaceModel(std::move(model), {}, {},
                             t);  // no new frames: trained anew on the signatures that are there
    return model;
  }
  const Tours tours(o.learn);
  hyselam::Progress progress("learning", 1);
  return trainPlaceModel(
      tours.sizes(), [&](std::size_t tour, std::size_t i) { return tours.load(tour, i); }, t);
}

nlohmann::json rowOf(const PlaceModel& model, const std::vector<Asked>& asked,
                     std::vector<double>* frame_ms) {
  nlohmann::json row = nlohmann::json::array();
  for (const Asked& tour : asked) {
    std::vector<PlaceFilter> filters;
    for (const char* name : kFilters) {
      PlaceFilterParams params;
      params.kind = placeFilterKindFromString(name);
      filters.emplace_back(model.transitions, params);
    }
    ImageRecognizerParams params;
    ImageRecognizer recognizer(model, model.transitions, params);
    std::vector<int> right(filters.size(), 0);
    std::map<std::string, int> right_by_part;
    Reliability reliability;
    std::vector<Reliability> filtered(filters.size());
    std::size_t unlearned_light = 0;
    std::vector<double> novelties;
    for (std::size_t i = 0; i < tour.signatures.size(); ++i) {
      const double start = cpuMilliseconds();
      const Recognition r = recognizer.updateWithSignature(tour.signatures[i].data());
      frame_ms->push_back(cpuMilliseconds() - start);
      const int truth = model.transitions.indexOf(tour.places[i]);
      if (const auto* opinions = recognizer.opinions()) {
        for (const PartOpinion& o : *opinions) right_by_part[o.part] += o.place == truth;
      }
      unlearned_light += recognizer.lightIsUnlearned();
      novelties.push_back(r.novelty);
      reliability.add(recognizer.frameProbabilities(), truth);
      for (std::size_t f = 0; f < filters.size(); ++f) {
        filters[f].update(recognizer.frameProbabilities());
        right[f] += filters[f].estimate().place == truth;
        filtered[f].add(filters[f].probabilities(), truth);
      }
    }
    nlohmann::json shares, parts, reliabilities;
    for (const auto& [part, count] : right_by_part) {
      parts[part] = count / static_cast<double>(tour.signatures.size());
    }
    for (std::size_t f = 0; f < filters.size(); ++f) {
      shares[kFilters[f]] = right[f] / static_cast<double>(tour.signatures.size());
      reliabilities[kFilters[f]] = filtered[f].toJson();
    }
    addPoses(model, tour, &shares, &reliabilities);
    row.push_back({{"frames", tour.signatures.size()},
                   {"accuracy_by_filter", shares},
                   {"accuracy_by_part", parts},
                   {"unlearned_light",
                    static_cast<double>(unlearned_light) / static_cast<double>(novelties.size())},
                   {"novelties", novelties},
                   {"reliability", reliability.toJson()},
                   {"reliability_by_filter", reliabilities}});
  }
  return row;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

nlohmann::json run(const Options& o) {
  nlohmann::json rows = nlohmann::json::array();
  std::unique_ptr<PlaceModel> described;  // the signatures of the SVMs: one view of each image
  std::vector<Asked> asked;
  double descriptor_ms = 0.0;
  for (const auto& name : o.kernels) {
    const std::string kernel = kernelOf(name.substr(0, name.find(':')), o.descriptor);
    const bool grid = name.find(":grid") != std::string::npos;
    const bool exemplar = comparesExemplars(svmKernelFromString(kernel));
    // A dictionary depends on the training images only: it is the same for all kernels.
    PlaceModel model = learn(o, kernel, grid, exemplar ? nullptr : described.get());
    if (!exemplar && !described) described = std::make_unique<PlaceModel>(model);
    if (asked.empty()) {
      const auto descriptor = model.makeDescriptor();
      std::vector<double> ms;
      for (const auto& list : o.ask) {
        const Tours tours({list});
        Asked tour;
        hyselam::Progress progress("describing", tours.sizes().front());
        for (std::size_t i = 0; i < tours.sizes().front(); ++i) {
          progress.update(i);
          const TrainingFrame frame = tours.load(0, i);
          const double start = cpuMilliseconds();
          tour.signatures.push_back(descriptor->compute(frame.image, frame.readings));
          ms.push_back(cpuMilliseconds() - start);
          SensorReadings kept;
          kept.odometry = frame.readings.odometry;
          kept.stamp = frame.readings.stamp;
          tour.readings.push_back(kept);
          tour.places.push_back(frame.place);
        }
        asked.push_back(std::move(tour));
      }
      descriptor_ms = median(ms);
    }
    std::vector<double> frame_ms;
    const nlohmann::json tours = rowOf(model, asked, &frame_ms);
    rows.push_back({{"descriptor", o.descriptor},
                    {"kernel", name == "auto" ? kernel : name},
                    {"cost", model.classifier.cost},
                    {"gamma", model.classifier.gamma},
                    {"size", model.samples.size},
                    {"asked", tours},
                    {"descriptor_ms", descriptor_ms},
                    {"frame_ms", descriptor_ms + median(frame_ms)}});
    if (model.classifier.kernel == SvmKernel::kFusion) {
      rows.back()["fusion"] = nlohmann::json::parse(model.svm);
    }
  }
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Learns tours with one descriptor and several kernels, asks for the places of others.",
      "places_table"};
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("--learn", o.learn, "lists of labelled images, as of train")->required();
  app.add_option("--ask", o.ask, "lists to be asked for")->required();
  app.add_option("--descriptor", o.descriptor, "name");
  app.add_option(
         "--kernels", o.kernels,
         "names; with :grid cost and gamma by cross-validation; auto: fusion for FUSION, else "
         "exemplar")
      ->delimiter(',');
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
