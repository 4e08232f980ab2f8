#include "hyselam_common/carmen_log.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "carmen_line.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "stamp_repair.hpp"

namespace hyselam {
namespace {

using IssueKind = CarmenIssue::Kind;

struct Entry {
  std::size_t line = 0;
  CarmenLine content;
  bool after_scan = false;  ///< an ODOM line right after a scan
  double stamp = 0.0;
};

struct ParsedLog {
  std::vector<Entry> entries;  ///< scans, odometry, ground truth in the order of the file
  double laser_offset = 0.0;
  bool corrected = false;
};

ParsedLog parseLines(const std::string& text, std::vector<CarmenIssue>* issues) {
  ParsedLog log;
  std::vector<std::string_view> fields;
  std::string reason;
  bool after_scan = false;
  forEachLine(text, [&](std::size_t number, std::string_view content) {
    auto line = parseCarmenLine(content, &fields, &reason);
    if (!line) {
      issues->push_back({number, IssueKind::kSkipped, reason});
      return;
    }
    switch (line->kind) {
      case CarmenLine::Kind::kNothing:
        return;
      case CarmenLine::Kind::kLaserOffset:
        log.laser_offset = line->laser_offset;
        return;
      case CarmenLine::Kind::kCorrected:
        log.corrected = true;
        return;
      default:
        break;
    }
    const bool is_scan = line->kind == CarmenLine::Kind::kScan;
    log.entries.push_back({number, std::move(*line), after_scan && !is_scan, 0.0});
    after_scan = is_scan;
  });
  return log;
}

std::string chooseMessage(const std::vector<Entry>& entries, const std::string& wanted) {
  const auto has = [&](const std::string& name) {
    return std::any_of(entries.begin(), entries.end(), [&](const Entry& e) {
      return e.content.kind == CarmenLine::Kind::kScan && e.content.message == name;
    });
  };
  if (!wanted.empty()) return has(wanted) ? wanted : "";
  for (const char* name : {"FLASER", "ROBOTLASER1", "L", "RAWLASER1"}) {
    if (has(name)) return name;
  }
  for (const Entry& e : entries) {
    if (e.content.kind == CarmenLine::Kind::kScan) return e.content.message;
  }
  return "";
}

double stampOf(const CarmenLine& line, CarmenClock clock) {
  return clock == CarmenClock::kIpc ? line.ipc_stamp : line.logger_stamp;
}

void useIndexClock(std::vector<Entry>* entries, double period) {
  for (std::size_t i = 0; i < entries->size(); ++i) {
    (*entries)[i].stamp = period * static_cast<double>(i);
  }
}

std::vector<std::size_t> indicesOf(const std::vector<Entry>& entries, CarmenLine::Kind kind) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].content.kind == kind) indices.push_back(i);
  }
  return indices;
}

/// Sets the stamps of all entries; those that find no place in time get NaN.
void setStamps(std::vector<Entry>* entries, const CarmenOptions& options,
               std::vector<CarmenIssue>* issues) {
  if (options.clock == CarmenClock::kIndex) {
    useIndexClock(entries, options.index_period);
    return;
  }
  std::vector<CarmenIssue> retimed;
  for (const auto kind :
       {CarmenLine::Kind::kScan, CarmenLine::Kind::kOdometry, CarmenLine::Kind::kGroundTruth}) {
    const std::vector<std::size_t> indices = indicesOf(*entries, kind);
    std::vector<double> stamps;
    stamps.reserve(indices.size());
    for (const std::size_t i : indices) {
      stamps.push_back(stampOf((*entries)[i].content, options.clock));
    }
    const RepairedStamps repaired = repairStamps(stamps, kind == CarmenLine::Kind::kScan);
    if (2 * repaired.changed.size() > indices.size()) {
      issues->push_back({0, IssueKind::kLog,
                         std::to_string(repaired.changed.size()) + " of " +
                             std::to_string(indices.size()) +
                             " times are out of order: message numbers replace the clock"});
      useIndexClock(entries, options.index_period);
      return;
    }
    for (std::size_t k = 0; k < indices.size(); ++k) {
      (*entries)[indices[k]].stamp = repaired.stamps[k];
    }
    for (const std::size_t k : repaired.changed) {
      const Entry& e = (*entries)[indices[k]];
      const std::string was = "time " + formatNumber(stamps[k]) + " is out of order";
      if (std::isnan(e.stamp)) {
        retimed.push_back({e.line, IssueKind::kSkipped, was + " and there is no room for it"});
      } else {
        retimed.push_back({e.line, IssueKind::kRetimed, was + ", now " + formatNumber(e.stamp)});
      }
    }
  }
  issues->insert(issues->end(), retimed.begin(), retimed.end());
}

/// See readCarmenLog(): where the highest readings pile up they are the sensor's "no return".
double deriveRangeMax(const std::vector<const LaserScan*>& scans) {
  constexpr double kBand = 0.01;
  constexpr std::size_t kRecurring = 3, kPile = 10;
  constexpr double kFar = 20.0;  // [m]
  float highest = 0.0F;
  std::size_t total = 0;
  for (const LaserScan* s : scans) {
    for (const float r : s->ranges) highest = std::max(highest, r);
    total += s->ranges.size();
  }
  if (!(highest > 0.0F)) return 1.0;  // nothing but zeros: any limit will do
  const auto edge = static_cast<float>(highest * (1.0 - kBand));
  const auto below = static_cast<float>(highest * (1.0 - 2.0 * kBand));
  std::size_t in_band = 0, in_next = 0;
  float smallest = highest;
  for (const LaserScan* s : scans) {
    for (const float r : s->ranges) {
      if (r >= edge) {
        ++in_band;
        smallest = std::min(smallest, r);
      } else if (r >= below) {
        ++in_next;
      }
    }
  }
  const bool piled = in_band >= kRecurring && in_band >= kPile * in_next;
  if (piled && (2 * in_band < total || highest >= kFar)) return smallest;
  return std::nextafter(highest, std::numeric_limits<float>::max());
}

void setLimits(const std::vector<Entry>& entries, const CarmenOptions& options, RobotLog* log) {
  // Scans of one message either all state their limit or none does.
  const bool stated = std::all_of(entries.begin(), entries.end(), [](const Entry& e) {
    return e.content.kind != CarmenLine::Kind::kScan || e.content.scan.range_max > 0.0;
  });
  double limit = options.range_max;
  if (limit == 0.0 && !stated) {
    std::vector<const LaserScan*> scans;
    for (const LaserScan& s : log->scans) scans.push_back(&s);
    limit = deriveRangeMax(scans);
  }
  for (LaserScan& scan : log->scans) {
    if (limit > 0.0) scan.range_max = limit;
    scan.range_min = std::min(options.range_min, 0.5 * scan.range_max);
  }
}

/// ODOM lines and the poses that scans carry, by time; at one stamp the scan's pose counts, else
/// the last one given.
std::vector<StampedPose2> mergeOdometry(std::vector<Entry>& entries) {
  struct Sample {
    StampedPose2 pose;
    bool from_scan;
  };
  std::vector<Sample> samples;
  for (const Entry& e : entries) {
    if (std::isnan(e.stamp)) continue;
    if (e.content.kind == CarmenLine::Kind::kOdometry) {
      samples.push_back({{e.stamp, e.content.pose}, false});
    } else if (e.content.kind == CarmenLine::Kind::kScan && e.content.odometry) {
      samples.push_back({{e.stamp, *e.content.odometry}, true});
    }
  }
  std::stable_sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
    if (a.pose.stamp != b.pose.stamp) return a.pose.stamp < b.pose.stamp;
    return a.from_scan < b.from_scan;
  });
  std::vector<StampedPose2> odometry;
  for (const Sample& s : samples) {
    if (!odometry.empty() && odometry.back().stamp == s.pose.stamp) {
      odometry.back() = s.pose;
    } else {
      odometry.push_back(s.pose);
    }
  }
  return odometry;
}

void checkOptions(const CarmenOptions& options) {
  if (!(options.range_max >= 0.0) || !std::isfinite(options.range_max)) {
    throw ParameterError("range_max", options.range_max, ">= 0");
  }
  if (!(options.range_min > 0.0) || !std::isfinite(options.range_min)) {
    throw ParameterError("range_min", options.range_min, "> 0");
  }
  if (!(options.index_period > 0.0 && options.index_period <= 3600.0)) {
    throw ParameterError("index_period", options.index_period, "in (0, 3600]");
  }
}

}  // namespace

std::string toString(const CarmenIssue& issue) {
  switch (issue.kind) {
    case IssueKind::kSkipped:
      return "line " + std::to_string(issue.line) + ": skipped: " + issue.reason;
    case IssueKind::kRetimed:
      return "line " + std::to_string(issue.line) + ": " + issue.reason;
    case IssueKind::kLog:
      break;
  }
  return issue.reason;
}

RobotLog parseCarmenLog(const std::string& text, const std::string& source,
                        const CarmenOptions& options, std::vector<CarmenIssue>* issues) {
  checkOptions(options);
  std::vector<CarmenIssue> found;
  ParsedLog parsed = parseLines(text, &found);
  const std::string message = chooseMessage(parsed.entries, options.scan_message);

  std::vector<Entry> entries;
  for (Entry& e : parsed.entries) {
    const bool is_scan = e.content.kind == CarmenLine::Kind::kScan;
    const bool artefact =
        parsed.corrected && e.after_scan && e.content.kind == CarmenLine::Kind::kOdometry;
    if ((is_scan && e.content.message != message) || artefact) continue;
    entries.push_back(std::move(e));
  }
  setStamps(&entries, options, &found);

  RobotLog log;
  log.odometry = mergeOdometry(entries);
  std::optional<Pose2> laser;
  for (Entry& e : entries) {
    if (std::isnan(e.stamp)) continue;
    if (e.content.kind == CarmenLine::Kind::kGroundTruth) {
      log.ground_truth.push_back({e.stamp, e.content.pose});
    } else if (e.content.kind == CarmenLine::Kind::kScan) {
      if (!laser) {
        laser = e.content.states_laser_pose ? e.content.scan.laser_in_base
                                            : Pose2{parsed.laser_offset, 0.0, 0.0};
      }
      log.scans.push_back(e.content.scan);
      log.scans.back().stamp = e.stamp;
      log.scans.back().laser_in_base = *laser;
    }
  }
  if (log.scans.empty()) {
    const std::string first = found.empty() ? "" : " (" + toString(found.front()) + ")";
    throw InputError(
        source, "",
        (options.scan_message.empty() ? std::string("holds no usable scan")
                                      : "holds no usable scan '" + options.scan_message + "'") +
            first);
  }
  setLimits(entries, options, &log);
  std::stable_sort(found.begin(), found.end(),
                   [](const CarmenIssue& a, const CarmenIssue& b) { return a.line < b.line; });
  if (issues != nullptr) *issues = std::move(found);
  return log;
}

RobotLog readCarmenLog(const std::string& path, const CarmenOptions& options,
                       std::vector<CarmenIssue>* issues) {
  return parseCarmenLog(readTextFile(path), path, options, issues);
}

}  // namespace hyselam
