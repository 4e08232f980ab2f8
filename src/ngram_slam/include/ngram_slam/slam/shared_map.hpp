// One map of several robots that map at the same time: merged again and again while they drive.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ngram_slam/slam/map_merging.hpp"
#include "ngram_slam/slam/told_graph.hpp"

namespace ngram_slam {

struct SharedMapParams {
  MapMergingParams merging;
  /// Maps of robots that began another one since, >= 0: the least ones are given up.
  int max_former_maps = 20;

  void describe(hyselam::ParameterVisitor& visit);
  /// @throws hyselam::ParameterError
  void validate() const;
};

/// Where a robot is.
struct RobotInSharedMap {
  std::size_t keyframes = 0;  ///< with those of its former maps
  /// The frame of its map in the shared one, by its newest keyframe; nothing if it is not in it.
  std::optional<hyselam::Pose2> map_in_shared;
  int ties = 0;  ///< loops to the other robots, of maps that are known still
};

/// Of the shared map at one time, ready to be drawn and saved.
struct SharedMapState {
  SlamState state;  ///< with the loops between the robots
  std::vector<std::size_t> robot_of_run;
};

/// Each robot tells its graph (ToldGraph). From time to time all are merged (mergeMaps(), from the
/// start: nothing is taken over from the last time but the frame). Meanwhile keyframes that came
/// since lie where the last ones of their run that were merged say.
///
/// The shared map is the merged map of most robots, among equals the one that it was, else that of
/// the first robot; until anything is merged, that of the first robot which has one. While it is of
/// one robot's map alone, its poses are those of that robot's SLAM. A robot that begins another map
/// leaves its former one, unless the new one goes on with it. Not thread-safe; deterministic.
class SharedMap {
 public:
  /// @throws hyselam::ParameterError
  SharedMap(std::vector<std::string> robots, const SharedMapParams& params = {});

  GraphQuestion question(std::size_t robot, std::uint32_t max_keyframes) const {
    return told_[robot].question(max_keyframes);
  }
  /// Adds what a robot answered. Whether there is something new.
  /// @throws hyselam::InputError as ToldGraph::add(); what is known stays.
  bool add(std::size_t robot, GraphPart part);

  /// Which map of a robot.
  struct Key {
    std::size_t robot = 0;
    std::string map;
    bool operator==(const Key& o) const { return robot == o.robot && map == o.map; }
    bool operator!=(const Key& o) const { return !(*this == o); }
  };
  struct Work {
    std::vector<Key> keys;  // of the sessions
    std::vector<MapSession> sessions;
    std::vector<std::vector<std::uint32_t>> runs;  // of their keyframes, without gaps
  };
  /// What is to be merged: nothing if there is nothing new since, or less than two maps.
  std::optional<Work> takeWork();
  /// Slow, and needs nothing of a SharedMap but its parameters. Takes the sessions' states. What
  /// `progress` throws ends it.
  static MergedMaps merge(Work* work, const MapMergingParams& params,
                          const MergingProgress& progress = {});
  /// What was taken was not merged: there is work again.
  void giveBack() { changed_ = true; }
  void apply(const Work& work, const MergedMaps& merged);

  SharedMapState state() const;
  std::vector<RobotInSharedMap> robots() const;
  int merges() const { return merges_; }
  int formerMapsGivenUp() const { return given_up_; }
  /// Of the last merging: what was left out or is doubtful, and why.
  const std::vector<LeftOutSession>& remarks() const { return remarks_; }
  const SharedMapParams& params() const { return params_; }

 private:
  struct Session {
    Key key;
    bool present = true;  // the robot goes on with it
    SlamState state;
    /// Where its first keyframes lie in the shared map; by keyframe, nothing if it is not in it.
    std::vector<std::optional<hyselam::Pose2>> placed;
    bool isPlaced() const;
  };
  struct Tie {
    Key older, newer;
    SlamLoop loop;  // numbers of the sessions
  };
  using Corrections = std::vector<std::optional<hyselam::Pose2>>;  // by run

  /// Of a merged map by what they are in the sessions: session, number.
  using Keyframes = std::vector<std::pair<std::size_t, std::size_t>>;

  Session* find(const Key& key);
  const Session* presentOf(std::size_t robot) const;
  void update(std::size_t robot);
  void giveUpFormerMaps();
  static Corrections correctionsOf(const Session& session);
  static void placeAlone(Session* session);
  bool isAnyPlacedBut(const Session* one) const;
  std::vector<std::size_t> sessionsByTime() const;
  std::optional<std::size_t> sessionOf(const Key& key, int keyframe) const;
  hyselam::Pose2 correctionOf(const MergedMap& map, const Keyframes& keyframes, const Work& work);

  std::vector<std::string> names_;
  SharedMapParams params_;
  std::vector<ToldGraph> told_;    // by robot
  std::vector<Session> sessions_;  // those that go on by robot, then the former ones by age
  std::vector<Tie> ties_;
  std::optional<Key> anchor_;  // the shared map keeps its frame
  std::vector<LeftOutSession> remarks_;
  bool changed_ = false;
  int merges_ = 0, given_up_ = 0;
};

}  // namespace ngram_slam
