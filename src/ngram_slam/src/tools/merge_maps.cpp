// merge_maps: saved maps of several sessions or robots become one, as far as they recognize each
// other's places.
#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/progress.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "merge_advice.hpp"
#include "ngram_slam/slam/map_merging.hpp"
#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "report_page.hpp"
#include "slam_report.hpp"
#include "tool_parts.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header
using nlohmann::json;

struct Options {
  std::vector<std::string> states;
  std::string out, model;
  double resolution = 0.05, place_interval = 0.0;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool keep_all = false;
};

/// Short names for the sessions of files, each another one: what tells them apart.
std::vector<std::string> labelsOf(const std::vector<std::string>& files) {
  std::vector<std::string> labels;
  std::map<std::string, int> stems, folders;
  const auto stemOf = [](const std::string& f) { return std::filesystem::path(f).stem().string(); };
  const auto folderOf = [](const std::string& f) {
    return std::filesystem::path(f).parent_path().filename().string();
  };
  for (const std::string& f : files) {
    ++stems[stemOf(f)];
    ++folders[folderOf(f)];
  }
  std::set<std::string> taken;
  for (const std::string& f : files) {
    const std::string stem = stemOf(f), folder = folderOf(f);
    const std::string label = stems[stem] == 1 || folder.empty() ? stem
                              : folders[folder] == 1             ? folder
                                                                 : folder + "_" + stem;
    std::string one = label;
    for (int i = 2; !taken.insert(one).second; ++i) one = label + "_" + std::to_string(i);
    labels.push_back(one);
  }
  return labels;
}

/// As NgramSlam shows it: what was seen last, and what was settled of keyframes that are dropped.
hyselam::OccupancyGrid gridOf(const SlamState& state, double resolution) {
  PresentMap map = emptyMap(resolution);
  const std::uint32_t runs = state.keyframes.empty() ? 0 : state.keyframes.back().run + 1;
  map.update({state.keyframes, state.settled, std::vector<bool>(runs, true), runs, 0});
  return map.grid();
}

struct Loaded {
  std::vector<MapSession> sessions;  // by file
  std::vector<std::string> files;    // of the sessions
  std::vector<LeftOutSession> broken;
};

Loaded load(const Options& o, const MapMergingParams& params) {
  Loaded loaded;
  hyselam::Progress progress("loading maps", o.states.size());
  for (std::size_t i = 0; i < o.states.size(); ++i) {
    progress.update(i + 1);
    try {
      loaded.sessions.push_back(
          {o.states[i], SlamStateFile::load(o.states[i], params.slam.surface)});
      loaded.files.push_back(o.states[i]);
    } catch (const hyselam::InputError& e) {
      loaded.broken.push_back({o.states[i], e.what()});
    }
  }
  return loaded;
}

/// Of a map, counted from 0: the largest one has no number.
std::string nameOfMap(std::size_t i) {
  return i == 0 ? "map" : "map_" + std::to_string(i + 1);
}

/// Numbers that follow each other as [first, count].
json rangesOf(const std::vector<std::size_t>& numbers) {
  json ranges = json::array();
  for (const std::size_t n : numbers) {
    if (!ranges.empty()) {
      json& last = ranges.back();
      if (last[0].get<std::size_t>() + last[1].get<std::size_t>() == n) {
        last[1] = last[1].get<std::size_t>() + 1;
        continue;
      }
    }
    ranges.push_back({n, 1});
  }
  return ranges;
}

/// Takes away the maps and trajectories of a merging into the same folder before this one.
void removeFormer(const std::string& out, const json& report) {
  const auto filesOf = [](const json& all) {
    std::set<std::string> files;
    for (const json& map : all.at("maps")) {
      const auto name = map.at("name").get<std::string>();
      for (const char* ending : {".state", ".yaml", ".pgm"}) files.insert(name + ending);
      for (const json& s : map.at("sessions")) files.insert(s.at("trajectory").get<std::string>());
    }
    return files;
  };
  std::set<std::string> former;
  try {
    former = filesOf(json::parse(hyselam::readTextFile(out + "/report.json")));
  } catch (const std::exception&) {
    return;  // there was none
  }
  const std::set<std::string> now = filesOf(report);
  for (const std::string& file : former) {
    const std::filesystem::path path = file;
    if (now.count(file) > 0 || path.has_parent_path()) continue;
    std::error_code error;
    std::filesystem::remove(out / path, error);
  }
}

json writeMap(const Options& o, const MergedMap& map, std::size_t number,
              const std::vector<std::string>& labels, const std::vector<std::string>& files) {
  const std::string name = nameOfMap(number);
  SlamStateFile::save(o.out + "/" + name + ".state", map.state);
  hyselam::saveMap(o.out + "/" + name + ".yaml", gridOf(map.state, o.resolution));
  json sessions = json::array();
  for (const MergedPart& part : map.parts) {
    std::string trajectory = "trajectory_" + labels[part.session];
    // A session whose runs lie in several maps.
    if (number > 0) trajectory += "_" + name;
    trajectory += ".tum";
    hyselam::writeTum(o.out + "/" + trajectory, part.trajectory);
    double path = 0.0;
    for (std::size_t i = 1; i < part.trajectory.size(); ++i) {
      path += distance(part.trajectory[i - 1].pose, part.trajectory[i].pose);
    }
    sessions.push_back({{"name", labels[part.session]},
                        {"file", files[part.session]},
                        {"runs", part.runs.size()},
                        {"scans", part.trajectory.size()},
                        {"scan_ranges", rangesOf(part.scans)},
                        {"path_m", rounded(path)},
                        {"trajectory", trajectory}});
  }
  return {{"name", name},
          {"state", name + ".state"},
          {"map", name + ".yaml"},
          {"keyframes", map.state.keyframes.size()},
          {"loops", map.state.loops.size()},
          {"bytes", std::filesystem::file_size(o.out + "/" + name + ".state")},
          {"sessions", sessions}};
}

json namesAndReasons(const std::vector<LeftOutSession>& sessions) {
  json out = json::array();
  for (const LeftOutSession& s : sessions) out.push_back({{"file", s.name}, {"reason", s.reason}});
  return out;
}

json toJson(const MapMergingCounters& c) {
  return {{"places_asked_for", c.questions},        {"loops_tried", c.tried},
          {"loops_verified", c.verified},           {"near_loops_tried", c.near_tried},
          {"near_loops_verified", c.near_verified}, {"ties", c.ties},
          {"ties_withdrawn", c.ties_withdrawn},     {"stretches_laid_on_maps", c.stretches},
          {"ties_by_places", c.place_ties}};
}

/// For people: which maps there are now, and who met whom.
void print(const json& report, const std::string& advice) {
  for (const json& map : report["maps"]) {
    std::cout << map["name"].get<std::string>() << ": " << map["keyframes"] << " keyframes of";
    for (const json& s : map["sessions"]) std::cout << " " << s["name"].get<std::string>();
    std::cout << "\n";
  }
  if (!report["meetings"].empty()) {
    std::cout << "\n| session | met | far loops | near loops | not believed | fit |\n"
                 "|---|---|---|---|---|---|\n";
  }
  for (const json& m : report["meetings"]) {
    std::cout << "| " << m["a"].get<std::string>() << " | " << m["b"].get<std::string>() << " | "
              << m["far_loops"] << " | " << m["near_loops"] << " | " << m["doubted"] << " | "
              << std::fixed << std::setprecision(2) << m["fit"].get<double>() << " |\n";
  }
  if (report["maps"].size() > 1) {
    std::cout << "\n"
              << report["maps"].size() << " maps that do not know where they lie to each other.\n"
              << advice;
  }
}

json run(const Options& o) {
  MapMergingParams params;
  params.threads = o.threads;
  params.place_interval = o.place_interval;
  params.slam.signatures.model = o.model;
  params.slam.consolidation.enabled = !o.keep_all;
  params.validate();
  emptyMap(o.resolution);  // refused before the work, not after it
  Loaded loaded = load(o, params);
  hyselam::makeFolder(o.out);

  const double begin = cpuSeconds();
  std::unique_ptr<hyselam::Progress> progress;
  std::string shown;
  const auto tell = [&](const std::string& step, std::size_t done, std::size_t total) {
    if (step != shown) progress = std::make_unique<hyselam::Progress>(step, total);
    shown = step;
    progress->update(done);
  };
  const MergedMaps merged = mergeMaps(std::move(loaded.sessions), params, tell);
  progress.reset();
  std::vector<LeftOutSession> left_out = loaded.broken;
  left_out.insert(left_out.end(), merged.left_out.begin(), merged.left_out.end());
  for (const LeftOutSession& s : left_out) {
    std::cerr << "warning: " << s.name << ": left out: " << s.reason << "\n";
  }
  for (const LeftOutSession& s : merged.doubtful) {
    std::cerr << "warning: " << s.name << ": " << s.reason << "\n";
  }
  if (merged.maps.empty()) {
    throw hyselam::InputError(
        "merge_maps", "", "none of the " + std::to_string(o.states.size()) + " maps can be used");
  }
  const std::vector<std::string> labels = labelsOf(loaded.files);
  json report = {{"left_out", namesAndReasons(left_out)},
                 {"doubtful", namesAndReasons(merged.doubtful)},
                 {"meetings", json::array()},
                 {"maps", json::array()},
                 {"counters", toJson(merged.counters)}};
  for (const MapMeeting& m : merged.meetings) {
    report["meetings"].push_back({{"a", labels[m.a]},
                                  {"b", labels[m.b]},
                                  {"far_loops", m.far_loops},
                                  {"near_loops", m.near_loops},
                                  {"doubted", m.doubted},
                                  {"fit", rounded(m.fit)}});
  }
  for (std::size_t i = 0; i < merged.maps.size(); ++i) {
    report["maps"].push_back(writeMap(o, merged.maps[i], i, labels, loaded.files));
  }
  removeFormer(o.out, report);
  hyselam::writeFileAtomically(o.out + "/report.json",
                               [&](std::ostream& out) { out << report.dump(2) << "\n"; });
  makePage("merge_report", o.out);
  print(report, adviceOn(merged, labels, o.place_interval));
  report["cpu_seconds"] = cpuSeconds() - begin;
  return report;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Saved maps (of slam_offline, NgramSlam or this program) of several sessions or robots "
      "become one map, as far as they recognize each other's places. Nothing needs to be known of "
      "where they lie to each other. What does not connect stays apart: map, map_2, ... by size.",
      "merge_maps");
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("states", o.states, "states of SLAM")->required();
  app.add_option("--out", o.out,
                 "folder for map.state, map.yaml, map.pgm, the trajectory of each session, "
                 "report.json and report.html")
      ->required();
  app.add_option("--resolution", o.resolution, "of the maps [m]");
  app.add_option("--threads", o.threads, "that verify loops; the result does not depend on it");
  app.add_option("--model", o.model, "another model of signatures; without it the shipped one");
  app.add_option("--place-interval", o.place_interval,
                 "[m] lay what loops leave apart on the other maps as they are drawn, a stretch "
                 "each so many metres (2 is a good one): more is tied, but buildings that repeat "
                 "themselves may be tied wrongly; 0: do not")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--keep-all", o.keep_all, "keep all keyframes, whether they add to the map or not");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
