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

void gather(const YAML::Node& node, const std::string& name, const std::string& path,
            Values* values) {
  if (node.IsMap()) {
    for (const auto& entry : node) {
      const std::string key = entry.first.Scalar();
      gather(entry.second, name.empty() ? key : name + "/" + key, path, values);
    }
  } else if (name.empty()) {
    throw InputError(path, "", "holds no names of parameters with their values");
  } else if (node.IsSequence()) {
    XmlRpc::XmlRpcValue list;
    list.setSize(static_cast<int>(node.size()));
    for (std::size_t i = 0; i < node.size(); ++i) {
      if (!node[i].IsScalar()) throw InputError(path, name, "is a list of more than values");
      list[static_cast<int>(i)] = scalarOf(node[i]);
    }
    (*values)[name] = list;
  } else if (node.IsScalar()) {
    if (!values->emplace(name, scalarOf(node)).second) throw InputError(path, name, "stands twice");
  } else {
    throw InputError(path, name, "has no value");
  }
}

Values valuesOf(const std::string& path) {
  Values values;
  gather(parseYaml(readTextFile(path, kLargestFile), path), "", path, &values);
  return values;
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
