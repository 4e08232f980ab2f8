// Parameters of a node, checked at start: wrong type, out of range and misspelt keys are said
// aloud.
#pragma once

#include <XmlRpcValue.h>
#include <ros/node_handle.h>

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
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

  static Range any() { return {}; }
  static Range atLeast(double low) { return {low, any().max, false, false}; }
  static Range above(double low) { return {low, any().max, true, false}; }
  static Range between(double low, double high) { return {low, high, false, false}; }
  bool contains(double value) const;
  /// "in (0, 1]", ">= 0", "any number".
  std::string text() const;
};

/// Where parameters come from; a test can put a map in place of the parameter server.
class ParamSource {
 public:
  virtual ~ParamSource() = default;
  virtual std::optional<XmlRpc::XmlRpcValue> get(const std::string& name) const = 0;
  /// All names below the private namespace, relative to it ("laser/range_max").
  virtual std::vector<std::string> names() const = 0;
  /// How the namespace is called in messages ("/localization").
  virtual std::string where() const = 0;
};

class MapParamSource : public ParamSource {
 public:
  explicit MapParamSource(std::map<std::string, XmlRpc::XmlRpcValue> values)
      : values_(std::move(values)) {}
  std::optional<XmlRpc::XmlRpcValue> get(const std::string& name) const override;
  std::vector<std::string> names() const override;
  std::string where() const override { return "map"; }

 private:
  std::map<std::string, XmlRpc::XmlRpcValue> values_;
};

/// Usage: `ParamLoader p(private_nh); p.get("sigma_hit", parameters.sigma_hit, Range::above(0),
/// "[m]
/// ..."); ...; p.warnUnknown();`. The variable holds the default on entry and the value on return;
/// it is untouched if an exception leaves. All get() throw ParameterError with the full name, the
/// value and what is allowed.
class ParamLoader {
 public:
  explicit ParamLoader(const ros::NodeHandle& private_nh);
  explicit ParamLoader(std::shared_ptr<const ParamSource> source);

  /// Whole numbers are accepted for floating point values, not the other way round. `meaning` goes
  /// into the table.
  void get(const std::string& name, double& value, const Range& range = Range::any(),
           const std::string& meaning = "");
  void get(const std::string& name, int& value, const Range& range = Range::any(),
           const std::string& meaning = "");
  void get(const std::string& name, bool& value, const std::string& meaning = "");
  void get(const std::string& name, std::string& value, const std::string& meaning = "");
  /// One word out of `choices`.
  void get(const std::string& name, std::string& value, const std::vector<std::string>& choices,
           const std::string& meaning = "");
  /// Each element in `range`; at least `min_size` of them.
  void get(const std::string& name, std::vector<double>& value, const Range& range,
           std::size_t min_size = 0, const std::string& meaning = "");

  /// A word that stands for a value: getEnum("model", m, {{"beam", Model::kBeam}, ...}).
  template <typename E>
  void getEnum(const std::string& name, E& value,
               const std::vector<std::pair<std::string, E>>& words,
               const std::string& meaning = "") {
    std::vector<std::string> choices;
    std::string word;
    for (const auto& w : words) {
      choices.push_back(w.first);
      if (w.second == value) word = w.first;
    }
    get(name, word, choices, meaning);
    for (const auto& w : words) {
      if (w.first == word) value = w.second;
    }
  }

  /// Whether the parameter server holds a value, for parameters whose absence means something.
  bool isSet(const std::string& name) const { return source_->get(name).has_value(); }

  /// Marks a name as known that something else reads (nodelet parameters, dynamic reconfigure).
  void know(const std::string& name) { known_.insert(name); }

  /// Set but never asked for, with the nearest known name: "unknown parameter '/n/alhpa' (did you
  /// mean 'alpha'?)". Call after the last get().
  std::vector<std::string> reportUnknown() const;
  /// Logs reportUnknown() as warnings.
  void warnUnknown() const;

  /// Resolved values, one per line: name = value [allowed] (default) meaning. For one log entry at
  /// start and for documents.
  std::string table() const;

 private:
  struct Row {
    std::string name, value, allowed, fallback, meaning;
  };
  std::string fullName(const std::string& name) const;
  void record(Row row);

  std::shared_ptr<const ParamSource> source_;
  std::set<std::string> known_;
  std::vector<Row> rows_;
};

}  // namespace hyselam
