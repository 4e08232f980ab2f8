#include "carmen_line.hpp"

#include <cctype>
#include <cmath>

#include "hyselam_common/numbers.hpp"

namespace hyselam {
namespace {

constexpr double kCentimeter = 0.01;
constexpr std::size_t kMinBeams = 2;       // one beam has no increment
constexpr std::size_t kMaxBeams = 100000;  // more is no laser scanner but a damaged count

/// Known messages that hold nothing for us.
constexpr const char* kIgnored[] = {"SYNC",
                                    "RLASER",
                                    "LASER",
                                    "MARKER",
                                    "SCANMARK",
                                    "SONAR",
                                    "BUMPER",
                                    "IR",
                                    "POSITIONLASER",
                                    "PANTILT",
                                    "GPSGGA",
                                    "GPSRMC",
                                    "NMEAGGA",
                                    "NMEARMC",
                                    "GPGGA",
                                    "IMU",
                                    "XSENS",
                                    "ARM",
                                    "VECTORMOVE",
                                    "ROBOTVELOCITY",
                                    "FOLLOWTRAJECTORY",
                                    "BASEVELOCITY",
                                    "COMMENT",
                                    "VERSION",
                                    "POSE",
                                    "LOCALIZE",
                                    "GLOBALPOS",
                                    "SIMULATOR",
                                    "TRUEPOSE"};

/// Reads fields one after the other; the first failure sticks.
class FieldReader {
 public:
  FieldReader(const std::vector<std::string_view>& fields, std::size_t begin, std::string* reason)
      : fields_(fields), next_(begin), reason_(reason) {}

  bool ok() const { return ok_; }
  double number(const char* what) {
    if (!ok_) return 0.0;
    if (next_ >= fields_.size()) return fail(std::string("ends before ") + what);
    const auto value = parseNumber(fields_[next_++]);
    if (!value) {
      return fail("field " + std::to_string(next_) + " (" + what + ") is not a finite number");
    }
    return *value;
  }
  void word() {
    if (ok_ && next_ >= fields_.size()) fail("ends before the host");
    ++next_;
  }
  std::size_t count(const char* what) {
    const double value = number(what);
    if (ok_ && (value < 0.0 || value > kMaxBeams || value != std::floor(value))) {
      fail(std::string(what) + " is not a sensible count");
    }
    return ok_ ? static_cast<std::size_t>(value) : 0;
  }
  Pose2 pose(const char* what) {
    const double x = number(what), y = number(what), theta = number(what);
    return {x, y, normalizeAngle(theta)};
  }
  void ranges(std::size_t n, double unit, LaserScan* scan) {
    if (ok_ && n < kMinBeams) fail("has fewer than 2 readings");
    if (ok_ && fields_.size() - next_ < n) {
      fail(std::to_string(n) + " readings announced, but only " +
           std::to_string(fields_.size() - next_) + " fields follow");
    }
    if (!ok_) return;
    scan->ranges.reserve(n);
    for (std::size_t i = 0; i < n && ok_; ++i) {
      const double range = number("a reading") * unit;
      if (ok_ && std::abs(range) > 1e6) fail("holds a reading beyond 1000 km");
      scan->ranges.push_back(static_cast<float>(range));
    }
  }
  void times(CarmenLine* line) {
    line->ipc_stamp = number("the ipc timestamp");
    word();
    line->logger_stamp = number("the logger timestamp");
  }
  void end() {
    if (ok_ && next_ != fields_.size()) {
      fail("has " + std::to_string(fields_.size() - next_) + " fields too many");
    }
  }
  double fail(std::string reason) {
    if (ok_) *reason_ = std::move(reason);
    ok_ = false;
    return 0.0;
  }

 private:
  const std::vector<std::string_view>& fields_;
  std::size_t next_;
  std::string* reason_;
  bool ok_ = true;
};

/// A field of view of 180 deg: n beams 180/n apart for even n, 180/(n - 1) for odd n.
void assumeHalfCircle(LaserScan* scan) {
  const std::size_t n = scan->ranges.size();
  scan->angle_min = -kPi / 2.0;
  scan->angle_increment = kPi / static_cast<double>(n % 2 == 0 ? n : n - 1);
}

void parseFrontLaser(FieldReader& in, CarmenLine* line) {
  const std::size_t n = in.count("the number of readings");
  in.ranges(n, 1.0, &line->scan);
  in.pose("the laser pose");
  line->odometry = in.pose("the odometry");
  in.times(line);
  in.end();
  if (in.ok()) assumeHalfCircle(&line->scan);
}

/// laser_type start_angle field_of_view angular_resolution maximum_range accuracy remission_mode n
/// r.. m e..
void parseConfiguredReadings(FieldReader& in, LaserScan* scan) {
  in.number("the laser type");
  scan->angle_min = in.number("the start angle");
  in.number("the field of view");
  scan->angle_increment = in.number("the angular resolution");
  scan->range_max = in.number("the maximum range");
  in.number("the accuracy");
  in.number("the remission mode");
  const std::size_t n = in.count("the number of readings");
  in.ranges(n, 1.0, scan);
  const std::size_t m = in.count("the number of remissions");
  for (std::size_t i = 0; i < m && in.ok(); ++i) in.number("a remission");
  if (in.ok() && (scan->angle_increment == 0.0 || std::abs(scan->angle_increment) > kPi ||
                  std::abs(scan->angle_min) > 2.0 * kPi)) {
    in.fail("states angles that no laser has");
  }
  if (in.ok() && scan->range_max < 0.0) in.fail("states a negative maximum range");
}

/// The old form of RAWLASER and ROBOTLASER has the count in the first place; the new one has it in
/// the eighth. In the old form the number of fields follows from the count alone.
bool isOldForm(const std::vector<std::string_view>& fields, std::size_t tail) {
  const auto n = fields.size() > 1 ? parseNumber(fields[1]) : std::nullopt;
  return n && *n >= 2.0 &&
         *n + 2.0 + static_cast<double>(tail) == static_cast<double>(fields.size());
}

void parseReadings(FieldReader& in, bool old, LaserScan* scan) {
  if (old) {
    const std::size_t n = in.count("the number of readings");
    in.ranges(n, 1.0, scan);
    if (in.ok()) assumeHalfCircle(scan);
  } else {
    parseConfiguredReadings(in, scan);
  }
}

void parseRawLaser(FieldReader& in, bool old, CarmenLine* line) {
  parseReadings(in, old, &line->scan);
  in.times(line);
  in.end();
}

void parseRobotLaser(FieldReader& in, bool old, bool with_motion, CarmenLine* line) {
  parseReadings(in, old, &line->scan);
  const Pose2 laser = in.pose("the laser pose");
  line->odometry = in.pose("the robot pose");
  if (with_motion) {
    for (const char* what : {"the laser's tv", "the laser's rv", "the forward safety distance",
                             "the side safety distance", "the turn axis"}) {
      in.number(what);
    }
  }
  in.times(line);
  in.end();
  line->scan.laser_in_base = between(*line->odometry, laser);
  line->states_laser_pose = true;
}

void parseWeanScan(FieldReader& in, std::size_t fields, CarmenLine* line) {
  constexpr std::size_t kOthers = 8;  // L, two poses, stamp
  Pose2 robot = in.pose("the odometry");
  Pose2 laser = in.pose("the laser pose");
  in.ranges(fields > kOthers ? fields - kOthers : 0, kCentimeter, &line->scan);
  line->ipc_stamp = line->logger_stamp = in.number("the timestamp");
  in.end();
  if (!in.ok()) return;
  for (Pose2* p : {&robot, &laser}) {
    p->x *= kCentimeter;
    p->y *= kCentimeter;
  }
  line->odometry = robot;
  line->scan.laser_in_base = between(robot, laser);
  line->states_laser_pose = true;
  assumeHalfCircle(&line->scan);
}

bool numbered(std::string_view tag, std::string_view name) {
  return tag.size() == name.size() + 1 && tag.substr(0, name.size()) == name &&
         std::isdigit(static_cast<unsigned char>(tag.back())) != 0;
}

}  // namespace

std::optional<CarmenLine> parseCarmenLine(std::string_view text,
                                          std::vector<std::string_view>* fields,
                                          std::string* reason) {
  using Kind = CarmenLine::Kind;
  CarmenLine line;
  splitFields(text, fields);
  if (fields->empty() || (*fields)[0][0] == '#') return line;
  const std::string_view tag = (*fields)[0];
  FieldReader in(*fields, 1, reason);
  if (tag == "FLASER") {
    line.kind = Kind::kScan;
    parseFrontLaser(in, &line);
  } else if (numbered(tag, "ROBOTLASER")) {
    constexpr std::size_t kPosesAndTimes = 9, kMotion = 5;
    line.kind = Kind::kScan;
    const bool old_short = isOldForm(*fields, kPosesAndTimes);
    const bool old = old_short || isOldForm(*fields, kPosesAndTimes + kMotion);
    parseRobotLaser(in, old, !old_short, &line);
  } else if (numbered(tag, "RAWLASER")) {
    line.kind = Kind::kScan;
    parseRawLaser(in, isOldForm(*fields, 3), &line);
  } else if (tag == "L") {
    line.kind = Kind::kScan;
    parseWeanScan(in, fields->size(), &line);
  } else if (tag == "ODOM") {
    line.kind = Kind::kOdometry;
    line.pose = in.pose("the odometry");
    for (const char* what : {"tv", "rv", "the acceleration"}) in.number(what);
    in.times(&line);
    in.end();
  } else if (tag == "O") {
    line.kind = Kind::kOdometry;
    line.pose = in.pose("the odometry");
    line.pose.x *= kCentimeter;
    line.pose.y *= kCentimeter;
    line.ipc_stamp = line.logger_stamp = in.number("the timestamp");
    in.end();
  } else if (tag == "TRUEPOS") {
    line.kind = Kind::kGroundTruth;
    line.pose = in.pose("the true pose");
    in.pose("the odometry");
    in.times(&line);
    in.end();
  } else if (tag == "PARAM") {
    if (fields->size() < 2) {
      in.fail("names no parameter");
    } else if ((*fields)[1] == "robot_frontlaser_offset") {
      FieldReader value(*fields, 2, reason);
      line.kind = Kind::kLaserOffset;
      line.laser_offset = value.number("the laser offset");
      if (value.ok() && std::abs(line.laser_offset) > 100.0)
        value.fail("a laser offset beyond 100 m");
      if (!value.ok()) return std::nullopt;
    }
  } else if (tag == "NEFF") {
    line.kind = Kind::kCorrected;
  } else {
    for (const char* name : kIgnored) {
      if (tag == name) return line;
    }
    in.fail("unknown message '" + printable(tag) + "'");
  }
  if (!in.ok()) return std::nullopt;
  if (line.kind == Kind::kScan) line.message = std::string(tag);
  return line;
}

}  // namespace hyselam
