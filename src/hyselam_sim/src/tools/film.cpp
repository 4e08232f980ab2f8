// film --bag RUN.bag --out OUT.bag: adds the pictures of a colour and depth camera to a simulated
// run.
#include "hyselam_sim/film.hpp"

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>
#include <sys/stat.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_sim/data.hpp"
#include "hyselam_sim/things.hpp"

namespace {

using hyselam_sim::CameraParams;
using hyselam_sim::FilmFrame;

constexpr const char* kFrame = "camera_optical_frame";
constexpr const char* kFixed = "/tf_static";

geometry_msgs::TransformStamped cameraOnBase(const CameraParams& camera, const ros::Time& stamp) {
  geometry_msgs::TransformStamped t;
  t.header.stamp = stamp;
  t.header.frame_id = "base_link";
  t.child_frame_id = kFrame;
  t.transform = hyselam::toTransformMsg(camera.camera_in_base);
  t.transform.translation.z = camera.above_floor;
  // z forward, x right, y down.
  tf2::Quaternion turn, optical(-0.5, 0.5, -0.5, 0.5);
  turn.setRPY(0.0, 0.0, camera.camera_in_base.theta);
  turn *= optical;
  t.transform.rotation.x = turn.x();
  t.transform.rotation.y = turn.y();
  t.transform.rotation.z = turn.z();
  t.transform.rotation.w = turn.w();
  return t;
}

sensor_msgs::CameraInfo infoOf(const CameraParams& camera, const std_msgs::Header& header) {
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  const double f = camera.focalLength(), cx = 0.5 * camera.width - 0.5,
               cy = 0.5 * camera.height - 0.5;
  info.K = {f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {f, 0.0, cx, 0.0, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

sensor_msgs::Image imageOf(const cv::Mat& picture, const std::string& encoding,
                           const std_msgs::Header& header) {
  sensor_msgs::Image image;
  image.header = header;
  image.height = static_cast<std::uint32_t>(picture.rows);
  image.width = static_cast<std::uint32_t>(picture.cols);
  image.encoding = encoding;
  image.step = static_cast<std::uint32_t>(picture.cols * picture.elemSize());
  image.data.assign(picture.datastart, picture.dataend);
  return image;
}

/// The run's messages with the camera's among them, in the order of time.
class FilmedBag {
 public:
  FilmedBag(const std::string& in, const std::string& out, const CameraParams& camera, int jpeg)
      : camera_(camera), jpeg_(jpeg), out_(out, rosbag::bagmode::Write) {
    in_.open(in, rosbag::bagmode::Read);
    view_.addQuery(in_);
    next_ = view_.begin();
    for (const auto* connection : view_.getConnections()) fixed_ |= connection->topic == kFixed;
    if (!fixed_) {  // a run that others recorded: the camera's place is told all the same
      using Traits = tf2_msgs::TFMessage;
      const auto header = boost::make_shared<ros::M_string>(
          ros::M_string{{"topic", kFixed},
                        {"type", ros::message_traits::datatype<Traits>()},
                        {"md5sum", ros::message_traits::md5sum<Traits>()},
                        {"message_definition", ros::message_traits::definition<Traits>()},
                        {"latching", "1"}});
      tf2_msgs::TFMessage fixed;
      fixed.transforms.push_back(cameraOnBase(camera_, view_.getBeginTime()));
      out_.write(kFixed, view_.getBeginTime(), fixed, header);
    }
  }

  void write(const FilmFrame& frame) {
    std_msgs::Header header;
    header.stamp = hyselam::toRosTime(frame.stamp);
    header.frame_id = kFrame;
    copyUntil(header.stamp);
    // After the scan of the same stamp, which bags record some nanoseconds later.
    const ros::Time recorded = header.stamp + ros::Duration(0, 10);
    out_.write("/camera/color/camera_info", recorded, infoOf(camera_, header));
    if (jpeg_ > 0) {
      sensor_msgs::CompressedImage image;
      image.header = header;
      image.format = "bgr8; jpeg compressed bgr8";
      cv::imencode(".jpg", frame.picture.color, image.data, {cv::IMWRITE_JPEG_QUALITY, jpeg_});
      out_.write("/camera/color/image_raw/compressed", recorded, image);
    } else {
      out_.write("/camera/color/image_raw", recorded, imageOf(frame.picture.color, "bgr8", header));
    }
    out_.write("/camera/depth/camera_info", recorded, infoOf(camera_, header));
    out_.write("/camera/depth/image_raw", recorded, imageOf(frame.picture.depth, "16UC1", header));
  }

  void close() {
    copyUntil(ros::TIME_MAX - ros::Duration(1));
    out_.close();
  }

 private:
  void copyUntil(const ros::Time& time) {
    for (; next_ != view_.end() && next_->getTime() <= time + ros::Duration(0, 9); ++next_) {
      if (next_->getTopic() == kFixed) {
        auto fixed = next_->instantiate<tf2_msgs::TFMessage>();
        if (fixed) {
          fixed->transforms.push_back(
              cameraOnBase(camera_, fixed->transforms.empty() ? next_->getTime()
                                                              : fixed->transforms[0].header.stamp));
          out_.write(kFixed, next_->getTime(), *fixed, next_->getConnectionHeader());
          continue;
        }
      }
      out_.write(next_->getTopic(), next_->getTime(), *next_, next_->getConnectionHeader());
    }
  }

  CameraParams camera_;
  int jpeg_;
  rosbag::Bag in_, out_;
  rosbag::View view_;
  rosbag::View::iterator next_;
  bool fixed_ = false;  // the run tells where sensors are mounted
};

/// Pictures as files with a list of what they show: image_path, place, depth_path, truth, the scan.
class FilmedFiles {
 public:
  FilmedFiles(const std::string& directory, const hyselam::RobotLog& log,
              const hyselam_sim::FloorPlan& plan)
      : directory_(directory), log_(log), plan_(plan) {
    for (const std::string& d : {directory, directory + "/rgb", directory + "/depth"}) {
      if (::mkdir(d.c_str(), 0777) != 0 && errno != EEXIST) {
        throw hyselam::InputError(d, "", "cannot be made");
      }
    }
    rows_ << "image_path,place,depth_path,stamp,x,y,theta";
    if (!log_.scans.empty()) {
      for (std::size_t i = 0; i < log_.scans.front().ranges.size(); ++i) rows_ << ",scan_" << i;
    }
    rows_ << "\n";
  }

  void write(const FilmFrame& frame) {
    if (frame.place < 0) return;
    char number[16];
    std::snprintf(number, sizeof number, "%05zu", count_++);
    const std::string rgb = std::string("rgb/") + number + ".jpg";
    const std::string depth = std::string("depth/") + number + ".png";
    for (const bool color : {true, false}) {
      const std::string path = directory_ + "/" + (color ? rgb : depth);
      const bool written =
          color ? cv::imwrite(path, frame.picture.color, {cv::IMWRITE_JPEG_QUALITY, 92})
                : cv::imwrite(path, frame.picture.depth);
      if (!written) throw hyselam::InputError(path, "", "cannot be written");
    }
    rows_ << rgb << "," << plan_.places[static_cast<std::size_t>(frame.place)].name << "," << depth
          << "," << std::to_string(frame.stamp) << "," << frame.base.x << "," << frame.base.y << ","
          << frame.base.theta;
    while (scan_ + 1 < log_.scans.size() && log_.scans[scan_ + 1].stamp <= frame.stamp + 1e-6) {
      ++scan_;
    }
    if (!log_.scans.empty()) {
      for (const float range : log_.scans[scan_].ranges) rows_ << "," << range;
    }
    rows_ << "\n";
  }

  void close() {
    const std::string text = rows_.str();
    hyselam::writeFileAtomically(directory_ + "/labels.csv",
                                 [&](std::ostream& out) { out << text; });
  }

 private:
  std::string directory_;
  const hyselam::RobotLog& log_;
  const hyselam_sim::FloorPlan& plan_;
  std::ostringstream rows_;
  std::size_t count_ = 0, scan_ = 0;
};

struct Options {
  std::string bag_in, plan, route, things, bag_out, images;
  std::uint64_t seed = 1;
  int jpeg = 0;
  hyselam_sim::FilmParams params;
  hyselam_sim::SceneParams scene;
  std::string lamps = "by_hour";
  double view = 70.0;  // [degrees]
};

/// Writes the pictures where they are wanted; returns their number.
std::size_t writePictures(const Options& o, const hyselam_sim::Scene& scene,
                          const hyselam::RobotLog& log,
                          const std::vector<hyselam_sim::Person>& people) {
  std::size_t frames = 0;
  hyselam::Progress progress("filming", hyselam_sim::filmLength(log, o.params));
  const auto record = [&](FilmedBag* bag) {
    std::unique_ptr<FilmedFiles> files;
    if (!o.images.empty()) files = std::make_unique<FilmedFiles>(o.images, log, scene.plan());
    hyselam_sim::film(scene, log, people, o.seed, o.params, [&](const FilmFrame& frame) {
      if (bag != nullptr) bag->write(frame);
      if (files) files->write(frame);
      progress.update(++frames);
    });
    if (files) files->close();
  };
  if (o.bag_out.empty()) {
    record(nullptr);
    return frames;
  }
  try {
    hyselam::replaceFileAtomically(o.bag_out, [&](const std::string& temporary) {
      FilmedBag bag(o.bag_in, temporary, o.params.camera, o.jpeg);
      record(&bag);
      bag.close();
    });
  } catch (const rosbag::BagException& e) {
    throw hyselam::InputError(o.bag_out, "", std::string("cannot be written: ") + e.what());
  }
  return frames;
}

nlohmann::json filmRun(Options o) {
  if (o.bag_out.empty() && o.images.empty()) {
    throw hyselam::InputError("command line", "", "give --out, --images or both");
  }
  hyselam_sim::Route route;
  if (!o.route.empty()) route = hyselam_sim::loadRoute(hyselam_sim::routeFile(o.route));
  if (o.plan.empty()) o.plan = route.plan;
  if (o.plan.empty()) throw hyselam::InputError("command line", "--plan", "is missing");
  hyselam_sim::FloorPlan plan = hyselam_sim::loadFloorPlan(hyselam_sim::planFile(o.plan));
  if (!route.doors.empty()) plan.setDoors(route.doors);
  o.params.camera.view = hyselam::radians(o.view);
  o.params.light.lamps = o.lamps == "on"    ? hyselam_sim::LightParams::Lamps::kOn
                         : o.lamps == "off" ? hyselam_sim::LightParams::Lamps::kOff
                                            : hyselam_sim::LightParams::Lamps::kByHour;
  const hyselam::RobotLog log = hyselam::readBag(o.bag_in);
  if (log.ground_truth.empty()) {
    throw hyselam::InputError(o.bag_in, "/ground_truth", "has no messages: nothing to film along");
  }
  o.params.start_time = log.ground_truth.front().stamp;
  if (!o.things.empty()) o.scene.things = hyselam_sim::loadThings(o.things);
  const hyselam_sim::Scene scene(plan, o.scene);
  const std::size_t frames = writePictures(o, scene, log, route.people);
  std::cout << frames << " pictures of " << plan.name << " at " << o.params.light.hour << " h\n";
  return {{"plan", plan.name},     {"pictures", frames}, {"hour", o.params.light.hour},
          {"rate", o.params.rate}, {"seed", o.seed},     {"look", o.scene.seed}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Films a simulated run: renders what a colour and depth camera on the robot sees along the "
      "ground truth of a bag, by the hour of the day, and writes it into a new bag, as files with "
      "the places' names, or both.",
      "film");
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("--bag", o.bag_in, "run to film, from `simulate`")->required();
  app.add_option("--route", o.route, "route of the run: with the people that walk about");
  app.add_option("--plan", o.plan, "floor plan; the route's own if not given");
  app.add_option("--things", o.things, "file of things that stand about");
  app.add_option("--out", o.bag_out, "bag to write: the run with /camera/color, /camera/depth");
  app.add_option("--images", o.images, "directory for rgb/, depth/ and labels.csv");
  app.add_option("--rate", o.params.rate, "pictures per second");
  app.add_option("--hour", o.params.light.hour, "of the day")->check(CLI::Range(0.0, 24.0));
  app.add_option("--clouds", o.params.light.clouds, "0 clear .. 1 dull")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--lamps", o.lamps, "by_hour, on, off")
      ->check(CLI::IsMember({"by_hour", "on", "off"}));
  app.add_option("--seed", o.seed, "of the pictures' noise");
  app.add_option("--look", o.scene.seed, "seed of paint, windows and posters");
  app.add_option("--width", o.params.camera.width, "[pixel]");
  app.add_option("--height", o.params.camera.height, "[pixel]");
  app.add_option("--view", o.view, "horizontal field of view [degrees]");
  app.add_option("--above-floor", o.params.camera.above_floor, "of the camera [m]");
  app.add_option("--jpeg", o.jpeg, "colour as JPEG of this quality; 0: raw")
      ->check(CLI::Range(0, 100));

  return hyselam::runTool(argc, argv, app, [&] { return filmRun(o); });
}
