#pragma once

#include "ngram_slam/slam/slam_types.hpp"

namespace ngram_slam {

/// A far loop that a signature proposed and the scans verified.
inline SlamLoop signatureLoop(int older, int newer) {
  SlamLoop l;
  l.older = older;
  l.newer = newer;
  l.source = LoopSource::kSignature;
  l.far = true;
  l.inlier_ratio = 0.8;
  l.fit = 0.97;
  return l;
}

}  // namespace ngram_slam
