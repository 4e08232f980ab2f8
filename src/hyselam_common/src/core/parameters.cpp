#include "hyselam_common/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "hyselam_common/numbers.hpp"

namespace hyselam {
namespace {

std::string shown(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}
std::string shown(int value) {
  return std::to_string(value);
}

/// YAML 1.1 wants a point in the mantissa; "1e-05" would be a text.
std::string yaml(double value) {
  if (std::isinf(value)) return value > 0.0 ? ".inf" : "-.inf";
  std::string text = formatNumber(value);
  if (text.find('.') == std::string::npos) {
    const auto exponent = text.find('e');
    text.insert(exponent == std::string::npos ? text.size() : exponent, ".0");
  }
  return text;
}
std::string yaml(int value) {
  return std::to_string(value);
}
std::string yaml(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

template <typename T, typename F>
std::string list(const std::vector<T>& values, F&& text) {
  std::string all = "[";
  for (std::size_t i = 0; i < values.size(); ++i) all += (i > 0 ? ", " : "") + text(values[i]);
  return all + "]";
}
template <typename T>
std::string shown(const std::vector<T>& values) {
  return list(values, [](T v) { return shown(v); });
}
template <typename T>
std::string yaml(const std::vector<T>& values) {
  return list(values, [](T v) { return yaml(v); });
}

bool isLimited(const Range& range) {
  return std::isfinite(range.min) || std::isfinite(range.max);
}

std::string allowedText(const ParameterInfo& info, ParameterType type) {
  const std::string least =
      info.min_size > 0 ? "at least " + std::to_string(info.min_size) + " " : "";
  switch (type) {
    case ParameterType::kDouble:
      return info.range.text();
    case ParameterType::kInt:
      return "a whole number" + (isLimited(info.range) ? " " + info.range.text() : "");
    case ParameterType::kBool:
      return "true or false";
    case ParameterType::kDoubles:
      return "a list of " + least + "numbers, each " + info.range.text();
    case ParameterType::kInts:
      return "a list of " + least + "whole numbers" +
             (isLimited(info.range) ? ", each " + info.range.text() : "");
    case ParameterType::kString:
      break;
  }
  if (info.choices.empty()) return "a text";
  std::string allowed = "one of";
  for (std::size_t i = 0; i < info.choices.size(); ++i) {
    allowed += (i > 0 ? ", " : " ") + info.choices[i];
  }
  return allowed;
}

ParameterRow row(const ParameterInfo& info, ParameterType type, const std::string& value,
                 const std::string& exact) {
  return {info.name, type,         value,      value,       exact, allowedText(info, type),
          info.unit, info.meaning, info.range, info.choices};
}

template <typename T>
void checkNumber(const ParameterInfo& info, T value) {
  if (info.range.contains(static_cast<double>(value))) return;
  throw ParameterError(info.name, value, parameterRow(info, value).allowed);
}

template <typename T>
void checkList(const ParameterInfo& info, const std::vector<T>& values) {
  const bool inside = std::all_of(values.begin(), values.end(),
                                  [&](T v) { return info.range.contains(static_cast<double>(v)); });
  if (inside && values.size() >= info.min_size) return;
  throw ParameterError(info.name, shown(values), parameterRow(info, values).allowed);
}

}  // namespace

Range Range::orValue(double value) const {
  Range range = *this;
  range.special = value;
  return range;
}

bool Range::contains(double value) const {
  if (std::isnan(value)) return false;
  if (value == special) return true;
  return (min_open ? value > min : value >= min) && (max_open ? value < max : value <= max);
}

std::string Range::text() const {
  const bool low = std::isfinite(min), high = std::isfinite(max);
  const std::string other = std::isnan(special) ? "" : shown(special) + " or ";
  if (low && high) {
    return other + "in " + (min_open ? "(" : "[") + shown(min) + ", " + shown(max) +
           (max_open ? ")" : "]");
  }
  if (low) return other + (min_open ? "> " : ">= ") + shown(min);
  if (high) return other + (max_open ? "< " : "<= ") + shown(max);
  return "a number";
}

std::optional<std::string> ParameterVisitor::fullName(const std::string& name) const {
  // From the innermost group outwards; an own name stands in place of that group's prefix + name.
  std::string full = name;
  for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope) {
    const auto own = scope->names.find(full);
    if (own == scope->names.end()) {
      full = scope->prefix + full;
    } else if (own->second != kNotOffered) {
      full = own->second;
    } else if (visitsNotOffered()) {
      full = scope->prefix + full;
    } else {
      return std::nullopt;
    }
  }
  return full;
}

template <typename T>
void ParameterVisitor::pass(ParameterInfo info, T& member) {
  const auto name = fullName(info.name);
  if (!name) return;
  info.name = *name;
  visit(info, member);
}

void ParameterVisitor::operator()(const std::string& name, double& member, const Range& range,
                                  const std::string& unit, const std::string& meaning) {
  pass({name, range, unit, meaning, {}, 0}, member);
}

void ParameterVisitor::operator()(const std::string& name, int& member, const Range& range,
                                  const std::string& unit, const std::string& meaning) {
  pass({name, range, unit, meaning, {}, 0}, member);
}

void ParameterVisitor::operator()(const std::string& name, std::size_t& member, const Range& range,
                                  const std::string& unit, const std::string& meaning) {
  pass({name, range, unit, meaning, {}, 0}, member);
}

void ParameterVisitor::operator()(const std::string& name, std::optional<double>& member,
                                  const Range& range, const std::string& unit,
                                  const std::string& meaning) {
  pass({name, range, unit, meaning, {}, 0}, member);
}

void ParameterVisitor::operator()(const std::string& name, bool& member,
                                  const std::string& meaning) {
  pass({name, {}, "", meaning, {}, 0}, member);
}

void ParameterVisitor::operator()(const std::string& name, std::string& member,
                                  const std::string& meaning) {
  pass({name, {}, "", meaning, {}, 0}, member);
}

void ParameterVisitor::operator()(const std::string& name, std::string& member,
                                  const std::vector<std::string>& choices,
                                  const std::string& meaning) {
  pass({name, {}, "", meaning, choices, 0}, member);
}

void ParameterVisitor::operator()(const std::string& name, std::vector<double>& member,
                                  const Range& range, std::size_t min_size, const std::string& unit,
                                  const std::string& meaning) {
  pass({name, range, unit, meaning, {}, min_size}, member);
}

void ParameterVisitor::operator()(const std::string& name, std::vector<int>& member,
                                  const Range& range, std::size_t min_size, const std::string& unit,
                                  const std::string& meaning) {
  pass({name, range, unit, meaning, {}, min_size}, member);
}

void ParameterVisitor::renamed(const std::string& old_name, const std::string& new_name) {
  const auto before = fullName(old_name), now = fullName(new_name);
  if (before && now) visitRenamed(*before, *now);
}

void checkParameter(const ParameterInfo& info, double value) {
  checkNumber(info, value);
}
void checkParameter(const ParameterInfo& info, int value) {
  checkNumber(info, value);
}
void checkParameter(const ParameterInfo& info, std::size_t value) {
  checkNumber(info, value);
}
void checkParameter(const ParameterInfo& info, const std::string& value) {
  if (info.choices.empty()) return;
  if (std::find(info.choices.begin(), info.choices.end(), value) != info.choices.end()) return;
  throw ParameterError(info.name, "'" + value + "'", parameterRow(info, value).allowed);
}
void checkParameter(const ParameterInfo& info, const std::vector<double>& value) {
  checkList(info, value);
}
void checkParameter(const ParameterInfo& info, const std::vector<int>& value) {
  checkList(info, value);
}

void ParameterChecker::visit(const ParameterInfo& info, double& member) {
  checkParameter(info, member);
}
void ParameterChecker::visit(const ParameterInfo& info, int& member) {
  checkParameter(info, member);
}
void ParameterChecker::visit(const ParameterInfo& info, std::size_t& member) {
  checkParameter(info, member);
}
void ParameterChecker::visit(const ParameterInfo& info, std::optional<double>& member) {
  if (member) checkParameter(info, *member);
}
void ParameterChecker::visit(const ParameterInfo& /*info*/, bool& /*member*/) {}
void ParameterChecker::visit(const ParameterInfo& info, std::string& member) {
  checkParameter(info, member);
}
void ParameterChecker::visit(const ParameterInfo& info, std::vector<double>& member) {
  checkParameter(info, member);
}
void ParameterChecker::visit(const ParameterInfo& info, std::vector<int>& member) {
  checkParameter(info, member);
}

ParameterRow parameterRow(const ParameterInfo& info, double value) {
  return row(info, ParameterType::kDouble, shown(value), yaml(value));
}
ParameterRow parameterRow(const ParameterInfo& info, int value) {
  return row(info, ParameterType::kInt, shown(value), yaml(value));
}
ParameterRow parameterRow(const ParameterInfo& info, std::size_t value) {
  return row(info, ParameterType::kInt, std::to_string(value), std::to_string(value));
}
ParameterRow parameterRow(const ParameterInfo& info, const std::optional<double>& value) {
  return value ? row(info, ParameterType::kDouble, shown(*value), yaml(*value))
               : row(info, ParameterType::kDouble, "unset", "");
}
ParameterRow parameterRow(const ParameterInfo& info, bool value) {
  const std::string text = value ? "true" : "false";
  return row(info, ParameterType::kBool, text, text);
}
ParameterRow parameterRow(const ParameterInfo& info, const std::string& value) {
  return row(info, ParameterType::kString, info.choices.empty() ? "'" + value + "'" : value,
             yaml(value));
}
ParameterRow parameterRow(const ParameterInfo& info, const std::vector<double>& value) {
  return row(info, ParameterType::kDoubles, shown(value), yaml(value));
}
ParameterRow parameterRow(const ParameterInfo& info, const std::vector<int>& value) {
  return row(info, ParameterType::kInts, shown(value), yaml(value));
}

void ParameterTable::visit(const ParameterInfo& info, double& member) {
  rows_.push_back(parameterRow(info, member));
}
void ParameterTable::visit(const ParameterInfo& info, int& member) {
  rows_.push_back(parameterRow(info, member));
}
void ParameterTable::visit(const ParameterInfo& info, std::size_t& member) {
  rows_.push_back(parameterRow(info, member));
}
void ParameterTable::visit(const ParameterInfo& info, std::optional<double>& member) {
  rows_.push_back(parameterRow(info, member));
}
void ParameterTable::visit(const ParameterInfo& info, bool& member) {
  rows_.push_back(parameterRow(info, member));
}
void ParameterTable::visit(const ParameterInfo& info, std::string& member) {
  rows_.push_back(parameterRow(info, member));
}
void ParameterTable::visit(const ParameterInfo& info, std::vector<double>& member) {
  rows_.push_back(parameterRow(info, member));
}
void ParameterTable::visit(const ParameterInfo& info, std::vector<int>& member) {
  rows_.push_back(parameterRow(info, member));
}

}  // namespace hyselam
