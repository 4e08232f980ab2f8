// Cost of signatures: making one, and searching among up to a million places.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <memory>

#include "hyselam_common/rng.hpp"
#include "ngram_slam/signatures/place_recognizer.hpp"
#include "ngram_slam/signatures/signature_sensor.hpp"
#include "random_scan.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header
using hyselam::Rng;

/// Ways of 20 m through places that vary as the model says, in clusters as corridors are: every
/// third value of a place is that of one of 50 kinds of building.
PlaceSignature placeOf(std::uint64_t number) {
  const std::uint64_t building = hyselam::mix(1, number / 40) % 50;
  Rng rng(2, number), of_building(3, building);
  PlaceSignature s;
  for (std::size_t i = 0; i < s.values.size(); ++i) {
    const double shared = of_building.gaussian(), own = rng.gaussian();
    const double value = (i % 3 == 0 ? 0.9 * shared + 0.44 * own : own) * 127.0 / 4.0;
    s.values[i] = static_cast<std::int8_t>(std::clamp(value, -127.0, 127.0));
  }
  return s;
}

PlaceSignature visited(PlaceSignature s, const SignatureModel& model, Rng& rng) {
  for (std::size_t i = 0; i < s.values.size(); ++i) {
    const double value =
        static_cast<double>(s.values[i]) + rng.gaussian() / static_cast<double>(model.steps()[i]);
    s.values[i] = static_cast<std::int8_t>(std::clamp(value, -127.0, 127.0));
  }
  return s;
}

const PlaceIndex& indexOf(std::uint32_t size) {
  static std::map<std::uint32_t, std::unique_ptr<PlaceIndex>> indices;
  auto& index = indices[size];
  if (index == nullptr) {
    index = std::make_unique<PlaceIndex>(SignatureModel::shipped());
    for (std::uint32_t i = 0; i < size; ++i) index->add(placeOf(i));
  }
  return *index;
}

/// Of this thread: other programs do not count.
double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void search(benchmark::State& state, bool exact) {
  const SignatureModel& model = SignatureModel::shipped();
  const auto size = static_cast<std::uint32_t>(state.range(0));
  const PlaceIndex& index = indexOf(size);
  Rng rng(5);
  std::vector<double> times;
  std::size_t found = 0;
  for (auto _ : state) {
    const std::uint32_t place = rng.below(size);
    const PlaceSignature wanted = visited(index[place], model, rng);
    const double begin = cpuSeconds();
    const auto best = exact ? index.searchAll(wanted, 60, size) : index.search(wanted, 60, size);
    times.push_back(1e3 * (cpuSeconds() - begin));
    state.SetIterationTime(1e-3 * times.back());
    found += std::any_of(best.begin(), best.end(), [&](const auto& f) { return f.place == place; });
  }
  std::sort(times.begin(), times.end());
  state.counters["median_ms"] = times[times.size() / 2];
  state.counters["p99_ms"] = times[times.size() * 99 / 100];
  state.counters["worst_ms"] = times.back();
  state.counters["recall"] = static_cast<double>(found) / static_cast<double>(times.size());
  state.counters["bytes_per_place"] = static_cast<double>(index.bytes()) / size;
}
void searchIndex(benchmark::State& state) {
  search(state, false);
}
void searchAll(benchmark::State& state) {
  search(state, true);
  state.SetLabel("baseline=searchIndex");
}
BENCHMARK(searchIndex)
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Arg(1000000)
    ->UseManualTime()
    ->Iterations(500);
BENCHMARK(searchAll)->Arg(1000)->Arg(10000)->Arg(100000)->Arg(1000000)->UseManualTime()->Iterations(
    30);

/// A place each half metre of a way with 180 beams every quarter.
void makeSignature(benchmark::State& state) {
  const SignatureModel& model = SignatureModel::shipped();
  Rng rng(7);
  const auto shared = randomIndoorScan(rng);
  std::int64_t places = 0;
  SignatureSensor sensor({}, [&](const PlaceOnWay&, const PlaceFeatures& features) {
    benchmark::DoNotOptimize(model.signatureOf(features));
    ++places;
  });
  std::int64_t k = 0;
  for (auto _ : state) {
    for (int i = 0; i < 2; ++i, ++k) {
      sensor.add(k, {0.25 * static_cast<double>(k), 0.0, 0.0}, shared);
    }
  }
  state.counters["places"] = static_cast<double>(places);
}
BENCHMARK(makeSignature)->Iterations(2000)->Unit(benchmark::kMicrosecond);

}  // namespace
