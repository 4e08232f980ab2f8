#include "training_examples.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string_view>
#include <utility>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "segmentation/prepared_basins.hpp"

namespace hyselam_topo {
namespace {

constexpr std::uint64_t kFirstPlanSeed = 1001;
constexpr double kTurn = 31.0;  // [degrees] of the turned copies

/// The checksum of maps with their rooms, one after another.
class MapChecksum {
 public:
  void add(const hyselam::OccupancyGrid& grid, const cv::Mat& rooms) {
    crc_ = hyselam::crc32Of({reinterpret_cast<const char*>(grid.cells.data()), grid.cells.size()},
                            crc_);
    for (int y = 0; y < rooms.rows; ++y) {
      for (int x = 0; x < rooms.cols; ++x) {
        const auto room = static_cast<std::uint32_t>(rooms.at<int>(y, x));
        const char bytes[2] = {static_cast<char>(room & 0xffu), static_cast<char>(room >> 8)};
        crc_ = hyselam::crc32Of({bytes, 2}, crc_);
      }
    }
    ++maps_;
  }
  int maps() const { return maps_; }
  std::string text() const {
    char digits[9];
    std::snprintf(digits, sizeof digits, "%08x", static_cast<unsigned>(crc_));
    return digits;
  }

 private:
  std::uint32_t crc_ = 0;
  int maps_ = 0;
};

/// `rooms`: CV_32S, row 0 lowest.
Example prepare(const std::string& name, const std::string& kind, const std::string& building,
                hyselam::OccupancyGrid grid, const cv::Mat& rooms, double scale,
                const ExampleOptions& options) {
  grid.geometry.resolution *= scale;
  // A basin's cells are looked up in the map of the rooms: neither joined nor resampled.
  SegmentationParams as_it_is = options.segmentation;
  as_it_is.working_resolution = grid.geometry.resolution;
  const PreparedBasins p = prepareBasins(grid, as_it_is, Preparation::kBasinsAlone);
  double most = 0;
  cv::minMaxLoc(rooms, nullptr, &most);
  Example e{name,
            kind,
            building,
            scale == 1.0,
            RegionAdjacencyGraph(p.clearance, p.basins, p.space.resolution),
            {}};
  e.rooms.assign(static_cast<std::size_t>(p.basins.count) + 1,
                 std::vector<int>(static_cast<std::size_t>(most) + 1, 0));
  for (int y = 0; y < rooms.rows; ++y)
    for (int x = 0; x < rooms.cols; ++x) {
      const int column = x - p.space.origin.x, row = y - p.space.origin.y;
      if (row < 0 || column < 0 || row >= p.space.free.rows || column >= p.space.free.cols)
        continue;
      const int basin = p.basins.labels.at<int>(row, column);
      if (basin != 0)
        ++e.rooms[static_cast<std::size_t>(basin)][static_cast<std::size_t>(rooms.at<int>(y, x))];
    }
  return e;
}

/// One cell in a hundred free or occupied at random.
hyselam::OccupancyGrid withNoise(hyselam::OccupancyGrid grid) {
  hyselam::Rng rng(grid.cells.size());
  for (std::int8_t& cell : grid.cells)
    if (rng.below(100) == 0)
      cell = rng.below(2) == 0 ? hyselam::OccupancyGrid::kFree : hyselam::OccupancyGrid::kOccupied;
  return grid;
}

/// Map and rooms turned about the middle.
std::pair<hyselam::OccupancyGrid, cv::Mat> turned(const hyselam::OccupancyGrid& grid,
                                                  const cv::Mat& rooms, double degrees) {
  const cv::Mat cells(grid.geometry.height, grid.geometry.width, CV_8S,
                      const_cast<std::int8_t*>(grid.cells.data()));
  cv::Mat values;
  cells.convertTo(values, CV_8U, 1.0, 1.0);  // unknown becomes 0
  const cv::Point2f middle(0.5f * static_cast<float>(cells.cols - 1),
                           0.5f * static_cast<float>(cells.rows - 1));
  cv::Mat m = cv::getRotationMatrix2D(middle, degrees, 1.0);
  const double c = std::abs(m.at<double>(0, 0)), s = std::abs(m.at<double>(0, 1));
  const cv::Size size(static_cast<int>(std::ceil(cells.cols * c + cells.rows * s)) + 2,
                      static_cast<int>(std::ceil(cells.cols * s + cells.rows * c)) + 2);
  m.at<double>(0, 2) += 0.5 * (size.width - cells.cols);
  m.at<double>(1, 2) += 0.5 * (size.height - cells.rows);
  cv::Mat new_values, new_rooms, small_rooms;
  cv::warpAffine(values, new_values, m, size, cv::INTER_NEAREST);
  rooms.convertTo(small_rooms, CV_16U);
  cv::warpAffine(small_rooms, new_rooms, m, size, cv::INTER_NEAREST);
  new_rooms.convertTo(new_rooms, CV_32S);
  hyselam::GridGeometry g = grid.geometry;
  g.width = size.width;
  g.height = size.height;
  hyselam::OccupancyGrid out(g);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      out.at({x, y}) = static_cast<std::int8_t>(new_values.at<std::uint8_t>(y, x) - 1);
  return {out, new_rooms};
}

/// Floors of the simulator, every second one furnished, some turned. Their seeds are those that no
/// test and no benchmark uses.
std::pair<hyselam::OccupancyGrid, cv::Mat> generated(int i) {
  hyselam_sim::PlanParams params;
  params.furniture = i % 2 == 1;
  params.rotation = i % 3 == 0 ? 0.0 : 0.13 * i;
  const hyselam_sim::FloorPlan plan =
      hyselam_sim::generatePlan(kFirstPlanSeed + static_cast<std::uint64_t>(i), params);
  const hyselam::OccupancyGrid grid = hyselam_sim::rasterize(plan, 0.05, 0.0);
  cv::Mat rooms(grid.geometry.height, grid.geometry.width, CV_32S, cv::Scalar(0));
  for (int y = 0; y < rooms.rows; ++y)
    for (int x = 0; x < rooms.cols; ++x)
      for (std::size_t k = 0; k < plan.places.size(); ++k)
        if (hyselam_sim::contains(plan.places[k].outline, grid.geometry.center({x, y})))
          rooms.at<int>(y, x) = static_cast<int>(k) + 1;
  return {grid, rooms};
}

struct GivenMap {
  std::string name, kind, building;
  hyselam::OccupancyGrid grid;
  cv::Mat rooms;  // CV_32S, row 0 lowest
};

std::vector<GivenMap> loadMaps(const std::string& folder) {
  std::vector<GivenMap> maps;
  const std::string index = folder + "/index.csv";
  std::ifstream file(index);
  if (!file) throw hyselam::InputError(index, "", "cannot be opened");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<std::string> fields;
    std::stringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    if (fields.size() < 8) throw hyselam::InputError(index, line, "has too few fields");
    GivenMap map{fields[0], fields[5], fields[6], hyselam::loadMap(folder + "/" + fields[2]), {}};
    map.rooms = cv::imread(folder + "/" + fields[3], cv::IMREAD_UNCHANGED);
    if (map.rooms.empty()) throw hyselam::InputError(folder + "/" + fields[3], "", "is no image");
    cv::flip(map.rooms, map.rooms, 0);
    map.rooms.convertTo(map.rooms, CV_32S);
    maps.push_back(std::move(map));
  }
  return maps;
}

void addGivenMap(const GivenMap& map, const ExampleOptions& options, std::vector<Example>& out) {
  const auto add = [&](const hyselam::OccupancyGrid& grid, const cv::Mat& rooms, double scale) {
    out.push_back(prepare(map.name, map.kind, map.building, grid, rooms, scale, options));
  };
  for (const double scale : options.scales) add(map.grid, map.rooms, scale);
  add(withNoise(map.grid), map.rooms, 1.0);
  out.back().scored = false;
  const auto [turned_grid, turned_rooms] = turned(map.grid, map.rooms, kTurn);
  add(turned_grid, turned_rooms, 1.0);
  out.back().scored = false;
}

}  // namespace

TrainingData loadExamples(const ExampleOptions& options) {
  TrainingData data;
  MapChecksum given, drawn;
  if (!options.data.empty()) {
    for (const GivenMap& map : loadMaps(options.data)) {
      given.add(map.grid, map.rooms);
      addGivenMap(map, options, data.examples);
    }
  }
  for (int i = 0; i < options.plans; ++i) {
    const auto [grid, rooms] = generated(i);
    drawn.add(grid, rooms);
    data.examples.push_back(prepare("generated " + std::to_string(i), "generated",
                                    "generated " + std::to_string(i % 4), grid, rooms, 1.0,
                                    options));
  }
  data.summary = std::to_string(given.maps()) + " maps (CRC-32 " + given.text() + "), " +
                 std::to_string(drawn.maps()) + " generated floors (CRC-32 " + drawn.text() + ")";
  return data;
}

}  // namespace hyselam_topo
