// Gr2To for a map that changes a little at a time: looks again only at the places around the
// change.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "hyselam_gr2to/gr2to.hpp"

namespace hyselam_topo {

/// What update() is about beyond Gr2ToParams.
struct UpdateParams {
  double context = 2.5;   ///< [m] around a change that decide about its places, >= 0.5
  double largest = 0.15;  ///< share of the map to look at again at most; more is done from scratch
};

/// Remembers the last grid and what came of it.
///
/// A partial update segments the places that the change touches as if all others were walls, and
/// gives the pieces the labels of the places that they were, so the rest keeps labels, doors and
/// walls exactly. A place that reaches far beyond the change (a corridor) is cut at some distance
/// from it and joined again. The result is a valid segmentation, but not always the one that a
/// start from scratch gives: places far away are not weighed anew. It falls back to one where a
/// change is large, spread over the map, or cuts a far-reaching place in two. Not for use from two
/// threads at once.
class Gr2ToUpdater {
 public:
  explicit Gr2ToUpdater(const UpdateParams& params = {});

  /// The result for this grid, valid until the next call. From scratch the first time, when the
  /// geometry or the parameters are others than before, and in mode thesis.
  /// @throws as gr2to(); then the next call starts from scratch.
  const Gr2ToResult& update(const hyselam::OccupancyGrid& grid, const Gr2ToParams& params = {});

  enum class Way { kFromScratch, kPartial, kUnchanged };
  Way lastWay() const { return way_; }

 private:
  bool sameAsBefore(const hyselam::OccupancyGrid& grid, const Gr2ToParams& params) const;
  cv::Rect changedBox(const hyselam::OccupancyGrid& grid) const;
  bool updatePart(const hyselam::OccupancyGrid& grid, const cv::Rect& changed);
  int closeGaps(const std::set<int>& touched, std::set<int>* cut, std::set<int>* renewed,
                int places);
  void findBoxes();

  UpdateParams params_;
  Gr2ToParams used_;
  hyselam::OccupancyGrid grid_;
  std::optional<Gr2ToResult> result_;
  std::vector<cv::Rect> boxes_;  // by label: where its cells are
  Way way_ = Way::kFromScratch;
};

}  // namespace hyselam_topo
