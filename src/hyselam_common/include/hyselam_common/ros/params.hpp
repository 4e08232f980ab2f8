// Parameters of a node, read and checked at start: a wrong type and a value out of range end it,
// unknown names are reported.
#pragma once

#include <XmlRpcValue.h>
#include <ros/node_handle.h>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/parameters.hpp"

namespace hyselam {

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

/// Reads what a struct of parameters describes (parameters.hpp) from the parameter server:
///
///     ParamLoader loader(private_nh);
///     Gr2ToServerParams params;    // holds the defaults
///     params.describe(loader);     // or loader.group("", params)
///     params.validate();           // conditions between parameters
///     loader.logWarnings();
///
/// A variable holds the default on entry and the value on return; it is untouched if an exception
/// leaves. All throw ParameterError with the full name, the value and what is allowed.
class ParamLoader : public ParameterVisitor {
 public:
  explicit ParamLoader(const ros::NodeHandle& private_nh);
  explicit ParamLoader(std::shared_ptr<const ParamSource> source);

  /// Single parameters without a description. Whole numbers are accepted for floating point values,
  /// not the other way round. `meaning` goes into the table and may begin with "[unit]".
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
    (*this)(name, value, words, meaning);
  }

  /// Whether the parameter server holds a value, for parameters whose absence means something.
  bool isSet(const std::string& name) const;

  /// Marks a name as known that something else reads (nodelet parameters, dynamic reconfigure).
  void know(const std::string& name) { known_.insert(name); }

  /// All names asked for or marked as known.
  const std::set<std::string>& known() const { return known_; }

  /// Set but never asked for, with the nearest known name: "unknown parameter '/n/alhpa' (did you
  /// mean 'alpha'?)". Call after the last parameter.
  std::vector<std::string> reportUnknown() const;
  /// Set under their former name: "parameter '/n/leap' is now called 'max_step'".
  std::vector<std::string> reportRenamed() const;
  /// Logs reportRenamed() and reportUnknown() as warnings.
  void logWarnings() const;

  /// What was resolved, in the order of reading; `default_value` is that before reading.
  const std::vector<ParameterRow>& rows() const { return rows_; }
  /// The same as text, one per line: name = value (allowed; default) [unit] meaning.
  std::string table() const;

 protected:
  void visit(const ParameterInfo& info, double& member) override;
  void visit(const ParameterInfo& info, int& member) override;
  void visit(const ParameterInfo& info, std::size_t& member) override;
  void visit(const ParameterInfo& info, std::optional<double>& member) override;
  void visit(const ParameterInfo& info, bool& member) override;
  void visit(const ParameterInfo& info, std::string& member) override;
  void visit(const ParameterInfo& info, std::vector<double>& member) override;
  void visit(const ParameterInfo& info, std::vector<int>& member) override;
  /// @throws ParameterError if both are set.
  void visitRenamed(const std::string& old_name, const std::string& new_name) override;

 private:
  std::string fullName(const std::string& name) const;
  /// The value that the server holds under this name or a former one.
  std::optional<XmlRpc::XmlRpcValue> read(const std::string& name);
  /// Stores the value read and its row, unless it lies outside of what is allowed.
  template <typename T>
  void accept(const ParameterInfo& info, T& member, const T& value);
  /// `element`: one of the array; none if it is not of its type.
  template <typename T>
  void visitArray(const ParameterInfo& info, std::vector<T>& member,
                  std::optional<T> (*element)(XmlRpc::XmlRpcValue));
  [[noreturn]] void refuse(const ParameterInfo& info, const ParameterRow& row,
                           const XmlRpc::XmlRpcValue& value) const;

  std::shared_ptr<const ParamSource> source_;
  std::set<std::string> known_;
  std::map<std::string, std::string> former_;  ///< name -> former name, where that one is set
  std::vector<ParameterRow> rows_;
};

/// Parameters of a struct that describes and validates itself; what is not set has its default.
/// @throws ParameterError
template <typename Params>
Params loadDescribed(ParamLoader& loader) {
  Params params;
  params.describe(loader);
  params.validate();
  return params;
}

}  // namespace hyselam
