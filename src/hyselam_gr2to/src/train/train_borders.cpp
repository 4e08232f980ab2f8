// Learns which neighbours are one place from maps with known rooms, and says how well it carries
// over to buildings that it has not seen.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "boosting.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/map_io.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_sim/generate_plan.hpp"
#include "hyselam_sim/plan_geometry.hpp"
#include "hyselam_sim/rasterize.hpp"
#include "room_scores.hpp"
#include "segmentation/agglomeration.hpp"

namespace hyselam_topo {
namespace {

struct Options {
  std::string data, out;
  int rounds = 4;
  std::vector<double> scales{1.0, 0.85, 1.2};
  double robot_weight = 2.0;
  int plans = 24;
  double plan_weight = 0.5;
  std::vector<int> without;
  std::vector<double> leans;
  BoostingParams boosting;
  SegmentationParams segmentation;
};

/// A map at one scale, ready to be merged, and how the cells of its basins share out on the rooms.
struct Example {
  std::string name, kind, building;
  bool scored = true;
  PlaceGraph graph;
  std::vector<std::vector<int>> rooms;  // [basin][room], room 0: none
};

std::vector<int> sum(const std::vector<int>& a, const std::vector<int>& b) {
  std::vector<int> out(a);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += b[i];
  return out;
}

/// `rooms`: CV_32S, row 0 lowest.
Example prepare(const std::string& name, const std::string& kind, const std::string& building,
                hyselam::OccupancyGrid grid, const cv::Mat& rooms, double scale,
                const Options& options) {
  grid.geometry.resolution *= scale;
  const PreparedPlaces p = preparePlaces(grid, options.segmentation);
  if (p.space.joined != 1 || p.space.split != 1)
    throw hyselam::InputError(name, "resolution", "is not near the working resolution");
  double most = 0;
  cv::minMaxLoc(rooms, nullptr, &most);
  Example e{
      name, kind, building, scale == 1.0, PlaceGraph(p.clearance, p.basins, p.space.resolution),
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

/// Floors of the simulator, every second one furnished, some turned. Tests and benches measure on
/// the first seeds.
std::pair<hyselam::OccupancyGrid, cv::Mat> generated(int i) {
  hyselam_sim::PlanParams params;
  params.furniture = i % 2 == 1;
  params.rotation = i % 3 == 0 ? 0.0 : 0.13 * i;
  const hyselam_sim::FloorPlan plan =
      hyselam_sim::generatePlan(1001 + static_cast<std::uint64_t>(i), params);
  const hyselam::OccupancyGrid grid = hyselam_sim::rasterize(plan, 0.05, 0.0);
  cv::Mat rooms(grid.geometry.height, grid.geometry.width, CV_32S, cv::Scalar(0));
  for (int y = 0; y < rooms.rows; ++y)
    for (int x = 0; x < rooms.cols; ++x)
      for (std::size_t k = 0; k < plan.places.size(); ++k)
        if (hyselam_sim::contains(plan.places[k].outline, grid.geometry.center({x, y})))
          rooms.at<int>(y, x) = static_cast<int>(k) + 1;
  return {grid, rooms};
}

std::vector<Example> load(const Options& options) {
  std::vector<Example> examples;
  const std::string index = options.data + "/index.csv";
  std::ifstream file(index);
  if (!file) throw hyselam::InputError(index, "", "cannot be opened");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<std::string> fields;
    std::stringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    if (fields.size() < 8) throw hyselam::InputError(index, line, "has too few fields");
    const hyselam::OccupancyGrid grid = hyselam::loadMap(options.data + "/" + fields[2]);
    cv::Mat rooms = cv::imread(options.data + "/" + fields[3], cv::IMREAD_UNCHANGED);
    if (rooms.empty()) throw hyselam::InputError(options.data + "/" + fields[3], "", "is no image");
    cv::flip(rooms, rooms, 0);
    rooms.convertTo(rooms, CV_32S);
    for (const double scale : options.scales)
      examples.push_back(prepare(fields[0], fields[5], fields[6], grid, rooms, scale, options));
    examples.push_back(
        prepare(fields[0], fields[5], fields[6], withNoise(grid), rooms, 1.0, options));
    examples.back().scored = false;
    const auto [turned_grid, turned_rooms] = turned(grid, rooms, 31.0);
    examples.push_back(
        prepare(fields[0], fields[5], fields[6], turned_grid, turned_rooms, 1.0, options));
    examples.back().scored = false;
  }
  for (int i = 0; i < options.plans; ++i) {
    const auto [grid, rooms] = generated(i);
    examples.push_back(prepare("generated " + std::to_string(i), "generated",
                               "generated " + std::to_string(i % 4), grid, rooms, 1.0, options));
  }
  return examples;
}

int room(const std::vector<int>& cells) {
  const auto most = std::max_element(cells.begin() + 1, cells.end());
  return *most > 0 ? static_cast<int>(most - cells.begin()) : 0;
}

/// Samples of one example, apart, so that a building can be left out.
using PerExample = std::vector<Samples>;

/// With `samples`, the trees' own odds lead to the borders that are met; without, and for the
/// scores, they are taken as the segmentation does. `lean`: added to the odds.
RoomScores run(const Example& example, const BoostedTrees* model, const Options& options,
               Samples* samples, double lean = 0.0) {
  PlaceGraph graph = example.graph;
  // Nodes keep the number of the smaller: their cells per room are kept beside.
  std::vector<std::vector<int>> rooms = example.rooms;
  std::vector<char> alive(rooms.size(), 1);
  const auto now = [&](const PlaceGraph& g) {
    for (std::size_t i = 1; i < rooms.size(); ++i)
      if (alive[i] && !g.node(static_cast<int>(i)).alive) {
        alive[i] = 0;
        const auto root = static_cast<std::size_t>(g.root(static_cast<int>(i)));
        rooms[root] = sum(rooms[root], rooms[i]);
      }
  };
  agglomerate(graph, [&](const PlaceGraph& g, int a, int b) {
    BorderFeatures f = describeBorder(g, a, b);
    for (const int w : options.without) f[static_cast<std::size_t>(w)] = 0.0;
    if (samples != nullptr) {
      now(g);
      const int ra = room(rooms[static_cast<std::size_t>(a)]);
      const int rb = room(rooms[static_cast<std::size_t>(b)]);
      if (ra != 0 && rb != 0) {
        const double small = std::min(g.node(a).area, g.node(b).area);
        samples->values.insert(samples->values.end(), f.begin(), f.end());
        samples->one_place.push_back(ra == rb);
        samples->weights.push_back(std::min(small, 3.0) / 3.0 + 0.05);
      }
    }
    if (model != nullptr)
      return (samples != nullptr ? (*model)(f.data()) : oddsOfOnePlace(*model, f)) + lean;
    return f[1] - std::log(0.75);
  });
  now(graph);
  std::vector<std::vector<int>> places;
  for (std::size_t i = 1; i < rooms.size(); ++i)
    if (alive[i]) places.push_back(rooms[i]);
  return scoreRooms(places, static_cast<int>(rooms[0].size()) - 1);
}

BoostedTrees fit(const std::vector<Example>& examples, const PerExample& samples,
                 const std::string& without, const Options& options) {
  Samples all;
  all.features = kBorderFeatures;
  // Every map counts by the root of its weight: many rooms say more, but not as many times more.
  std::map<std::string, double> weights;
  for (std::size_t i = 0; i < examples.size(); ++i)
    for (const double w : samples[i].weights) weights[examples[i].name] += w;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (examples[i].building == without) continue;
    all.values.insert(all.values.end(), samples[i].values.begin(), samples[i].values.end());
    all.one_place.insert(all.one_place.end(), samples[i].one_place.begin(),
                         samples[i].one_place.end());
    const double share = (examples[i].kind == "robot"       ? options.robot_weight
                          : examples[i].kind == "generated" ? options.plan_weight
                                                            : 1.0) /
                         std::sqrt(weights[examples[i].name]);
    for (const double w : samples[i].weights) all.weights.push_back(w * share);
  }
  return boost(all, options.boosting);
}

void print(const char* title, const std::vector<Example>& examples,
           const std::vector<RoomScores>& scores, bool each) {
  std::map<std::string, std::vector<RoomScores>> kinds;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (!examples[i].scored) continue;
    const RoomScores& s = scores[i];
    if (each)
      std::printf("  %-28s places %3.0f of %2zu  P %.3f R %.3f MCC %.3f F1 %.3f\n",
                  examples[i].name.c_str(), s.places, examples[i].rooms[0].size() - 1, s.precision,
                  s.recall, s.mcc, s.f1);
    kinds[examples[i].kind].push_back(s);
  }
  std::printf("%s\n", title);
  for (const auto& [kind, list] : kinds) {
    RoomScores m;
    for (const RoomScores& s : list) {
      const double n = static_cast<double>(list.size());
      m.precision += s.precision / n, m.recall += s.recall / n, m.mcc += s.mcc / n,
          m.f1 += s.f1 / n;
    }
    std::printf("  %-12s P %.3f R %.3f MCC %.3f F1 %.3f\n", kind.c_str(), m.precision, m.recall,
                m.mcc, m.f1);
  }
  std::fflush(stdout);
}

/// What would become of the scores if pairs were joined more, or less, easily.
void tryLeaning(const std::vector<Example>& examples,
                const std::map<std::string, BoostedTrees>& models, const Options& options) {
  for (const double lean : options.leans) {
    std::vector<RoomScores> scores;
    scores.reserve(examples.size());
    for (const Example& e : examples)
      scores.push_back(run(e, &models.at(e.building), options, nullptr, lean));
    print(("building left out, odds changed by " + std::to_string(lean)).c_str(), examples, scores,
          false);
  }
}

void write(const std::string& folder, const BoostedTrees& model) {
  hyselam::writeFileAtomically(folder + "/border_model_nodes.inc", [&](std::ostream& out) {
    out.precision(6);
    for (const TreeNode& n : model.nodes())
      out << '{' << n.feature << ", " << n.threshold << ", " << n.left << "},\n";
  });
  hyselam::writeFileAtomically(folder + "/border_model_roots.inc", [&](std::ostream& out) {
    for (const int root : model.roots()) out << root << ",\n";
  });
}

int train(int argc, char** argv) {
  Options options;
  bool each = false;
  CLI::App app("Learns which neighbouring parts of a map are one place");
  app.add_option("DATA", options.data, "folder with index.csv, maps and rooms")->required();
  app.add_option("--out", options.out, "folder for border_model_*.inc");
  app.add_option("--rounds", options.rounds, "times that the borders met are added");
  app.add_option("--scales", options.scales, "of the maps")->delimiter(',');
  app.add_option("--robot-weight", options.robot_weight, "of robot-built maps");
  app.add_option("--plans", options.plans, "generated floors besides");
  app.add_option("--plan-weight", options.plan_weight, "of generated floors");
  app.add_option("--without", options.without, "features")->delimiter(',');
  app.add_option("--leans", options.leans, "changes of the odds that are tried at the end")
      ->delimiter(',');
  app.add_option("--trees", options.boosting.trees);
  app.add_option("--leaves", options.boosting.leaves);
  app.add_option("--rate", options.boosting.rate);
  app.add_option("--l2", options.boosting.l2);
  app.add_option("--least-hessian", options.boosting.least_hessian);
  app.add_option("--feature-share", options.boosting.feature_share);
  app.add_option("--seed", options.boosting.seed);
  app.add_option("--clutter", options.segmentation.clutter);
  app.add_flag("--each", each, "print every map");
  options.boosting.monotone = {0, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 0, 0, 0, -1, -1, 0, 0, -1, 0, 1};
  return hyselam::runTool(argc, argv, app, [&]() -> nlohmann::json {
    const std::vector<Example> examples = load(options);
    std::set<std::string> buildings;
    for (const Example& e : examples) buildings.insert(e.building);
    PerExample samples(examples.size());
    for (std::size_t i = 0; i < examples.size(); ++i)
      run(examples[i], nullptr, options, &samples[i]);
    BoostedTrees all;
    for (int round = 0; round < options.rounds; ++round) {
      const bool last = round + 1 == options.rounds;
      std::map<std::string, BoostedTrees> models;
      all = fit(examples, samples, "", options);
      for (const std::string& b : buildings) models[b] = fit(examples, samples, b, options);
      PerExample met(examples.size());
      std::vector<RoomScores> seen, unseen;
      for (std::size_t i = 0; i < examples.size(); ++i) {
        const BoostedTrees& other = models[examples[i].building];
        run(examples[i], &all, options, &met[i]);
        run(examples[i], &other, options, &met[i]);
        seen.push_back(run(examples[i], &all, options, nullptr));
        unseen.push_back(run(examples[i], &other, options, nullptr));
      }
      std::size_t count = 0;
      for (const Samples& s : samples) count += s.size();
      std::printf("round %d, %zu borders\n", round + 1, count);
      print("seen", examples, seen, false);
      print("building left out", examples, unseen, each && last);
      if (last) tryLeaning(examples, models, options);
      for (std::size_t i = 0; i < examples.size(); ++i) {
        Samples& s = samples[i];
        s.values.insert(s.values.end(), met[i].values.begin(), met[i].values.end());
        s.one_place.insert(s.one_place.end(), met[i].one_place.begin(), met[i].one_place.end());
        s.weights.insert(s.weights.end(), met[i].weights.begin(), met[i].weights.end());
      }
    }
    if (!options.out.empty()) write(options.out, all);
    return {};
  });
}

}  // namespace
}  // namespace hyselam_topo

int main(int argc, char** argv) {
  return hyselam_topo::train(argc, argv);
}
