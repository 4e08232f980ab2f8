// bench/run topo_parser: what one sentence costs.
#include <benchmark/benchmark.h>

#include "hyselam_language/building/description_builder.hpp"

namespace {

using hyselam_topo::DescriptionBuilder;
using hyselam_topo::ParseOptions;
using hyselam_topo::TopoParser;

constexpr char kDescription[] =
    "Robot, you are in the corridor. On your left you have room I-109, then i-110 and i-111. You "
    "are in the corridor. On your right you have room i-108 and then i-110. Room i-108 is also "
    "known as the industrial robotics lab. Room i-109 is 6 by 8 meters. Room i-110 is 6 by 6 "
    "meters. Finally, room i-111 is 6 meters by 4 meters.";
constexpr int kSentences = 8;

const TopoParser& parser() {
  static const TopoParser kParser;
  return kParser;
}

void run(benchmark::State& state, const std::string& text, const std::string& language,
         int sentences) {
  ParseOptions options;
  options.language = language;
  for (auto _ : state) {
    benchmark::DoNotOptimize(parser().parse(text, options));
  }
  state.counters["sentences_per_second"] = benchmark::Counter(
      sentences * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

void BM_DescriptionOfTheThesis(benchmark::State& state) {
  run(state, kDescription, "en", kSentences);
}
BENCHMARK(BM_DescriptionOfTheThesis)->Unit(benchmark::kMicrosecond);

void BM_DescriptionAnyLanguage(benchmark::State& state) {
  run(state, kDescription, "auto", kSentences);
}
BENCHMARK(BM_DescriptionAnyLanguage)->Unit(benchmark::kMicrosecond);

void BM_ShortCommand(benchmark::State& state) {
  run(state, "Robot, go to I-110 and then go to the corridor.", "en", 1);
}
BENCHMARK(BM_ShortCommand)->Unit(benchmark::kMicrosecond);

void BM_LongList(benchmark::State& state) {
  std::string text = "On your left you have room 1";
  for (int i = 2; i <= 40; ++i) text += ", room " + std::to_string(i);
  run(state, text + ".", "en", 1);
}
BENCHMARK(BM_LongList)->Unit(benchmark::kMicrosecond);

void BM_NotUnderstood(benchmark::State& state) {
  run(state, "The quick brown fox jumps over the lazy dog while nobody in the kitchen looks at it.",
      "en", 1);
}
BENCHMARK(BM_NotUnderstood)->Unit(benchmark::kMicrosecond);

/// 600 words in forty sentences that nobody understands.
void BM_LongNotUnderstood(benchmark::State& state) {
  std::string text;
  for (int i = 0; i < 40; ++i) {
    text += "The quick brown fox jumps over the lazy dog while the kitchen looks away now. ";
  }
  run(state, text, "en", 40);
}
BENCHMARK(BM_LongNotUnderstood)->Unit(benchmark::kMillisecond);

void BM_SecondReaderLoads(benchmark::State& state) {
  const hyselam_topo::Grammar grammar = hyselam_topo::Grammar::shipped("en");
  for (auto _ : state) benchmark::DoNotOptimize(hyselam_topo::FactReader::shipped(grammar));
}
BENCHMARK(BM_SecondReaderLoads)->Unit(benchmark::kMillisecond);

void BM_DescriptionIntoGraph(benchmark::State& state) {
  for (auto _ : state) {
    DescriptionBuilder builder(parser());
    builder.add(parser().parse(kDescription));
    const auto* building = &builder.building();
    benchmark::DoNotOptimize(building);
  }
}
BENCHMARK(BM_DescriptionIntoGraph)->Unit(benchmark::kMicrosecond);

void BM_LoadGrammar(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(hyselam_topo::Grammar::shipped("en"));
}
BENCHMARK(BM_LoadGrammar)->Unit(benchmark::kMillisecond);

}  // namespace
