// carmen_to_bag IN.log[.gz] OUT.bag: a CARMEN log as /scan, /odom, /tf with the log's times.
#include <algorithm>
#include <iostream>
#include <map>

#include "hyselam_common/report_issues.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/tool.hpp"

int main(int argc, char** argv) {
  using hyselam::CarmenClock;
  CLI::App app(
      "Converts a CARMEN log (or a Wean Hall log), plain or gzip, to a ROS bag.\n"
      "Lines that cannot be used are reported and skipped.",
      "carmen_to_bag");
  std::string in, out;
  hyselam::CarmenOptions carmen;
  hyselam::BagOptions bag;
  const std::map<std::string, CarmenClock> clocks{
      {"logger", CarmenClock::kLogger}, {"ipc", CarmenClock::kIpc}, {"index", CarmenClock::kIndex}};
  app.option_defaults()->always_capture_default();
  app.add_option("IN", in, "log to read")->required();
  app.add_option("OUT", out, "bag to write")->required();
  app.add_option("--laser-frame", bag.laser_frame, "frame of the scans");
  app.add_option("--odom-frame", bag.odom_frame, "frame of the odometry");
  app.add_option("--base-frame", bag.base_frame, "frame of the robot");
  app.add_option(
      "--scan-message", carmen.scan_message,
      "message with the scans (FLASER, ROBOTLASER1, RAWLASER1, L, ...); default: the first "
      "of these that the log has");
  app.add_option("--range-max", carmen.range_max,
                 "at or above it a reading means no return [m]; 0: from the log");
  std::string clock = "logger";
  app.add_option("--clock", clock, "times: logger, ipc, or index (message number * period)")
      ->check(CLI::IsMember({"logger", "ipc", "index"}));
  app.add_option("--index-period", carmen.index_period, "period of --clock index [s]");

  return hyselam::runTool(argc, argv, app, [&] {
    carmen.clock = clocks.at(clock);
    std::vector<hyselam::CarmenIssue> issues;
    const hyselam::RobotLog log = hyselam::readCarmenLog(in, carmen, &issues);
    const nlohmann::json list = hyselam::reportIssues(in, issues);
    hyselam::writeBag(out, log, bag);

    const auto skipped = std::count_if(issues.begin(), issues.end(), [](const auto& i) {
      return i.kind == hyselam::CarmenIssue::Kind::kSkipped;
    });
    const auto retimed = std::count_if(issues.begin(), issues.end(), [](const auto& i) {
      return i.kind == hyselam::CarmenIssue::Kind::kRetimed;
    });
    const auto span = hyselam::timeSpan(log);
    const double duration = span->end - span->begin;
    std::cout << in << ": " << log.scans.size() << " scans of " << log.scans.front().ranges.size()
              << " beams, " << log.odometry.size() << " odometry samples, " << duration << " s, "
              << skipped << " lines skipped -> " << out << '\n';
    return nlohmann::json{{"scans", log.scans.size()},
                          {"beams", log.scans.front().ranges.size()},
                          {"odometry", log.odometry.size()},
                          {"ground_truth", log.ground_truth.size()},
                          {"duration", duration},
                          {"range_max", log.scans.front().range_max},
                          {"skipped", skipped},
                          {"retimed", retimed},
                          {"issues", list}};
  });
}
