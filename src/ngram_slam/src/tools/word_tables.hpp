// What the tools write about words.
#pragma once

#include <iomanip>
#include <string>

#include "hyselam_common/atomic_file.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"

namespace ngram_slam {

/// words.csv: README.md names the columns. @throws hyselam::InputError
inline void writeWords(const std::string& path, const NgramRecognizer& r) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << std::setprecision(15)
        << "word,level,first,last,run,stamp_begin,stamp_end,class,size,angle\n";
    const WordLattice& text = r.text();
    for (WordIndex i = 0; i < text.words(); ++i) {
      const DensityWord w = text.word(i);
      const std::uint32_t begin = text.observationBegin(i), end = text.observationEnd(i);
      out << i << ',' << w.level << ',' << w.first << ',' << w.last << ','
          << r.observations().runOf(begin) << ',' << r.observations().stamp(begin) << ','
          << r.observations().stamp(end - 1) << ',' << w.syllables.density_class << ','
          << w.syllables.size << ',' << std::setprecision(6) << w.syllables.angle
          << std::setprecision(15) << '\n';
    }
  });
}

}  // namespace ngram_slam
