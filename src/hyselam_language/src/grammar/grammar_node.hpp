// A node of a grammar file (YAML) with the keys that lead there, for errors.
#pragma once

#include <yaml-cpp/yaml.h>

#include <functional>
#include <string>
#include <vector>

namespace hyselam_topo {
namespace language {

/// All throw hyselam::InputError with file, line and key unless the node is what is asked for.
class GrammarNode {
 public:
  /// The root of a file.
  static GrammarNode parse(const std::string& yaml, const std::string& source);

  [[noreturn]] void fail(const std::string& reason) const;

  std::string text() const;
  bool truth() const;
  double number() const;
  /// A list of texts; a single one is a list of one.
  std::vector<std::string> texts() const;

  using Visit = std::function<void(const std::string& key, const GrammarNode& value)>;
  /// Calls visit(key, node) for all keys in their order.
  void each(const Visit& visit) const;

 private:
  GrammarNode(const YAML::Node& node, std::string source, std::string path)
      : node_(node), source_(std::move(source)), path_(std::move(path)) {}

  YAML::Node node_;
  std::string source_;
  std::string path_;
};

}  // namespace language
}  // namespace hyselam_topo
