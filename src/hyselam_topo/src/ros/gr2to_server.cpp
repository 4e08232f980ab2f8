#include "hyselam_topo/ros/gr2to_server.hpp"

#include <visualization_msgs/MarkerArray.h>

#include <filesystem>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/server_setup.hpp"
#include "hyselam_gr2to/ros/octomap_conversions.hpp"
#include "hyselam_topological_map/map_geometry.hpp"
#include "hyselam_topological_map/ros/conversions.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"

namespace hyselam_topo {
namespace {

constexpr double kPatience = 5.0;  // without a map until diagnostics warn [s]

std::size_t doorsOf(const AugmentedTopologicalMap& map) {
  std::size_t doors = 0;
  for (const Edge& edge : map.edges) doors += edge.doors.size();
  return doors;
}

std::string counts(const AugmentedTopologicalMap& map) {
  return std::to_string(map.places.size()) + " places, " + std::to_string(doorsOf(map)) + " doors";
}

/// A map from a file; what no message can carry is refused before it takes another map's place.
AugmentedTopologicalMap loadToPublish(const std::string& path) {
  AugmentedTopologicalMap map = loadXml(path);
  map.frame_id = frameOf(map.frame_id);
  if (map.stamp != 0.0) hyselam::toRosTime(map.stamp, path);
  return map;
}

bool hasExtension(const std::string& path, const char* extension) {
  return std::filesystem::path(path).extension() == extension;
}

}  // namespace

Gr2ToServer::Gr2ToServer(ros::NodeHandle nh, const ros::NodeHandle& private_nh,
                         BackgroundGr2To::Pipeline pipeline)
    : who_(hyselam::logName(private_nh)),
      params_(hyselam::loadAndLogParams(private_nh, loadGr2ToParams)),
      marker_params_(params_.markers),
      map_publisher_(
          nh.advertise<hyselam_msgs::AugmentedTopologicalMap>("topological_map", 1, true)),
      marker_publisher_(
          nh.advertise<visualization_msgs::MarkerArray>("topological_markers", 1, true)),
      background_(
          [this](const BackgroundGr2To::Outcome& outcome) { onOutcome(outcome); },
          pipeline ? std::move(pipeline) : BackgroundGr2To::updating(params_.partial_updates)) {
  if (!params_.map_file.empty()) {
    background_.replace(loadToPublish(params_.map_file), params_.map_file);
    publish(background_.current());
    ROS_INFO_STREAM(who_ << " begins with " << counts(*background_.current()) << " of "
                         << params_.map_file);
  }
  place_at_service_ = nh.advertiseService("place_at", &Gr2ToServer::onPlaceAt, this);
  save_service_ = nh.advertiseService("save_topological_map", &Gr2ToServer::onSave, this);
  load_service_ = nh.advertiseService("load_topological_map", &Gr2ToServer::onLoad, this);
  diagnostics_.emplace(nh, private_nh.getNamespace().substr(1) + ": places",
                       params_.diagnostic_period,
                       [this](diagnostic_msgs::DiagnosticStatus& status) { report(status); });
  if (params_.use_octomap) {
    projected_publisher_ = nh.advertise<nav_msgs::OccupancyGrid>("projected_map", 1, true);
    subscriber_ = nh.subscribe("octomap", 1, &Gr2ToServer::onOctomap, this);
  } else {
    subscriber_ = nh.subscribe("map", 1, &Gr2ToServer::onMap, this);
  }
}

Gr2ToServer::~Gr2ToServer() {
  // The segmentation ends before the other members: nothing may come in for it any more.
  diagnostics_.reset();
  subscriber_.shutdown();
  for (ros::ServiceServer* service : {&place_at_service_, &save_service_, &load_service_}) {
    service->shutdown();
  }
}

void Gr2ToServer::onMap(const nav_msgs::OccupancyGrid::ConstPtr& msg) {
  ++received_;
  last_map_ = msg;
  startLast();
}

void Gr2ToServer::onOctomap(const octomap_msgs::Octomap::ConstPtr& msg) {
  ++received_;
  last_octomap_ = msg;
  startLast();
}

void Gr2ToServer::startLast() {
  if (!last_map_ && !last_octomap_) return;
  const std_msgs::Header& header = last_map_ ? last_map_->header : last_octomap_->header;
  if (header.frame_id.empty()) {
    ROS_WARN_STREAM_ONCE(who_ << " the map has no frame_id, 'map' is taken");
  }
  BackgroundGr2To::Input input;
  input.frame_id = frameOf(header.frame_id);
  input.stamp = hyselam::toSeconds(header.stamp);
  input.params = params_.gr2to;
  input.params_version = params_version_;
  if (last_map_) {
    input.grid = [msg = last_map_, most = params_.max_map_cells] {
      const std::uint64_t cells = std::uint64_t{msg->info.width} * msg->info.height;
      if (cells > static_cast<std::uint64_t>(most)) {
        throw hyselam::InputError("map", "",
                                  "it has " + std::to_string(cells) +
                                      " cells, more than max_map_cells, " + std::to_string(most));
      }
      return hyselam::fromMsg(*msg, "map");
    };
  } else {
    input.grid = [msg = last_octomap_, params = params_.octomap] {
      return compress(fromMsg(*msg, "octomap"), params, "octomap").grid;
    };
  }
  background_.start(std::move(input));
}

void Gr2ToServer::setParams(const Gr2ToServerParams& params) {
  params_.gr2to = params.gr2to;
  params_.octomap = params.octomap;
  params_.markers = params.markers;
  ++params_version_;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    marker_params_ = params.markers;
  }
  const BackgroundGr2To::MapPtr map = background_.current();
  if (last_map_ || last_octomap_)
    startLast();
  else if (map)  // of a file: as it is, in other colors
    publish(map);
}

void Gr2ToServer::onOutcome(const BackgroundGr2To::Outcome& outcome) {
  BackgroundGr2To::MapPtr before;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    status_.error = outcome.error;
    if (!outcome.error.empty()) {
      ++status_.refused;
    } else if (outcome.unchanged) {
      ++status_.unchanged;
    } else {
      ++status_.segmented;
      status_.seconds = outcome.total_seconds;
      status_.stages = outcome.seconds;
    }
    before = published_;
  }
  logOutcome(outcome, before.get());
  if (!outcome.map || outcome.unchanged) return;
  try {
    if (projected_publisher_) {
      projected_publisher_.publish(
          hyselam::toMsg(*outcome.grid, outcome.map->frame_id, ros::Time(outcome.map->stamp)));
    }
    publish(outcome.map);
  } catch (const std::exception& e) {  // no memory for the messages; the thread must live on
    ROS_ERROR_STREAM(who_ << " this map is not published: " << e.what());
    const std::lock_guard<std::mutex> lock(mutex_);
    status_.error = e.what();
  }
}

void Gr2ToServer::logOutcome(const BackgroundGr2To::Outcome& outcome,
                             const AugmentedTopologicalMap* before) const {
  if (!outcome.error.empty()) {
    ROS_ERROR_STREAM(who_ << " this input is not used: " << outcome.error);
    return;
  }
  if (outcome.unchanged) return;
  if (!outcome.warning.empty()) ROS_WARN_STREAM(who_ << " " << outcome.warning);
  ROS_INFO_STREAM(who_ << " " << counts(*outcome.map) << " in " << outcome.total_seconds
                       << " s; new places: " << outcome.report.created.size() << ", merged: "
                       << outcome.report.merged.size() << ", lost: " << outcome.report.lost.size());
  if (before == nullptr) return;
  for (const Id id : outcome.report.lost) {
    const Place* place = before->findPlace(id);
    if (place != nullptr && !place->words.empty()) {
      ROS_WARN_STREAM(who_ << " '" << nameOf(*place) << "' is no longer in the map");
    }
  }
}

void Gr2ToServer::publish(const BackgroundGr2To::MapPtr& map) {
  MapMarkerParams marker_params;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    marker_params = marker_params_;
  }
  const hyselam_msgs::AugmentedTopologicalMap msg = toMsg(*map);
  const visualization_msgs::MarkerArray markers = mapMarkers(*map, marker_params);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (background_.current() != map) return;  // something newer goes out, or went
  published_ = map;
  status_.places = map->places.size();
  status_.doors = doorsOf(*map);
  map_publisher_.publish(msg);
  marker_publisher_.publish(markers);
}

bool Gr2ToServer::onPlaceAt(hyselam_msgs::PlaceAt::Request& request,
                            hyselam_msgs::PlaceAt::Response& response) {
  const BackgroundGr2To::MapPtr map = background_.current();
  const std::string& frame = request.point.header.frame_id;
  if (!map) {
    response.message = "there is no topological map yet";
  } else if (!frame.empty() && frameOf(frame) != map->frame_id) {
    response.message = "the map is in frame '" + map->frame_id + "', not in '" + frame + "'";
  } else if (!(request.max_distance >= 0.0)) {
    response.message = "max_distance must be >= 0";
  } else {
    const auto found =
        placeAt(*map, {request.point.point.x, request.point.point.y}, request.max_distance);
    if (!found) {
      response.message = "there is no place at this point";
      return true;
    }
    const Place& place = *map->findPlace(found->place);
    response.found = true;
    response.id = place.id;
    response.word = place.words.empty() ? "" : nameOf(place);
    response.kind = static_cast<std::uint8_t>(place.kind);
    response.distance = found->distance;
  }
  return true;
}

bool Gr2ToServer::onSave(hyselam_msgs::TopologicalMapPath::Request& request,
                         hyselam_msgs::TopologicalMapPath::Response& response) {
  try {
    const BackgroundGr2To::MapPtr map = background_.current();
    if (!map) throw hyselam::InputError(request.path, "", "there is no topological map yet");
    if (hasExtension(request.path, ".graphml")) {
      const std::string text = toGraphMl(*map);
      hyselam::writeFileAtomically(request.path, [&](std::ostream& out) { out << text; });
    } else if (hasExtension(request.path, ".xml")) {
      saveXml(request.path, *map);
    } else {
      throw hyselam::InputError(request.path, "", "the name must end in .xml or .graphml");
    }
    response.success = true;
    response.message = counts(*map) + " written to " + request.path;
    ROS_INFO_STREAM(who_ << " " << response.message);
  } catch (const std::exception& e) {
    response.message = e.what();
    ROS_ERROR_STREAM(who_ << " not saved: " << e.what());
  }
  return true;
}

bool Gr2ToServer::onLoad(hyselam_msgs::TopologicalMapPath::Request& request,
                         hyselam_msgs::TopologicalMapPath::Response& response) {
  try {
    background_.replace(loadToPublish(request.path), request.path);
    const BackgroundGr2To::MapPtr map = background_.current();
    publish(map);
    response.success = true;
    response.message = counts(*map) + " read from " + request.path;
    ROS_INFO_STREAM(who_ << " " << response.message);
  } catch (const std::exception& e) {
    response.message = e.what();
    ROS_ERROR_STREAM(who_ << " not loaded: " << e.what());
  }
  return true;
}

void Gr2ToServer::report(diagnostic_msgs::DiagnosticStatus& status) {
  using diagnostic_msgs::DiagnosticStatus;
  using hyselam::addRemark;
  using hyselam::addValue;
  const bool busy = background_.busy();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!status_.error.empty()) addRemark(status, DiagnosticStatus::ERROR, status_.error);
  if (published_) {
    addRemark(status, DiagnosticStatus::OK, counts(*published_));
  } else if (status_.error.empty()) {
    const bool long_ago = (ros::WallTime::now() - begun_).toSec() > kPatience;
    addRemark(status, long_ago && !busy ? DiagnosticStatus::WARN : DiagnosticStatus::OK,
              busy ? "the first map is being segmented" : "no map has come");
  }
  addValue(status, "maps received", received_);
  addValue(status, "maps segmented", status_.segmented);
  addValue(status, "maps unchanged", status_.unchanged);
  addValue(status, "maps refused", status_.refused);
  addValue(status, "segmenting", busy);
  addValue(status, "places", status_.places);
  addValue(status, "doors", status_.doors);
  addValue(status, "last segmentation [s]", status_.seconds);
  for (const auto& [stage, seconds] : status_.stages) addValue(status, stage + " [s]", seconds);
}

}  // namespace hyselam_topo
