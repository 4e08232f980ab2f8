#include "hyselam_objects/ros/map_file.hpp"

#include <ros/console.h>

#include <chrono>
#include <filesystem>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_objects/ros/conversions.hpp"

namespace hyselam_objects {
namespace {

/// What went wrong; empty: nothing.
std::string write(const std::string& path, const ObjectMap& map) {
  try {
    saveXml(path, map);
    return "";
  } catch (const std::exception& e) {
    return e.what();
  }
}

}  // namespace

ObjectMap loadMapIn(const std::string& frame_id, const std::string& path) {
  ObjectMap map = loadObjectMap(path);
  if (map.frame_id != frame_id) {
    throw hyselam::InputError(path, "frame_id",
                              "is '" + map.frame_id + "', not '" + frame_id + "'");
  }
  hyselam::toRosTime(map.stamp, path);  // what no message can hold is refused
  toMsg(map);                           // the times of its objects, too
  return map;
}

MapFile::MapFile(std::string who, std::string path)
    : who_(std::move(who)), path_(std::move(path)) {}

ObjectMap MapFile::begin(const std::string& frame_id) {
  ObjectMap map;
  map.frame_id = frame_id;
  // What cannot even be looked at is treated as a file that cannot be read.
  std::error_code unseen;
  if (!path_.empty() && (std::filesystem::exists(path_, unseen) || unseen)) {
    try {
      map = loadMapIn(frame_id, path_);
    } catch (const std::exception& e) {
      error_ = e.what();
      const std::string aside = path_ + ".damaged";
      std::error_code failed;
      std::filesystem::rename(path_, aside, failed);
      ROS_ERROR_STREAM(who_ << " begins without its objects: " << e.what()
                            << (failed ? "" : "; the file is kept as " + aside));
      if (failed) path_.clear();
    }
  }
  saved_ = map;
  return map;
}

void MapFile::save(const ObjectMap& map) {
  if (path_.empty()) return;
  wait();
  if (!differs_ && map == saved_) return;
  saved_ = map;
  told(write(path_, map));
}

void MapFile::saveAside(const ObjectMap& map) {
  error();
  if (path_.empty() || writing_.valid() || (!differs_ && map == saved_)) return;
  saved_ = map;
  writing_ = std::async(std::launch::async, [path = path_, map] { return write(path, map); });
}

void MapFile::wait() {
  if (writing_.valid()) told(writing_.get());
}

const std::string& MapFile::error() {
  if (writing_.valid() && writing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    told(writing_.get());
  }
  return error_;
}

void MapFile::told(const std::string& error) {
  if (!error.empty() && error_.empty()) {
    ROS_ERROR_STREAM(who_ << " the objects are not saved: " << error);
  }
  error_ = error;
  differs_ = !error.empty();
}

}  // namespace hyselam_objects
