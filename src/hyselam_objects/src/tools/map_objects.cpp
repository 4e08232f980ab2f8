// map_objects BAG --map OUT.xml: the object map of a recorded run, without a master: what the
// nodelet ObjectEngine makes of the same frames.
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>
#include <tf2_msgs/TFMessage.h>

#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <string>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_objects/mapping/landmark_check.hpp"
#include "hyselam_objects/ros/conversions.hpp"

namespace {

using namespace hyselam_objects;  // NOLINT: a program, not a header

struct Options {
  std::string bag, map_file, dictionary_file, map_frame = "map", camera = "/camera";
  double frame_period = 0.5, unconfirmed_for = 20.0;  // [s], as the nodelet has them
};

/// Of the transforms of a bag.
struct Frames {
  std::set<std::string> all, children;
};

/// All transforms of a bag, those between frames of all times.
Frames readTransforms(const rosbag::Bag& bag, tf2::BufferCore& to) {
  Frames frames;
  for (const rosbag::MessageInstance& m :
       rosbag::View(bag, rosbag::TopicQuery(std::vector<std::string>{"/tf", "/tf_static"}))) {
    const tf2_msgs::TFMessage::ConstPtr msg = m.instantiate<tf2_msgs::TFMessage>();
    if (msg == nullptr) continue;
    for (const auto& each : msg->transforms) {
      to.setTransform(each, "bag", m.getTopic() == "/tf_static");
      frames.all.insert({each.header.frame_id, each.child_frame_id});
      frames.children.insert(each.child_frame_id);
    }
  }
  return frames;
}

Eigen::Isometry3d poseOf(const tf2::BufferCore& transforms, const std::string& map_frame,
                         const std_msgs::Header& header) {
  const geometry_msgs::Transform pose =
      transforms.lookupTransform(map_frame, header.frame_id, header.stamp).transform;
  const auto& t = pose.translation;
  const auto& q = pose.rotation;
  return Eigen::Translation3d(t.x, t.y, t.z) * Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();
}

class BagMapper {
 public:
  BagMapper(const Options& options, ObjectDictionary dictionary)
      : options_(options), transforms_(ros::Duration(1e6)), mapper_(map_, std::move(dictionary)) {
    map_.frame_id = options.map_frame;
  }

  ObjectMap run(nlohmann::json& told) {
    rosbag::Bag bag;
    try {
      bag.open(options_.bag, rosbag::bagmode::Read);
    } catch (const rosbag::BagException& e) {
      throw hyselam::InputError(options_.bag, "", e.what());
    }
    const Frames frames = readTransforms(bag, transforms_);
    const std::vector<std::string> topics{options_.camera + "/depth/camera_info",
                                          options_.camera + "/depth/image_raw",
                                          options_.camera + "/color/image_raw"};
    for (const rosbag::MessageInstance& m : rosbag::View(bag, rosbag::TopicQuery(topics))) {
      if (m.getTopic() == topics[0]) {
        if (const auto info = m.instantiate<sensor_msgs::CameraInfo>())
          camera_ = cameraFromInfo(*info);
      } else if (m.getTopic() == topics[1]) {
        depth_ = m.instantiate<sensor_msgs::Image>();
        depth_images_ += depth_ != nullptr;
      } else {
        color_ = m.instantiate<sensor_msgs::Image>();
        color_images_ += color_ != nullptr;
      }
      const bool pair = camera_ && depth_ != nullptr && color_ != nullptr &&
                        depth_->header.stamp == color_->header.stamp;
      if (pair && isDue(depth_->header.stamp)) addFrame();
    }
    if (frames_ == 0) {
      throw hyselam::InputError(options_.bag, options_.camera,
                                without_pose_ == 0 ? withoutImages() : withoutPose(frames));
    }
    mapper_.consolidate(mapper_.time() - options_.unconfirmed_for);
    told = {{"frames", frames_},
            {"without_pose", without_pose_},
            {"held_back", held_back_},
            {"detections", detections_},
            {"objects", map_.objects.size()},
            {"relations", map_.relations.size()}};
    return map_;
  }

 private:
  bool isDue(const ros::Time& stamp) {
    if (!last_.isZero() && (stamp == last_ || (stamp - last_).toSec() < options_.frame_period)) {
      return false;
    }
    last_ = stamp;
    return true;
  }

  std::string withoutImages() const {
    return "has no depth and color images of equal stamps (depth: " +
           std::to_string(depth_images_) + ", color: " + std::to_string(color_images_) +
           ", camera_info: " + (camera_ ? "there" : "missing") + ")";
  }

  /// Images are there, but no pose of any: what the bag has, and which frame would do.
  std::string withoutPose(const Frames& frames) const {
    std::string names, instead;
    for (const std::string& frame : frames.all) {
      names += (names.empty() ? "" : ", ") + frame;
      const bool is_root = frames.children.count(frame) == 0;
      if (instead.empty() && is_root &&
          transforms_.canTransform(frame, depth_->header.frame_id, depth_->header.stamp)) {
        instead = "use --frame " + frame + ", or ";
      }
    }
    return "images are there (" + std::to_string(without_pose_) +
           " frames), but no transform from " + options_.map_frame + " to " +
           depth_->header.frame_id + "; frames of the bag: " + (names.empty() ? "none" : names) +
           "; " + instead + "localize first";
  }

  void addFrame() {
    PinholeCamera camera = *camera_;
    try {
      camera.in_map = poseOf(transforms_, options_.map_frame, depth_->header);
    } catch (const tf2::TransformException&) {
      ++without_pose_;
      return;
    }
    const OrganizedCloud cloud = cloudFromImages(*depth_, color_.get(), camera);
    const std::vector<DetectedObject> seen = detectObjects(cloud, camera.in_map);
    if (guard_.allowsUpdate(map_, seen)) {
      mapper_.update(cloud, camera, seen, hyselam::toSeconds(depth_->header.stamp));
    } else {
      ++held_back_;
    }
    ++frames_;
    detections_ += seen.size();
  }

  const Options& options_;
  tf2::BufferCore transforms_;
  ObjectMap map_;
  ObjectMapper mapper_;
  MapUpdateGuard guard_;
  std::optional<PinholeCamera> camera_;
  sensor_msgs::Image::ConstPtr depth_, color_;
  ros::Time last_;
  std::size_t frames_ = 0, without_pose_ = 0, held_back_ = 0, detections_ = 0;
  std::size_t depth_images_ = 0, color_images_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Maps the objects of a recorded run (depth and color images, camera_info, tf) without a "
      "master, as the nodelet ObjectEngine does.",
      "map_objects");
  Options options;
  app.option_defaults()->always_capture_default();
  app.add_option("BAG", options.bag, "with the images of a color and depth camera, and tf")
      ->required();
  app.add_option("--map", options.map_file, "object map to write (XML)")->required();
  app.add_option("--dictionary", options.dictionary_file, "object dictionary (XML)");
  app.add_option("--frame", options.map_frame, "frame of the map");
  app.add_option("--camera", options.camera, "namespace of the camera's topics");
  app.add_option("--frame-period", options.frame_period,
                 "frames that come sooner are left out [s]");

  return hyselam::runTool(argc, argv, app, [&] {
    ObjectDictionary dictionary;
    if (!options.dictionary_file.empty()) dictionary = loadDictionary(options.dictionary_file);
    nlohmann::json told;
    const ObjectMap map = BagMapper(options, dictionary).run(told);
    saveXml(options.map_file, map);
    for (const std::string& line : summaryLines(map)) std::cout << line << "\n";
    return told;
  });
}
