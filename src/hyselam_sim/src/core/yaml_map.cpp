#include "yaml_map.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "hyselam_common/edit_distance.hpp"
#include "hyselam_common/errors.hpp"

namespace hyselam_sim {
namespace {

std::string place(const std::string& path, const YAML::Node& node) {
  std::ostringstream out;
  if (node && node.Mark().line >= 0) out << "line " << node.Mark().line + 1;
  if (!path.empty()) out << (out.str().empty() ? "" : ", ") << "key '" << path << "'";
  return out.str();
}

}  // namespace

std::string suggestion(const std::string& wrong, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::numeric_limits<std::size_t>::max();
  for (const std::string& candidate : candidates) {
    const std::size_t d = hyselam::editDistance(wrong, candidate);
    if (d < best_distance) {
      best_distance = d;
      best = candidate;
    }
  }
  if (best.empty()) return "";
  if (best_distance <= std::max<std::size_t>(2, wrong.size() / 2)) {
    return ", did you mean '" + best + "'?";
  }
  std::string all;
  for (std::size_t i = 0; i < candidates.size() && i < 20; ++i) {
    all += (i ? ", " : "") + candidates[i];
  }
  return "; known are: " + all + (candidates.size() > 20 ? ", ..." : "");
}

YamlMap::YamlMap(std::string source, std::string path, const YAML::Node& node,
                 const std::vector<std::string>& known_keys)
    : source_(std::move(source)), path_(std::move(path)), node_(node) {
  if (!node_.IsMap()) failAt(source_, path_, node_, "must be a mapping (key: value)");
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) failAt(source_, path_, entry.first, "has a key that is no word");
    const std::string key = entry.first.Scalar();
    if (std::find(known_keys.begin(), known_keys.end(), key) == known_keys.end()) {
      failAt(source_, pathOf(key), entry.first, "unknown key" + suggestion(key, known_keys));
    }
    if (!seen.insert(key).second) failAt(source_, pathOf(key), entry.first, "given twice");
  }
}

std::string YamlMap::pathOf(const std::string& key) const {
  return path_.empty() ? key : path_ + "." + key;
}

YAML::Node YamlMap::child(const std::string& key) const {
  if (!has(key)) failAt(source_, pathOf(key), node_, "missing");
  return node_[key];
}

void YamlMap::failAt(const std::string& source, const std::string& path, const YAML::Node& node,
                     const std::string& reason) {
  throw hyselam::InputError(source, place(path, node), reason);
}

void YamlMap::fail(const std::string& key, const std::string& reason) const {
  failAt(source_, pathOf(key), has(key) ? node_[key] : node_, reason);
}

double YamlMap::numberIn(const std::string& source, const std::string& path, const YAML::Node& node,
                         double low, double high) {
  double value = 0.0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value)) {
    failAt(source, path, node, "must be a number");
  }
  if (!std::isfinite(value)) failAt(source, path, node, "must be a finite number");
  if (value < low || value > high) {
    std::ostringstream reason;
    reason << "is " << value << ", but must be within " << low << " .. " << high;
    failAt(source, path, node, reason.str());
  }
  return value;
}

std::vector<double> YamlMap::numbersIn(const std::string& source, const std::string& path,
                                       const YAML::Node& node) {
  if (!node.IsSequence()) failAt(source, path, node, "must be a list of numbers");
  std::vector<double> out;
  for (std::size_t i = 0; i < node.size(); ++i) {
    out.push_back(numberIn(source, path, node[i], -kMaxCoordinate, kMaxCoordinate));
  }
  return out;
}

double YamlMap::number(const std::string& key, double low, double high) const {
  return numberIn(source_, pathOf(key), child(key), low, high);
}

double YamlMap::numberOr(const std::string& key, double fallback, double low, double high) const {
  return has(key) ? number(key, low, high) : fallback;
}

std::string YamlMap::text(const std::string& key) const {
  const YAML::Node node = child(key);
  if (!node.IsScalar() || node.Scalar().empty()) fail(key, "must be a non-empty text");
  return node.Scalar();
}

std::string YamlMap::textOr(const std::string& key, const std::string& fallback) const {
  return has(key) ? text(key) : fallback;
}

bool YamlMap::boolean(const std::string& key) const {
  const YAML::Node node = child(key);
  bool value = false;
  if (!node.IsScalar() || !YAML::convert<bool>::decode(node, value)) {
    fail(key, "must be true or false");
  }
  return value;
}

Point2 YamlMap::point(const std::string& key) const {
  const std::vector<double> xy = numbersIn(source_, pathOf(key), child(key));
  if (xy.size() != 2) fail(key, "must be a point [x, y]");
  return {xy[0], xy[1]};
}

std::vector<Point2> YamlMap::points(const std::string& key, std::size_t at_least) const {
  std::vector<Point2> out;
  const std::vector<YAML::Node> nodes = list(key);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::string path = pathOf(key) + "[" + std::to_string(i) + "]";
    const std::vector<double> xy = numbersIn(source_, path, nodes[i]);
    if (xy.size() != 2) failAt(source_, path, nodes[i], "must be a point [x, y]");
    out.push_back({xy[0], xy[1]});
  }
  if (out.size() < at_least) {
    fail(key, "must have at least " + std::to_string(at_least) + " points");
  }
  return out;
}

std::vector<YAML::Node> YamlMap::list(const std::string& key) const {
  if (!has(key)) return {};
  const YAML::Node node = node_[key];
  if (!node.IsSequence()) fail(key, "must be a list");
  return {node.begin(), node.end()};
}

std::string YamlMap::choice(const std::string& key, const std::vector<std::string>& words,
                            const std::string& fallback) const {
  std::string word = textOr(key, fallback);
  if (std::find(words.begin(), words.end(), word) == words.end()) {
    fail(key, "is '" + word + "'" + suggestion(word, words));
  }
  return word;
}

}  // namespace hyselam_sim
