#include "linear_classifier.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace language {

LinearClassifier LinearClassifier::fromText(const std::string& source, const std::string& text) {
  LinearClassifier model;
  std::istringstream lines(text);
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    const auto fail = [&, at = number](const std::string& reason) {
      throw hyselam::InputError(source, "line " + std::to_string(at), reason);
    };
    std::istringstream fields(line);
    std::string feature, field;
    if (!(fields >> feature)) fail("is empty");
    if (number == 1) {
      if (feature != "classes") fail("must begin with 'classes'");
      while (fields >> field) model.classes_.push_back(field);
      if (model.classes_.empty()) fail("names no class");
      continue;
    }
    while (fields >> field) {
      const std::size_t colon = field.find(':');
      std::istringstream index_text(field.substr(0, colon));
      std::istringstream weight_text(colon == std::string::npos ? "" : field.substr(colon + 1));
      std::size_t index = 0;
      float weight = 0.0f;
      if (!(index_text >> index) || !(weight_text >> weight) || !std::isfinite(weight)) {
        fail("'" + field + "' is not CLASS:WEIGHT");
      }
      if (index >= model.classes_.size()) fail("there is no class " + std::to_string(index));
      model.setWeight(feature, index, weight);
    }
  }
  if (model.classes_.empty()) throw hyselam::InputError(source, "", "is empty");
  return model;
}

std::string LinearClassifier::toText() const {
  std::ostringstream out;
  out << "classes";
  for (const std::string& each : classes_) out << ' ' << each;
  out << '\n';
  const std::map<std::string, std::vector<Weight>> sorted(weights_.begin(), weights_.end());
  for (const auto& [feature, weights] : sorted) {
    out << feature;
    for (const auto& [index, weight] : weights) {
      out << ' ' << index << ':' << std::round(weight * 1000.0f) / 1000.0f;
    }
    out << '\n';
  }
  return out.str();
}

void LinearClassifier::setWeight(const std::string& feature, std::size_t of_class, float weight) {
  weights_[feature].emplace_back(of_class, weight);
}

std::vector<double> LinearClassifier::probabilities(const Features& features) const {
  std::vector<double> scores(classes_.size(), 0.0);
  for (const std::string& feature : features) {
    const auto found = weights_.find(feature);
    if (found == weights_.end()) continue;
    for (const auto& [index, weight] : found->second) scores[index] += weight;
  }
  double sum = 0.0;
  for (double& score : scores) sum += score = 1.0 / (1.0 + std::exp(-score));
  for (double& score : scores) score /= sum;
  return scores;
}

}  // namespace language
}  // namespace hyselam_topo
