// slam_offline as a shell sees it, in a small made-up building.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "hyselam_common/map_io.hpp"
#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/trajectory_io.hpp"
#include "loop_table.hpp"
#include "looped_corridors.hpp"
#include "reference_poses.hpp"
#include "tool_test.hpp"

using hyselam::testing::fileBytes;
using hyselam::testing::writeFile;

namespace {

struct SlamOffline : ToolTest {
  static void SetUpTestSuite() {
    ToolTest::SetUpTestSuite();
    const auto building = ngram_slam::loopedCorridors(4, 2, 10);
    auto log =
        hyselam_sim::simulate(building.plan, building.route, 4, ngram_slam::atScanRate(4.0)).log;
    scans = log.scans.size();
    hyselam::writeBag(*directory / "run.bag", log);
    log.odometry.erase(log.odometry.begin() + 1, log.odometry.end());
    log.odometry[0].stamp = 1e6;
    hyselam::writeBag(*directory / "late.bag", log);
  }
  int run(const std::string& arguments) { return ToolTest::run("slam_offline " + arguments); }
  void expectRefused(const std::string& arguments, const std::string& part) {
    ToolTest::expectRefused("slam_offline " + arguments, part);
  }
  /// The recording as a CARMEN log.
  static std::string carmenLog() {
    const hyselam::RobotLog log = hyselam::readBag(*directory / "run.bag");
    std::ostringstream out;
    for (const hyselam::LaserScan& scan : log.scans) {
      const auto odometry = hyselam::poseAt(log.odometry, scan.stamp, 1.0);
      const std::string pose = std::to_string(odometry->x) + " " + std::to_string(odometry->y) +
                               " " + std::to_string(odometry->theta);
      const std::string stamp = std::to_string(scan.stamp);
      out << "FLASER " << scan.ranges.size();
      for (const float range : scan.ranges)
        out << ' ' << (range > 0.0F && range < scan.range_max ? range : 81.83F);
      out << ' ' << pose << ' ' << pose << ' ' << stamp << " robot " << stamp << '\n';
    }
    return out.str();
  }
  static std::size_t lines(const std::string& path) {
    const std::string text = fileBytes(path);
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }

  static std::size_t scans;
};

std::size_t SlamOffline::scans = 0;

TEST_F(SlamOffline, writesTheFilesOfTheContract) {
  const std::string out = d / "a";
  ASSERT_EQ(
      run("--bag " + d / "run.bag" + " --out " + out + " --side-by-side --json " + d / "a.json"), 0)
      << errors;
  EXPECT_EQ(errors, "");
  EXPECT_EQ(hyselam::readTum(out + "/trajectory.tum").size(), scans);
  EXPECT_GE(hyselam::readTum(out + "/odometry.tum").size(), scans);
  EXPECT_GT(hyselam::loadMap(out + "/map.yaml").geometry.width, 50);
  EXPECT_EQ(fileBytes(out + "/matches.csv")
                .rfind("stamp_a,stamp_b,level,n,direction,x,y,theta,verified", 0),
            0u);
  EXPECT_EQ(fileBytes(out + "/regions.csv").rfind("first,last,stamp_begin,stamp_end,class", 0), 0u);
  EXPECT_GT(lines(out + "/words.csv"), 5U);
  EXPECT_EQ(fileBytes(out + "/words.csv").rfind("word,level,first,last,run,stamp_begin", 0), 0u);
  EXPECT_NE(fileBytes(out + "/graph.g2o").find("EDGE_SE2"), std::string::npos);
  const std::string report = fileBytes(out + "/report.html");
  EXPECT_NE(report.find("data:image/png;base64,"), std::string::npos);
  EXPECT_NE(report.find("loops: thesis"), std::string::npos);
  EXPECT_NE(report.find("side_by_side_none"), std::string::npos);
  EXPECT_NE(report.find("<title>word 0: class"), std::string::npos);
  EXPECT_GT(hyselam::loadMap(out + "/map_thesis.yaml").geometry.width, 50);
  const auto page = nlohmann::json::parse(fileBytes(out + "/report.json"));
  EXPECT_EQ(page["figures"].size(), 3U);
  EXPECT_EQ(page["figures"][0]["trajectory"].size(), scans);
  EXPECT_NE(report.find("<h1>run.bag</h1>"), std::string::npos);
  const auto summary = nlohmann::json::parse(fileBytes(out + "/summary.json"));
  EXPECT_EQ(summary, nlohmann::json::parse(fileBytes(d / "a.json")));
  EXPECT_EQ(summary["scans"], scans);
  EXPECT_LT(summary["errors"]["rms_m"], 0.15);
  EXPECT_EQ(summary["errors"]["false_loops_near"], 0);
  EXPECT_EQ(summary["errors"]["false_loops_far"], 0);
  EXPECT_TRUE(summary.contains("side_by_side_none"));
}

ngram_slam::SlamLoop loopOf(ngram_slam::LoopSource source, bool far, double inliers,
                            double weight) {
  ngram_slam::SlamLoop loop;
  loop.source = source;
  loop.far = far;
  loop.inlier_ratio = inliers;
  loop.weight = weight;
  return loop;
}

TEST(LoopCounts, AddUp) {
  using ngram_slam::LoopSource;
  std::vector<ngram_slam::SlamLoop> loops;
  EXPECT_EQ(sentenceOf(ngram_slam::LoopCounts(loops, 0)), "no place seen again");
  loops = {loopOf(LoopSource::kProximity, false, 0.9, 1.0),
           loopOf(LoopSource::kProximity, false, 0.9, 0.1),
           loopOf(LoopSource::kNgram, false, 0.9, 1.0)};
  EXPECT_EQ(sentenceOf(ngram_slam::LoopCounts(loops, 0)),
            "3 places seen again: 3 nearby, 0 after a longer way; 1 of them not believed");
  for (const LoopSource source :
       {LoopSource::kProximity, LoopSource::kSignature, LoopSource::kSignature, LoopSource::kNgram,
        LoopSource::kNgram, LoopSource::kNgram}) {
    loops.push_back(loopOf(source, true, 0.8, 1.0));
  }
  loops.push_back(loopOf(LoopSource::kNgram, false, 0.0, 0.2));
  loops.push_back(loopOf(LoopSource::kProximity, false, 0.0, 1.0));
  const ngram_slam::LoopCounts counts(loops, 0);
  EXPECT_EQ(counts.total, counts.near + counts.far + counts.unverified + counts.supposed);
  EXPECT_EQ(counts.near_by_words, 1U);
  EXPECT_EQ(sentenceOf(counts),
            "11 places seen again: 3 nearby, 6 after a longer way (3 found by words, 2 by "
            "signatures, 1 by their outline), 1 by words that no scan verified, 1 where it was "
            "told to start; 2 of them not believed");
  // All of a saved map of one more keyframe: what is near, or composed, or a start, is not told.
  const ngram_slam::LoopCounts saved(loops, 1);
  EXPECT_EQ(saved.saved, 3U);  // by proximity and not far
  EXPECT_EQ(saved.near, 1U);   // by words
  EXPECT_EQ(saved.far, 6U);
  EXPECT_EQ(saved.unverified, 1U);
  EXPECT_EQ(saved.supposed, 0U);
}

/// Rows of a table by the names of their columns.
std::vector<std::map<std::string, std::string>> rowsOf(const std::string& path) {
  std::istringstream in(fileBytes(path));
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);
    std::map<std::string, std::string> row;
    std::size_t i = 0;
    for (std::string field; std::getline(fields, field, ','); ++i) {
      if (rows.empty() && row.empty() && names.size() == i && line.rfind("stamp_a", 0) == 0) {
        names.push_back(field);
      } else {
        row[names.at(i)] = field;
      }
    }
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

TEST_F(SlamOffline, tellsWhichPlacesItHasRecognized) {
  const std::string out = d / "loops";
  // With errors, the robot does not know that it is close by when it comes again.
  ASSERT_EQ(run("--bag " + d / "run.bag" + " --odometry-noise 15 --out " + out), 0) << errors;
  const auto summary = nlohmann::json::parse(fileBytes(out + "/summary.json"));
  const auto& counts = summary["loops_by_kind"];
  const auto rows = rowsOf(out + "/loops.csv");
  ASSERT_GT(rows.size(), 0U);
  EXPECT_EQ(rows.size(), summary["loops"]);
  std::map<std::string, std::size_t> kinds, found_by;
  std::size_t believed = 0;
  for (auto row : rows) {
    ++kinds[row["kind"]];
    ++found_by[row["kind"] + " " + row["found_by"]];
    believed += row["believed"] == "1" ? 1 : 0;
    EXPECT_EQ(row["believed"] == "1", std::stod(row["weight"]) >= ngram_slam::kMinLoopWeight);
    EXPECT_GT(std::stod(row["stamp_a"]), std::stod(row["stamp_b"]));
    EXPECT_GT(std::stoi(row["keyframe_a"]), std::stoi(row["keyframe_b"]));
    EXPECT_GT(std::stod(row["path_a"]), std::stod(row["path_b"]));
    EXPECT_GT(std::stod(row["inliers"]), 0.0);
    const double probability = std::stod(row["probability"]);
    if (row["kind"] == "far") {
      EXPECT_GT(probability, 0.0);
      EXPECT_LE(probability, 1.0);
    } else {
      EXPECT_EQ(probability, -1.0);
    }
  }
  EXPECT_GT(kinds["near"], 0U);
  EXPECT_GT(kinds["far"], 0U);
  EXPECT_EQ(kinds["near"] + kinds["far"], rows.size());
  EXPECT_EQ(kinds["near"], counts["near"]);
  EXPECT_EQ(kinds["far"], counts["far"]);
  EXPECT_EQ(found_by["far words"], counts["far_by_words"]);
  EXPECT_EQ(found_by["far signatures"], counts["far_by_signatures"]);
  EXPECT_EQ(found_by["far outline"], counts["far_by_outline"]);
  EXPECT_EQ(rows.size() - believed, counts["not_believed"]);
  const std::string sentence = summary["places_seen_again"];
  EXPECT_EQ(sentence.rfind(std::to_string(rows.size()) + " places seen again: ", 0), 0U);
  const std::string report = fileBytes(out + "/report.html");
  EXPECT_NE(report.find(sentence + "</figcaption>"), std::string::npos);
  // What the figure draws is what the table tells.
  std::map<std::string, std::size_t> told, drawn;
  for (auto row : rows) ++told[row["believed"] == "1" ? row["found_by"] : "not_believed"];
  const auto page = nlohmann::json::parse(fileBytes(out + "/report.json"));
  for (const auto& [kind, loops] : page["figures"][0]["loops"].items()) {
    if (!loops.empty()) drawn[kind] = loops.size();
  }
  EXPECT_EQ(drawn, told);
}

TEST_F(SlamOffline, tellsStartsAndLoopsOfTheSavedMapApart) {
  const std::string bag = "--bag " + d / "run.bag --out ";
  ASSERT_EQ(run(bag + d / "first --save-state " + d / "first.state"), 0) << errors;
  // Far beside the map: no scan fits there. Without loops the start is taken as it is told.
  ASSERT_EQ(run(bag + d / "second --loops none --start 500,500,0 --state " + d / "first.state"), 0)
      << errors;
  const auto summary = nlohmann::json::parse(fileBytes(d / "second/summary.json"));
  const auto& counts = summary["loops_by_kind"];
  const auto rows = rowsOf(d / "second/loops.csv");
  std::map<std::string, std::size_t> kinds;
  for (auto row : rows) {
    ++kinds[row["kind"]];
    if (row["kind"] == "saved") {
      EXPECT_EQ(row["found_by"], "saved");
      EXPECT_EQ(row["run_a"], "0");
    } else if (row["kind"] == "supposed") {
      EXPECT_EQ(row["found_by"], "start");
      EXPECT_EQ(row["run_a"], "1");
      EXPECT_EQ(row["run_b"], "0");
      EXPECT_EQ(row["inliers"], "0");
    } else {
      EXPECT_NE(row["found_by"], "proximity");  // of the saved map, which tells what found it
    }
  }
  EXPECT_EQ(kinds["supposed"], 1U);
  EXPECT_GT(kinds["saved"], 0U);
  EXPECT_EQ(kinds["unverified"], 0U);
  EXPECT_EQ(kinds["supposed"], counts["supposed"]);
  EXPECT_EQ(kinds["saved"], counts["saved"]);
  const std::string sentence = summary["places_seen_again"];
  EXPECT_NE(sentence.find("1 where it was told to start"), std::string::npos) << sentence;
  const auto page = nlohmann::json::parse(fileBytes(d / "second/report.json"));
  EXPECT_EQ(page["figures"][0]["loops"]["start"].size(), 1U);
  // Where it had begun: the scans fit, which is no supposition.
  ASSERT_EQ(run(bag + d / "third --loops none --start 0,0,0 --state " + d / "first.state"), 0)
      << errors;
  const auto third = nlohmann::json::parse(fileBytes(d / "third/summary.json"));
  EXPECT_EQ(third["loops_by_kind"]["supposed"], 0);
  EXPECT_EQ(third["loops_by_kind"]["near"], kinds["near"] + 1);
  // What changed is known where it is known where the robot was.
  for (const auto& told : {summary, third}) {
    const std::string changes = told["changes"];
    EXPECT_EQ(changes.rfind("not known", 0) == 0, told["place"] != "tied") << told["place"];
  }
  // Of two scans it is not known.
  ASSERT_EQ(run(bag + d / "fourth --every " + std::to_string(scans / 2 + 1) +
                " --start unknown --state " + d / "first.state"),
            0)
      << errors;
  const auto fourth = nlohmann::json::parse(fileBytes(d / "fourth/summary.json"));
  EXPECT_NE(fourth["place"], "tied");
  EXPECT_EQ(fourth["changes"], "not known: the session is not tied to the map");
}

TEST_F(SlamOffline, takesTheParametersOfTheNode) {
  const std::string some = "--bag " + d / "run.bag" + " --out ";
  const std::string shipped = std::string(HYSELAM_PACKAGE_DIR) + "/config/slam.yaml";
  ASSERT_EQ(run(some + d / "p0"), 0) << errors;
  ASSERT_EQ(run(some + d / "p1 --parameters " + shipped), 0) << errors;
  for (const char* name : {"trajectory.tum", "graph.g2o", "map.pgm", "words.csv", "loops.csv"}) {
    EXPECT_EQ(fileBytes(d / "p0/" + name), fileBytes(d / "p1/" + name)) << name;
  }
  writeFile(d / "some.yaml", "keyframe_step: 2\nresolution: 0.2\nloops: none\n");
  ASSERT_EQ(run(some + d / "p2 --parameters " + d / "some.yaml"), 0) << errors;
  const auto usual = nlohmann::json::parse(fileBytes(d / "p0/summary.json"));
  auto other = nlohmann::json::parse(fileBytes(d / "p2/summary.json"));
  EXPECT_LT(other["keyframes"], usual["keyframes"]);
  EXPECT_EQ(other["loops"], 0);
  EXPECT_EQ(other["loops_mode"], "none");
  EXPECT_DOUBLE_EQ(hyselam::loadMap(d / "p2/map.yaml").geometry.resolution, 0.2);
  // What is given on the command line wins.
  ASSERT_EQ(run(some + d / "p3 --resolution 0.1 --loops proximity --parameters " + d / "some.yaml"),
            0)
      << errors;
  other = nlohmann::json::parse(fileBytes(d / "p3/summary.json"));
  EXPECT_EQ(other["loops_mode"], "proximity");
  EXPECT_DOUBLE_EQ(hyselam::loadMap(d / "p3/map.yaml").geometry.resolution, 0.1);

  writeFile(d / "former.yaml", "optimise_every: 5\n");
  ASSERT_EQ(run(some + d / "p5 --parameters " + d / "former.yaml"), 0) << errors;
  EXPECT_EQ(errors.rfind("warning: parameter '", 0), 0U) << errors;
  EXPECT_NE(errors.find("is now called 'optimize_interval'"), std::string::npos) << errors;

  const auto refuse = [&](const std::string& text, const std::string& part) {
    writeFile(d / "wrong.yaml", text);
    expectRefused(some + d / "p4 --parameters " + d / "wrong.yaml", part);
  };
  refuse("keyframe_stop: 1\n", "'keyframe_step'?");
  refuse("odometry_doubt:\n  nothing: 1\n", "odometry_doubt/nothing");
  refuse("keyframe_step: -1\n", "keyframe_step' is -1");
  refuse("keyframe_step: far\n", "keyframe_step' is 'far'");
  refuse("- 1\n", "names of parameters");
  expectRefused(some + d / "p4 --parameters " + d / "none.yaml", "none.yaml");
}

TEST_F(SlamOffline, takesOnlyTheWordsOfTheThesisWithAFile) {
  const auto keyframes = [&](const std::string& name, const std::string& arguments) {
    EXPECT_EQ(run("--bag " + d / "run.bag --out " + d / name + " " + arguments), 0) << errors;
    const auto summary = nlohmann::json::parse(fileBytes(d / name + "/summary.json"));
    EXPECT_EQ(summary["loops_mode"], "thesis");
    return summary["keyframes"].get<int>();
  };
  writeFile(d / "step.yaml", "keyframe_step: 2\n");
  writeFile(d / "node.yaml", "keyframe_step: 2\nloops: thesis\n");
  const int usual = keyframes("t0", "--loops thesis");
  const int sparse = keyframes("t1", "--loops thesis --parameters " + d / "step.yaml");
  EXPECT_LT(sparse, usual);  // the file's step counts
  // The mode of the file alone has the node's words, asked for by name those of the thesis.
  EXPECT_EQ(keyframes("t2", "--parameters " + d / "node.yaml"), sparse);
  EXPECT_NE(fileBytes(d / "t1/words.csv"), fileBytes(d / "t2/words.csv"));
  EXPECT_EQ(keyframes("t3", "--loops thesis --parameters " + d / "node.yaml"), sparse);
  EXPECT_EQ(fileBytes(d / "t1/words.csv"), fileBytes(d / "t3/words.csv"));
}

TEST_F(SlamOffline, tellsWhatItCouldNotReadOfALog) {
  std::string text = carmenLog();
  writeFile(d / "whole.log", text);
  ASSERT_EQ(run("--carmen " + d / "whole.log --out " + d / "whole"), 0) << errors;
  EXPECT_EQ(errors, "");
  auto summary = nlohmann::json::parse(fileBytes(d / "whole/summary.json"));
  EXPECT_EQ(summary["trouble"].dump().find("lines of the log"), std::string::npos);
  EXPECT_FALSE(summary.contains("log_issues"));
  text.resize(text.rfind("FLASER") + 300);
  writeFile(d / "cut.log", text);
  ASSERT_EQ(run("--carmen " + d / "cut.log --out " + d / "cut"), 0) << errors;
  EXPECT_NE(errors.find("warning: " + d / "cut.log: line " + std::to_string(scans) + ": skipped"),
            std::string::npos)
      << errors;
  summary = nlohmann::json::parse(fileBytes(d / "cut/summary.json"));
  EXPECT_EQ(summary["scans"], scans - 1);
  EXPECT_NE(summary["trouble"].dump().find("1 line of the log was skipped"), std::string::npos)
      << summary["trouble"];
  EXPECT_EQ(summary["log_issues"].size(), 1U);
  EXPECT_EQ(summary["log_issues"][0]["line"], scans);
}

TEST_F(SlamOffline, tellsThatALogIsNoBag) {
  writeFile(d / "some.log", carmenLog());
  expectRefused("--bag " + d / "some.log --out " + d / "x", "try --carmen");
  ASSERT_EQ(std::system(("gzip -k " + d / "some.log").c_str()), 0);
  expectRefused("--bag " + d / "some.log.gz --out " + d / "x", "try --carmen");
  writeFile(d / "neither", "neither of them");
  expectRefused("--bag " + d / "neither --out " + d / "x", "neither");
  EXPECT_EQ(errors.find("--carmen"), std::string::npos) << errors;
}

TEST_F(SlamOffline, givesTheSameBytesForTheSameLog) {
  const std::string arguments = "--bag " + d / "run.bag" + " --odometry-noise 5 --seed 3 --out ";
  ASSERT_EQ(run(arguments + d / "b"), 0) << errors;
  ASSERT_EQ(run(arguments + d / "c"), 0) << errors;
  for (const char* name : {"trajectory.tum", "odometry.tum", "graph.g2o", "map.pgm", "map.yaml",
                           "words.csv", "regions.csv", "matches.csv"})
    EXPECT_EQ(fileBytes(d / "b" + "/" + name), fileBytes(d / "c" + "/" + name)) << name;
}

TEST_F(SlamOffline, tellsTheTroubleThatItMakes) {
  ASSERT_EQ(run("--bag " + d / "run.bag" + " --out " + d / "smooth --json " + d / "smooth.json"), 0)
      << errors;
  EXPECT_TRUE(nlohmann::json::parse(fileBytes(d / "smooth.json"))["trouble"].empty());
  ASSERT_EQ(run("--bag " + d / "run.bag" + " --freeze-odometry 30,5 --gap 50,5 --laser-error " +
                "-0.1,0.08,5 --correct-laser --out " + d / "rough --json " + d / "rough.json"),
            0)
      << errors;
  const auto rough = nlohmann::json::parse(fileBytes(d / "rough.json"));
  EXPECT_GT(rough["rough_road"]["path_unseen_m"], 1.0);
  EXPECT_GT(rough["rough_road"]["gaps"], 0);
  EXPECT_LT(rough["scans"], scans);
  EXPECT_TRUE(rough["laser_mount"]["wrong"]);
  EXPECT_TRUE(rough["laser_mount"]["corrected"]);
  EXPECT_NE(rough["trouble"].dump().find("while the odometry stands still"), std::string::npos);
}

TEST_F(SlamOffline, refusesUnusableInput) {
  const std::string some = "--bag " + d / "run.bag" + " --out " + d / "x ";
  expectRefused(some + "--freeze-odometry 100", "is not 2 numbers");
  expectRefused(some + "--gap 5,100", "EVERY above FOR");
  expectRefused(some + "--gap 100,5,", "is not 2 numbers");
  expectRefused(some + "--every 0", "--every");
  expectRefused(some + "--laser-error 1,2,left", "is not 3 numbers");
  expectRefused("--out " + d / "x", "--bag or --carmen");
  expectRefused("--bag " + d / "none.bag" + " --out " + d / "x", "none.bag");
  expectRefused("--bag " + d / "run.bag" + " --loops some --out " + d / "x", "loops");
  expectRefused("--bag " + d / "run.bag" + " --levels 0 --out " + d / "x", "levels");
  expectRefused("--bag " + d / "run.bag" + " --levels 2000000000 --loops thesis --out " + d / "x",
                "levels");
  expectRefused("--bag " + d / "run.bag" + " --resolution 0 --out " + d / "y", "resolution");
  EXPECT_FALSE(std::filesystem::exists(d / "y"));  // refused before anything is made
  expectRefused("--bag " + d / "late.bag" + " --out " + d / "x", "no odometry");
  writeFile(d / "empty.log", "");
  expectRefused("--carmen " + d / "empty.log" + " --out " + d / "x", "empty.log");
  writeFile(d / "file", "");
  expectRefused("--bag " + d / "run.bag" + " --out " + d / "file/x", "file/x");
  EXPECT_NE(run("--bag a --carmen b --out " + d / "x"), 0);
}

// The robot turns by a radian in five scans; odometry, which the table has between its estimates,
// tells half of that.
TEST(ReferencePoses, haveTheTurnsOfSlamBetweenEstimates) {
  ngram_slam::Reference table;
  std::vector<hyselam::StampedPose2> path;
  for (int i = 0; i <= 5; ++i) {
    const bool estimated = i == 0 || i == 5;
    const double turned = 0.2 * i;
    table.poses.push_back({0.1 * i, {1.0 * i, 0.0, estimated ? turned : 0.5 * turned}});
    table.estimated.push_back(estimated);
    path.push_back({0.1 * i, {7.0, 8.0, turned + 0.3}});  // in another frame
  }
  const auto poses = ngram_slam::withTurnsOf(path, table);
  ASSERT_EQ(poses.size(), table.poses.size());
  for (int i = 0; i <= 5; ++i) {
    EXPECT_NEAR(poses[static_cast<std::size_t>(i)].pose.theta, 0.2 * i, 1e-12);
    EXPECT_EQ(poses[static_cast<std::size_t>(i)].pose.x, 1.0 * i);
  }
  // Where SLAM tells nothing, and where all was estimated, headings stay.
  EXPECT_EQ(ngram_slam::withTurnsOf({}, table)[2].pose.theta, table.poses[2].pose.theta);
  table.estimated.clear();
  EXPECT_EQ(ngram_slam::withTurnsOf(path, table)[2].pose.theta, table.poses[2].pose.theta);
}

}  // namespace
