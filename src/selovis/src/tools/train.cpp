// train: learns places from labeled images.
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "tours.hpp"

namespace {

using namespace selovis;  // NOLINT: a program, not a header

struct Options {
  std::vector<std::string> labels;
  std::string out, kernel, views, libsvm;
  bool add = false;
  TrainingOptions training;
};

/// One progress line per stage.
class Stages {
 public:
  void operator()(const std::string& stage, std::size_t done, std::size_t all) {
    if (stage != stage_) {
      line_ = std::make_unique<hyselam::Progress>(stage, all);
      stage_ = stage;
    }
    line_->update(done);
  }

 private:
  std::string stage_;
  std::unique_ptr<hyselam::Progress> line_;
};

void printFusion(const nlohmann::json& fusion) {
  const auto left_out = fusion["left_out"].get<std::string>();
  if (left_out == "nothing") {
    std::cout << "parts weighted as other environments suggest: too few frames to leave some out\n";
    return;
  }
  std::cout << fusion["frames"] << " frames asked for, their " << left_out
            << " left out: " << std::lround(100.0 * fusion["accuracy"].get<double>())
            << " % right\n";
  for (const auto& part : fusion["parts"]) {
    std::cout << "  " << std::left << std::setw(16) << part["name"].get<std::string>() << std::right
              << std::fixed << std::setprecision(2) << " weight " << part["weight"].get<double>()
              << ", alone " << std::lround(100.0 * part["accuracy"].get<double>()) << " %\n";
  }
}

nlohmann::json run(Options& o) {
  const Tours tours(o.labels);
  const auto load = [&](std::size_t tour, std::size_t i) { return tours.load(tour, i); };
  auto stages = std::make_shared<Stages>();
  TrainingOptions& t = o.training;
  t.progress = [stages](const std::string& stage, std::size_t done, std::size_t all) {
    (*stages)(stage, done, all);
  };
  t.classifier.kernel = svmKernelFromString(o.kernel);
  if (o.views != "auto") t.views = numbersOf(o.views, "--views");
  PlaceModel model;
  const auto learn = [&](const std::string& libsvm_file) {
    t.libsvm_file = libsvm_file;
    model = o.add ? extendPlaceModel(loadPlaceModel(o.out), tours.sizes(), load, t)
                  : trainPlaceModel(tours.sizes(), load, t);
  };
  if (o.libsvm.empty()) {
    learn("");
  } else {
    hyselam::replaceFileAtomically(o.libsvm, learn);
  }
  savePlaceModel(model, o.out);
  nlohmann::json result = {{"descriptor", model.descriptor},
                           {"signature_size", model.samples.size},
                           {"kernel", toString(model.classifier.kernel)},
                           {"cost", model.classifier.cost},
                           {"gamma", model.classifier.gamma},
                           {"places", model.transitions.places},
                           {"signatures", model.samples.count()},
                           {"model", o.out}};
  if (model.classifier.kernel == SvmKernel::kFusion) {
    result["fusion"] = nlohmann::json::parse(model.svm);
    printFusion(result["fusion"]);
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Learns places from labeled images and writes a model directory.", "train"};
  Options o;
  TrainingOptions& t = o.training;
  app.add_option("--labels", o.labels, "CSV: image_path,place[,sensor columns]; one file per tour")
      ->required();
  app.add_option("--out", o.out, "model directory")->required();
  app.add_option("--descriptor", t.descriptor, "name, as in the thesis; --list shows some")
      ->capture_default_str();
  app.add_option("--kernel", o.kernel = toString(t.classifier.kernel),
                 "fusion, exemplar, linear, poly or rbf")
      ->capture_default_str();
  app.add_flag("--grid", t.grid_search, "choose cost and gamma (beta) by cross-validation");
  app.add_flag("--add", o.add, "add the frames, and new places, to the model in --out");
  app.add_option("--cost", t.classifier.cost, "C of the SVM")->capture_default_str();
  app.add_option("--gamma", t.classifier.gamma, "gamma of poly and rbf")->capture_default_str();
  app.add_option("--beta", t.classifier.beta, "sharpness of the exemplar kernel")
      ->capture_default_str();
  app.add_option("--neighbours", t.classifier.neighbors, "exemplars that are weighted")
      ->capture_default_str();
  app.add_option("--power", t.classifier.power, "each value is raised to it; 1: as it is")
      ->capture_default_str();
  app.add_option(
         "--views", o.views = "auto",
         "sideways shifts of each image, in widths; auto: five for fusion and exemplar, else one")
      ->capture_default_str();
  app.add_option("--aperture", t.horizontal_fov, "horizontal field of view of the camera [rad]")
      ->capture_default_str();
  app.add_option("--heading-weight", t.descriptor_params.heading_weight, "of psi and [psi]")
      ->capture_default_str();
  app.add_option("--range-weight", t.descriptor_params.range_weight, "of An and scan")
      ->capture_default_str();
  app.add_option("--lbp-radius", t.descriptor_params.lbp.radius, "[pixels]")->capture_default_str();
  app.add_option("--seed", t.seed, "of k-means; cross-validation for probabilities has its own")
      ->capture_default_str();
  app.add_option("--libsvm", o.libsvm, "also write libsvm's own model file");
  app.add_flag_callback(
      "--list",
      [] {
        for (const auto& name : descriptorNames()) std::cout << name << '\n';
        throw CLI::Success();
      },
      "list descriptors and exit");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
