// RapidCheck with a fixed seed, so that every run tries the same cases (RC_PARAMS overrides it).
// Include it only under #ifdef HYSELAM_HAVE_RAPIDCHECK.
#pragma once

#include <cstdlib>

namespace hyselam {
namespace testing {

struct FixedSeed {
  FixedSeed() { ::setenv("RC_PARAMS", "seed=20240229", 0); }
};
static const FixedSeed kFixedSeed;

}  // namespace testing
}  // namespace hyselam

#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "hyselam_common/pose2.hpp"

namespace hyselam {
namespace testing {

/// A number in [low, high].
inline rc::Gen<double> between(double low, double high) {
  return rc::gen::map(rc::gen::inRange(0, 1 << 30),
                      [=](int k) { return low + (high - low) * k / static_cast<double>(1 << 30); });
}

inline rc::Gen<Pose2> anyPose(double side = 100.0) {
  return rc::gen::map(
      rc::gen::tuple(between(-side, side), between(-side, side), between(-kPi, kPi)),
      [](const std::tuple<double, double, double>& t) {
        return Pose2{std::get<0>(t), std::get<1>(t), std::get<2>(t)};
      });
}

}  // namespace testing
}  // namespace hyselam
