#include "linear_classifier.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string_view>

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr float kUnit = 1000.0f;       // weights are written in thousandths
constexpr int kHeaviest = 100'000;     // of them: ten times what training has ever given
constexpr double kLargestSum = 700.0;  // whose exponential is a number

/// Up to the separator, which goes with it.
std::string_view cut(std::string_view* rest, char separator) {
  const std::size_t at = std::min(rest->find(separator), rest->size());
  const std::string_view part = rest->substr(0, at);
  rest->remove_prefix(std::min(at + 1, rest->size()));
  return part;
}

template <typename Number>
bool isNumber(std::string_view text, Number* value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

LinearClassifier LinearClassifier::fromText(const std::string& source, const std::string& text) {
  LinearClassifier model;
  std::string_view rest = text;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const auto fail = [&, at = number](const std::string& reason) {
      throw hyselam::InputError(source, "line " + std::to_string(at), reason);
    };
    std::string_view line = cut(&rest, '\n');
    const std::string feature(cut(&line, ' '));
    if (feature.empty()) fail("is empty");
    if (number == 1) {
      if (feature != "classes") fail("must begin with 'classes'");
      while (!line.empty()) {
        const std::string name(cut(&line, ' '));
        if (name.empty()) fail("has a class without a name");
        const auto& before = model.classes_;
        if (std::find(before.begin(), before.end(), name) != before.end()) {
          fail("has class '" + name + "' twice");
        }
        model.classes_.push_back(name);
      }
      if (model.classes_.empty()) fail("names no class");
      continue;
    }
    while (!line.empty()) {
      const std::string_view field = cut(&line, ' ');
      std::string_view weight_text = field;
      const std::string_view index_text = cut(&weight_text, ':');
      std::size_t index = 0;
      int weight = 0;
      if (!isNumber(index_text, &index) || !isNumber(weight_text, &weight)) {
        fail("'" + std::string(field) + "' is not CLASS:WEIGHT");
      }
      if (std::abs(static_cast<long>(weight)) > kHeaviest) {
        fail("weight " + std::to_string(weight) + " is not within +-" + std::to_string(kHeaviest));
      }
      if (index >= model.classes_.size()) fail("there is no class " + std::to_string(index));
      model.setWeight(feature, index, static_cast<float>(weight) / kUnit);
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
  const std::map<std::string, std::size_t> sorted(features_.begin(), features_.end());
  for (const auto& [feature, at] : sorted) {
    out << feature;
    for (const auto& [index, weight] : weights_[at]) {
      out << ' ' << index << ':' << std::lround(weight * kUnit);
    }
    out << '\n';
  }
  return out.str();
}

void LinearClassifier::setWeight(const std::string& feature, std::size_t of_class, float weight) {
  const auto [found, is_new] = features_.emplace(feature, weights_.size());
  if (is_new) weights_.emplace_back();
  weights_[found->second].emplace_back(of_class, weight);
}

std::vector<double> LinearClassifier::scores(const Features& features) const {
  std::vector<std::size_t> known;
  known.reserve(features.size());
  for (const std::string& feature : features) {
    const auto found = features_.find(feature);
    if (found != features_.end()) known.push_back(found->second);
  }
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  std::vector<double> sums(classes_.size(), 0.0);
  for (const std::size_t at : known) {
    for (const auto& [index, weight] : weights_[at]) sums[index] += weight;
  }
  return sums;
}

std::vector<double> LinearClassifier::probabilitiesOf(std::vector<double> scores) {
  double sum = 0.0;
  for (double& score : scores) {
    const double bounded = std::min(std::max(score, -kLargestSum), kLargestSum);
    sum += score = 1.0 / (1.0 + std::exp(-bounded));
  }
  for (double& score : scores) score /= sum;
  return scores;
}

std::vector<double> LinearClassifier::probabilities(const Features& features) const {
  return probabilitiesOf(scores(features));
}

}  // namespace language
}  // namespace hyselam_topo
