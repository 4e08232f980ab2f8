#include "merge_patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "hyselam_common/union_find.hpp"
#include "partition.hpp"
#include "patch_rules.hpp"

namespace hyselam_objects {
namespace {

constexpr int kNone = Patches::kNone;
// Share of the contour of a fragment that its host must touch.
constexpr double kMinFragmentContact = 0.2;

class PatchMerger {
 public:
  PatchMerger(const SurfaceGrid& grid, const Patches& patches, const SegmentParams& params)
      : grid_(grid), patches_(patches), params_(params) {}

  std::vector<int> byRules() const {
    hyselam::UnionFind sets(patches_.count());
    joinByRules(grid_, patches_, params_, sets);
    return objects(sets);
  }

  std::vector<int> byOdds(const std::vector<PatchRelation>& relations,
                          const RelationModel& model) const {
    std::vector<PairOdds> pairs;
    for (const PatchRelation& relation : relations) {
      pairs.push_back({relation.first, relation.second,
                       model.oddsOfOneObject(relation, grid_.hasColors()) + params_.join_bias});
    }
    const std::vector<int> group = partitionByOdds(static_cast<int>(patches_.count()), pairs);
    hyselam::UnionFind sets(patches_.count());
    for (std::size_t p = 0; p < group.size(); ++p) sets.unite(static_cast<int>(p), group[p]);
    return objects(sets);
  }

 private:
  // Small fragments, such as a top seen at a flat angle, join the object that they are nearest to
  // along most of their contour.
  void mergeFragments(hyselam::UnionFind& sets) const {
    constexpr int kRounds = 4;  // fragments of fragments
    for (int round = 0; round < kRounds && mergeFragmentsOnce(sets); ++round) {
    }
  }

  bool mergeFragmentsOnce(hyselam::UnionFind& sets) const {
    std::vector<int> size(patches_.count(), 0);
    for (const int patch : patches_.all()) {
      if (patch != kNone) ++size[static_cast<std::size_t>(sets.find(patch))];
    }
    std::map<std::pair<int, int>, int> contacts;
    std::vector<int> contour(patches_.count(), 0);
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patches_[i] == kNone) continue;
      const int a = sets.find(patches_[i]);
      if (size[static_cast<std::size_t>(a)] >= params_.max_fragment_pixels) continue;
      grid_.forNeighbors(i, [&](std::size_t j) {
        const int b = patches_[j] == kNone ? kNone : sets.find(patches_[j]);
        if (a == b) return;
        ++contour[static_cast<std::size_t>(a)];
        const bool near = b != kNone && (grid_.point(i) - grid_.point(j)).norm() <
                                            static_cast<float>(params_.max_fragment_gap);
        if (near) ++contacts[{a, b}];
      });
    }
    std::vector<std::pair<int, int>> joins;
    for (std::size_t p = 0; p < patches_.count(); ++p) {
      int most = 0, host = kNone;
      for (auto it = contacts.lower_bound({static_cast<int>(p), 0});
           it != contacts.end() && it->first.first == static_cast<int>(p); ++it) {
        if (it->second <= most || size[static_cast<std::size_t>(it->first.second)] <= size[p]) {
          continue;
        }
        most = it->second;
        host = it->first.second;
      }
      const bool tiny = size[p] < params_.min_object_pixels;
      if (host != kNone && (tiny || most > kMinFragmentContact * contour[p])) {
        joins.emplace_back(static_cast<int>(p), host);
      }
    }
    for (const auto& [piece, host] : joins) sets.unite(piece, host);
    return !joins.empty();
  }

  std::vector<int> objects(hyselam::UnionFind& sets) const {
    mergeFragments(sets);
    std::vector<int> total(patches_.count(), 0);
    std::vector<float> nearest(patches_.count(), std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patches_[i] == kNone) continue;
      const auto root = static_cast<std::size_t>(sets.find(patches_[i]));
      ++total[root];
      nearest[root] = std::min(nearest[root], grid_.point(i).norm());
    }
    std::vector<int> order;
    for (std::size_t p = 0; p < patches_.count(); ++p) {
      if (total[p] >= params_.min_object_pixels) order.push_back(static_cast<int>(p));
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return nearest[static_cast<std::size_t>(a)] < nearest[static_cast<std::size_t>(b)];
    });
    std::vector<int> number(patches_.count(), kNone);
    for (std::size_t k = 0; k < order.size(); ++k) {
      number[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
    }
    std::vector<int> out(grid_.size(), kNone);
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      if (patches_[i] != kNone) out[i] = number[static_cast<std::size_t>(sets.find(patches_[i]))];
    }
    return out;
  }

  const SurfaceGrid& grid_;
  const Patches& patches_;
  const SegmentParams& params_;
};

}  // namespace

std::vector<int> mergePatches(const SurfaceGrid& grid, const Patches& patches,
                              const SegmentParams& params, const RelationModel& model) {
  return PatchMerger(grid, patches, params).byOdds(relatePatches(grid, patches, params), model);
}

std::vector<int> mergePatchesByRules(const SurfaceGrid& grid, const Patches& patches,
                                     const SegmentParams& params) {
  return PatchMerger(grid, patches, params).byRules();
}

}  // namespace hyselam_objects
