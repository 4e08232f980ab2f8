// What one new word costs, against texts of a thousand to a million words with three levels. The
// baseline is Alg. 5.3 over a scan of all words.
#include <benchmark/benchmark.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>

#include "../test/random_texts.hpp"
#include "../test/transcription/matching.hpp"
#include "ngram_slam/matching/ngram_recognizer.hpp"
#include "ngram_slam/matching/reverse_ngram_matcher.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a bench, not a header

enum class Place {
  kCircuit,      // one corridor circuit of 24 words with doors, round and round (chapter 5)
  kBuilding,     // 40 different corridors of 24 words, visited in random order
  kCircuitBoth,  // the same, every visit in one of both directions
  kBuildingBoth
};
bool isCircuit(Place p) {
  return p == Place::kCircuit || p == Place::kCircuitBoth;
}

/// Writes the way of a robot: real words with noise of sizes and angles. In one corridor out of
/// three a door is open: three words instead of one.
class Writer {
 public:
  Writer(Place place, std::uint64_t seed) : rng_(seed), place_(place) {
    const std::size_t corridors = isCircuit(place) ? 1 : 40;
    for (std::size_t c = 0; c < corridors; ++c) {
      std::vector<Syllables> words;
      for (int i = 0; i < 24; ++i) {
        Syllables w;
        w.density_class = static_cast<int>(rng_.below(4)) * 2 + i % 2;
        w.size = 8 + rng_.below(i % 2 == 0 ? 120 : 30);
        w.angle = static_cast<float>(i % 2 == 0 || rng_.below(2) == 0 ? 0.0
                                     : rng_.below(2) == 0             ? 1.57
                                                                      : -1.57);
        words.push_back(w);
      }
      corridors_.push_back(words);
    }
  }
  void write(WordLattice& text) {
    if (pending_.empty()) {
      const auto& corridor = corridors_[corridor_];
      const std::size_t at = backwards_ ? corridor.size() - 1 - at_ : at_;
      Syllables w = random_texts::noisy(corridor[at], rng_, 0.08, 0.15);
      if (backwards_) w.angle = -w.angle;
      if (w.size > 60 && rng_.below(3) == 0) {
        const std::uint32_t before = w.size / 4 + rng_.below(w.size / 3);
        pending_ = {{w.density_class, w.size - 6 - before, 0.0f},
                    {w.density_class ^ 1, 6, 0.0f},
                    {w.density_class, before, 0.0f}};
      } else {
        pending_ = {w};
      }
      if (++at_ == corridor.size()) {
        at_ = 0;
        corridor_ = rng_.below(static_cast<std::uint32_t>(corridors_.size()));
        const bool both = place_ == Place::kCircuitBoth || place_ == Place::kBuildingBoth;
        backwards_ = both && rng_.below(2) == 0;
      }
    }
    text.push(pending_.back());
    pending_.pop_back();
  }

 private:
  hyselam::Rng rng_;
  Place place_;
  std::vector<std::vector<Syllables>> corridors_;
  std::size_t corridor_ = 0, at_ = 0;
  bool backwards_ = false;
  std::vector<Syllables> pending_;
};

/// Time that this thread has been given, whatever else the machine does.
double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <typename AnyMatcher>
struct Situation {
  explicit Situation(Place place) : writer(place, 7), matcher(text) {}
  Writer writer;
  WordLattice text{3};
  AnyMatcher matcher;
};

/// A text of so many words; kept from the smaller ones on, so that it is written only once.
template <typename AnyMatcher>
Situation<AnyMatcher>& situation(Place place, std::size_t words) {
  static std::map<Place, std::unique_ptr<Situation<AnyMatcher>>> all;
  auto& s = all[place];
  if (!s || s->text.words() > words + 50000) s = std::make_unique<Situation<AnyMatcher>>(place);
  while (s->text.words() < words) {
    s->writer.write(s->text);
    s->matcher.skip();
  }
  for (int i = 0; i < 200; ++i) {  // the grams come alive
    s->writer.write(s->text);
    s->matcher.update();
  }
  return *s;
}

void textLengths(benchmark::internal::Benchmark* b) {
  for (int words : {1000, 3000, 10000, 30000, 100000, 300000, 1000000}) b->Arg(words);
}

template <typename AnyMatcher>
void oneWord(benchmark::State& state, Place place, const char* baseline) {
  const auto words = static_cast<std::size_t>(state.range(0));
  auto& s = situation<AnyMatcher>(place, words);
  std::vector<double> ms;
  std::size_t matches = 0;
  const auto compared = s.matcher.counters().comparisons;
  for (auto _ : state) {
    const double before = cpuSeconds();
    s.writer.write(s.text);
    const auto& found = s.matcher.update();
    const double seconds = cpuSeconds() - before;
    matches += found.size();
    ms.push_back(1e3 * seconds);
  }
  double sum = 0.0;
  for (double t : ms) sum += t;
  std::sort(ms.begin(), ms.end());
  const auto n = static_cast<double>(ms.size());
  const auto comparisons = static_cast<double>(s.matcher.counters().comparisons - compared);
  state.counters["median_ms"] = ms[ms.size() / 2];
  state.counters["p99_ms"] = ms[ms.size() * 99 / 100];
  state.counters["worst_ms"] = ms.back();
  state.counters["matches_per_word"] = static_cast<double>(matches) / n;
  state.counters["comparisons_per_word"] = comparisons / n;
  // What the thesis counts: pairs of words that are known to match or not afterwards.
  state.counters["pairs_decided_per_100ms"] = n * static_cast<double>(s.text.words()) / sum * 100.0;
  state.counters["text_bytes_per_word"] =
      static_cast<double>(s.text.bytes()) / static_cast<double>(s.text.words());
  state.counters["index_bytes_per_word"] =
      static_cast<double>(s.matcher.bytes()) / static_cast<double>(s.text.words());
  if (baseline != nullptr) {
    state.SetLabel(std::string("baseline=") + baseline + "/" + std::to_string(words) +
                   "/iterations:3");
  }
}

void OneWord_Circuit(benchmark::State& state) {
  oneWord<NgramMatcher>(state, Place::kCircuit, nullptr);
}
void OneWord_Building(benchmark::State& state) {
  oneWord<NgramMatcher>(state, Place::kBuilding, "OneWord_Building_Scan");
}
/// The same corridors both ways, and what the search the other way round costs by itself.
void OneWord_CircuitReverse(benchmark::State& state) {
  oneWord<ReverseNgramMatcher>(state, Place::kCircuitBoth, nullptr);
}
void OneWord_BuildingReverse(benchmark::State& state) {
  oneWord<ReverseNgramMatcher>(state, Place::kBuildingBoth, nullptr);
}
BENCHMARK(OneWord_CircuitReverse)
    ->Apply(textLengths)
    ->Iterations(3000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(OneWord_BuildingReverse)
    ->Apply(textLengths)
    ->Iterations(3000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(OneWord_Circuit)->Apply(textLengths)->Iterations(3000)->Unit(benchmark::kMillisecond);
BENCHMARK(OneWord_Building)->Apply(textLengths)->Iterations(3000)->Unit(benchmark::kMillisecond);

/// A lap of the circuit after 40 laps (5.3.2), regions already built: words, levels, all matches.
void OneLap_Circuit(benchmark::State& state) {
  Writer writer(Place::kCircuit, 7);
  WordLattice text(3);
  NgramMatcher matcher(text);
  while (text.positions() < 40 * 24) {
    writer.write(text);
    matcher.update();
  }
  for (auto _ : state) {
    for (int i = 0; i < 24; ++i) {
      writer.write(text);
      benchmark::DoNotOptimize(matcher.update().size());
    }
  }
}
BENCHMARK(OneLap_Circuit)->Iterations(40)->Unit(benchmark::kMillisecond);

/// Single comparisons of words, one after the other.
void CompareWords(benchmark::State& state) {
  Writer writer(Place::kBuilding, 7);
  WordLattice text(1);
  while (text.words() < 10000) writer.write(text);
  const WordTolerance tolerance;
  const Syllables newest = text.syllables(0);
  for (auto _ : state) {
    int matches = 0;
    for (WordIndex i = 0; i < 10000; ++i) {
      matches += wordsMatch(newest, text.syllables(i), tolerance);
    }
    benchmark::DoNotOptimize(matches);
  }
  state.counters["comparisons_per_100ms"] =
      benchmark::Counter(1000.0, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(CompareWords)->Unit(benchmark::kMicrosecond);

/// A corpus of 10^5 words (1.5 million observations): saved, and loaded with words and index.
Corpus largeCorpus() {
  Corpus corpus;
  hyselam::Rng rng(5);
  DensityObservation o;
  for (int i = 0; i < 1500000; ++i) {
    o.base_in_odom = o.base_in_odom * hyselam::Pose2{0.1, 0.0, rng.uniform(-0.02, 0.02)};
    if (std::hypot(o.base_in_odom.x, o.base_in_odom.y) > 1e4) o.base_in_odom = {};
    o.stamp += 0.2;
    if (i % 15 == 0) o.soft = rng.uniform();
    corpus.observations.append(o);
  }
  return corpus;
}
std::string corpusFile() {
  return (std::filesystem::temp_directory_path() /
          ("ngram_benchmark_" + std::to_string(::getpid()) + ".corpus"))
      .string();
}
void SaveCorpus(benchmark::State& state) {
  const Corpus corpus = largeCorpus();
  for (auto _ : state) CorpusFile::save(corpusFile(), corpus);
  state.counters["file_bytes_per_observation"] =
      static_cast<double>(std::filesystem::file_size(corpusFile())) / corpus.observations.size();
  std::filesystem::remove(corpusFile());
}
void LoadCorpus(benchmark::State& state) {
  CorpusFile::save(corpusFile(), largeCorpus());
  for (auto _ : state) {
    const NgramRecognizer r(NgramRecognizerParams{}, CorpusFile::load(corpusFile()));
    state.counters["words"] = static_cast<double>(r.text().words());
    state.counters["bytes_per_word"] =
        static_cast<double>(r.bytes()) / static_cast<double>(r.text().words());
  }
  std::filesystem::remove(corpusFile());
}
BENCHMARK(SaveCorpus)->Iterations(3)->Unit(benchmark::kMillisecond);
BENCHMARK(LoadCorpus)->Iterations(3)->Unit(benchmark::kMillisecond);

/// All words are compared with the newest, then predecessors are followed (Alg. 5.3). Longest
/// n-grams instead of all, which nobody could wait for.
void OneWord_Building_Scan(benchmark::State& state) {
  Writer writer(Place::kBuilding, 7);
  WordLattice text(3);
  while (text.words() < static_cast<std::size_t>(state.range(0))) writer.write(text);
  const NgramMatcherParams params;
  const auto words = transcription::plainWords(text);
  Position last = text.positions();
  for (auto _ : state) {
    const WordIndex newest = text.realWord(--last);
    std::size_t matches = 0;
    for (std::size_t v = 0; v < words.size(); ++v) {
      if (words[v].last >= words[newest].first) continue;
      if (!transcription::equal(words[newest], words[v], params.tolerance)) continue;
      // The longest gram, layer by layer, up to what the third pass asks for.
      std::set<std::pair<std::size_t, std::size_t>> layer = {{newest, v}};
      int n = 0;
      for (; n < params.min_n.back() && !layer.empty(); ++n) {
        std::set<std::pair<std::size_t, std::size_t>> next;
        for (const auto& [a, b] : layer) {
          for (std::size_t p : words[a].P) {
            for (std::size_t q : words[b].P) {
              if (words[q].last < words[p].first &&
                  transcription::equal(words[p], words[q], params.tolerance)) {
                next.insert({p, q});
              }
            }
          }
        }
        layer = std::move(next);
      }
      matches += n >= params.min_n.back();
    }
    benchmark::DoNotOptimize(matches);
  }
}
BENCHMARK(OneWord_Building_Scan)->Apply(textLengths)->Iterations(3)->Unit(benchmark::kMillisecond);

}  // namespace
