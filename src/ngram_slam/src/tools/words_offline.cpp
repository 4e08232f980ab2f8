// words_offline: recorded runs as words, and where the robot was before, without a master.
#include <filesystem>
#include <iomanip>
#include <iostream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "ngram_slam/alignment.hpp"
#include "recognition_options.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header

struct Options {
  RecognitionOptions recognition;
  std::string out, corpus;
};

void writeWords(const std::string& path, const Recogniser& r) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << std::setprecision(15)
        << "word,level,first,last,run,stamp_begin,stamp_end,class,size,angle\n";
    const Text& text = r.text();
    for (WordIndex i = 0; i < text.words(); ++i) {
      const Word w = text.word(i);
      const std::uint32_t begin = text.observationBegin(i), end = text.observationEnd(i);
      out << i << ',' << w.level << ',' << w.first << ',' << w.last << ','
          << r.observations().runOf(begin) << ',' << r.observations().stamp(begin) << ','
          << r.observations().stamp(end - 1) << ',' << w.syllables.density_class << ','
          << w.syllables.size << ',' << std::setprecision(6) << w.syllables.angle
          << std::setprecision(15) << '\n';
    }
  });
}

/// One line per match: the observations in the middle of its last pair of words, aligned.
void writeMatches(const std::string& path, const Recogniser& r, const std::vector<Match>& matches) {
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << std::setprecision(15)
        << "stamp_a,stamp_b,level,n,direction,run_a,run_b,word_a,word_b,alignment_rms\n";
    for (const Match& m : matches) {
      const auto pairs = alignedObservations(r.text(), r.observations(), {{m.newer, m.older}});
      if (pairs.empty()) continue;
      const ObservationPair& middle = pairs[pairs.size() / 2];
      out << r.observations().stamp(middle.newer) << ',' << r.observations().stamp(middle.older)
          << ',' << m.levels - 1 << ',' << m.n << ",same," << r.observations().runOf(middle.newer)
          << ',' << r.observations().runOf(middle.older) << ',' << m.newer << ',' << m.older << ','
          << std::setprecision(6) << middle.rms << std::setprecision(15) << '\n';
    }
  });
}

nlohmann::json run(const Options& o) {
  Recogniser r(o.recognition.params());
  std::error_code error;
  std::filesystem::create_directories(o.out, error);
  if (error) throw hyselam::InputError(o.out, "", "cannot be made: " + error.message());
  std::vector<Match> matches;
  feed(o.recognition, r, [&](const RecogniserUpdate& u) {
    if (u.requantised) matches.clear();
    matches.insert(matches.end(), u.matches.begin(), u.matches.end());
  });
  writeWords(o.out + "/words.csv", r);
  writeMatches(o.out + "/matches.csv", r, matches);
  if (!o.corpus.empty()) CorpusFile::save(o.corpus, r.corpus());
  const auto words = static_cast<double>(r.text().words());
  const nlohmann::json j = {
      {"observations", r.observations().size()},
      {"words", r.text().positions()},
      {"alternative_words", r.text().words() - r.text().positions()},
      {"classes", r.classes().list().size()},
      {"requantisations", r.requantisations()},
      {"matches", matches.size()},
      {"comparisons", r.counters().comparisons},
      {"bytes_per_word", words > 0 ? static_cast<double>(r.bytes()) / words : 0.0}};
  std::cout << j.dump(2) << "\n";
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Writes recorded runs as words, and the places that are recognised.",
               "words_offline");
  Options o;
  o.recognition.addTo(app);
  app.add_option("--out", o.out, "folder for words.csv and matches.csv")->required();
  app.add_option("--corpus", o.corpus, "file for the text, to go on with later");
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
