// The stages of the thesis' pipeline: against plain transcriptions, on drawn maps, and as a whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/drawn_grid.hpp"
#include "hyselam_gr2to/gr2to.hpp"
#include "hyselam_gr2to/thesis/door_candidates.hpp"
#include "hyselam_gr2to/thesis/thesis.hpp"
#include "transcription/thesis.hpp"

using namespace hyselam_topo;  // NOLINT: a test, not a header
using hyselam::Cell;
using hyselam::OccupancyGrid;
using hyselam::testing::drawnGrid;

namespace {

// Rooms of 4 m side by side, joined by doors of the given width in their middle; cells of 10 cm.
OccupancyGrid roomsInARow(int rooms, int door_cells) {
  hyselam::GridGeometry g;
  g.width = rooms * 42 + 4;
  g.height = 44;
  g.resolution = 0.1;
  OccupancyGrid grid(g);
  for (int y = 1; y < 43; ++y) {
    for (int x = 1; x < g.width - 1; ++x) {
      const bool wall = y < 3 || y > 40 || x < 3 || (x - 1) % 42 < 2;
      const bool door = x > 10 && x < g.width - 10 && std::abs(2 * (y - 20)) < door_cells;
      grid.at({x, y}) = wall && !door ? OccupancyGrid::kOccupied : OccupancyGrid::kFree;
    }
  }
  return grid;
}

cv::Mat randomRooms(std::uint64_t seed) {
  hyselam::Rng rng(seed);
  const auto upTo = [&](int n) {
    return static_cast<int>(rng.below(static_cast<std::uint32_t>(n)));
  };
  cv::Mat m(40 + upTo(60), 40 + upTo(60), CV_8UC1, cv::Scalar(0));
  cv::rectangle(m, {0, 0}, {m.cols - 1, m.rows - 1}, 255);
  for (int k = 2 + upTo(8); k > 0; --k) {
    const cv::Point a{upTo(m.cols), upTo(m.rows)};
    cv::line(m, a, upTo(2) ? cv::Point(a.x, upTo(m.rows)) : cv::Point(upTo(m.cols), a.y), 255, 2);
  }
  for (int k = upTo(6); k > 0; --k) {
    cv::circle(m, {upTo(m.cols), upTo(m.rows)}, 1 + upTo(8), 0, cv::FILLED);
  }
  return m;
}

}  // namespace

TEST(ThesisOracle, DoorCellsEqualTheTranscription) {
  std::size_t cells = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const DistanceMap d(randomRooms(seed));
    const double low = 1.5 + 0.05 * static_cast<double>(seed % 40), high = low + 4.0;
    const auto found = doorCells(d, low, high);
    EXPECT_EQ(transcription::doorCells(d, low, high), found) << "seed " << seed;
    EXPECT_EQ(transcription::centralLocations(found, low), centralLocations(found, low));
    cells += found.size();
  }
  EXPECT_GT(cells, 1000u);
}

TEST(ThesisOracle, CirclesEqualTheTranscription) {
  std::size_t circles = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const DistanceMap d(randomRooms(seed));
    const cv::Mat lines = VoronoiDiagram(d).lines();
    const auto found = packCircles(d, lines), plain = transcription::packCircles(d, lines);
    ASSERT_EQ(plain.size(), found.size()) << "seed " << seed;
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(plain[i].centre, found[i].centre);
    circles += found.size();
  }
  EXPECT_GT(circles, 500u);
}

TEST(ThesisOracle, StoredCirclesDoNotOverlap) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const DistanceMap d(randomRooms(seed));
    const auto circles = packCircles(d, VoronoiDiagram(d).lines());
    for (std::size_t i = 0; i < circles.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_LT(circles[i].radius + circles[j].radius,
                  std::hypot(circles[i].centre.x - circles[j].centre.x,
                             circles[i].centre.y - circles[j].centre.y));
      }
    }
  }
}

TEST(ThesisFilter, RemovesIsolatedCells) {
  const OccupancyGrid out = filterIsolatedCells(
      drawnGrid({"#####     ", "#...#     ", "#.......  ", "#...#    .", "#####     "}));
  EXPECT_EQ(OccupancyGrid::kUnknown, out.at({9, 1}));
  EXPECT_EQ(OccupancyGrid::kFree, out.at({7, 2}));
  EXPECT_EQ(OccupancyGrid::kOccupied, out.at({4, 1}));
  const OccupancyGrid salt = filterIsolatedCells(drawnGrid({".....", "..#..", "....."}));
  EXPECT_EQ(OccupancyGrid::kFree, salt.at({2, 1}));
}

TEST(ThesisDoors, CentralLocationsAreTheMeansOfGroups) {
  const auto centres = centralLocations({{0, 0}, {2, 0}, {20, 0}, {1, 3}, {21, 0}}, 5.0);
  ASSERT_EQ(2u, centres.size());
  EXPECT_NEAR(1.0, centres[0].x, 1e-9);
  EXPECT_NEAR(1.0, centres[0].y, 1e-9);
  EXPECT_NEAR(20.5, centres[1].x, 1e-9);
}

TEST(ThesisDoors, OnlyOfTheGivenWidths) {
  for (const int cells : {8, 9, 10, 11, 12}) {
    const ThesisResult r = runThesis(roomsInARow(3, cells));
    ASSERT_EQ(2u, r.doors.size()) << cells;
    int real = 0;
    for (const DoorLine& d : r.segmentation.doors) {
      if (!d.real) continue;
      ++real;
      EXPECT_NEAR(0.1 * cells, d.width, 0.11) << cells;
      EXPECT_NEAR(2.05, 0.5 * (d.a.y + d.b.y), 0.11);
    }
    EXPECT_EQ(2, real) << cells;
  }
  EXPECT_TRUE(runThesis(roomsInARow(3, 18)).doors.empty());
  EXPECT_TRUE(runThesis(roomsInARow(3, 4)).doors.empty());
}

TEST(ThesisPlaces, ThreeRoomsThreePlacesTwoLinks) {
  const ThesisResult r = runThesis(roomsInARow(3, 9));
  EXPECT_EQ(3, r.segmentation.places);
  ASSERT_EQ(2u, r.links.size());
  // Each room is of one place, all of it.
  std::set<int> seen;
  for (int room = 0; room < 3; ++room) {
    const cv::Mat part = r.segmentation.labels(cv::Rect(4 + 42 * room, 4, 37, 36));
    double low = 0, high = 0;
    cv::minMaxLoc(part, &low, &high);
    EXPECT_EQ(low, high) << room;
    EXPECT_GT(low, 0.0);
    seen.insert(static_cast<int>(low));
  }
  EXPECT_EQ(3u, seen.size());
  // Each room's polygon has walls above and below.
  for (const PlacePolygon& p : r.polygons) {
    EXPECT_GE(std::count(p.wall.begin(), p.wall.end(), true), 4);
  }
}

TEST(ThesisPlaces, EveryLabelIsConnectedAndOnTheFloor) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const cv::Mat obstacles = randomRooms(seed);
    hyselam::GridGeometry g;
    g.width = obstacles.cols;
    g.height = obstacles.rows;
    OccupancyGrid grid(g, OccupancyGrid::kFree);
    for (std::size_t i = 0; i < grid.cells.size(); ++i) {
      if (obstacles.ptr()[i] != 0) grid.cells[i] = OccupancyGrid::kOccupied;
    }
    const ThesisResult r = runThesis(grid);
    for (int label = 1; label <= r.segmentation.places; ++label) {
      cv::Mat parts;
      EXPECT_EQ(2, cv::connectedComponents(r.segmentation.labels == label, parts, 4))
          << "seed " << seed << ", label " << label;
    }
    EXPECT_EQ(0, cv::countNonZero((r.segmentation.labels > 0) & (r.obstacles > 0)));
    for (const DoorLine& d : r.segmentation.doors) {
      EXPECT_LT(d.place_a, d.place_b);
      EXPECT_GT(d.place_a, 0);
      EXPECT_LE(d.place_b, r.segmentation.places);
    }
  }
}

TEST(ThesisPlaces, HandlesEmptyAndInvalidMaps) {
  hyselam::GridGeometry g;
  g.width = 20;
  g.height = 10;
  EXPECT_EQ(0, segmentThesis(OccupancyGrid(g)).places);
  EXPECT_EQ(0, segmentThesis(OccupancyGrid(g, OccupancyGrid::kFree)).places);
  EXPECT_EQ(0, segmentThesis(OccupancyGrid(g, OccupancyGrid::kOccupied)).places);
  OccupancyGrid broken(g);
  broken.cells.pop_back();
  EXPECT_THROW(segmentThesis(broken), hyselam::InputError);
  EXPECT_THROW(segmentThesis(OccupancyGrid()), hyselam::InputError);
  ThesisParams params;
  params.door_max = 0.1;
  EXPECT_THROW(segmentThesis(OccupancyGrid(g), params), hyselam::ParameterError);
}

TEST(ThesisParameters, ReachThePipelineThroughGr2To) {
  const auto doors = [](const Gr2ToParams& params) {
    int real = 0;
    for (const DoorLine& d : gr2to(roomsInARow(3, 9), params).doors) real += d.real ? 1 : 0;
    return real;
  };
  Gr2ToParams params;
  params.mode = Gr2ToParams::Mode::kThesis;
  EXPECT_EQ(2, doors(params));
  params.thesis.door_max = 0.7;
  EXPECT_EQ(0, doors(params));
  params.thesis.door_max = 0.5;  // below Door_min
  EXPECT_THROW(doors(params), hyselam::ParameterError);
}

TEST(ThesisParameters, FreeMaxHoldsInBothModes) {
  OccupancyGrid grid = roomsInARow(3, 9);
  for (std::int8_t& cell : grid.cells) cell = cell == OccupancyGrid::kFree ? 40 : cell;
  for (const auto mode : {Gr2ToParams::Mode::kDefault, Gr2ToParams::Mode::kThesis}) {
    Gr2ToParams params;
    params.mode = mode;
    EXPECT_EQ(0u, gr2to(grid, params).map.places.size());
    params.segmentation.free_max = 40;
    const Gr2ToResult result = gr2to(grid, params);
    ASSERT_EQ(3u, result.map.places.size());
    int solid = 0;
    for (const Wall& wall : result.map.places[0].walls) solid += wall.kind == WallKind::kSolid;
    EXPECT_GE(solid, 4);
  }
}

TEST(ThesisPicture, EveryStageCanBeDrawn) {
  const ThesisResult r = runThesis(roomsInARow(3, 9));
  cv::Mat last;
  for (const auto stage : {ThesisStage::kDistance, ThesisStage::kCandidates, ThesisStage::kVoronoi,
                           ThesisStage::kCircles, ThesisStage::kPlaces}) {
    const cv::Mat picture = drawThesis(r, stage);
    ASSERT_EQ(CV_8UC3, picture.type());
    if (!last.empty()) {
      EXPECT_GT(cv::norm(picture, last, cv::NORM_L1), 0.0);
    }
    last = picture;
  }
}
