#include "hyselam_common/ros/params.hpp"

#include <ros/console.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "hyselam_common/edit_distance.hpp"

namespace hyselam {
namespace {

using XmlRpc::XmlRpcValue;

std::string number(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

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

bool Range::contains(double value) const {
  if (std::isnan(value)) return false;
  return (min_open ? value > min : value >= min) && (max_open ? value < max : value <= max);
}

std::string Range::text() const {
  const bool low = std::isfinite(min), high = std::isfinite(max);
  if (low && high) {
    return std::string("in ") + (min_open ? "(" : "[") + number(min) + ", " + number(max) +
           (max_open ? ")" : "]");
  }
  if (low) return (min_open ? "> " : ">= ") + number(min);
  if (high) return (max_open ? "< " : "<= ") + number(max);
  return "a number";
}

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

void ParamLoader::record(Row row) {
  known_.insert(row.name);
  rows_.push_back(std::move(row));
}

void ParamLoader::get(const std::string& name, double& value, const Range& range,
                      const std::string& meaning) {
  known_.insert(name);
  double result = value;
  if (const auto given = source_->get(name)) {
    const auto as_double = asDouble(*given);
    if (!as_double) throw ParameterError(fullName(name), show(*given), range.text());
    result = *as_double;
  }
  if (!range.contains(result)) throw ParameterError(fullName(name), result, range.text());
  record({name, number(result), range.text(), number(value), meaning});
  value = result;
}

void ParamLoader::get(const std::string& name, int& value, const Range& range,
                      const std::string& meaning) {
  known_.insert(name);
  const std::string allowed =
      "a whole number" + (range.text() == Range::any().text() ? "" : " " + range.text());
  int result = value;
  if (auto given = source_->get(name)) {
    if (given->getType() != XmlRpcValue::TypeInt) {
      throw ParameterError(fullName(name), show(*given), allowed);
    }
    result = static_cast<int&>(*given);
  }
  if (!range.contains(result)) throw ParameterError(fullName(name), result, allowed);
  record({name, std::to_string(result), allowed, std::to_string(value), meaning});
  value = result;
}

void ParamLoader::get(const std::string& name, bool& value, const std::string& meaning) {
  known_.insert(name);
  bool result = value;
  if (auto given = source_->get(name)) {
    if (given->getType() != XmlRpcValue::TypeBoolean) {
      throw ParameterError(fullName(name), show(*given), "true or false");
    }
    result = static_cast<bool&>(*given);
  }
  record({name, result ? "true" : "false", "true or false", value ? "true" : "false", meaning});
  value = result;
}

void ParamLoader::get(const std::string& name, std::string& value, const std::string& meaning) {
  known_.insert(name);
  std::string result = value;
  if (auto given = source_->get(name)) {
    if (given->getType() != XmlRpcValue::TypeString) {
      throw ParameterError(fullName(name), show(*given), "a text");
    }
    result = static_cast<std::string&>(*given);
  }
  record({name, quote(result), "a text", quote(value), meaning});
  value = result;
}

void ParamLoader::get(const std::string& name, std::string& value,
                      const std::vector<std::string>& choices, const std::string& meaning) {
  known_.insert(name);
  std::string allowed = "one of";
  for (std::size_t i = 0; i < choices.size(); ++i) allowed += (i > 0 ? ", " : " ") + choices[i];
  std::string result = value;
  if (auto given = source_->get(name)) {
    if (given->getType() != XmlRpcValue::TypeString) {
      throw ParameterError(fullName(name), show(*given), allowed);
    }
    result = static_cast<std::string&>(*given);
  }
  if (std::find(choices.begin(), choices.end(), result) == choices.end()) {
    throw ParameterError(fullName(name), quote(result), allowed);
  }
  record({name, result, allowed, value, meaning});
  value = result;
}

void ParamLoader::get(const std::string& name, std::vector<double>& value, const Range& range,
                      std::size_t min_size, const std::string& meaning) {
  known_.insert(name);
  const std::string allowed = "a list of " +
                              (min_size > 0 ? "at least " + std::to_string(min_size) + " " : "") +
                              "numbers, each " + range.text();
  const auto list = [](const std::vector<double>& numbers) {
    std::string text = "[";
    for (std::size_t i = 0; i < numbers.size(); ++i)
      text += (i > 0 ? ", " : "") + number(numbers[i]);
    return text + "]";
  };
  std::vector<double> result = value;
  if (auto given = source_->get(name)) {
    if (given->getType() != XmlRpcValue::TypeArray) {
      throw ParameterError(fullName(name), show(*given), allowed);
    }
    result.clear();
    for (int i = 0; i < given->size(); ++i) {
      const auto element = asDouble((*given)[i]);
      if (!element) throw ParameterError(fullName(name), show(*given), allowed);
      result.push_back(*element);
    }
  }
  const bool inside =
      std::all_of(result.begin(), result.end(), [&](double v) { return range.contains(v); });
  if (!inside || result.size() < min_size) {
    throw ParameterError(fullName(name), list(result), allowed);
  }
  record({name, list(result), allowed, list(value), meaning});
  value = result;
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

void ParamLoader::warnUnknown() const {
  for (const std::string& line : reportUnknown()) ROS_WARN("%s", line.c_str());
}

std::string ParamLoader::table() const {
  std::ostringstream out;
  out << source_->where() << ":\n";
  for (const Row& r : rows_) {
    out << "  " << r.name << " = " << r.value << "  (" << r.allowed << "; default " << r.fallback
        << ")" << (r.meaning.empty() ? "" : " " + r.meaning) << "\n";
  }
  return out.str();
}

}  // namespace hyselam
