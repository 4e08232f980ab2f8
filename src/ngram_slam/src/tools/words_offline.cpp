// words_offline: recorded runs as words, and where the robot was before, without a master.
#include <iomanip>
#include <iostream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/folder.hpp"
#include "ngram_slam/matching/match_place.hpp"
#include "ngram_slam/semantics/semantic_regions_io.hpp"
#include "recognition_options.hpp"
#include "word_tables.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header

struct Options {
  RecognitionOptions recognition;
  std::string out, corpus;
};

struct PlacedMatch {
  NgramMatch match;
  ObservationPair place;
};

/// One line per match: the pair of observations that stands for it. x, y, theta is where the newer
/// one was made in the frame of the older one, as far as words can tell: the same place, and the
/// same heading or the opposite one. Nobody has verified it.
void writeMatches(const std::string& path, const NgramRecognizer& r,
                  const std::vector<PlacedMatch>& matches) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "stamp_a,stamp_b,level,n,direction,x,y,theta,verified,run_a,run_b,word_a,word_b,"
           "alignment_rms,chance,probability\n";
    for (const auto& [m, place] : matches) {
      const bool reverse = m.direction == Direction::kReverse;
      out << std::setprecision(15) << r.observations().stamp(place.newer) << ','
          << r.observations().stamp(place.older) << std::setprecision(6) << ',' << m.levels - 1
          << ',' << m.n << ',' << (reverse ? "reverse,0,0,3.14159,0," : "same,0,0,0,0,")
          << r.observations().runOf(place.newer) << ',' << r.observations().runOf(place.older)
          << ',' << m.newer << ',' << m.older << ',' << place.rms << ',' << m.chance << ','
          << m.probability << '\n';
    }
  });
}

nlohmann::json run(const Options& o) {
  NgramRecognizer r(o.recognition.params());
  hyselam::makeFolder(o.out);
  std::vector<PlacedMatch> matches;
  feed(o.recognition, r, [&](const NgramRecognizerUpdate& u) {
    if (u.requantised) matches.clear();
    // Now, as a robot would: later observations could move the pair a little.
    for (const NgramMatch& m : u.matches) {
      if (const auto place = placeOf(r, m)) matches.push_back({m, *place});
    }
  });
  writeWords(o.out + "/words.csv", r);
  writeMatches(o.out + "/matches.csv", r, matches);
  const std::vector<SemanticRegion> regions = semanticRegions(r.observations());
  std::vector<double> stamps;
  for (std::uint32_t i = 0; i < r.observations().size(); ++i) {
    stamps.push_back(r.observations().stamp(i));
  }
  writeRegions(o.out + "/regions.csv", regions, stamps);
  if (!o.corpus.empty()) CorpusFile::save(o.corpus, r.corpus());
  const auto words = static_cast<double>(r.text().words());
  nlohmann::json j = {{"observations", r.observations().size()},
                      {"words", r.text().positions()},
                      {"alternative_words", r.text().words() - r.text().positions()},
                      {"classes", r.classes().list().size()},
                      {"requantisations", r.requantisations()},
                      {"matches", matches.size()},
                      {"regions", regions.size()},
                      {"comparisons", r.counters().comparisons},
                      {"bytes_per_word", words > 0 ? static_cast<double>(r.bytes()) / words : 0.0}};
  std::cout << j.dump(2) << "\n";
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Writes recorded runs as words, the places that are recognised, and kinds of regions.",
      "words_offline");
  Options o;
  o.recognition.addTo(app);
  app.add_option("--out", o.out, "folder for words.csv, matches.csv and regions.csv")->required();
  app.add_option("--corpus", o.corpus, "file for the text, to go on with later");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
