#include "dynamic_parameters.hpp"

#ifdef HYSELAM_HAVE_DYNAMIC_RECONFIGURE

#include <dynamic_reconfigure/server.h>
#include <hyselam_topo/Gr2ToConfig.h>

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace {

Gr2ToConfig configOf(const Gr2ToServerParams& params) {
  Gr2ToConfig config = Gr2ToConfig::__getDefault__();
  config.mode = toString(params.gr2to.mode);
  config.free_max = params.gr2to.segmentation.free_max;
  config.working_resolution = params.gr2to.segmentation.working_resolution;
  config.max_clutter_size = params.gr2to.segmentation.max_clutter_size;
  config.min_place_area = params.gr2to.segmentation.min_place_area;
  config.thesis_door_min = params.gr2to.thesis.door_min;
  config.thesis_door_max = params.gr2to.thesis.door_max;
  config.thesis_critical_radius = params.gr2to.thesis.critical_radius;
  config.thesis_wall_share = params.gr2to.thesis.wall_share;
  config.max_free_height = params.octomap.max_free_height;
  config.min_occupied_height = params.octomap.min_occupied_height;
  config.marker_alpha = params.markers.alpha;
  return config;
}

/// The server of dynamic_reconfigure and what it needs.
class DynamicParameters {
 public:
  DynamicParameters(const ros::NodeHandle& private_nh, Gr2ToServer* server)
      : server_(server), dynamic_(mutex_, private_nh) {
    // setCallback() calls at once with what the parameter server says: nothing new.
    dynamic_.setCallback([this](Gr2ToConfig& config, std::uint32_t) {
      if (ready_) apply(config);  // what it changes in it is published
    });
    dynamic_.updateConfig(configOf(server->params()));
    ready_ = true;
  }

 private:
  void apply(Gr2ToConfig& config) {
    Gr2ToServerParams params = server_->params();
    // A text may be anything; numbers are clamped to their range before they come here.
    if (config.mode == "thesis") {
      params.gr2to.mode = Gr2ToParams::Mode::kThesis;
    } else if (config.mode == "default") {
      params.gr2to.mode = Gr2ToParams::Mode::kDefault;
    } else {
      const std::string now = configOf(params).mode;
      ROS_WARN_STREAM("mode '" << config.mode << "' is none of default, thesis: it stays " << now);
      config.mode = now;
    }
    params.gr2to.segmentation.free_max = config.free_max;
    params.gr2to.segmentation.working_resolution = config.working_resolution;
    params.gr2to.segmentation.max_clutter_size = config.max_clutter_size;
    params.gr2to.segmentation.min_place_area = config.min_place_area;
    params.gr2to.thesis.door_min = config.thesis_door_min;
    params.gr2to.thesis.door_max = config.thesis_door_max;
    params.gr2to.thesis.critical_radius = config.thesis_critical_radius;
    params.gr2to.thesis.wall_share = config.thesis_wall_share;
    params.octomap.max_free_height = config.max_free_height;
    params.octomap.min_occupied_height = config.min_occupied_height;
    params.markers.alpha = config.marker_alpha;
    try {
      params.validate();
    } catch (const hyselam::ParameterError& e) {
      ROS_WARN_STREAM("all parameters stay as they are: " << e.what());
      config = configOf(server_->params());
      return;
    }
    server_->setParams(params);
  }

  Gr2ToServer* server_;
  bool ready_ = false;
  boost::recursive_mutex mutex_;
  dynamic_reconfigure::Server<Gr2ToConfig> dynamic_;
};

}  // namespace

std::shared_ptr<void> makeDynamicParameters(const ros::NodeHandle& private_nh,
                                            Gr2ToServer* server) {
  return std::make_shared<DynamicParameters>(private_nh, server);
}

}  // namespace hyselam_topo

#else

namespace hyselam_topo {

std::shared_ptr<void> makeDynamicParameters(const ros::NodeHandle&, Gr2ToServer*) {
  return nullptr;
}

}  // namespace hyselam_topo

#endif
