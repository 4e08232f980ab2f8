#include "hyselam_common/ros/params.hpp"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "hyselam_common/edit_distance.hpp"

namespace hyselam {
namespace {

using XmlRpc::XmlRpcValue;

std::string show(const XmlRpcValue& value) {
  switch (value.getType()) {
    case XmlRpcValue::TypeString: {
      XmlRpcValue copy = value;
      return "'" + static_cast<std::string&>(copy) + "'";
    }
    case XmlRpcValue::TypeStruct:
      return "a group of parameters";
    case XmlRpcValue::TypeInvalid:
      return "nothing";
    default: {
      std::ostringstream out;
      value.write(out);
      return out.str();
    }
  }
}

std::string quote(const std::string& text) {
  return "'" + text + "'";
}

/// Reads a number that may be written as a whole one.
std::optional<double> asDouble(XmlRpcValue value) {
  if (value.getType() == XmlRpcValue::TypeDouble) return static_cast<double&>(value);
  if (value.getType() == XmlRpcValue::TypeInt) return static_cast<int&>(value);
  return std::nullopt;
}

/// Reads a whole number that may be written as a floating point one.
std::optional<int> asWhole(XmlRpcValue value) {
  const auto number = asDouble(std::move(value));
  const bool whole = number && std::abs(*number) <= std::numeric_limits<int>::max() &&
                     *number == std::trunc(*number);
  return whole ? std::optional<int>(static_cast<int>(*number)) : std::nullopt;
}

/// A meaning that begins with its unit: "[m] ...".
ParameterInfo infoOf(const std::string& name, const std::string& meaning) {
  ParameterInfo info;
  info.name = name;
  info.meaning = meaning;
  const auto end = meaning.find(']');
  if (meaning.empty() || meaning[0] != '[' || end == std::string::npos) return info;
  info.unit = meaning.substr(1, end - 1);
  info.meaning = meaning.substr(end + 1);
  info.meaning.erase(0, info.meaning.find_first_not_of(' '));
  return info;
}

class ServerSource : public ParamSource {
 public:
  explicit ServerSource(const ros::NodeHandle& nh) : nh_(nh) {}

  std::optional<XmlRpcValue> get(const std::string& name) const override {
    XmlRpcValue value;
    if (!nh_.getParam(name, value)) return std::nullopt;
    return value;
  }
  std::vector<std::string> names() const override {
    std::vector<std::string> all, own;
    nh_.getParamNames(all);
    const std::string prefix = nh_.getNamespace() + "/";
    for (const std::string& name : all) {
      if (name.compare(0, prefix.size(), prefix) == 0) own.push_back(name.substr(prefix.size()));
    }
    std::sort(own.begin(), own.end());
    return own;
  }
  std::string where() const override { return nh_.getNamespace(); }

 private:
  ros::NodeHandle nh_;
};

}  // namespace

std::optional<XmlRpcValue> MapParamSource::get(const std::string& name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) return std::nullopt;
  return found->second;
}

std::vector<std::string> MapParamSource::names() const {
  std::vector<std::string> names;
  for (const auto& v : values_) names.push_back(v.first);
  return names;
}

ParamLoader::ParamLoader(const ros::NodeHandle& private_nh)
    : source_(std::make_shared<ServerSource>(private_nh)) {}

ParamLoader::ParamLoader(std::shared_ptr<const ParamSource> source) : source_(std::move(source)) {}

std::string ParamLoader::fullName(const std::string& name) const {
  return source_->where() + "/" + name;
}

bool ParamLoader::isSet(const std::string& name) const {
  return source_->get(name).has_value() || former_.count(name) > 0;
}

std::optional<XmlRpcValue> ParamLoader::read(const std::string& name) {
  known_.insert(name);
  const auto former = former_.find(name);
  return source_->get(former == former_.end() ? name : former->second);
}

template <typename T>
void ParamLoader::accept(const ParameterInfo& info, T& member, const T& value) {
  ParameterInfo full = info;
  full.name = fullName(info.name);
  checkParameter(full, value);
  ParameterRow row = parameterRow(info, member);
  row.value = parameterRow(info, value).value;
  rows_.push_back(std::move(row));
  member = value;
}

void ParamLoader::refuse(const ParameterInfo& info, const ParameterRow& row,
                         const XmlRpcValue& value) const {
  throw ParameterError(fullName(info.name), show(value), row.allowed);
}

void ParamLoader::visit(const ParameterInfo& info, double& member) {
  double value = member;
  if (const auto given = read(info.name)) {
    const auto number = asDouble(*given);
    if (!number) refuse(info, parameterRow(info, member), *given);
    value = *number;
  }
  accept(info, member, value);
}

void ParamLoader::visit(const ParameterInfo& info, int& member) {
  int value = member;
  if (auto given = read(info.name)) {
    if (given->getType() != XmlRpcValue::TypeInt) refuse(info, parameterRow(info, member), *given);
    value = static_cast<int&>(*given);
  }
  accept(info, member, value);
}

void ParamLoader::visit(const ParameterInfo& info, std::size_t& member) {
  std::size_t value = member;
  if (auto given = read(info.name)) {
    if (given->getType() != XmlRpcValue::TypeInt || static_cast<int&>(*given) < 0) {
      refuse(info, parameterRow(info, member), *given);
    }
    value = static_cast<std::size_t>(static_cast<int&>(*given));
  }
  accept(info, member, value);
}

void ParamLoader::visit(const ParameterInfo& info, std::optional<double>& member) {
  std::optional<double> value = member;
  if (const auto given = read(info.name)) {
    value = asDouble(*given);
    if (!value) refuse(info, parameterRow(info, member), *given);
  }
  ParameterInfo full = info;
  full.name = fullName(info.name);
  if (value) checkParameter(full, *value);
  ParameterRow row = parameterRow(info, member);
  row.value = parameterRow(info, value).value;
  rows_.push_back(std::move(row));
  member = value;
}

void ParamLoader::visit(const ParameterInfo& info, bool& member) {
  ParameterRow row = parameterRow(info, member);
  bool value = member;
  if (auto given = read(info.name)) {
    if (given->getType() != XmlRpcValue::TypeBoolean) refuse(info, row, *given);
    value = static_cast<bool&>(*given);
  }
  row.value = parameterRow(info, value).value;
  rows_.push_back(std::move(row));
  member = value;
}

void ParamLoader::visit(const ParameterInfo& info, std::string& member) {
  std::string value = member;
  if (auto given = read(info.name)) {
    if (given->getType() != XmlRpcValue::TypeString) {
      refuse(info, parameterRow(info, member), *given);
    }
    value = static_cast<std::string&>(*given);
  }
  accept(info, member, value);
}

template <typename T>
void ParamLoader::visitArray(const ParameterInfo& info, std::vector<T>& member,
                             std::optional<T> (*element)(XmlRpcValue)) {
  std::vector<T> value = member;
  if (auto given = read(info.name)) {
    if (given->getType() != XmlRpcValue::TypeArray) {
      refuse(info, parameterRow(info, member), *given);
    }
    value.clear();
    for (int i = 0; i < given->size(); ++i) {
      const auto one = element((*given)[i]);
      if (!one) refuse(info, parameterRow(info, member), *given);
      value.push_back(*one);
    }
  }
  accept(info, member, value);
}

void ParamLoader::visit(const ParameterInfo& info, std::vector<double>& member) {
  visitArray(info, member, &asDouble);
}

void ParamLoader::visit(const ParameterInfo& info, std::vector<int>& member) {
  visitArray(info, member, &asWhole);
}

void ParamLoader::visitRenamed(const std::string& old_name, const std::string& new_name) {
  known_.insert(old_name);
  const auto given = source_->get(old_name);
  if (!given) return;
  if (source_->get(new_name)) {
    throw ParameterError(fullName(old_name), show(*given),
                         "left out: it is the former name of '" + new_name + "', which is set too");
  }
  former_[new_name] = old_name;
}

void ParamLoader::get(const std::string& name, double& value, const Range& range,
                      const std::string& meaning) {
  ParameterInfo info = infoOf(name, meaning);
  info.range = range;
  visit(info, value);
}

void ParamLoader::get(const std::string& name, int& value, const Range& range,
                      const std::string& meaning) {
  ParameterInfo info = infoOf(name, meaning);
  info.range = range;
  visit(info, value);
}

void ParamLoader::get(const std::string& name, bool& value, const std::string& meaning) {
  visit(infoOf(name, meaning), value);
}

void ParamLoader::get(const std::string& name, std::string& value, const std::string& meaning) {
  visit(infoOf(name, meaning), value);
}

void ParamLoader::get(const std::string& name, std::string& value,
                      const std::vector<std::string>& choices, const std::string& meaning) {
  ParameterInfo info = infoOf(name, meaning);
  info.choices = choices;
  visit(info, value);
}

void ParamLoader::get(const std::string& name, std::vector<double>& value, const Range& range,
                      std::size_t min_size, const std::string& meaning) {
  ParameterInfo info = infoOf(name, meaning);
  info.range = range;
  info.min_size = min_size;
  visit(info, value);
}

std::vector<std::string> ParamLoader::reportUnknown() const {
  std::vector<std::string> report;
  for (const std::string& name : source_->names()) {
    // A known group ("laser") covers what lies in it ("laser/range_max").
    const bool known = std::any_of(known_.begin(), known_.end(), [&](const std::string& k) {
      return name == k || name.compare(0, k.size() + 1, k + "/") == 0;
    });
    if (known) continue;
    std::string nearest;
    std::size_t best = std::max<std::size_t>(2, name.size() / 3) + 1;
    for (const std::string& k : known_) {
      const std::size_t d = editDistance(name, k);
      if (d < best) {
        best = d;
        nearest = k;
      }
    }
    report.push_back("unknown parameter " + quote(fullName(name)) +
                     (nearest.empty() ? "" : " (did you mean " + quote(nearest) + "?)"));
  }
  return report;
}

std::vector<std::string> ParamLoader::reportRenamed() const {
  std::vector<std::string> report;
  for (const auto& [name, former] : former_) {
    report.push_back("parameter " + quote(fullName(former)) + " is now called " + quote(name));
  }
  return report;
}

void ParamLoader::logWarnings() const {
  for (const std::string& line : reportRenamed()) ROS_WARN("%s", line.c_str());
  for (const std::string& line : reportUnknown()) ROS_WARN("%s", line.c_str());
}

std::string ParamLoader::table() const {
  std::ostringstream out;
  out << source_->where() << ":\n";
  for (const ParameterRow& r : rows_) {
    out << "  " << r.name << " = " << r.value << "  (" << r.allowed << "; default "
        << r.default_value << ")" << (r.unit.empty() ? "" : " [" + r.unit + "]")
        << (r.meaning.empty() ? "" : " " + r.meaning) << "\n";
  }
  return out.str();
}

}  // namespace hyselam
