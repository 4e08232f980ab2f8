#include <cstdlib>

#include "agglomeration.hpp"

namespace hyselam_topo {
namespace {

constexpr double kStep = 0.1;  // of the logarithms
constexpr int kLengths = 2;    // steps to either side
constexpr int kSaddles = 1;

}  // namespace

const BoostedTrees& borderModel() {
  static const BoostedTrees model(
      {
#include "border_model_nodes.inc"
      },
      {
#include "border_model_roots.inc"
      });
  return model;
}

double oddsOfOnePlace(const BoostedTrees& model, const BorderFeatures& border) {
  double sum = 0.0;
  int weights = 0;
  for (int i = -kLengths; i <= kLengths; ++i)
    for (int j = -kSaddles; j <= kSaddles; ++j) {
      const int weight = (kLengths + 1 - std::abs(i)) * (kSaddles + 1 - std::abs(j));
      sum += weight * model(resized(border, i * kStep, j * kStep).data());
      weights += weight;
    }
  return sum / weights;
}

}  // namespace hyselam_topo
