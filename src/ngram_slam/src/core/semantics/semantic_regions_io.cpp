#include "ngram_slam/semantics/semantic_regions_io.hpp"

#include <iomanip>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"

namespace ngram_slam {

void writeRegions(const std::string& path, const std::vector<SemanticRegion>& regions,
                  const std::vector<double>& stamps) {
  for (const SemanticRegion& r : regions) {
    if (r.first > r.last || r.last >= stamps.size()) {
      throw hyselam::ParameterError("region", r.last, "within the observations");
    }
  }
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "first,last,stamp_begin,stamp_end,class,confidence\n";
    for (const SemanticRegion& r : regions) {
      out << r.first << ',' << r.last << ',' << std::setprecision(15) << stamps[r.first] << ','
          << stamps[r.last] << ',' << toString(r.semantic_class) << ',' << std::setprecision(4)
          << r.confidence << '\n';
    }
  });
}

}  // namespace ngram_slam
