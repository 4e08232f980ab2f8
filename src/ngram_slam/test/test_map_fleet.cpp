// map_fleet on a cluster of two workers: killed, and run again.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "hyselam_common/map_io.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "looped_corridors.hpp"

using hyselam::testing::fileBytes;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

namespace {

bool hasDask() {
  return std::system("/usr/bin/python3 -c 'import distributed' 2>/dev/null") == 0 &&
         std::filesystem::exists("/usr/bin/dask-scheduler");
}

/// A program that runs beside the test and is ended with it.
class Process {
 public:
  explicit Process(std::vector<std::string> command, const std::string& output) {
    pid_ = ::fork();
    if (pid_ != 0) return;
    const int out = ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    ::dup2(out, 1);
    ::dup2(out, 2);
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() { kill(); }
  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
  /// Exit status, waited for.
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t pid_ = -1;
};

struct MapFleet : testing::Test {
  void SetUp() override {
    if (!hasDask()) GTEST_SKIP() << "python3-distributed is not installed";
    const auto building = ngram_slam::loopedCorridors(4, 2, 8);
    std::filesystem::create_directory(d / "bags");
    std::filesystem::create_directory(d / "bags/second");
    for (const std::uint64_t seed : {4, 5, 6}) {
      const std::string name = seed == 6 ? "second/day" : "robot" + std::to_string(seed);
      hyselam::writeBag(
          d / ("bags/" + name + ".bag"),
          hyselam_sim::simulate(building.plan, building.route, seed, ngram_slam::atScanRate(4.0))
              .log);
    }
    const std::string whole = fileBytes(d / "bags/robot4.bag");
    writeFile(d / "bags/broken.bag", whole.substr(0, whole.size() / 3));
    writeFile(d / "bags/copy.bag", whole);
    writeFile(d / "bags/empty.log", "");
    writeFile(d / "bags/notes.txt", "no recording");
  }
  std::vector<std::string> command(std::vector<std::string> more) const {
    std::vector<std::string> words{std::string(HYSELAM_TOOLS) + "/map_fleet", d / "bags", "--out",
                                   d / "out"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// When each recording was done, by its folder.
  std::map<std::string, std::filesystem::file_time_type> done() const {
    std::map<std::string, std::filesystem::file_time_type> times;
    const std::string folder = d / "out/recordings";
    if (!std::filesystem::exists(folder)) return times;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const auto marker = entry.path() / "done.json";
      std::error_code error;
      const auto time = std::filesystem::last_write_time(marker, error);
      if (entry.path().filename().string()[0] != '.' && !error) {
        times[entry.path().filename().string()] = time;
      }
    }
    return times;
  }
  template <typename Condition>
  static bool waitFor(const Condition& condition) {
    for (int i = 0; i < 6000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }
  nlohmann::json json(const std::string& name) const {
    return nlohmann::json::parse(fileBytes(d / name));
  }

  TemporaryDirectory d;
};

TEST_F(MapFleet, goesOnAfterAKillOnACluster) {
  {
    Process killed(command({"--workers", "2"}), d / "killed.txt");
    ASSERT_TRUE(waitFor([&] { return !done().empty(); })) << fileBytes(d / "killed.txt");
    killed.kill();
  }
  const auto before = done();
  ASSERT_FALSE(std::filesystem::exists(d / "out/report.json"));

  Process scheduler({"/usr/bin/dask-scheduler", "--host", "127.0.0.1", "--port", "0",
                     "--no-dashboard", "--scheduler-file", d / "cluster.json"},
                    d / "scheduler.txt");
  ASSERT_TRUE(waitFor([&] { return nlohmann::json::accept(fileBytes(d / "cluster.json")); }))
      << fileBytes(d / "scheduler.txt");
  const std::string address = json("cluster.json")["address"];
  std::vector<std::unique_ptr<Process>> workers;
  for (const char* name : {"worker1", "worker2"}) {
    workers.push_back(std::make_unique<Process>(
        std::vector<std::string>{"/usr/bin/dask-worker", address, "--nthreads", "1", "--no-nanny",
                                 "--no-dashboard", "--memory-limit", "0", "--local-directory",
                                 d / name},
        d / (std::string(name) + ".txt")));
  }
  Process again(command({"--scheduler", address, "--json", d / "fleet.json"}), d / "again.txt");
  ASSERT_EQ(again.wait(), 0) << fileBytes(d / "again.txt") << fileBytes(d / "worker1.txt");
  const auto after = done();
  for (const auto& [folder, time] : before) EXPECT_EQ(after.at(folder), time) << folder;
  const auto report = json("fleet.json");
  EXPECT_EQ(report, json("out/report.json"));
  std::size_t known = 0;
  std::map<std::string, std::string> left_out;
  for (const auto& r : report["recordings"]) {
    known += r["reused"].get<bool>() ? 1 : 0;
    if (!r["left_out"].is_null()) left_out[r["name"]] = r["left_out"];
  }
  EXPECT_EQ(known, before.size());
  EXPECT_EQ(left_out.size(), 3U);
  EXPECT_NE(left_out["broken"].find("broken.bag"), std::string::npos) << left_out["broken"];
  EXPECT_NE(left_out["empty"].find("empty.log"), std::string::npos) << left_out["empty"];
  EXPECT_EQ(left_out["robot4"], "is the same recording as copy");
  ASSERT_EQ(report["maps"].size(), 1U);
  EXPECT_EQ(report["maps"][0]["recordings"],
            (std::vector<std::string>{"copy", "robot5", "second_day"}));
  EXPECT_EQ(hyselam::readTum(d / "out/trajectories/copy.tum").size(),
            hyselam::readBag(d / "bags/copy.bag").scans.size());
  EXPECT_GT(hyselam::loadMap(d / "out/map.yaml").geometry.width, 50);
  const std::string page = fileBytes(d / "out/report.html");
  EXPECT_NE(page.find("6 recordings, 1 map"), std::string::npos);
  EXPECT_NE(page.find("data:image/png;base64,"), std::string::npos);

  // Everything is known, also under another name.
  const std::string map = fileBytes(d / "out/map.state");
  std::filesystem::rename(d / "bags/robot5.bag", d / "bags/robot5b.bag");
  Process known_all(command({"--scheduler", address}), d / "known.txt");
  ASSERT_EQ(known_all.wait(), 0) << fileBytes(d / "known.txt");
  EXPECT_EQ(done(), after);
  EXPECT_TRUE(fileBytes(d / "out/map.state") == map);
  EXPECT_NE(fileBytes(d / "known.txt").find("robot5b: known"), std::string::npos);
}

/// What a program in Python says that knows the parts of map_fleet.
std::string saidBy(const std::string& program, const TemporaryDirectory& d) {
  writeFile(
      d / "ask.py",
      "import importlib.machinery, importlib.util, pathlib, sys\n"
      "sys.dont_write_bytecode = True\n"
      "loader = importlib.machinery.SourceFileLoader('fleet', sys.argv[1])\n"
      "fleet = importlib.util.module_from_spec(importlib.util.spec_from_loader('fleet', loader))\n"
      "loader.exec_module(fleet)\n" +
          program);
  EXPECT_EQ(std::system(("/usr/bin/python3 " + d / "ask.py" + " " + HYSELAM_PACKAGE_DIR +
                         "/scripts/map_fleet > " + d / "said.txt")
                            .c_str()),
            0);
  return fileBytes(d / "said.txt");
}

TEST(MapFleetParts, cutsASessionThatLiesInTwoMapsIntoItsRecordings) {
  const TemporaryDirectory d;
  EXPECT_EQ(
      saidBy(
          "parts = [['a', 5], ['b', 5], ['c', 5]]\n"
          "print(fleet.pieces_of(parts, [[0, 15]]), fleet.pieces_of(parts, [[3, 4], [12, 1]]))\n",
          d),
      "[['a', 5], ['b', 5], ['c', 5]] [['a', 2], ['b', 2], ['c', 1]]\n");
}

TEST(MapFleetParts, anotherProgramMakesItAnew) {
  const TemporaryDirectory d;
  EXPECT_EQ(saidBy("tool = pathlib.Path(sys.argv[0]).parent / 'prefix/lib/p/tool'\n"
                   "tool.parent.mkdir(parents=True)\n"
                   "tool.write_text('one'); one = fleet.fingerprint_of(str(tool))\n"
                   "again = fleet.fingerprint_of(str(tool))\n"
                   "tool.write_text('two'); two = fleet.fingerprint_of(str(tool))\n"
                   "print(one == again, one == two)\n",
                   d),
            "True False\n");
}

TEST_F(MapFleet, refusesWhatCannotBeUsed) {
  const auto expectRefused = [&](std::vector<std::string> words, const std::string& part) {
    words.insert(words.begin(), std::string(HYSELAM_TOOLS) + "/map_fleet");
    Process p(words, d / "refused.txt");
    EXPECT_EQ(p.wait(), 2) << fileBytes(d / "refused.txt");
    EXPECT_NE(fileBytes(d / "refused.txt").find(part), std::string::npos)
        << fileBytes(d / "refused.txt");
  };
  std::filesystem::create_directory(d / "nothing");
  expectRefused({d / "nothing", "--out", d / "x"}, "holds no recordings");
  expectRefused({d / "none", "--out", d / "x"}, "is no folder");
  expectRefused({d / "bags", "--out", d / "x", "--workers", "0"}, "--workers");
  expectRefused({d / "bags", "--out", d / "x", "--scheduler", "nonsense://here"}, "nonsense");
}

}  // namespace
