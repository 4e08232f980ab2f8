#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "../ros/dynamic_parameters.hpp"
#include "fsd_localization/ros/localization_server.hpp"
#include "hyselam_common/ros/server_nodelet.hpp"

namespace fsd_localization {

class LocalizationNodelet : public hyselam::ServerNodelet<LocalizationServer> {
  void onServer(LocalizationServer& server) override {
    dynamic_ = makeDynamicParameters(getPrivateNodeHandle(), &server);
  }

  std::shared_ptr<void> dynamic_;
};

}  // namespace fsd_localization

PLUGINLIB_EXPORT_CLASS(fsd_localization::LocalizationNodelet, nodelet::Nodelet)
