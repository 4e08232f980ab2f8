// What slam_offline writes about changes, matches and regions; README.md names the columns. Loops:
// loop_table.hpp, words: word_tables.hpp.
#pragma once

#include <iomanip>
#include <string>
#include <vector>

#include "hyselam_common/atomic_file.hpp"
#include "ngram_slam/semantics/semantic_regions_io.hpp"
#include "ngram_slam/slam/present_map.hpp"
#include "ngram_slam/slam/region_graph.hpp"
#include "ngram_slam/slam/slam_engine.hpp"

namespace ngram_slam {

/// changes.csv: a line for each thing that came or went since the saved map.
/// @throws hyselam::InputError, as the others.
inline void writeChanges(const std::string& path, const std::vector<MapChange>& changes) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "kind,again,x,y,size,cells,probability\n";
    for (const MapChange& c : changes) {
      out << toString(c.kind) << ',' << (c.again ? 1 : 0) << ',' << c.center.x << ',' << c.center.y
          << ',' << c.size << ',' << c.cells.size() << ',' << c.probability << '\n';
    }
  });
}

/// matches.csv. x, y, theta: where the newer observation was made, in the frame of the older one;
/// by the scans where they fit, else as words have it: the same place. Verified: the scans fit, and
/// other places beside it say the same.
inline void writeMatches(const std::string& path, const std::vector<SlamMatch>& matches) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "stamp_a,stamp_b,level,n,direction,x,y,theta,verified,probability,tried,scans_fit\n";
    for (const SlamMatch& m : matches)
      out << std::setprecision(15) << m.stamp_newer << ',' << m.stamp_older << ','
          << std::setprecision(6) << m.level << ',' << m.n << ','
          << (m.direction == Direction::kReverse ? "reverse" : "same") << ',' << m.measured.x << ','
          << m.measured.y << ',' << m.measured.theta << ',' << (m.accepted ? 1 : 0) << ','
          << m.probability << ',' << (m.tried ? 1 : 0) << ',' << (m.verified ? 1 : 0) << '\n';
  });
}

/// regions.csv, of the regions of all runs.
inline void writeSemanticRegions(const std::string& path, const SlamEngine& engine) {
  std::vector<SemanticRegion> regions;
  for (const RegionNode& n : regionGraph(engine).nodes) {
    SemanticRegion r;
    r.first = n.first;
    r.last = n.last;
    r.semantic_class = n.semantic_class;
    r.confidence = n.confidence;
    regions.push_back(r);
  }
  const ObservationStore& observations = engine.recognizer().observations();
  std::vector<double> stamps;
  for (std::uint32_t i = 0; i < observations.size(); ++i) stamps.push_back(observations.stamp(i));
  writeRegions(path, regions, stamps);
}

}  // namespace ngram_slam
