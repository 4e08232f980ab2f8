#include "border_training.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <set>

#include "hyselam_common/errors.hpp"
#include "segmentation/agglomeration.hpp"
#include "segmentation/describe_border.hpp"

namespace hyselam_topo {
namespace {

/// What decides before there are trees: the border's clearance against the smaller peak.
constexpr double kFirstRatio = 0.75;

/// Samples of one example, apart, so that a building can be left out.
using SamplesOfExamples = std::vector<Samples>;

/// Of what may only raise the odds of one place (1) or lower them (-1).
std::vector<int> monotoneFeatures() {
  std::vector<int> monotone(kBorderFeatureCount, 0);
  for (const BorderFeature f :
       {BorderFeature::kClearanceToSmallerPeak, BorderFeature::kClearanceToLargerPeak,
        BorderFeature::kClearanceToSmallerMean, BorderFeature::kClearanceToLargerMean,
        BorderFeature::kOpenShare, BorderFeature::kJointSolidity, BorderFeature::kSolidityGain,
        BorderFeature::kOpenToSmallerPerimeter, BorderFeature::kJointRectangularity}) {
    monotone[static_cast<std::size_t>(f)] = 1;
  }
  for (const BorderFeature f : {BorderFeature::kWeakerWall, BorderFeature::kStrongerWall,
                                BorderFeature::kWallToSmallerPerimeter}) {
    monotone[static_cast<std::size_t>(f)] = -1;
  }
  return monotone;
}

/// The room in which most cells lie; 0: none.
int mainRoom(const std::vector<int>& cells) {
  const auto most = std::max_element(cells.begin() + 1, cells.end());
  return *most > 0 ? static_cast<int>(most - cells.begin()) : 0;
}

/// The cells per room of the regions of a graph while they merge.
class RoomsOfRegions {
 public:
  explicit RoomsOfRegions(const Example& example)
      : rooms_(example.rooms), alive_(rooms_.size(), 1) {}

  /// Regions keep the smaller number: what merged since the last call is added there.
  void follow(const RegionAdjacencyGraph& graph) {
    for (std::size_t i = 1; i < rooms_.size(); ++i) {
      if (alive_[i] == 0 || graph.node(static_cast<int>(i)).alive) continue;
      alive_[i] = 0;
      std::vector<int>& kept = rooms_[static_cast<std::size_t>(graph.root(static_cast<int>(i)))];
      for (std::size_t room = 0; room < kept.size(); ++room) kept[room] += rooms_[i][room];
    }
  }
  int mainRoomOf(int region) const { return mainRoom(rooms_[static_cast<std::size_t>(region)]); }
  RoomScores scores() const {
    std::vector<std::vector<int>> places;
    for (std::size_t i = 1; i < rooms_.size(); ++i) {
      if (alive_[i] != 0) places.push_back(rooms_[i]);
    }
    return scoreRooms(places, static_cast<int>(rooms_[0].size()) - 1);
  }

 private:
  std::vector<std::vector<int>> rooms_;
  std::vector<char> alive_;
};

void addSample(const RegionAdjacencyGraph& graph, int a, int b, const BorderFeatures& features,
               const RoomsOfRegions& rooms, Samples& samples) {
  const int room_a = rooms.mainRoomOf(a), room_b = rooms.mainRoomOf(b);
  if (room_a == 0 || room_b == 0) return;
  const double smaller = std::min(graph.node(a).area, graph.node(b).area);
  samples.values.insert(samples.values.end(), features.values.begin(), features.values.end());
  samples.one_place.push_back(room_a == room_b);
  samples.weights.push_back(std::min(smaller, 3.0) / 3.0 + 0.05);
}

BorderFeatures usedFeatures(const RegionAdjacencyGraph& graph, int a, int b,
                            const BorderTrainingOptions& options) {
  BorderFeatures features = describeBorder(graph, a, b);
  for (const BorderFeature f : options.without) features[f] = 0.0;
  return features;
}

/// Merges regions by the trees' own odds, or without trees by one ratio, and adds the borders that
/// are met on the way.
void gatherSamples(const Example& example, const BoostedTrees* trees,
                   const BorderTrainingOptions& options, Samples& samples) {
  RegionAdjacencyGraph graph = example.graph;
  RoomsOfRegions rooms(example);
  agglomerate(graph, [&](const RegionAdjacencyGraph& g, int a, int b) {
    const BorderFeatures features = usedFeatures(g, a, b, options);
    rooms.follow(g);
    addSample(g, a, b, features, rooms, samples);
    if (trees != nullptr) return (*trees)(features.values.data());
    return features[BorderFeature::kClearanceToSmallerPeak] - std::log(kFirstRatio);
  });
}

/// Merges regions as the segmentation does. `offset`: added to the odds.
RoomScores scoresOf(const Example& example, const BoostedTrees& trees,
                    const BorderTrainingOptions& options, double offset = 0.0) {
  const BorderModel model(trees, {});
  RegionAdjacencyGraph graph = example.graph;
  RoomsOfRegions rooms(example);
  agglomerate(graph, [&](const RegionAdjacencyGraph& g, int a, int b) {
    return model.oddsOfOnePlace(usedFeatures(g, a, b, options)) + offset;
  });
  rooms.follow(graph);
  return rooms.scores();
}

/// Trees of all examples but those of the building `without`.
BoostedTrees fit(const std::vector<Example>& examples, const SamplesOfExamples& samples,
                 const std::string& without, const BorderTrainingOptions& options) {
  Samples all;
  all.features = static_cast<int>(kBorderFeatureCount);
  // Every map counts by the root of its weight: many rooms say more, but not as many times more.
  std::map<std::string, double> weights;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    for (const double w : samples[i].weights) weights[examples[i].name] += w;
  }
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (examples[i].building == without) continue;
    const Samples& s = samples[i];
    all.values.insert(all.values.end(), s.values.begin(), s.values.end());
    all.one_place.insert(all.one_place.end(), s.one_place.begin(), s.one_place.end());
    const double share = (examples[i].kind == "robot"       ? options.robot_weight
                          : examples[i].kind == "generated" ? options.plan_weight
                                                            : 1.0) /
                         std::sqrt(weights[examples[i].name]);
    for (const double w : s.weights) all.weights.push_back(w * share);
  }
  BoostingParams boosting = options.boosting;
  boosting.monotone = monotoneFeatures();
  return boost(all, boosting);
}

void append(const Samples& more, Samples& samples) {
  samples.values.insert(samples.values.end(), more.values.begin(), more.values.end());
  samples.one_place.insert(samples.one_place.end(), more.one_place.begin(), more.one_place.end());
  samples.weights.insert(samples.weights.end(), more.weights.begin(), more.weights.end());
}

/// "furnished MCC 0.925 F1 0.960, generated ...", the means of each kind; logs them as a table.
std::string summarize(const std::string& title, const std::vector<Example>& examples,
                      const std::vector<RoomScores>& scores, bool each, std::ostream& log) {
  char line[200];
  std::map<std::string, std::vector<RoomScores>> kinds;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (!examples[i].scored) continue;
    const RoomScores& s = scores[i];
    if (each) {
      std::snprintf(line, sizeof line,
                    "  %-28s places %3.0f of %2zu  P %.3f R %.3f MCC %.3f F1 %.3f\n",
                    examples[i].name.c_str(), s.places, examples[i].rooms[0].size() - 1,
                    s.precision, s.recall, s.mcc, s.f1);
      log << line;
    }
    kinds[examples[i].kind].push_back(s);
  }
  log << title << '\n';
  std::string summary;
  for (const auto& [kind, list] : kinds) {
    RoomScores m;
    const double n = static_cast<double>(list.size());
    for (const RoomScores& s : list) {
      m.precision += s.precision / n;
      m.recall += s.recall / n;
      m.mcc += s.mcc / n;
      m.f1 += s.f1 / n;
    }
    std::snprintf(line, sizeof line, "  %-12s P %.3f R %.3f MCC %.3f F1 %.3f\n", kind.c_str(),
                  m.precision, m.recall, m.mcc, m.f1);
    log << line << std::flush;
    std::snprintf(line, sizeof line, "MCC %.3f F1 %.3f", m.mcc, m.f1);
    summary += (summary.empty() ? "" : ", ") + kind + " " + line;
  }
  return summary;
}

/// What would become of the scores if pairs were merged more, or less, easily.
void tryOffsets(const std::vector<Example>& examples,
                const std::map<std::string, BoostedTrees>& models,
                const BorderTrainingOptions& options, std::ostream& log) {
  for (const double offset : options.odds_offsets) {
    std::vector<RoomScores> scores;
    scores.reserve(examples.size());
    for (const Example& e : examples) {
      scores.push_back(scoresOf(e, models.at(e.building), options, offset));
    }
    summarize("building left out, odds changed by " + std::to_string(offset), examples, scores,
              false, log);
  }
}

}  // namespace

TrainedBorderModel trainBorderModel(const std::vector<Example>& examples,
                                    const BorderTrainingOptions& options, std::ostream& log) {
  std::set<std::string> buildings;
  for (const Example& e : examples) buildings.insert(e.building);
  SamplesOfExamples samples(examples.size());
  for (std::size_t i = 0; i < examples.size(); ++i) {
    gatherSamples(examples[i], nullptr, options, samples[i]);
  }
  TrainedBorderModel trained;
  for (int round = 0; round < options.rounds; ++round) {
    const bool last = round + 1 == options.rounds;
    std::size_t count = 0;
    for (const Samples& s : samples) count += s.size();
    if (count == 0) throw hyselam::InputError("training data", "", "has no borders in rooms");
    trained.trees = fit(examples, samples, "", options);
    std::map<std::string, BoostedTrees> models;
    for (const std::string& b : buildings) models[b] = fit(examples, samples, b, options);
    std::vector<RoomScores> in_sample, left_out;
    SamplesOfExamples met(examples.size());
    for (std::size_t i = 0; i < examples.size(); ++i) {
      const BoostedTrees& other = models[examples[i].building];
      gatherSamples(examples[i], &trained.trees, options, met[i]);
      gatherSamples(examples[i], &other, options, met[i]);
      in_sample.push_back(scoresOf(examples[i], trained.trees, options));
      left_out.push_back(scoresOf(examples[i], other, options));
    }
    log << "round " << round + 1 << ", " << count << " borders\n";
    trained.in_sample = summarize("in sample", examples, in_sample, false, log);
    trained.left_out =
        summarize("building left out", examples, left_out, options.each && last, log);
    if (last) tryOffsets(examples, models, options, log);
    if (last) trained.without = models;
    for (std::size_t i = 0; i < examples.size(); ++i) append(met[i], samples[i]);
  }
  return trained;
}

}  // namespace hyselam_topo
