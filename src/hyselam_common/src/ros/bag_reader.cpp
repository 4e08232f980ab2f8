#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <tf2/LinearMath/Transform.h>
#include <tf2_msgs/TFMessage.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>

#include "bag_structure.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/ros/conversions.hpp"

namespace hyselam {
namespace {

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::string withoutSlash(const std::string& name) {
  return !name.empty() && name[0] == '/' ? name.substr(1) : name;
}

/// A bag packed by gzip, unpacked for as long as this object lives.
class UnpackedBag {
 public:
  explicit UnpackedBag(const std::string& path) : name_(path) {
    std::ifstream file(path, std::ios::binary);
    if (!(file.get() == 0x1f && file.get() == 0x8b)) return;
    const std::string content = readTextFile(path);
    const char* directory = std::getenv("TMPDIR");
    name_ = std::string(directory != nullptr && *directory != '\0' ? directory : "/tmp") +
            "/hyselam-XXXXXX";
    const int fd = ::mkstemp(&name_[0]);
    if (fd < 0) throw InputError(path, "", "cannot be unpacked: no temporary file " + name_);
    ::close(fd);
    temporary_ = true;
    std::ofstream out(name_, std::ios::binary);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    if (!out) {
      ::unlink(name_.c_str());
      throw InputError(path, "", "cannot be unpacked: the disk of " + name_ + " is full");
    }
  }
  ~UnpackedBag() {
    if (temporary_) ::unlink(name_.c_str());
  }
  UnpackedBag(const UnpackedBag&) = delete;
  UnpackedBag& operator=(const UnpackedBag&) = delete;
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  bool temporary_ = false;
};

/// What is taken out of the bag before transforms and order are settled.
struct Content {
  struct Scan {
    LaserScan scan;
    std::string frame;
  };
  std::vector<Scan> scans;
  std::vector<StampedPose2> odometry, tf_odometry, truth;
  std::map<std::pair<std::string, std::string>, tf2::Transform> transforms;  ///< (parent, child)
};

std::map<std::string, std::string> topicTypes(rosbag::Bag& bag) {
  std::map<std::string, std::string> types;
  rosbag::View view(bag);
  for (const rosbag::ConnectionInfo* c : view.getConnections()) types[c->topic] = c->datatype;
  return types;
}

/// The wanted topic if it has the type. Else, if it was not asked for by another name than the
/// usual one, the only one of that type, or "".
std::string findTopic(const std::map<std::string, std::string>& types, const std::string& wanted,
                      const std::string& usual, const std::string& type, const std::string& path) {
  std::vector<std::string> candidates;
  for (const auto& t : types) {
    if (t.second != type) continue;
    if (withoutSlash(t.first) == withoutSlash(wanted)) return t.first;
    candidates.push_back(t.first);
  }
  const bool asked_for = withoutSlash(wanted) != withoutSlash(usual);
  if (!asked_for && candidates.size() <= 1) return candidates.empty() ? "" : candidates.front();
  std::string names;
  for (const std::string& c : candidates) names += " " + c;
  throw InputError(path, "",
                   "there is no topic " + wanted + " of type " + type +
                       (candidates.empty()       ? ", and no other"
                        : candidates.size() == 1 ? ", only" + names
                                                 : ", and several:" + names));
}

/// The time of the header, or that of the recording where the header has none.
double stampOf(const ros::Time& header, const rosbag::MessageInstance& m) {
  return toSeconds(header.isZero() ? m.getTime() : header);
}

void takeTransforms(const rosbag::MessageInstance& m, const tf2_msgs::TFMessage& msg,
                    const std::string& source, const BagOptions& options, Content* content) {
  for (const auto& t : msg.transforms) {
    const std::string parent = withoutSlash(t.header.frame_id);
    const std::string child = withoutSlash(t.child_frame_id);
    std::string what = source;
    what.append(": ").append(parent).append(" -> ").append(child);
    if (parent == options.odom_frame && child == options.base_frame) {
      content->tf_odometry.push_back({stampOf(t.header.stamp, m), fromMsg(t.transform, what)});
    } else if (parent != options.odom_frame && parent != options.map_frame) {
      // Only what is fixed on the robot matters here: its first value counts.
      content->transforms.emplace(std::make_pair(parent, child), spatialFromMsg(t.transform, what));
    }
  }
}

/// base -> frame through known transforms, in either direction.
std::optional<tf2::Transform> chain(const Content& content, const std::string& base,
                                    const std::string& frame) {
  std::map<std::string, tf2::Transform> reached{{base, tf2::Transform::getIdentity()}};
  for (bool grown = true; grown && reached.count(frame) == 0;) {
    grown = false;
    for (const auto& t : content.transforms) {
      const auto& [parent, child] = t.first;
      const auto p = reached.find(parent), c = reached.find(child);
      if (p != reached.end() && c == reached.end()) {
        reached.emplace(child, p->second * t.second);
        grown = true;
      } else if (c != reached.end() && p == reached.end()) {
        reached.emplace(parent, c->second * t.second.inverse());
        grown = true;
      }
    }
  }
  const auto found = reached.find(frame);
  if (found == reached.end()) return std::nullopt;
  return found->second;
}

/// Whether the list in a message fits into it. roscpp would take the memory for any stated length
/// before it looks.
bool statedLengthsFit(const rosbag::MessageInstance& m) {
  constexpr std::size_t kHeader = 12;             // seq, stamp; the frame's name follows
  constexpr std::size_t kScanNumbers = 7 * 4;     // between the header and the ranges
  constexpr std::size_t kSmallestTransform = 76;  // with empty names
  std::vector<std::uint8_t> bytes(m.size());
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  m.write(stream);
  const auto numberAt = [&](std::size_t at) -> std::optional<std::size_t> {
    if (at + 4 > bytes.size()) return std::nullopt;
    return bytes[at] + (bytes[at + 1] << 8) + (bytes[at + 2] << 16) +
           (static_cast<std::size_t>(bytes[at + 3]) << 24);
  };
  if (m.getDataType() == "sensor_msgs/LaserScan") {
    const auto name = numberAt(kHeader);
    const auto ranges = name ? numberAt(kHeader + 4 + *name + kScanNumbers) : std::nullopt;
    if (!ranges || *ranges * 4 > bytes.size()) return false;
    const auto intensities = numberAt(kHeader + 4 + *name + kScanNumbers + 4 + *ranges * 4);
    return intensities && *intensities * 4 <= bytes.size();
  }
  if (m.getDataType() == "tf2_msgs/TFMessage" || m.getDataType() == "tf/tfMessage") {
    const auto transforms = numberAt(0);
    return transforms && *transforms * kSmallestTransform <= bytes.size();
  }
  return true;
}

template <typename T>
boost::shared_ptr<T> decode(const rosbag::MessageInstance& m, const std::string& source) {
  if (!statedLengthsFit(m)) throw InputError(source, "", "the message is damaged (wrong lengths)");
  try {
    if (auto msg = m.instantiate<T>()) return msg;
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    throw InputError(source, "", std::string("the message is damaged (") + e.what() + ")");
  }
  throw InputError(source, "", "the message has another version of its type");
}

Content readContent(rosbag::Bag& bag, const std::string& path, const BagOptions& options) {
  const auto types = topicTypes(bag);
  const BagOptions usual;
  const std::string scan_topic =
      findTopic(types, options.scan_topic, usual.scan_topic, "sensor_msgs/LaserScan", path);
  if (scan_topic.empty()) throw InputError(path, "", "holds no laser scans");
  // The ground truth is an Odometry topic too, but never a candidate for the odometry.
  auto odometry_types = types;
  std::string truth_topic;
  for (const auto& t : types) {
    if (withoutSlash(t.first) == withoutSlash(options.ground_truth_topic)) truth_topic = t.first;
  }
  odometry_types.erase(truth_topic);
  const std::string odometry_topic = findTopic(odometry_types, options.odometry_topic,
                                               usual.odometry_topic, "nav_msgs/Odometry", path);

  std::vector<std::string> topics{scan_topic, "/tf", "/tf_static", "tf", "tf_static"};
  for (const std::string& t : {odometry_topic, truth_topic}) {
    if (!t.empty()) topics.push_back(t);
  }
  Content content;
  for (const rosbag::MessageInstance& m : rosbag::View(bag, rosbag::TopicQuery(topics))) {
    const std::string source =
        path + ": " + m.getTopic() + " at " + std::to_string(m.getTime().toSec());
    const std::string& topic = m.getTopic();
    if (topic == scan_topic) {
      const auto msg = decode<sensor_msgs::LaserScan>(m, source);
      content.scans.push_back({fromMsg(*msg, source), withoutSlash(msg->header.frame_id)});
      content.scans.back().scan.stamp = stampOf(msg->header.stamp, m);
    } else if (topic == truth_topic && m.getDataType() == "geometry_msgs/PoseStamped") {
      const auto msg = decode<geometry_msgs::PoseStamped>(m, source);
      content.truth.push_back({stampOf(msg->header.stamp, m), fromMsg(msg->pose, source)});
    } else if (topic == truth_topic || topic == odometry_topic) {
      const auto msg = decode<nav_msgs::Odometry>(m, source);
      auto& list = topic == truth_topic ? content.truth : content.odometry;
      list.push_back({stampOf(msg->header.stamp, m), fromMsg(msg->pose.pose, source)});
    } else {
      takeTransforms(m, *decode<tf2_msgs::TFMessage>(m, source), source, options, &content);
    }
  }
  return content;
}

void sortByStamp(std::vector<StampedPose2>* poses) {
  std::stable_sort(poses->begin(), poses->end(),
                   [](const StampedPose2& a, const StampedPose2& b) { return a.stamp < b.stamp; });
}

/// No transform leads from the base to a laser. Bags without any are taken as they are: the laser
/// is at the base. But a base that is in no transform, beside transforms, is one of another name.
void requireKnownBase(const Content& content, const std::string& laser, const std::string& path,
                      const BagOptions& options) {
  std::set<std::string> frames;
  for (const auto& t : content.transforms) frames.insert({t.first.first, t.first.second});
  const bool asked_for = options.base_frame != BagOptions().base_frame;
  if (!content.tf_odometry.empty() || frames.count(options.base_frame) != 0 || frames.empty() ||
      (!asked_for && frames.count(laser) == 0)) {
    return;
  }
  std::string known;
  for (const std::string& frame : frames) known += " " + frame;
  throw InputError(
      path, "frame " + laser,
      "no transform leads to it from " + options.base_frame + "; frames of the bag:" + known);
}

RobotLog assemble(Content content, const std::string& path, const BagOptions& options) {
  RobotLog log;
  if (content.scans.empty()) throw InputError(path, "", "holds no laser scans");
  log.odometry = std::move(content.odometry.empty() ? content.tf_odometry : content.odometry);
  if (log.odometry.empty() && options.odometry_required) {
    throw InputError(path, "",
                     "holds no odometry: neither " + options.odometry_topic +
                         " nor the transform " + options.odom_frame + " -> " + options.base_frame);
  }
  log.ground_truth = std::move(content.truth);
  sortByStamp(&log.odometry);
  sortByStamp(&log.ground_truth);
  std::map<std::string, std::optional<tf2::Transform>> lasers;
  for (Content::Scan& s : content.scans) {
    if (options.laser_in_base) {
      s.scan.laser_in_base = *options.laser_in_base;
    } else {
      auto found = lasers.find(s.frame);
      if (found == lasers.end()) {
        found = lasers.emplace(s.frame, chain(content, options.base_frame, s.frame)).first;
        if (!found->second) requireKnownBase(content, s.frame, path, options);
      }
      if (found->second) placeLaser(*found->second, path + ": frame " + s.frame, &s.scan);
    }
    log.scans.push_back(std::move(s.scan));
  }
  std::stable_sort(log.scans.begin(), log.scans.end(),
                   [](const LaserScan& a, const LaserScan& b) { return a.stamp < b.stamp; });
  return log;
}

}  // namespace

RobotLog readBag(const std::string& path, const BagOptions& options) {
  if (::access(path.c_str(), R_OK) != 0) {
    throw InputError(path, "", "cannot be read: no such file, or no permission");
  }
  const UnpackedBag unpacked(path);
  try {
    checkBagStructure(unpacked.name(), path);
    rosbag::Bag bag;  // opened below: where open() throws, only a finished object frees its memory
    bag.open(unpacked.name(), rosbag::bagmode::Read);
    return assemble(readContent(bag, path, options), path, options);
  } catch (const rosbag::BagUnindexedException&) {
    throw InputError(path, "", "the bag has no index: it is truncated (rosbag reindex may help)");
  } catch (const rosbag::BagException& e) {
    throw InputError(path, "", std::string("is no usable bag: ") + e.what());
  } catch (const ros::Exception& e) {
    throw InputError(path, "", std::string("is no usable bag: ") + e.what());
  } catch (const std::bad_alloc&) {
    throw InputError(path, "", "is no usable bag: it states sizes beyond the memory");
  } catch (const std::length_error&) {
    throw InputError(path, "", "is no usable bag: it states sizes beyond the memory");
  }
}

RobotLog readRobotLog(const std::string& path, const BagOptions& bag_options,
                      const CarmenOptions& carmen_options, std::vector<CarmenIssue>* issues) {
  if (endsWith(path, ".bag") || endsWith(path, ".bag.gz")) return readBag(path, bag_options);
  return readCarmenLog(path, carmen_options, issues);
}

}  // namespace hyselam
