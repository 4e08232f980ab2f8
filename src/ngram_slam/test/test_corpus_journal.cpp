// A corpus that is saved by what is new: cut off, damaged, outgrown, and killed while it is saved.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <functional>
#include <thread>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/words/corpus_journal.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header
using hyselam::InputError;
using hyselam::testing::fileBytes;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

namespace {

/// The i-th observation of the way; a run begins with every hundredth.
DensityObservation observation(std::uint32_t i) {
  hyselam::Rng rng(3, i);
  DensityObservation o;
  o.stamp = 0.2 * i;
  o.base_in_odom = {0.1 * i, rng.uniform(-1, 1), rng.uniform(-3.1, 3.1)};
  o.soft = rng.uniform();
  if (rng.below(2) == 0) o.hard = rng.uniform();
  if (rng.below(2) == 0) o.full = rng.uniform();
  o.frontiers = static_cast<int>(rng.below(256));
  return o;
}

void grow(ObservationStore& store, std::uint32_t size) {
  while (store.size() < size) {
    if (store.size() % 100 == 0) store.startRun();
    store.append(observation(store.size()));
  }
}

/// What the corpus would be as one file.
std::string bytesOf(const Corpus& corpus, const TemporaryDirectory& folder) {
  CorpusFile::save(folder / "whole", corpus);
  return fileBytes(folder / "whole");
}

struct Growing {
  explicit Growing(const TemporaryDirectory& folder) : journal(folder / "c") { journal.load(); }
  void save(std::uint32_t size) {
    grow(corpus.observations, size);
    corpus.histogram.assign(MeanShiftQuantizer::kBins, size);
    journal.save(corpus.observations, corpus.classes, corpus.histogram);
  }
  Corpus corpus;
  CorpusJournal journal;
};

/// That a journal which was loaded goes on: what is saved next is on the disk.
void expectGoesOn(CorpusJournal& journal, Corpus corpus, std::uint32_t size,
                  const TemporaryDirectory& folder) {
  grow(corpus.observations, size);
  journal.save(corpus.observations, corpus.classes, corpus.histogram);
  ASSERT_EQ(bytesOf(CorpusJournal(folder / "c").load().corpus, folder), bytesOf(corpus, folder));
}

}  // namespace

TEST(CorpusJournal, holdsWhatAWholeFileHolds) {
  const TemporaryDirectory folder;
  Growing g(folder);
  EXPECT_EQ(g.journal.saved(), 0u);
  std::uint64_t journal_before = 0;
  for (std::uint32_t size : {130u, 131u, 131u, 260u, 300u, 301u}) {
    g.save(size);
    EXPECT_EQ(g.journal.saved(), size);
    CorpusJournal other(folder / "c");
    const auto loaded = other.load();
    EXPECT_EQ(loaded.remark, "");
    EXPECT_EQ(loaded.corpus.observations.runs(), g.corpus.observations.runs());
    EXPECT_EQ(bytesOf(loaded.corpus, folder), bytesOf(g.corpus, folder));
    EXPECT_EQ(other.journalBytes(), g.journal.journalBytes());
    EXPECT_GE(g.journal.journalBytes(), journal_before);
    journal_before = g.journal.journalBytes();
  }
  EXPECT_GT(journal_before, 0u);
  // One that was loaded goes on.
  CorpusJournal next(folder / "c");
  expectGoesOn(next, next.load().corpus, 400, folder);
}

TEST(CorpusJournal, losesOnlyATruncatedBlockAndContinues) {
  const TemporaryDirectory folder;
  Growing g(folder);
  g.save(100);
  g.save(150);
  const std::size_t good = g.journal.journalBytes();
  const Corpus before = g.corpus;
  g.save(160);
  const std::string whole = fileBytes(folder / "c.journal");
  for (std::size_t cut = 0; cut < whole.size(); cut += cut < good ? 197 : 47) {
    writeFile(folder / "c.journal", whole.substr(0, cut));
    CorpusJournal journal(folder / "c");
    const auto loaded = journal.load();
    const std::uint32_t expected = cut < good ? 100 : 150;
    ASSERT_EQ(loaded.corpus.observations.size(), expected) << cut;
    EXPECT_EQ(loaded.remark.empty(), cut == good || cut == 20);
    // What is saved next stands behind the last good block.
    expectGoesOn(journal, loaded.corpus, 170, folder);
  }
}

TEST(CorpusJournal, refusesDamageAndNamesThePlace) {
  const TemporaryDirectory folder;
  Growing g(folder);
  g.save(100);
  for (std::uint32_t size : {120u, 140u, 160u}) g.save(size);
  const std::string whole = fileBytes(folder / "c.journal");
  hyselam::Rng rng(1);
  std::size_t named = 0;
  for (int round = 0; round < 300; ++round) {
    std::string damaged = whole;
    const std::size_t at = rng.below(static_cast<std::uint32_t>(whole.size()));
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << rng.below(8)));
    writeFile(folder / "c.journal", damaged);
    const std::string message = messageOf<InputError>([&] { CorpusJournal(folder / "c").load(); });
    ASSERT_NE(message.find("c.journal"), std::string::npos) << at << ": " << message;
    named += message.find("block") != std::string::npos;
  }
  EXPECT_GT(named, 250u);
  writeFile(folder / "c.journal", "something else altogether, and long enough for a header");
  EXPECT_NE(messageOf<InputError>([&] { CorpusJournal(folder / "c").load(); }).find("no journal"),
            std::string::npos);
  writeFile(folder / "c", "no corpus");
  EXPECT_NE(messageOf<InputError>([&] { CorpusJournal(folder / "c").load(); }).find("no corpus"),
            std::string::npos);
}

TEST(CorpusJournal, isWrittenWholeWhenTheFilesWereChanged) {
  const auto afterwards =
      [](const std::function<void(const TemporaryDirectory&, Growing&)>& meddle) {
        const TemporaryDirectory folder;
        Growing g(folder);
        g.save(100);
        g.save(150);
        meddle(folder, g);
        g.save(170);
        const auto loaded = CorpusJournal(folder / "c").load();
        EXPECT_EQ(loaded.remark, "");
        return bytesOf(loaded.corpus, folder) == bytesOf(g.corpus, folder);
      };
  EXPECT_TRUE(afterwards([](const TemporaryDirectory& folder, Growing&) {
    ::unlink((folder / "c").c_str());
  })) << "the file removed";
  EXPECT_TRUE(afterwards([](const TemporaryDirectory& folder, Growing&) {
    ::unlink((folder / "c.journal").c_str());
  })) << "the journal removed";
  EXPECT_TRUE(afterwards([](const TemporaryDirectory& folder, Growing& g) {
    CorpusJournal(folder / "./c")
        .saveWhole(g.corpus.observations, g.corpus.classes, g.corpus.histogram);
  })) << "saved by another name";
}

TEST(CorpusJournal, isNotUsedWithAnotherFile) {
  const TemporaryDirectory folder;
  Growing g(folder);
  g.save(100);
  g.save(150);
  Corpus other;
  grow(other.observations, 120);
  CorpusFile::save(folder / "c", other);
  CorpusJournal journal(folder / "c");
  const auto loaded = journal.load();
  EXPECT_EQ(loaded.corpus.observations.size(), 120u);
  EXPECT_NE(loaded.remark.find("another version"), std::string::npos);
  Corpus corpus = loaded.corpus;
  grow(corpus.observations, 130);
  journal.save(corpus.observations, corpus.classes, corpus.histogram);
  EXPECT_EQ(CorpusJournal(folder / "c").load().corpus.observations.size(), 130u);
}

TEST(CorpusJournal, isMergedIntoTheFileWhenItOutgrowsIt) {
  const TemporaryDirectory folder;
  Growing g(folder);
  g.save(100);
  std::size_t folded = 0;
  std::uint64_t journal_before = 0, most = 0;
  for (std::uint32_t size = 3000; size <= 90000; size += 3000) {
    g.save(size);
    folded += g.journal.journalBytes() < journal_before;
    journal_before = g.journal.journalBytes();
    most = std::max(most, journal_before);
    ASSERT_EQ(CorpusJournal(folder / "c").load().corpus.observations.size(), size);
  }
  EXPECT_GE(folded, 1u);
  EXPECT_LT(most, 2 * CorpusJournal::kSmallJournal + g.journal.fileBytes());
}

TEST(CorpusJournal, failsWithoutLossWhereItCannotWrite) {
  const TemporaryDirectory folder;
  CorpusJournal journal(folder / "missing/c");
  EXPECT_EQ(journal.load().corpus.observations.size(), 0u);
  Corpus corpus;
  grow(corpus.observations, 10);
  EXPECT_NE(messageOf<InputError>(
                [&] { journal.save(corpus.observations, corpus.classes, corpus.histogram); }),
            "");
  EXPECT_EQ(journal.saved(), 0u);
}

TEST(CorpusJournal, losesNothingThatWasSavedWhenItIsKilled) {
  const TemporaryDirectory folder;
  hyselam::Rng rng(5);
  std::uint32_t acknowledged = 0;
  int cut_off = 0, in_mid_save = 0;
  for (int round = 0; round < 40; ++round) {
    int pipes[2];
    ASSERT_EQ(::pipe(pipes), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      // Goes on from the disk and tells each saving when it is done: -1 before, the size after.
      CorpusJournal journal(folder / "c");
      Corpus corpus = journal.load().corpus;
      for (;;) {
        grow(corpus.observations, corpus.observations.size() + 2000);
        std::uint32_t tell = 0xffffffffu;
        if (::write(pipes[1], &tell, sizeof(tell)) != sizeof(tell)) ::_exit(1);
        journal.save(corpus.observations, corpus.classes, corpus.histogram);
        tell = corpus.observations.size();
        if (::write(pipes[1], &tell, sizeof(tell)) != sizeof(tell)) ::_exit(1);
      }
    }
    ::close(pipes[1]);
    std::this_thread::sleep_for(std::chrono::microseconds(5000 + rng.below(60000)));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    std::uint32_t told = 0, last = 0;
    while (::read(pipes[0], &told, sizeof(told)) == sizeof(told)) {
      last = told;
      if (told != 0xffffffffu) acknowledged = told;
    }
    ::close(pipes[0]);
    in_mid_save += last == 0xffffffffu;
    CorpusJournal journal(folder / "c");
    const auto loaded = journal.load();
    cut_off += !loaded.remark.empty();
    const ObservationStore& o = loaded.corpus.observations;
    ASSERT_GE(o.size(), acknowledged);
    acknowledged = o.size();
    for (std::uint32_t i = 0; i < o.size(); i += 7) {
      ASSERT_NEAR(o[i].soft, observation(i).soft, 1e-4) << i;
      ASSERT_EQ(o.stamp(i), observation(i).stamp);
    }
  }
  EXPECT_GT(acknowledged, 2000u);
  EXPECT_GT(in_mid_save, 0);
  RecordProperty("cut_off", cut_off);
}
