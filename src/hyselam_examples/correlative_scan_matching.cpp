// The scan of a corner is found in a map, 0.8 m and 20 degrees from the guess.
#include <cstdio>

#include "hyselam_scan_matching/correlative_matcher.hpp"
#include "hyselam_scan_matching/icp.hpp"

using namespace hyselam_scan_matching;  // NOLINT: a program, not a header

int main() {
  SurfacePoints corner;  // two walls, seen from the room between them
  for (double t = 0.0; t < 3.0; t += 0.05) corner.push_back({t, 0.0, 0.0, 1.0});
  for (double t = 0.0; t < 2.0; t += 0.05) corner.push_back({0.0, t, 1.0, 0.0});
  SurfaceMap map;
  map.insert({}, corner);
  map.finish();

  const hyselam::Pose2 truth{1.0, 0.8, hyselam::radians(20.0)};
  const SurfacePoints scan = transformed(truth.inverse(), corner);
  const auto match = CorrelativeMatcher(map).match(scan, {1.5, 0.2, 0.0});
  if (!match) return 1;
  const IcpResult aligned = alignIcp(scan, map, match->pose);
  std::printf("score %.1f\n", match->score);
  std::printf("pose %.2f m  %.2f m  %.0f deg\n", aligned.pose.x, aligned.pose.y,
              hyselam::degrees(aligned.pose.theta));
  return 0;
}
