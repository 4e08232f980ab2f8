// Gr2To for a map that changes a little at a time: segments only the places around the change
// again.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "hyselam_gr2to/gr2to.hpp"

namespace hyselam_topo {

struct Patch;
struct PlaceSelection;

/// Of Gr2ToUpdater, beside Gr2ToParams.
struct UpdateParams {
  double context = 2.5;  ///< [m] around a change that decide about its places, >= 0.5
  /// Share of the map that is segmented again at most, 0 .. 1; more is done from scratch.
  double max_share = 0.15;

  void describe(hyselam::ParameterVisitor& visit);
  void validate() const;  ///< @throws hyselam::ParameterError
};

/// Remembers the last grid and its result.
///
/// A partial update segments the places that the change touches as if all others were walls, and
/// gives the pieces the labels of the places that they were, so the rest keeps labels, doors and
/// walls exactly. A place that reaches far beyond the change (a corridor) is cut at some distance
/// from it and joined again. The result is a valid segmentation, but not always the one that a
/// start from scratch gives: places far away are not segmented again. It falls back to
/// one where a change is large, spread over the map, or cuts a far-reaching place in two. Not for
/// use from two threads at once.
class Gr2ToUpdater {
 public:
  explicit Gr2ToUpdater(const UpdateParams& params = {});

  /// The result for this grid, valid until the next call. From scratch the first time, when the
  /// geometry or the parameters are others than before, and in mode thesis.
  /// @throws as gr2to(); then the next call starts from scratch.
  const Gr2ToResult& update(const hyselam::OccupancyGrid& grid, const Gr2ToParams& params = {});

  enum class UpdateKind { kFromScratch, kPartial, kUnchanged };
  UpdateKind lastUpdate() const { return last_update_; }

 private:
  /// Labels of places that were segmented again, and how many labels there are then.
  struct Renewed {
    std::set<int> labels;
    int places = 0;
  };

  bool sameAsBefore(const hyselam::OccupancyGrid& grid, const Gr2ToParams& params) const;
  cv::Rect changedBox(const hyselam::OccupancyGrid& grid) const;
  /// False: the change has to be segmented from scratch.
  bool updatePart(const hyselam::OccupancyGrid& grid, const cv::Rect& changed);
  std::optional<Patch> choosePatch(const cv::Rect& changed) const;
  hyselam::OccupancyGrid patchGrid(const hyselam::OccupancyGrid& grid, const cv::Rect& changed,
                                   const Patch& patch) const;
  std::optional<Renewed> relabel(Patch& patch);
  void closeGaps(Patch& patch, Renewed& renewed);
  void updateDoors(const hyselam::OccupancyGrid& grid, const cv::Rect& box);
  void updatePlaces(const hyselam::OccupancyGrid& grid, const Patch& patch, const Renewed& renewed);
  PlaceSelection selectPlaces(const hyselam::OccupancyGrid& grid, const Patch& patch,
                              const Renewed& renewed) const;
  void findBoxes();
  cv::Rect& boxOf(int label) { return boxes_[static_cast<std::size_t>(label)]; }
  const cv::Rect& boxOf(int label) const { return boxes_[static_cast<std::size_t>(label)]; }
  int cellsIn(double meters) const;  // rounded up

  UpdateParams params_;
  Gr2ToParams used_;
  hyselam::OccupancyGrid grid_;
  std::optional<Gr2ToResult> result_;
  std::vector<cv::Rect> boxes_;  // by label: where its cells are
  UpdateKind last_update_ = UpdateKind::kFromScratch;
};

}  // namespace hyselam_topo
