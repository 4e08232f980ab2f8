#include "hyselam_objects/ros/map_file.hpp"

#include <ros/console.h>

#include <chrono>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/put_aside.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_objects/ros/conversions.hpp"

namespace hyselam_objects {
namespace {

/// Returns the error; empty: none.
std::string write(const std::string& path, const ObjectMap& map) {
  try {
    saveXml(path, map);
    return "";
  } catch (const std::exception& e) {
    return e.what();
  }
}

}  // namespace

ObjectMap loadMapInFrame(const std::string& frame_id, const std::string& path) {
  ObjectMap map = loadObjectMap(path);
  if (map.frame_id != frame_id) {
    throw hyselam::InputError(path, "frame_id",
                              "is '" + map.frame_id + "', not '" + frame_id + "'");
  }
  hyselam::toRosTime(map.stamp, path);  // what no message can hold is refused
  toMsg(map);                           // as well as times of its objects
  return map;
}

MapFile::MapFile(std::string log_name, std::string path)
    : log_name_(std::move(log_name)), path_(std::move(path)) {}

ObjectMap MapFile::load(const std::string& frame_id) {
  ObjectMap map;
  map.frame_id = frame_id;
  if (!path_.empty() && hyselam::mayExist(path_)) {
    try {
      map = loadMapInFrame(frame_id, path_);
    } catch (const std::exception& e) {
      error_ = e.what();
      const auto aside = hyselam::putAside(path_);
      ROS_ERROR_STREAM(log_name_ << " starts without its objects: " << e.what()
                                 << hyselam::keptAs(aside));
      if (!aside) path_.clear();
    }
  }
  saved_ = map;
  return map;
}

void MapFile::save(const ObjectMap& map) {
  if (path_.empty()) return;
  wait();
  if (!outdated_ && map == saved_) return;
  saved_ = map;
  setError(write(path_, map));
}

void MapFile::saveInBackground(const ObjectMap& map) {
  error();
  if (path_.empty() || writing_.valid() || (!outdated_ && map == saved_)) return;
  saved_ = map;
  writing_ = std::async(std::launch::async, [path = path_, map] { return write(path, map); });
}

void MapFile::wait() {
  if (writing_.valid()) setError(writing_.get());
}

const std::string& MapFile::error() {
  if (writing_.valid() && writing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    setError(writing_.get());
  }
  return error_;
}

void MapFile::setError(const std::string& error) {
  if (!error.empty() && error_.empty()) {
    ROS_ERROR_STREAM(log_name_ << " the objects are not saved: " << error);
  }
  error_ = error;
  outdated_ = !error.empty();
}

}  // namespace hyselam_objects
