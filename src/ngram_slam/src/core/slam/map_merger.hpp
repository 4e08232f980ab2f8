// The work of mergeMaps(), for its own files only.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ngram_slam/slam/loop_candidates.hpp"
#include "ngram_slam/slam/loop_verifier.hpp"
#include "ngram_slam/slam/map_merging.hpp"
#include "ngram_slam/slam/map_questions.hpp"
#include "ngram_slam/slam/map_ties.hpp"
#include "ngram_slam/slam/placed_loops.hpp"
#include "ngram_slam/slam/run_connections.hpp"

namespace ngram_slam {

/// Sessions joined to one state, in which loops are found between its maps.
class MapMerger {
 public:
  MapMerger(const std::vector<SlamState>& sessions, const MapMergingParams& params,
            MergingProgress progress);
  void run();

  std::uint32_t runs() const { return static_cast<std::uint32_t>(session_of_run_.size()); }
  std::size_t sessionOf(std::uint32_t run) const { return session_of_run_[run]; }
  /// The first run of the map that a run belongs to now.
  std::uint32_t mapOf(std::uint32_t run) const { return connections_.mapOf(run); }
  const SlamState& state() const { return state_; }
  const MapMergingCounters& counters() const { return counters_; }
  std::vector<MapMeeting> meetings() const;
  struct TakenScan {
    std::size_t session;
    std::size_t number;  // in the session
    std::uint32_t map;
    hyselam::StampedPose2 pose;
  };
  std::vector<TakenScan> scans() const;

 private:
  const SlamKeyframe& keyframe(int k) const {
    return state_.keyframes[static_cast<std::size_t>(k)];
  }
  std::size_t sessionOfKeyframe(int k) const { return session_of_run_[keyframe(k).run]; }
  std::uint32_t mapOfKeyframe(int k) const { return connections_.mapOf(keyframe(k).run); }
  /// Whether two keyframes were in different maps when this began.
  bool areStrangers(int a, int b) const {
    return !given_.connected(keyframe(a).run, keyframe(b).run);
  }

  bool isMerged(std::uint32_t map) const;

  struct NearTry {
    int older, newer;
    bool fits;
  };

  // Far loops.
  void askAll(const std::string& step, double interval, int candidates);
  void askAroundVerified();
  bool isOpen(int older, int newer);
  void verifyFar(const std::string& step, const std::vector<SignatureCandidate>& candidates);
  std::vector<LoopVerification> verified(const std::vector<LoopTask>& tasks) const;
  void forEach(std::size_t n, const std::function<void(std::size_t)>& work) const;

  // Places on the drawn maps, in map_merger_places.cpp.
  static constexpr std::size_t kStretchesAtOnce = 64;
  using MapPair = std::pair<std::uint32_t, std::uint32_t>;  // the smaller name first
  /// A verified loop at a place.
  struct Placed {
    PlacedLoop placed;
    int last;  // keyframe that the stretch ends with
  };
  void tieByPlaces();
  MapPair mapsOf(const SlamLoop& loop) const;
  std::vector<int> stretches() const;
  void askPlaces();
  LoopTask placeTask(int last, const KnownPlace& place) const;
  bool areIndependent(const Placed& a, const Placed& b) const;
  std::vector<MapTie> hypothesesOf(const MapPair& maps) const;
  void tieByPlaces(const MapPair& maps);
  std::size_t maps() const;
  enum class Evidence { kNone, kFits, kAgainst };
  Evidence evidenceOf(const NearTry& t) const;
  bool isBorneOutByScans() const;

  // Ties and what follows from them.
  void settle();
  std::optional<MapTie> bestTieOfAll() const;
  void join(const MapTie& tie);
  enum class TieEvidence { kTooLittle, kBorneOut, kAgainst };
  TieEvidence evidenceFor(const MapTie& tie, const std::vector<std::uint32_t>& maps_before) const;
  /// What a tie changes.
  struct Untied {
    std::vector<std::uint32_t> map_of_run;
    std::vector<hyselam::Pose2> poses;  // of the keyframes
    std::vector<SlamLoop> loops;
  };
  Untied untied() const;
  double bend(const Untied& before) const;
  void withdraw(const Untied& before, const MapTie& tie, bool is_wrong);
  void addLoop(const SlamLoop& loop);
  bool believeWithinMaps();
  bool excludes(const SlamLoop& loop) const;
  std::vector<LoopTask> nearTasks();
  void closeNear(std::uint32_t run);
  void optimize(std::uint32_t map);
  void rebuildPathLengths();

  MapMergingParams params_;
  MergingProgress progress_;
  SlamState state_;
  std::vector<std::size_t> session_of_run_, session_of_scan_;
  RunConnections given_, connections_;
  GraphPathLengths path_lengths_;
  std::optional<MapQuestions> questions_;
  std::vector<SlamLoop> withdrawn_;  // of ties that were
  std::vector<SlamLoop> pending_;    // verified far loops that are not in the graph
  std::set<std::pair<int, std::uint32_t>> near_asked_;  // keyframe, a given map
  std::vector<bool> is_near_asked_;  // by keyframe: since its map was tied to another one
  std::vector<Placed> placed_;       // of the maps as they are
  MapMergingCounters counters_;
  std::vector<std::pair<int, std::uint32_t>> near_asked_since_;  // the last tie
  std::vector<NearTry> near_tries_;                              // since the last tie
  /// Ties of two maps of which too little is known yet: their support.
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> undecided_;
  int lengths_of_ = -1;  // keyframe of isOpen()
  std::vector<double> lengths_;
};

}  // namespace ngram_slam
