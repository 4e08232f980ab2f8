// The tools of semantic classes as a shell sees them, in a small made-up building.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "hyselam_common/ros/bag_io.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_sim/generate_corridors.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/simulation.hpp"
#include "tool_test.hpp"

using hyselam::testing::fileBytes;
using hyselam::testing::writeFile;

namespace {

struct SemanticTools : ToolTest {
  static void SetUpTestSuite() {
    ToolTest::SetUpTestSuite();
    hyselam_sim::CorridorParams params;
    params.lines = 3;
    params.legs = 16;
    const auto building = hyselam_sim::generateCorridors(11, params);
    auto log = hyselam_sim::simulate(building.plan, building.route, 11).log;
    hyselam::writeBag(*directory / "run.bag", log);
    log.ground_truth.clear();
    hyselam::writeBag(*directory / "blind.bag", log);
    writeFile(*directory / "plan.yaml", toYaml(building.plan));
    hyselam_sim::FloorPlan bare = building.plan;
    bare.areas.clear();
    bare.floor_kind.clear();
    writeFile(*directory / "bare.yaml", toYaml(bare));
  }
  std::string evaluate() const {
    return "evaluate_semantics " + d / "run.bag" + " --plan " + d / "plan.yaml";
  }
};

}  // namespace

TEST_F(SemanticTools, evaluateScoresAndWritesConfusionAndRegions) {
  const std::string outputs = " --json " + d / "a.json" + " --confusion " + d / "a_confusion.csv" +
                              " --regions " + d / "a.csv";
  ASSERT_EQ(run(evaluate() + outputs), 0) << errors;
  const auto j = nlohmann::json::parse(fileBytes(d / "a.json"));
  // Four of ten turns are sharp here, which the tree of the thesis was not drawn for.
  EXPECT_GT(j["accuracy"].get<double>(), 0.8);
  EXPECT_GT(j["classes"]["corridor"]["actual"].get<int>(), 500);
  EXPECT_LE(j["strict"]["accuracy"].get<double>(), j["accuracy"].get<double>());

  // The table is the matrix of the JSON, and the plot script draws it.
  std::istringstream matrix(fileBytes(d / "a_confusion.csv"));
  std::string row;
  std::getline(matrix, row);
  EXPECT_EQ(row, "truth,bifurcation,corner,corridor,dead-end,hall");
  for (const auto& counts : j["confusion"]) {
    std::getline(matrix, row);
    std::string expected = row.substr(0, row.find(','));
    for (const auto& n : counts) expected += "," + n.dump();
    EXPECT_EQ(row, expected);
  }
  const auto plot = [&](const std::string& table, const std::string& out) {
    return std::system(("/usr/bin/python3 " HYSELAM_PACKAGE_DIR "/../../scripts/plot_confusion " +
                        table + " " + out + " --title Example 2>" + (d / "stderr"))
                           .c_str());
  };
  EXPECT_EQ(plot(d / "a_confusion.csv", d / "a.png"), 0) << fileBytes(d / "stderr");
  EXPECT_EQ(fileBytes(d / "a.png").substr(1, 3), "PNG");
  EXPECT_NE(plot(d / "a.json", d / "none.png"), 0);
  EXPECT_NE(fileBytes(d / "stderr").find("a.json"), std::string::npos);

  // The regions follow each other and hold every observation.
  std::istringstream table(fileBytes(d / "a.csv"));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "first,last,stamp_begin,stamp_end,class,confidence");
  std::size_t next = 0, regions = 0;
  while (std::getline(table, line)) {
    std::istringstream fields(line);
    std::size_t first = 0, last = 0;
    char comma = 0;
    fields >> first >> comma >> last;
    EXPECT_EQ(first, next);
    next = last + 1;
    ++regions;
  }
  EXPECT_EQ(next, j["observations"].get<std::size_t>());
  EXPECT_EQ(regions, j["regions"].get<std::size_t>());

  ASSERT_EQ(run(evaluate() + " --json " + d / "b.json" + " --confusion " + d / "b_confusion.csv" +
                " --regions " + d / "b.csv"),
            0);
  for (const char* rest : {".json", "_confusion.csv", ".csv"}) {
    EXPECT_EQ(fileBytes(d / (std::string("a") + rest)), fileBytes(d / (std::string("b") + rest)));
  }
}

TEST_F(SemanticTools, trainLearnsAForestThatEvaluateUses) {
  ASSERT_EQ(run("train_semantic --buildings 1 --held-out 0 --trees 10 --out " + d / "forest"), 0)
      << errors;
  ASSERT_EQ(run(evaluate() + " --model " + d / "forest" + " --json " + d / "f.json"), 0) << errors;
  const auto j = nlohmann::json::parse(fileBytes(d / "f.json"));
  EXPECT_EQ(j["classifier"], "forest");
  EXPECT_GT(j["accuracy"].get<double>(), 0.7);

  const std::string forest = fileBytes(d / "forest");
  writeFile(d / "cut", forest.substr(0, forest.size() / 2));
  expectRefused(evaluate() + " --model " + d / "cut", "checksum");
  expectRefused(evaluate() + " --model " + d / "plan.yaml", "is no 'ngram_slam semantic forest 3'");
  expectRefused(evaluate() + " --model " + d / "nothing", "nothing");
}

// The forest that comes with the package fits the features of this version.
TEST_F(SemanticTools, theShippedForestIsUsable) {
  ASSERT_EQ(run(evaluate() + " --model shipped" + " --json " + d / "s.json"), 0) << errors;
  const auto j = nlohmann::json::parse(fileBytes(d / "s.json"));
  EXPECT_GT(j["strict"]["accuracy"].get<double>(), 0.95);
}

TEST_F(SemanticTools, badInputIsStatus2) {
  expectRefused("evaluate_semantics " + d / "none.bag" + " --plan " + d / "plan.yaml", "none.bag");
  expectRefused("evaluate_semantics " + d / "blind.bag" + " --plan " + d / "plan.yaml",
                "no ground truth");
  expectRefused("evaluate_semantics " + d / "run.bag" + " --plan " + d / "bare.yaml", "areas");
  expectRefused("evaluate_semantics " + d / "run.bag" + " --plan nowhere", "nowhere");
  expectRefused("evaluate_semantics " + d / "run.bag", "--plan");
  expectRefused(evaluate() + " --border 1.5", "border");
  expectRefused(evaluate() + " --high-variation nan", "high_variation");
  expectRefused(evaluate() + " --bandwidth -1", "");
  expectRefused(evaluate() + " --confusion " + d / "none/c.csv", "none");
  expectRefused(evaluate() + " --confusion " + d / "c.png", "plot_confusion");
  expectRefused("train_semantic --buildings 0", "--buildings");
  expectRefused("train_semantic --trees 0", "trees");
  expectRefused("train_semantic --depth many", "--depth");
}

TEST_F(SemanticTools, wayForestIsLearntAndTellsTheKindsOfAnotherBuilding) {
  const std::string train = "train_way_regions --buildings 5 --trees 20 --out " + d / "way.txt";
  ASSERT_EQ(run(train), 0) << errors;
  const std::string first = fileBytes(d / "way.txt");
  ASSERT_EQ(run(train), 0) << errors;
  EXPECT_EQ(fileBytes(d / "way.txt"), first);
  EXPECT_NE(first.find("command: train_way_regions"), std::string::npos);
  ASSERT_EQ(run(evaluate() + " --way-model " + d / "way.txt" + " --places " + d / "places.csv" +
                " --json " + d / "way.json"),
            0)
      << errors;
  const auto score = nlohmann::json::parse(fileBytes(d / "way.json"));
  EXPECT_EQ(score["classifier"], "way forest");
  EXPECT_GT(score["accuracy"], 0.8);
  EXPECT_GT(score["average_recall"], 0.5);
  const std::string places = fileBytes(d / "places.csv");
  EXPECT_EQ(places.rfind("x,y,truth,class\n", 0), 0u);
  EXPECT_GT(std::count(places.begin(), places.end(), '\n'), 500);

  // The same log as a lesson, drawn by two.
  const std::string lesson =
      "train_way_regions " + d / "run.bag" + " --buildings 0 --trees 5 --out " + d / "own.txt";
  EXPECT_EQ(run(lesson + " --drawing " + d / "plan.yaml" + " " + d / "plan.yaml"), 0) << errors;
  expectRefused(lesson, "--drawing");
  expectRefused(lesson + " --drawing " + d / "none.yaml", "none.yaml");
  expectRefused("train_way_regions --buildings 0", "--buildings");
  expectRefused("train_way_regions --buildings 1 --simulated-weight 0", "--simulated-weight");
  expectRefused("train_way_regions --buildings 1 --trees 0", "trees");
  expectRefused(lesson + " --drawing " + d / "plan.yaml" + " --out-without-each " + d / ".",
                "--out-without-each");
  expectRefused(evaluate() + " --way-model " + d / "plan.yaml", "plan.yaml");
  expectRefused(evaluate() + " --way-model shipped --model shipped", "--way-model");
  expectRefused(evaluate() + " --way-model " + d / "way.txt" + " --change-cost -1", "change_cost");
}
