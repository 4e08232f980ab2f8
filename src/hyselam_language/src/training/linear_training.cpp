#include "linear_training.hpp"

#include <linear.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace language {
namespace {

void saysNothing(const char* /*unused*/) {}

struct FreeModel {
  void operator()(model* of) const { free_and_destroy_model(&of); }
};

}  // namespace

void TrainingSet::add(const Features& features, const std::string& label) {
  features_.push_back(features);
  std::sort(features_.back().begin(), features_.back().end());
  features_.back().erase(std::unique(features_.back().begin(), features_.back().end()),
                         features_.back().end());
  labels_.push_back(label);
}

LinearClassifier TrainingSet::train(double cost, std::size_t least_seen) const {
  std::map<std::string, std::size_t> seen, label_seen;
  for (const Features& each : features_) {
    for (const std::string& feature : each) ++seen[feature];
  }
  for (const std::string& label : labels_) ++label_seen[label];
  std::vector<std::string> names, classes;
  std::map<std::string, int> index, class_index;
  for (const auto& [feature, times] : seen) {
    if (times < least_seen) continue;
    names.push_back(feature);
    index[feature] = static_cast<int>(names.size());
  }
  for (const auto& [label, times] : label_seen) {
    if (times < least_seen) continue;
    class_index[label] = static_cast<int>(classes.size());
    classes.push_back(label);
  }
  if (classes.empty()) throw hyselam::InputError("training", "", "there is no example");

  std::vector<std::vector<feature_node>> rows;
  std::vector<double> targets;
  for (std::size_t i = 0; i < features_.size(); ++i) {
    const auto of_class = class_index.find(labels_[i]);
    if (of_class == class_index.end()) continue;
    std::vector<feature_node> row;
    for (const std::string& feature : features_[i]) {
      const auto found = index.find(feature);
      if (found != index.end()) row.push_back({found->second, 1.0});
    }
    row.push_back({-1, 0.0});
    rows.push_back(std::move(row));
    targets.push_back(of_class->second);
  }
  std::vector<feature_node*> pointers;
  for (auto& row : rows) pointers.push_back(row.data());
  problem examples{};
  examples.l = static_cast<int>(rows.size());
  examples.n = static_cast<int>(names.size());
  examples.y = targets.data();
  examples.x = pointers.data();
  examples.bias = -1.0;
  parameter how{};
  how.solver_type = L1R_LR;
  how.C = cost;
  how.eps = 0.01;
  if (const char* wrong = check_parameter(&examples, &how)) {
    throw hyselam::ParameterError("cost", cost, wrong);
  }
  set_print_string_function(&saysNothing);
  std::srand(1);  // liblinear's only source of chance
  const std::unique_ptr<model, FreeModel> learnt(::train(&examples, &how));

  LinearClassifier classifier(classes);
  const int count = get_nr_class(learnt.get());
  std::vector<int> labels(static_cast<std::size_t>(count));
  get_labels(learnt.get(), labels.data());
  for (std::size_t feature = 0; feature < names.size(); ++feature) {
    for (int i = 0; i < count; ++i) {
      const double weight = get_decfun_coef(learnt.get(), static_cast<int>(feature) + 1, i);
      if (std::abs(weight) < 0.0005) continue;
      classifier.setWeight(names[feature],
                           static_cast<std::size_t>(labels[static_cast<std::size_t>(i)]),
                           static_cast<float>(weight));
    }
  }
  return classifier;
}

}  // namespace language
}  // namespace hyselam_topo
