// Gradient boosting of small trees on a logistic loss (Friedman 2001; second order and histograms
// as in XGBoost), with monotone features. Single thread, seeded: the same samples give the same
// trees.
#pragma once

#include <cstdint>
#include <vector>

#include "hyselam_gr2to/segmentation/boosted_trees.hpp"

namespace hyselam_topo {

struct Samples {
  int features = 0;
  std::vector<double> values;  ///< features per sample
  std::vector<std::uint8_t> one_place;
  std::vector<double> weights;

  std::size_t size() const { return one_place.size(); }
};

struct BoostingParams {
  int trees = 120;
  int leaves = 6;
  double rate = 0.1;
  double l2 = 5.0;
  double min_hessian = 3.0;    ///< in a leaf; weights are scaled to a mean of 1
  double feature_share = 0.5;  ///< looked at by a tree
  double sample_share = 0.7;   ///< looked at by a tree
  std::vector<int> monotone;   ///< per feature: 1 odds rise with it, -1 fall, 0 (or absent) either
  std::uint64_t seed = 1;
};

BoostedTrees boost(const Samples& samples, const BoostingParams& params);

}  // namespace hyselam_topo
