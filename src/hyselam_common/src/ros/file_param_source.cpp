#include "hyselam_common/ros/file_param_source.hpp"

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/yaml_text.hpp"

namespace hyselam {
namespace {

using Values = std::map<std::string, XmlRpc::XmlRpcValue>;

constexpr std::size_t kLargestFile = std::size_t{1} << 20;

/// As rosparam: quoted is text, else a whole number, a number, true or false, or text.
XmlRpc::XmlRpcValue scalarOf(const YAML::Node& node) {
  bool truth = false;
  int whole = 0;
  double number = 0.0;
  // "!" is the tag of what stands between quotes.
  if (node.Tag() == "!") return XmlRpc::XmlRpcValue(node.Scalar());
  if (YAML::convert<int>::decode(node, whole)) return XmlRpc::XmlRpcValue(whole);
  if (YAML::convert<double>::decode(node, number)) return XmlRpc::XmlRpcValue(number);
  if (YAML::convert<bool>::decode(node, truth)) return XmlRpc::XmlRpcValue(truth);
  return XmlRpc::XmlRpcValue(node.Scalar());
}

/// Collects the values below a node. An alias may lead back to what holds it, or a few of them to
/// millions of values: depth and count are bounded.
class Gatherer {
 public:
  explicit Gatherer(const std::string& path) : path_(path) {}

  void gather(const YAML::Node& node, const std::string& name, int depth) {
    count(name);
    if (depth > kDeepest) throw InputError(path_, name.substr(0, 40), "nested too deep");
    if (node.IsMap()) {
      for (const auto& entry : node) {
        const std::string key = entry.first.Scalar();
        gather(entry.second, name.empty() ? key : name + "/" + key, depth + 1);
      }
    } else if (name.empty()) {
      throw InputError(path_, "", "holds no names of parameters with their values");
    } else if (node.IsSequence()) {
      take(name, listOf(node, name));
    } else if (node.IsScalar()) {
      take(name, scalarOf(node));
    } else {
      throw InputError(path_, name, "has no value");
    }
  }
  Values values;

 private:
  static constexpr int kDeepest = 16, kMost = 10000;

  void count(const std::string& name) {
    if (++count_ > kMost) throw InputError(path_, name, "too many values");
  }
  XmlRpc::XmlRpcValue listOf(const YAML::Node& node, const std::string& name) {
    XmlRpc::XmlRpcValue list;
    list.setSize(0);
    for (const auto& element : node) {
      count(name);
      if (!element.IsScalar()) throw InputError(path_, name, "is a list of more than values");
      const int at = list.size();
      list[at] = scalarOf(element);
    }
    return list;
  }
  void take(const std::string& name, const XmlRpc::XmlRpcValue& value) {
    if (!values.emplace(name, value).second) throw InputError(path_, name, "stands twice");
  }

  const std::string path_;
  int count_ = 0;
};

Values valuesOf(const std::string& path) {
  Gatherer gatherer(path);
  gatherer.gather(parseYaml(readTextFile(path, kLargestFile), path), "", 0);
  return std::move(gatherer.values);
}

}  // namespace

FileParamSource::FileParamSource(const std::string& path)
    : MapParamSource(valuesOf(path)), path_(path) {}

void requireAllKnown(const ParamLoader& loader, const std::string& path) {
  std::string all;
  for (const std::string& sentence : loader.reportUnknown()) {
    all += (all.empty() ? "" : "; ") + sentence;
  }
  if (!all.empty()) throw InputError(path, "", all);
}

}  // namespace hyselam
