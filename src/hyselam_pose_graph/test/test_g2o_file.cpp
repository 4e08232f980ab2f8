// g2o files that are good, odd, and hostile; the tool.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_pose_graph/g2o_file.hpp"
#include "random_graphs.hpp"

namespace {

using namespace hyselam_pose_graph;  // NOLINT: a test
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

const char* const kEdge = "EDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\n";

std::string complaint(const std::string& content) {
  TemporaryDirectory dir;
  writeFile(dir / "bad.g2o", content);
  return hyselam::testing::messageOf<hyselam::InputError>([&] { readG2o(dir / "bad.g2o"); });
}

TEST(G2oFile, RoundTripIsExact) {
  TemporaryDirectory dir;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    auto graph = random_graphs::streets(40, 0.05, seed).graph;
    for (auto& id : graph.ids) id = 3 * id - 20;
    writeG2o(dir / "a.g2o", graph);
    const PoseGraph back = readG2o(dir / "a.g2o");
    ASSERT_EQ(back.ids, graph.ids);
    ASSERT_EQ(back.edges.size(), graph.edges.size());
    for (std::size_t i = 0; i < graph.poses.size(); ++i) {
      EXPECT_EQ(back.poses[i].x, graph.poses[i].x);
      EXPECT_EQ(back.poses[i].theta, graph.poses[i].theta);
    }
    for (std::size_t i = 0; i < graph.edges.size(); ++i) {
      EXPECT_EQ(back.edges[i].measured.y, graph.edges[i].measured.y);
      EXPECT_EQ(back.edges[i].information, graph.edges[i].information);
    }
  }
}

TEST(G2oFile, EdgesAloneAreComposed) {
  TemporaryDirectory dir;
  writeFile(dir / "e.g2o", std::string("# edges only\n\n") + kEdge +
                               "EDGE_SE2 2 7 0 2 1.5 1 0 0 1 0 1 # with a remark\nFIX 1\n");
  const PoseGraph g = readG2o(dir / "e.g2o");
  ASSERT_EQ(g.ids, (std::vector<std::int64_t>{1, 2, 7}));
  EXPECT_EQ(g.poses[2].x, 1.0);
  EXPECT_EQ(g.poses[2].y, 2.0);
  EXPECT_EQ(g.poses[2].theta, 1.5);
}

TEST(G2oFile, RejectsInvalidFiles) {
  const std::string good(kEdge);
  EXPECT_NE(complaint("").find("holds no pose"), std::string::npos);
  EXPECT_NE(complaint(good + "VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n").find("line 2"),
            std::string::npos);
  EXPECT_NE(complaint("VERTEX_SE2 1 0 0\n").find("too few"), std::string::npos);
  EXPECT_NE(complaint("VERTEX_SE2 1 0 0 0 0\n").find("not 4"), std::string::npos);
  EXPECT_NE(complaint("VERTEX_SE2 1.5 0 0 0\n").find("not the number of a pose"),
            std::string::npos);
  EXPECT_NE(complaint("VERTEX_SE2 1 0 nan 0\n").find("not a finite number"), std::string::npos);
  EXPECT_NE(complaint("VERTEX_SE2 1 0 0 0\nVERTEX_SE2 1 0 0 0\n").find("given twice"),
            std::string::npos);
  EXPECT_NE(complaint("EDGE_SE2 1 1 1 0 0 1 0 0 1 0 1\n").find("to itself"), std::string::npos);
  EXPECT_NE(complaint("EDGE_SE2 1 2 1 0 0 1 5 0 1 0 1\n").find("positive semidefinite"),
            std::string::npos);
  EXPECT_NE(complaint("EDGE_SE2 1 2 1 0 0 1 0 0 1 0\n").find("too few"), std::string::npos);
  EXPECT_NE(complaint("\x1b[2J 1\n").find("'?[2J'"), std::string::npos);
  EXPECT_NE(complaint(std::string("\x1f\x8b\x08 not gzip")), "");
  EXPECT_THROW(readG2o("/nowhere/graph.g2o"), hyselam::InputError);
}

TEST(G2oFile, TruncatedFilesAreReadOrRejected) {
  std::string text;
  {
    TemporaryDirectory dir;
    writeG2o(dir / "a.g2o", random_graphs::streets(6, 0.05, 1).graph);
    text = hyselam::testing::fileBytes(dir / "a.g2o");
  }
  for (std::size_t length = 0; length < text.size(); length += 3) complaint(text.substr(0, length));
}

TEST(OptimizeGraphTool, SolvesWritesAndReports) {
  TemporaryDirectory dir;
  writeG2o(dir / "in.g2o", random_graphs::streets(80, 0.05, 1).graph);
  const std::string tool = std::string(HYSELAM_TOOLS) + "/optimize_graph ";
  const std::string command = tool + (dir / "in.g2o") + " " + (dir / "out.g2o") + " --json " +
                              (dir / "r.json") + " > " + (dir / "log");
  ASSERT_EQ(std::system(command.c_str()), 0);
  const auto j = nlohmann::json::parse(hyselam::testing::fileBytes(dir / "r.json"));
  EXPECT_EQ(j["vertices"], 80);
  EXPECT_LT(j["final_cost"].get<double>(), j["initial_cost"].get<double>());
  EXPECT_TRUE(j.contains("iterations") && j.contains("solve_ms") && j.contains("edges"));
  const PoseGraph out = readG2o(dir / "out.g2o");
  EXPECT_NEAR(graphCost(out, out.poses), j["final_cost"].get<double>(),
              1e-6 * j["final_cost"].get<double>());
  const std::string bad =
      tool + (dir / "none.g2o") + " " + (dir / "o.g2o") + " 2> " + (dir / "err");
  EXPECT_EQ(WEXITSTATUS(std::system(bad.c_str())), 2);
  const std::string error = hyselam::testing::fileBytes(dir / "err");
  EXPECT_EQ(error.find("error: "), 0u) << error;
  EXPECT_FALSE(std::filesystem::exists(dir / "o.g2o"));
}

}  // namespace
