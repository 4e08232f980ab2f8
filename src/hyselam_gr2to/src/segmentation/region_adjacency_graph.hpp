// Third step of the segmentation: basins as the nodes of a region adjacency graph (RAG), whose
// edges are the borders between them, with the figures that the features of a border are made from.
// They are kept up to date when regions merge.
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <vector>

#include "basins.hpp"
#include "corridor_basins.hpp"

namespace hyselam_topo {

/// The passage at the widest point of a border, and the walls that carry on its line.
struct Passage {
  cv::Point at{-1, -1};    ///< cell of the widest point
  double width = 0.0;      ///< of the shortest chord through it [m]
  double weaker_wall = 0;  ///< share of solid cells along the chord's line behind its two ends
  double stronger_wall = 0;
  int furniture = 0;  ///< how many of its ends are furniture
  /// The border's clearance by the largest one within 1.5 m in either of the two first basins, the
  /// lower of these: near 1 where nothing narrows the way, as across a corridor that is bent.
  double evenness = 0.0;
};

/// What else is known of a map when its borders are measured.
struct BorderContext {
  CorridorBasins corridors;  ///< along which the basins are cut
  cv::Mat furniture;         ///< CV_8U; empty: not known
};

struct RegionBorder {
  double open = 0.0;    ///< length without a wall [m]
  double beside = 0.0;  ///< of it along the side of a straight corridor, where a wall would be [m]
  double within = 0.0;  ///< of it within one [m]
  double ending = 0.0;  ///< of it across the end of one, in the middle of a basin [m]
  double wall = 0.0;    ///< length of thin wall between the two [m]
  double clearance = 0.0;  ///< largest on the open part [m]
  Passage passage;
};

struct RegionNode {
  double area = 0.0;       ///< [m^2]
  double clearances = 0;   ///< sum over the area [m^3]
  double peak = 0.0;       ///< largest clearance [m]
  double corridor = 0.0;   ///< of the area in straight corridors [m^2]
  double perimeter = 0.0;  ///< walls and open borders [m]
  std::vector<cv::Point> hull;
  double hull_area = 0.0;      ///< [m^2]
  bool alive = true;           ///< false: has become part of another
  std::map<int, int> borders;  ///< neighbour to index in RegionAdjacencyGraph::borders
};

class RegionAdjacencyGraph {
 public:
  /// `clearance`: CV_32F, the distance map [cells] that the basins are of.
  RegionAdjacencyGraph(const cv::Mat& clearance, const Basins& basins, double resolution,
                       const BorderContext& context = {});

  int size() const { return static_cast<int>(nodes_.size()) - 1; }
  /// 1 .. size(), as the basins are numbered.
  const RegionNode& node(int i) const { return nodes_[static_cast<std::size_t>(i)]; }
  const RegionBorder& border(int index) const { return borders_[static_cast<std::size_t>(index)]; }
  double resolution() const { return resolution_; }

  /// Makes `gone` part of `kept`, its neighbour.
  void merge(int kept, int gone);
  /// The living node that a basin has become part of.
  int root(int basin) const;

 private:
  RegionNode& at(int i) { return nodes_[static_cast<std::size_t>(i)]; }
  RegionBorder& between(int a, int b);
  void measureNodes(const cv::Mat& clearance, const cv::Mat& labels);
  void measureCorridors(const CorridorBasins& corridors, const cv::Mat& labels);
  void measureBorders(const cv::Mat& clearance, const cv::Mat& labels, const cv::Mat& reach,
                      const CorridorBasins& corridors);
  void setHull(RegionNode& node) const;

  double resolution_;
  std::vector<RegionNode> nodes_;  // [0] is not used
  std::vector<RegionBorder> borders_;
  std::vector<int> merged_into_;
};

}  // namespace hyselam_topo
