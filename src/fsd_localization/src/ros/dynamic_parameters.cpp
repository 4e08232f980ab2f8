#include "dynamic_parameters.hpp"

#ifdef HYSELAM_HAVE_DYNAMIC_RECONFIGURE

#include <dynamic_reconfigure/server.h>
#include <fsd_localization/LocalizationConfig.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/server_setup.hpp"

namespace fsd_localization {
namespace {

using Values = std::map<std::string, XmlRpc::XmlRpcValue>;

Values valuesOf(const LocalizationConfig& config) {
  dynamic_reconfigure::Config msg;
  config.__toMessage__(msg);
  Values values;
  for (const auto& v : msg.bools) values[v.name] = XmlRpc::XmlRpcValue(v.value != 0);
  for (const auto& v : msg.ints) values[v.name] = XmlRpc::XmlRpcValue(v.value);
  for (const auto& v : msg.doubles) values[v.name] = XmlRpc::XmlRpcValue(v.value);
  for (const auto& v : msg.strs) values[v.name] = XmlRpc::XmlRpcValue(v.value);
  return values;
}

/// Writes what it visits into the fields of the same name.
class ConfigWriter : public hyselam::ParameterVisitor {
 public:
  explicit ConfigWriter(dynamic_reconfigure::Config* msg) : msg_(msg) {}

 private:
  template <typename Fields, typename Value>
  static void write(Fields& fields, const std::string& name, const Value& value) {
    for (auto& field : fields) {
      if (field.name == name) field.value = value;
    }
  }
  void visit(const hyselam::ParameterInfo& info, double& member) override {
    write(msg_->doubles, info.name, member);
  }
  void visit(const hyselam::ParameterInfo& info, int& member) override {
    write(msg_->ints, info.name, member);
  }
  void visit(const hyselam::ParameterInfo& info, std::size_t& member) override {
    write(msg_->ints, info.name, static_cast<int>(member));
  }
  void visit(const hyselam::ParameterInfo& info, bool& member) override {
    write(msg_->bools, info.name, member);
  }
  void visit(const hyselam::ParameterInfo& info, std::string& member) override {
    write(msg_->strs, info.name, member);
  }
  // dynamic_reconfigure has neither lists nor values that may be missing.
  void visit(const hyselam::ParameterInfo&, std::optional<double>&) override {}
  void visit(const hyselam::ParameterInfo&, std::vector<double>&) override {}
  void visit(const hyselam::ParameterInfo&, std::vector<int>&) override {}

  dynamic_reconfigure::Config* msg_;
};

LocalizationConfig configOf(LocalizationServerParams params) {
  LocalizationConfig config = LocalizationConfig::__getDefault__();
  dynamic_reconfigure::Config msg;
  config.__toMessage__(msg);
  ConfigWriter writer(&msg);
  writer.group("", params);
  config.__fromMessage__(msg);
  return config;
}

/// Of the names that nothing here uses, those that are not on the parameter server.
std::vector<std::string> unusedAndUnset(const ros::NodeHandle& private_nh) {
  UnusedAmclParams params;
  hyselam::ParameterTable table;
  table.group("", params);
  std::vector<std::string> names;
  for (const hyselam::ParameterRow& row : table.rows()) {
    if (!private_nh.hasParam(row.name)) names.push_back(row.name);
  }
  return names;
}

/// The server of dynamic_reconfigure and what it needs.
class DynamicParameters {
 public:
  DynamicParameters(const ros::NodeHandle& private_nh, LocalizationServer* server)
      : private_nh_(private_nh),
        log_name_(hyselam::logName(private_nh)),
        server_(server),
        start_(configOf(server->params())),
        unset_(unusedAndUnset(private_nh)),
        dynamic_(mutex_, private_nh) {
    // setCallback() calls at once with what the parameter server says: nothing new.
    dynamic_.setCallback([this](LocalizationConfig& config, std::uint32_t) {
      if (ready_) apply(config);  // what it changes in it is published
    });
    dynamic_.updateConfig(start_);
    sweep();
    ready_ = true;
  }

 private:
  /// dynamic_reconfigure leaves all that it offers on the parameter server. Nobody asked for what
  /// has no effect, and the next start shall not warn of it.
  void sweep() {
    for (const std::string& name : unset_) private_nh_.deleteParam(name);
  }

  void apply(LocalizationConfig& config) {
    // It does so after this returns.
    sweep_timer_ = private_nh_.createWallTimer(
        ros::WallDuration(0.05), [this](const ros::WallTimerEvent&) { sweep(); }, true);
    const LocalizationConfig before = configOf(server_->params());
    const Values changes = changesOf(config.restore_defaults ? start_ : config, before);
    config = before;
    LocalizationServerParams params = server_->params();
    hyselam::ParamLoader loader(std::make_shared<hyselam::MapParamSource>(changes));
    try {
      loader.group("", params);
      params.validate();
    } catch (const hyselam::ParameterError& e) {
      ROS_WARN_STREAM(log_name_ << " all parameters stay as they are: " << e.what());
      return;
    }
    for (const auto& change : changes) {
      if (loader.known().count(change.first) > 0) continue;
      ROS_WARN_STREAM(log_name_ << " parameter '" << change.first
                                << "' of amcl has no effect here (see \"Replacing amcl\" in "
                                   "fsd_localization/README.md): it stays");
    }
    server_->setParams(params);
    config = configOf(server_->params());
  }

  /// What is to change and may.
  Values changesOf(const LocalizationConfig& wanted, const LocalizationConfig& now) const {
    Values changes;
    const Values old = valuesOf(now);
    for (const auto& value : valuesOf(wanted)) {
      if (old.at(value.first) == value.second) continue;
      if (isReadAtStartOnly(value.first)) {
        ROS_WARN_STREAM(log_name_ << " parameter '" << value.first
                                  << "' is read at the start only: it stays");
        continue;
      }
      changes.insert(value);
    }
    return changes;
  }

  ros::NodeHandle private_nh_;
  std::string log_name_;
  LocalizationServer* server_;
  LocalizationConfig start_;
  std::vector<std::string> unset_;  // before dynamic_ sets them
  ros::WallTimer sweep_timer_;
  bool ready_ = false;
  boost::recursive_mutex mutex_;
  dynamic_reconfigure::Server<LocalizationConfig> dynamic_;
};

}  // namespace

std::shared_ptr<void> makeDynamicParameters(const ros::NodeHandle& private_nh,
                                            LocalizationServer* server) {
  return std::make_shared<DynamicParameters>(private_nh, server);
}

}  // namespace fsd_localization

#else

namespace fsd_localization {

std::shared_ptr<void> makeDynamicParameters(const ros::NodeHandle&, LocalizationServer*) {
  return nullptr;
}

}  // namespace fsd_localization

#endif
