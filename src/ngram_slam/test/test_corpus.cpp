// Alignment of raw densities, the corpus on the disk, and the whole way from observations to
// matches.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/matching/alignment.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::InputError;
using hyselam::ParameterError;
using hyselam::Pose2;
using hyselam::testing::fileBytes;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

namespace {

/// Density and heading along a building's circuit of 68 m: corridors, corners, niches.
struct Circuit {
  struct Stretch {
    double density;
    int steps;    // of 0.1 m
    double turn;  // over the stretch [rad]
  };
  std::vector<Stretch> stretches = {{0.31, 100, 0}, {0.56, 25, 1.57}, {0.31, 60, 0},
                                    {0.44, 20, 0},  {0.31, 90, 0},    {0.56, 28, 1.57},
                                    {0.19, 130, 0}, {0.69, 30, 1.57}, {0.31, 40, 0},
                                    {0.44, 15, 0},  {0.31, 70, 0},    {0.56, 22, 1.57}};
  std::size_t steps() const {
    std::size_t n = 0;
    for (const auto& s : stretches) n += static_cast<std::size_t>(s.steps);
    return n;
  }
};

/// Drives from stretch `from` through `count` stretches. `use` gets each observation.
template <typename Use>
void drive(const Circuit& c, std::size_t from, std::size_t count, hyselam::Rng& rng, Use&& use) {
  Pose2 pose{rng.uniform(-50, 50), rng.uniform(-50, 50), rng.uniform(-3, 3)};
  double stamp = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const auto& s = c.stretches[(from + k) % c.stretches.size()];
    for (int i = 0; i < s.steps; ++i) {
      pose = pose * Pose2{0.1, 0.0, s.turn / s.steps + rng.gaussian(0.0, 0.002)};
      DensityObservation o;
      o.stamp = stamp += 0.2;
      o.base_in_odom = pose;
      o.soft = s.density + rng.gaussian(0.0, 0.008);
      o.frontiers = 2;
      use(o);
    }
  }
}

NgramRecognizerParams circuitParams() {
  NgramRecognizerParams p;
  p.levels = 2;
  p.matcher.min_n = {5, 8};
  p.matcher.index_bits = 12;
  return p;
}

Corpus someCorpus() {
  NgramRecognizer r(circuitParams());
  hyselam::Rng rng(4);
  for (int run = 0; run < 2; ++run) {
    drive(Circuit(), static_cast<std::size_t>(run) * 5, 14, rng,
          [&](const DensityObservation& o) { r.add(o); });
    r.endRun();
  }
  Corpus c = r.corpus();
  c.histogram.assign(MeanShiftQuantizer::kBins, 3);
  return c;
}

std::vector<std::vector<double>> matchesOf(const std::vector<NgramMatch>& matches,
                                           const WordLattice& text) {
  std::vector<std::vector<double>> out;
  for (const NgramMatch& m : matches) {
    out.push_back({static_cast<double>(text.last(m.newer)), static_cast<double>(text.last(m.older)),
                   static_cast<double>(text.level(m.older)), static_cast<double>(m.levels),
                   static_cast<double>(m.n)});
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

TEST(Alignment, findsTheShiftOfEquation53) {
  ObservationStore store;
  hyselam::Rng rng(9);
  const auto density = [](int i) { return 0.4 + 0.2 * std::sin(0.13 * i) * std::sin(0.017 * i); };
  for (int run = 0; run < 2; ++run) {
    store.startRun();
    for (int i = 0; i < 300; ++i) {
      DensityObservation o;
      o.soft = density(i + 7 * run) + rng.gaussian(0.0, 0.005);  // run 1 starts 7 steps later
      store.append(o);
    }
  }
  // Observation s1 + i of run 1 is the place 7 steps on; so shift -7 brings it to s2 + i.
  const auto a = align(store, 300 + 100, 100, 60);
  ASSERT_TRUE(a.has_value());
  EXPECT_EQ(a->shift, -7);
  EXPECT_EQ(a->terms, 60u);
  EXPECT_LT(a->rms, 0.02);
  EXPECT_EQ(align(store, 300 + 100, 107, 60)->shift, 0);
  // Out of reach: strictly less than delta_max.
  AlignmentParams narrow;
  narrow.max_shift = 7;
  EXPECT_NE(align(store, 400, 100, 60, narrow)->shift, -7);
  narrow.max_shift = 8;
  EXPECT_EQ(align(store, 400, 100, 60, narrow)->shift, -7);
  // At the beginning of a run the terms before it do not exist.
  const auto edge = align(store, 300, 0, 20);
  ASSERT_TRUE(edge.has_value());
  EXPECT_EQ(edge->shift, -7);
  EXPECT_EQ(edge->terms, 13u);
  AlignmentParams strict;
  strict.min_overlap = 1.0;
  EXPECT_GE(align(store, 300, 0, 20, strict)->shift, 0);
  EXPECT_NE(messageOf<ParameterError>([&] {
              AlignmentParams p;
              p.max_shift = 0;
              align(store, 0, 300, 5, p);
            }),
            "");
}

TEST(Alignment, equalsATranscriptionOfEquation53) {
  ObservationStore store;
  hyselam::Rng rng(10);
  for (int i = 0; i < 2000; ++i) {
    DensityObservation o;
    o.soft = 0.5 + 0.4 * std::sin(0.05 * i * rng.uniform(0.99, 1.01));
    store.append(o);
  }
  for (int round = 0; round < 300; ++round) {
    const std::uint32_t s1 = 100 + rng.below(1700), s2 = 100 + rng.below(1700);
    const std::uint32_t n = 1 + rng.below(80);
    int best = 0;
    double least = 1e9;
    for (int d = -19; d < 20; ++d) {
      double sum = 0.0;
      for (int i = 0; i < static_cast<int>(n); ++i) {
        const double e = store.soft(static_cast<std::uint32_t>(static_cast<int>(s1) + i + d)) -
                         store.soft(s2 + static_cast<std::uint32_t>(i));
        sum += e * e;
      }
      if (sum < least || (sum == least && std::abs(d) < std::abs(best))) {
        least = sum;
        best = d;
      }
    }
    const auto a = align(store, s1, s2, n);
    ASSERT_TRUE(a.has_value());
    ASSERT_EQ(a->shift, best);
    ASSERT_NEAR(a->rms * a->rms * n, least, 1e-9);
  }
}

TEST(NgramRecognizer, recognizesTheSecondLapAndAlignsIt) {
  const Circuit c;
  NgramRecognizer r(circuitParams());
  hyselam::Rng rng(1);
  std::vector<std::size_t> place;  // of each observation, along the circuit
  std::size_t at = 0;
  drive(c, 0, 24, rng, [&](const DensityObservation& o) {
    place.push_back(at++ % c.steps());
    r.add(o);
  });
  r.endRun();
  // A second run, from another place in another frame.
  std::size_t begin = 0;
  for (std::size_t k = 0; k < 5; ++k) begin += static_cast<std::size_t>(c.stretches[k].steps);
  std::size_t matches = 0, wrong = 0, pairs = 0;
  double error = 0.0;
  at = begin;
  drive(c, 5, 16, rng, [&](const DensityObservation& o) {
    place.push_back(at++ % c.steps());
    const auto update = r.add(o);
    for (const NgramMatch& m : update.matches) {
      const auto ngram =
          longestNgram(r.text(), r.params().matcher.tolerance, {m.newer, m.older}, m.levels);
      ASSERT_EQ(static_cast<int>(ngram.size()), m.n);
      ++matches;
      for (const auto& p : alignedObservations(r.text(), r.observations(), {ngram.back()}, 5)) {
        const auto half = c.steps() / 2;
        const auto away =
            static_cast<double>((place[p.newer] + c.steps() - place[p.older] + half) % c.steps());
        const double apart = std::abs(away - static_cast<double>(half));
        wrong += apart > 20;
        error += apart;
        ++pairs;
      }
    }
  });
  EXPECT_GE(matches, 10u);
  EXPECT_GT(pairs, 50u);
  EXPECT_EQ(wrong, 0u);
  EXPECT_LT(error / static_cast<double>(pairs), 10.0);  // less than a metre
}

TEST(NgramRecognizer, newClassesRebuildWordsAndMatches) {
  NgramRecognizerParams p = circuitParams();
  p.learn_classes = true;
  NgramRecognizer learning(p);
  hyselam::Rng rng(2);
  std::vector<DensityObservation> all;
  drive(Circuit(), 0, 40, rng, [&](const DensityObservation& o) { all.push_back(o); });
  std::vector<NgramMatch> told;
  for (const DensityObservation& o : all) {
    const auto update = learning.add(o);
    if (update.requantised) told.clear();
    told.insert(told.end(), update.matches.begin(), update.matches.end());
  }
  ASSERT_GE(learning.requantisations(), 1);
  EXPECT_EQ(learning.classes().list().size(), 5u);  // the five densities of the circuit
  EXPECT_GT(told.size(), 10u);

  // The same as if the classes had been known from the beginning.
  DensityRegionBuilder regions(p.min_region);
  WordLattice text(p.levels, [&](std::uint32_t b, std::uint32_t e) {
    return angleVariation(learning.observations(), b, e);
  });
  for (std::uint32_t i = 0; i < learning.observations().size(); ++i) {
    if (const auto region =
            regions.add(learning.classes().classOf(learning.observations().soft(i)))) {
      text.push({region->density_class, region->size(),
                 static_cast<float>(
                     angleVariation(learning.observations(), region->begin, region->end))});
    }
  }
  NgramMatcher matcher(text, p.matcher);
  ASSERT_EQ(text.words(), learning.text().words());
  EXPECT_EQ(matchesOf(matcher.update(), text), matchesOf(told, learning.text()));
}

TEST(Corpus, isTheSameAfterSavingAndLoading) {
  const TemporaryDirectory dir;
  const Corpus saved = someCorpus();
  CorpusFile::save(dir / "a.corpus", saved);
  const Corpus loaded = CorpusFile::load(dir / "a.corpus");
  ASSERT_EQ(loaded.observations.size(), saved.observations.size());
  ASSERT_EQ(loaded.observations.runs(), 2u);
  EXPECT_EQ(loaded.observations.runBegin(1), saved.observations.runBegin(1));
  EXPECT_EQ(loaded.histogram, saved.histogram);
  ASSERT_EQ(loaded.classes.list().size(), saved.classes.list().size());
  for (std::uint32_t i = 0; i < saved.observations.size(); ++i) {
    const DensityObservation a = saved.observations[i], b = loaded.observations[i];
    ASSERT_EQ(a.stamp, b.stamp);
    ASSERT_EQ(a.base_in_odom.x, b.base_in_odom.x);
    ASSERT_EQ(a.base_in_odom.theta, b.base_in_odom.theta);
    ASSERT_EQ(a.soft, b.soft);
    ASSERT_EQ(a.hard, b.hard);
    ASSERT_EQ(a.frontiers, b.frontiers);
  }
  // Bytes do not depend on the way they came about.
  CorpusFile::save(dir / "b.corpus", loaded);
  EXPECT_EQ(fileBytes(dir / "a.corpus"), fileBytes(dir / "b.corpus"));
  EXPECT_EQ(dir.fileCount(), 2u);
  CorpusFile::save(dir / "empty", Corpus{});
  EXPECT_EQ(CorpusFile::load(dir / "empty").observations.size(), 0u);
}

TEST(Corpus, aRunAfterLoadingMatchesAsWithoutARestart) {
  for (const bool learn : {false, true}) {
    SCOPED_TRACE(learn ? "learnt classes" : "uniform classes");
    const TemporaryDirectory dir;
    NgramRecognizerParams p = circuitParams();
    p.learn_classes = learn;
    NgramRecognizer through(p);
    hyselam::Rng rng(6);
    drive(Circuit(), 0, 30, rng, [&](const DensityObservation& o) { through.add(o); });
    through.endRun();
    CorpusFile::save(dir / "c", through.corpus());
    NgramRecognizer resumed(p, CorpusFile::load(dir / "c"));
    ASSERT_EQ(resumed.text().words(), through.text().words());
    std::vector<NgramMatch> a, b;
    drive(Circuit(), 3, 30, rng, [&](const DensityObservation& o) {
      const auto x = through.add(o), y = resumed.add(o);
      ASSERT_EQ(x.word, y.word);
      ASSERT_EQ(x.requantised, y.requantised);
      a.insert(a.end(), x.matches.begin(), x.matches.end());
      b.insert(b.end(), y.matches.begin(), y.matches.end());
    });
    EXPECT_GT(a.size(), 10u);
    EXPECT_EQ(matchesOf(a, through.text()), matchesOf(b, resumed.text()));
  }
}

TEST(Corpus, refusesDamageAnywhereAndNamesThePlace) {
  const TemporaryDirectory dir;
  CorpusFile::save(dir / "good", someCorpus());
  const std::string good = fileBytes(dir / "good");
  const auto refusal = [&](const std::string& bytes) {
    writeFile(dir / "bad", bytes);
    return messageOf<InputError>([&] { CorpusFile::load(dir / "bad"); });
  };
  EXPECT_EQ(refusal(good), "");
  EXPECT_NE(refusal("").find("no corpus"), std::string::npos);
  EXPECT_NE(refusal("some text that is no corpus at all").find("no corpus"), std::string::npos);
  EXPECT_NE(refusal(good.substr(0, 20)).find("truncated"), std::string::npos);
  EXPECT_NE(refusal(good + "x").find("bytes instead of"), std::string::npos);
  std::string other = good;
  other[8] = 1;  // before there were full densities
  EXPECT_NE(refusal(other).find("version"), std::string::npos);
  hyselam::Rng rng(7);
  for (int round = 0; round < 300; ++round) {
    const auto at = rng.below(static_cast<std::uint32_t>(good.size()));
    EXPECT_NE(refusal(good.substr(0, at)), "") << "cut at " << at;
    std::string flipped = good;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << rng.below(8)));
    EXPECT_NE(refusal(flipped), "") << "bit flipped in byte " << at;
  }
  EXPECT_NE(messageOf<InputError>([&] { CorpusFile::load(dir / "none"); }), "");
  EXPECT_NE(messageOf<InputError>([&] { CorpusFile::save("/nowhere/at/all", Corpus{}); }), "");
}

TEST(Corpus, keepsTheOldFileWhenKilledWhileSaving) {
  const TemporaryDirectory dir;
  const std::string path = dir / "text";
  const Corpus corpus = someCorpus();
  CorpusFile::save(path, corpus);
  const std::string good = fileBytes(path);
  for (int round = 0; round < 20; ++round) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (;;) CorpusFile::save(path, corpus);
    }
    ::usleep(static_cast<useconds_t>(1000 + 700 * round));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    ASSERT_EQ(fileBytes(path), good);
  }
}
