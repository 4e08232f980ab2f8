// One description of a parameter, from which its range check, its ROS loader, its row in
// docs/parameters.md and its line in config/*.yaml are made. A struct of parameters describes
// itself:
//
//   struct RefineParams {
//     double sigma = 0.03;  ///< standard deviation of points from surfaces [m], > 0
//     int max_iterations = 20;
//     void describe(hyselam::ParameterVisitor& visit);
//     void validate() const;  ///< @throws hyselam::ParameterError
//   };
//   void RefineParams::describe(hyselam::ParameterVisitor& visit) {
//     visit("sigma", sigma, Range::above(0.0), "m", "standard deviation of points from surfaces");
//     visit("max_iterations", max_iterations, Range::between(1, 1000), "", "iterations at most");
//   }
//   void RefineParams::validate() const { hyselam::checkParameters(*this); }  // and
//   cross-conditions
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"

namespace hyselam {

/// The values a number may take; NaN never lies inside.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_open = false;  ///< min itself is not allowed
  bool max_open = false;
  /// A value outside that is allowed too, for a meaning of its own ("-1: no limit"); NaN: none.
  double special = std::numeric_limits<double>::quiet_NaN();

  static Range any() { return {}; }
  static Range atLeast(double low) { return {low, any().max, false, false}; }
  static Range above(double low) { return {low, any().max, true, false}; }
  static Range between(double low, double high) { return {low, high, false, false}; }
  /// Without its ends.
  static Range inside(double low, double high) { return {low, high, true, true}; }
  /// (low, high].
  static Range aboveUpTo(double low, double high) { return {low, high, true, false}; }
  /// [low, high).
  static Range fromBelow(double low, double high) { return {low, high, false, true}; }
  /// The same, and this value: `Range::aboveUpTo(0, 1000).orValue(-1)`.
  Range orValue(double value) const;

  bool contains(double value) const;
  /// "in (0, 1]", ">= 0", "-1 or > 0", "a number".
  std::string text() const;
};

/// What is said of one parameter beside its value.
struct ParameterInfo {
  std::string name;  ///< full, with the prefixes of its groups
  Range range;       ///< of a number, or of each number of a list
  std::string unit;  ///< "m", "rad", "1/m"; empty: none
  std::string meaning;
  std::vector<std::string> choices;  ///< of a text; empty: any text
  std::size_t min_size = 0;          ///< of a list
};

/// Goes through the parameters of a struct, see above. Derived: the checker, ParamLoader (from the
/// parameter server), ParameterTable.
class ParameterVisitor {
 public:
  virtual ~ParameterVisitor() = default;

  void operator()(const std::string& name, double& member, const Range& range,
                  const std::string& unit, const std::string& meaning);
  void operator()(const std::string& name, int& member, const Range& range, const std::string& unit,
                  const std::string& meaning);
  void operator()(const std::string& name, std::size_t& member, const Range& range,
                  const std::string& unit, const std::string& meaning);
  /// May be left unset; has no default then.
  void operator()(const std::string& name, std::optional<double>& member, const Range& range,
                  const std::string& unit, const std::string& meaning);
  void operator()(const std::string& name, bool& member, const std::string& meaning);
  void operator()(const std::string& name, std::string& member, const std::string& meaning);
  /// One word out of `choices`.
  void operator()(const std::string& name, std::string& member,
                  const std::vector<std::string>& choices, const std::string& meaning);
  /// Each number in `range`; at least `min_size` of them.
  void operator()(const std::string& name, std::vector<double>& member, const Range& range,
                  std::size_t min_size, const std::string& unit, const std::string& meaning);
  void operator()(const std::string& name, std::vector<int>& member, const Range& range,
                  std::size_t min_size, const std::string& unit, const std::string& meaning);
  /// A word that stands for a value:
  /// `visit("model", model, {{"beam", Model::kBeam}, {"fsd", Model::kFsd}}, "observation model")`.
  template <typename E, typename = std::enable_if_t<std::is_enum_v<E>>>
  void operator()(const std::string& name, E& member,
                  const std::vector<std::pair<std::string, E>>& words, const std::string& meaning) {
    std::vector<std::string> choices;
    std::string word = "(none of them)";
    for (const auto& w : words) {
      choices.push_back(w.first);
      if (w.second == member) word = w.first;
    }
    (*this)(name, word, choices, meaning);
    for (const auto& w : words) {
      if (w.first == word) member = w.second;
    }
  }

  /// Own names for some parameters of a group, in place of prefix + name.
  using Names = std::map<std::string, std::string>;
  /// For Names: not offered on the parameter server; the checker visits it nevertheless.
  static constexpr const char* kNotOffered = "";

  /// The parameters of a nested struct, each name behind `prefix` ("laser_", "loop/", "").
  /// `visit.group("laser_", cosine, {{"exponent", "cosine_exponent"}, {"seed",
  /// visit.kNotOffered}})`
  template <typename P>
  void group(const std::string& prefix, P& params, const Names& names = {}) {
    scopes_.push_back({prefix, names});
    params.describe(*this);
    scopes_.pop_back();
  }

  /// The former name of a parameter, announced before it is visited: where it is set on the
  /// parameter server its value is taken, with a warning.
  void renamed(const std::string& old_name, const std::string& new_name);

 protected:
  virtual void visit(const ParameterInfo& info, double& member) = 0;
  virtual void visit(const ParameterInfo& info, int& member) = 0;
  virtual void visit(const ParameterInfo& info, std::size_t& member) = 0;
  virtual void visit(const ParameterInfo& info, std::optional<double>& member) = 0;
  virtual void visit(const ParameterInfo& info, bool& member) = 0;
  virtual void visit(const ParameterInfo& info, std::string& member) = 0;
  virtual void visit(const ParameterInfo& info, std::vector<double>& member) = 0;
  virtual void visit(const ParameterInfo& info, std::vector<int>& member) = 0;
  virtual void visitRenamed(const std::string& /*old_name*/, const std::string& /*new_name*/) {}
  /// Whether parameters that are kNotOffered are visited as well, under prefix + name.
  virtual bool visitsNotOffered() const { return false; }

 private:
  struct Scope {
    std::string prefix;
    Names names;
  };
  std::optional<std::string> fullName(const std::string& name) const;
  template <typename T>
  void pass(ParameterInfo info, T& member);

  std::vector<Scope> scopes_;
};

/// @throws ParameterError with the name, the value and what is allowed if it lies outside.
void checkParameter(const ParameterInfo& info, double value);
void checkParameter(const ParameterInfo& info, int value);
void checkParameter(const ParameterInfo& info, std::size_t value);
void checkParameter(const ParameterInfo& info, const std::string& value);
void checkParameter(const ParameterInfo& info, const std::vector<double>& value);
void checkParameter(const ParameterInfo& info, const std::vector<int>& value);

/// Throws what checkParameter() throws, for the first parameter that lies outside of its range.
class ParameterChecker : public ParameterVisitor {
 protected:
  void visit(const ParameterInfo& info, double& member) override;
  void visit(const ParameterInfo& info, int& member) override;
  void visit(const ParameterInfo& info, std::size_t& member) override;
  void visit(const ParameterInfo& info, std::optional<double>& member) override;
  void visit(const ParameterInfo& info, bool& member) override;
  void visit(const ParameterInfo& info, std::string& member) override;
  void visit(const ParameterInfo& info, std::vector<double>& member) override;
  void visit(const ParameterInfo& info, std::vector<int>& member) override;
  bool visitsNotOffered() const override { return true; }
};

/// Whether each parameter lies in its range. Conditions between parameters are for the struct's own
/// validate(). @throws ParameterError with the name, the value and what is allowed.
template <typename P>
void checkParameters(const P& params) {
  P copy = params;
  ParameterChecker checker;
  copy.describe(checker);
}

enum class ParameterType { kDouble, kInt, kBool, kString, kDoubles, kInts };

/// A parameter as documents show it.
struct ParameterRow {
  std::string name;
  ParameterType type = ParameterType::kString;
  std::string value;          ///< as people read it: numbers of 6 digits, texts between ''
  std::string default_value;  ///< likewise
  std::string default_yaml;   ///< exact; empty: unset without a value
  std::string allowed;        ///< "in (0, 1]", "one of beam, fsd", "true or false"
  std::string unit;
  std::string meaning;
  Range range;
  std::vector<std::string> choices;
};

/// The row of a value that is its own default.
ParameterRow parameterRow(const ParameterInfo& info, double value);
ParameterRow parameterRow(const ParameterInfo& info, int value);
ParameterRow parameterRow(const ParameterInfo& info, std::size_t value);
ParameterRow parameterRow(const ParameterInfo& info, const std::optional<double>& value);
ParameterRow parameterRow(const ParameterInfo& info, bool value);
ParameterRow parameterRow(const ParameterInfo& info, const std::string& value);
ParameterRow parameterRow(const ParameterInfo& info, const std::vector<double>& value);
ParameterRow parameterRow(const ParameterInfo& info, const std::vector<int>& value);

/// Gathers the rows of what it visits.
class ParameterTable : public ParameterVisitor {
 public:
  const std::vector<ParameterRow>& rows() const { return rows_; }

 protected:
  void visit(const ParameterInfo& info, double& member) override;
  void visit(const ParameterInfo& info, int& member) override;
  void visit(const ParameterInfo& info, std::size_t& member) override;
  void visit(const ParameterInfo& info, std::optional<double>& member) override;
  void visit(const ParameterInfo& info, bool& member) override;
  void visit(const ParameterInfo& info, std::string& member) override;
  void visit(const ParameterInfo& info, std::vector<double>& member) override;
  void visit(const ParameterInfo& info, std::vector<int>& member) override;

 private:
  std::vector<ParameterRow> rows_;
};

/// The rows of a struct with its default values.
template <typename P>
std::vector<ParameterRow> parameterRows(P params = {}) {
  ParameterTable table;
  params.describe(table);
  return table.rows();
}

}  // namespace hyselam
