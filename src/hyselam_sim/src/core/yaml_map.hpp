// A YAML mapping read strictly: every key is known, every number finite, every message says where.
#pragma once

#include <yaml-cpp/yaml.h>

#include <limits>
#include <string>
#include <vector>

#include "hyselam_sim/geometry.hpp"

namespace hyselam_sim {

/// ", did you mean 'x'?" with the nearest candidate, or the list of candidates if none is near.
std::string suggestion(const std::string& wrong, const std::vector<std::string>& candidates);

class YamlMap {
 public:
  /// `path` names the mapping in messages ("doors[2]", empty for the whole file). Throws
  /// hyselam::InputError if the node is no mapping or has an unknown or repeated key.
  YamlMap(std::string source, std::string path, const YAML::Node& node,
          const std::vector<std::string>& known_keys);

  bool has(const std::string& key) const { return static_cast<bool>(node_[key]); }
  YAML::Node child(const std::string& key) const;
  std::string pathOf(const std::string& key) const;
  const std::string& source() const { return source_; }

  /// Finite and within [low, high].
  double number(const std::string& key, double low, double high) const;
  double numberOr(const std::string& key, double fallback, double low, double high) const;
  std::string text(const std::string& key) const;
  std::string textOr(const std::string& key, const std::string& fallback) const;
  bool boolean(const std::string& key) const;
  Point2 point(const std::string& key) const;
  std::vector<Point2> points(const std::string& key, std::size_t at_least) const;
  /// The entries of a list; empty if the key is missing.
  std::vector<YAML::Node> list(const std::string& key) const;
  /// One of the words.
  std::string choice(const std::string& key, const std::vector<std::string>& words,
                     const std::string& fallback) const;

  [[noreturn]] void fail(const std::string& key, const std::string& reason) const;

  /// As the members, for nodes that are not values of a mapping.
  static double numberIn(const std::string& source, const std::string& path, const YAML::Node& node,
                         double low, double high);
  static std::vector<double> numbersIn(const std::string& source, const std::string& path,
                                       const YAML::Node& node);
  [[noreturn]] static void failAt(const std::string& source, const std::string& path,
                                  const YAML::Node& node, const std::string& reason);

 private:
  std::string source_;
  std::string path_;
  YAML::Node node_;
};

/// No coordinate of a building is larger than this [m].
constexpr double kMaxCoordinate = 1e4;

}  // namespace hyselam_sim
