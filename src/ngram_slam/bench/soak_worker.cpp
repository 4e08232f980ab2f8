// One life of a robot in a soak: goes on with the corpus on the disk, checks every observation of
// it, drives, recognises and saves, until enough words are written or it is killed. bench/soak
// starts it, kills it, and starts it again.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <sstream>

#include "hyselam_common/rng.hpp"
#include "hyselam_common/tool.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/words/corpus_journal.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header
using Clock = std::chrono::steady_clock;

/// A building of 40 corridors with 24 regions each, and a robot that visits them in random order
/// for ever. In one large region out of three a door stands open. The way is the same in every
/// life: visit by visit it follows from the seed alone.
class Way {
 public:
  explicit Way(std::uint64_t seed) : seed_(seed) {
    hyselam::Rng rng(seed);
    for (auto& corridor : corridors_) {
      for (std::size_t i = 0; i < corridor.size(); ++i) {
        Stretch& s = corridor[i];
        s.density = (rng.below(4) * 2 + i % 2 + 0.5) / 8.0;
        s.size = 8 + rng.below(i % 2 == 0 ? 30 : 14);
        s.turn = i % 2 == 0 || rng.below(2) == 0 ? 0.0 : rng.below(2) == 0 ? 1.57 : -1.57;
      }
    }
  }
  DensityObservation next() {
    while (at_ == visit_.size()) write();
    DensityObservation o;
    const Step& step = visit_[at_++];
    pose_ = pose_ * hyselam::Pose2{0.1, 0.0, step.turn};
    // A way of years does not leave its building.
    if (std::hypot(pose_.x, pose_.y) > 1000.0) pose_ = {0.0, 0.0, pose_.theta};
    o.base_in_odom = pose_;
    o.stamp = 0.2 * static_cast<double>(count_++);
    o.soft = step.density;
    o.frontiers = 2;
    return o;
  }

 private:
  struct Stretch {
    double density = 0.0;
    std::uint32_t size = 1;
    double turn = 0.0;
  };
  struct Step {
    double density, turn;
  };
  void write() {
    hyselam::Rng rng(seed_, 1 + visits_++);
    visit_.clear();
    at_ = 0;
    for (const Stretch& s : corridors_[rng.below(static_cast<std::uint32_t>(corridors_.size()))]) {
      const auto size = static_cast<std::uint32_t>(std::lround(s.size * rng.uniform(0.92, 1.08)));
      const bool door = size > 24 && rng.below(3) == 0;
      const std::uint32_t door_at = size / 4 + rng.below(size / 3);
      for (std::uint32_t i = 0; i < size; ++i) {
        const bool at_door = door && i >= door_at && i < door_at + 6;
        const double density = s.density + rng.uniform(-0.03, 0.03) + (at_door ? 0.125 : 0.0);
        visit_.push_back(
            {std::clamp(density, 0.0, 1.0), s.turn / size + rng.uniform(-0.004, 0.004)});
      }
    }
  }

  std::uint64_t seed_, visits_ = 0, count_ = 0;
  std::array<std::array<Stretch, 24>, 40> corridors_;
  std::vector<Step> visit_;
  std::size_t at_ = 0;
  hyselam::Pose2 pose_;
};

double residentMb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stod(line.substr(6)) / 1024.0;
  }
  return 0.0;
}

double msSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// One line for the one who started this, at once.
void tell(const std::string& line) {
  std::cout << line + "\n" << std::flush;
}

struct Options {
  std::string corpus;
  std::uint64_t seed = 1;
  std::uint32_t words = 1000000, save_every = 3000;
  bool improved = false;
};

nlohmann::json run(const Options& o) {
  const auto begin = Clock::now();
  CorpusJournal journal(o.corpus);
  CorpusJournal::Loaded loaded = journal.load();
  if (!loaded.remark.empty()) tell("cut " + loaded.remark);
  Way way(o.seed);
  const ObservationStore& known = loaded.corpus.observations;
  for (std::uint32_t i = 0; i < known.size(); ++i) {
    const DensityObservation expected = way.next();
    if (std::abs(known.soft(i) - expected.soft) > 1e-4 || known.stamp(i) != expected.stamp) {
      throw std::runtime_error("observation " + std::to_string(i) + " is not what was saved");
    }
  }
  NgramRecognizer r(o.improved ? NgramRecognizerParams::improved() : NgramRecognizerParams{},
                    std::move(loaded.corpus));
  std::ostringstream start;
  start << "loaded " << r.observations().size() << ' ' << r.text().positions() << ' '
        << msSince(begin) << ' ' << residentMb();
  tell(start.str());

  std::vector<double> word_ms, save_ms;
  std::size_t matches = 0;
  while (r.text().positions() < o.words) {
    const DensityObservation next = way.next();
    const auto t0 = Clock::now();
    const NgramRecognizerUpdate update = r.add(next);
    if (update.word) word_ms.push_back(msSince(t0));
    matches += update.matches.size();
    if (r.observations().size() % o.save_every != 0) continue;
    tell("saving");
    const auto t1 = Clock::now();
    journal.save(r.observations(), r.classes(), r.histogram());
    save_ms.push_back(msSince(t1));
    tell("saved " + std::to_string(r.observations().size()) + " " +
         std::to_string(r.text().positions()));
  }
  tell("saving");
  journal.save(r.observations(), r.classes(), r.histogram());
  tell("saved " + std::to_string(r.observations().size()) + " " +
       std::to_string(r.text().positions()));
  std::sort(word_ms.begin(), word_ms.end());
  std::sort(save_ms.begin(), save_ms.end());
  const auto part = [](const std::vector<double>& v, double share) {
    return v.empty() ? 0.0 : v[static_cast<std::size_t>(share * static_cast<double>(v.size() - 1))];
  };
  const auto words = static_cast<double>(r.text().positions());
  const nlohmann::json j = {
      {"words", r.text().positions()},
      {"alternative_words", r.text().words() - r.text().positions()},
      {"observations", r.observations().size()},
      {"runs", r.observations().runs()},
      {"way_km", 1e-4 * r.observations().size()},
      {"matches_of_last_life", matches},
      {"word_ms_median", part(word_ms, 0.5)},
      {"word_ms_p99", part(word_ms, 0.99)},
      {"word_ms_worst", part(word_ms, 1.0)},
      {"save_ms_median", part(save_ms, 0.5)},
      {"save_ms_worst", part(save_ms, 1.0)},
      {"file_mb", static_cast<double>(journal.fileBytes() + journal.journalBytes()) / 1e6},
      {"resident_mb", residentMb()},
      {"observation_bytes_per_word", static_cast<double>(r.observations().bytes()) / words},
      {"bytes_per_word", static_cast<double>(r.bytes()) / words}};
  tell("done " + j.dump());
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Goes on with a corpus: drives, recognises, saves; for bench/soak.", "soak_worker");
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("corpus", o.corpus, "file of the corpus")->required();
  app.add_option("--words", o.words, "ends with so many words");
  app.add_flag("--improved", o.improved, "reverse matches and probabilities too");
  app.add_option("--seed", o.seed, "of the way");
  app.add_option("--save-every", o.save_every, "observations between savings")
      ->check(CLI::PositiveNumber);
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
