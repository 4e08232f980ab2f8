// What one observation, one density field and one filter iteration cost, each beside the thesis'
// algorithm written down plainly, or beside the peer that it replaces. The label names the
// baseline.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "../test/look.hpp"
#include "../test/random_worlds.hpp"
#include "../test/transcription/himm.hpp"
#include "buildings.hpp"
#include "fsd_localization/localizer.hpp"

namespace {

using namespace fsd_localization;  // NOLINT: a bench, not a header
using hyselam::Pose2;

constexpr int kBigSide = 2000;
constexpr std::size_t kParticles = 40000;

// ---- one observation: a scan of 181 beams into the local map, soft and hard density at h = 40
// ----

/// Scans as a robot takes them that drives through a building.
const std::vector<std::pair<hyselam::LaserScan, Pose2>>& drive() {
  static const auto scans = [] {
    const auto map = bench::building(400, 3);
    const GridRayCaster rays(map);
    std::vector<std::pair<hyselam::LaserScan, Pose2>> out;
    for (int i = 0; i < 100; ++i) {
      const Pose2 pose{3.0 + 0.1 * i, 1.5, 0.3 * std::sin(0.1 * i)};
      out.push_back({look(rays, pose, 0.0), pose});
    }
    return out;
  }();
  return scans;
}

void OneObservation_Transcription(benchmark::State& state) {
  const Kernel kernel(KernelProfile::kUniform, 40);
  transcription::HimmGrid grid(181);
  transcription::Cells cells;
  cells.width = cells.height = 181;
  cells.state.resize(181 * 181);
  std::size_t i = 0;
  for (auto _ : state) {
    const auto& [scan, pose] = drive()[i++ % drive().size()];
    transcription::himm(grid, scan, pose.theta, 0.1, 90.0, 9.0, 1.0);
    for (std::size_t k = 0; k < cells.state.size(); ++k) {
      cells.state[k] = grid.occ[k] < 3    ? transcription::Cells::kFree
                       : grid.occ[k] > 12 ? transcription::Cells::kOccupied
                                          : transcription::Cells::kUnknown;
    }
    benchmark::DoNotOptimize(transcription::freeSpaceDensity(cells, 90, 90, kernel));
  }
}
BENCHMARK(OneObservation_Transcription)->Unit(benchmark::kMicrosecond);

void OneObservation(benchmark::State& state) {
  LocalMap map;
  const FreeSpaceDensity density(Kernel(KernelProfile::kUniform, 40));
  FreeSpaceGrid space;
  std::size_t i = 0;
  for (auto _ : state) {
    const auto& [scan, pose] = drive()[i++ % drive().size()];
    map.update(scan, pose);
    map.freeSpace(42, space);
    benchmark::DoNotOptimize(density.density(space, map.robotCell()));
  }
  state.SetLabel("baseline=OneObservation_Transcription");
}
BENCHMARK(OneObservation)->Unit(benchmark::kMicrosecond);

void ObservationWithThreeKernelsAndGradients(benchmark::State& state) {
  FsdSensor sensor;
  std::size_t i = 0;
  for (auto _ : state) {
    const auto& [scan, pose] = drive()[i++ % drive().size()];
    sensor.integrate(scan, pose);
    benchmark::DoNotOptimize(sensor.observe());
  }
}
BENCHMARK(ObservationWithThreeKernelsAndGradients)->Unit(benchmark::kMicrosecond);

// ---- density of a cell of a map, h = 30 ----

void DensityOfACell_Transcription(benchmark::State& state) {
  const auto map = bench::building(500, 7);
  const Kernel kernel(KernelProfile::kInverted, static_cast<int>(state.range(0)));
  transcription::Cells cells;
  cells.width = cells.height = 500;
  for (std::int8_t v : map.cells) {
    cells.state.push_back(v == 0 ? transcription::Cells::kFree : transcription::Cells::kOccupied);
  }
  std::mt19937_64 rng(1);
  for (auto _ : state) {
    int x = 0, y = 0;
    do x = static_cast<int>(rng() % 500), y = static_cast<int>(rng() % 500);
    while (cells.at(x, y) != transcription::Cells::kFree);
    // On a map as large as the kernel sees, as an implementation that minds its memory would.
    benchmark::DoNotOptimize(transcription::freeSpaceDensityNear(cells, x, y, kernel));
  }
}
BENCHMARK(DensityOfACell_Transcription)->Arg(15)->Arg(30)->Arg(50)->Unit(benchmark::kNanosecond);

void DensityOfACell(benchmark::State& state) {
  const FreeSpaceGrid space = freeSpaceOf(bench::building(500, 7));
  const FreeSpaceDensity density(
      Kernel(KernelProfile::kInverted, static_cast<int>(state.range(0))));
  int i = 0;
  for (auto _ : state) {  // row by row over the free cells, as a field is made
    do i = (i + 1) % (500 * 500);
    while (!space.free.get(i % 500, i / 500));
    benchmark::DoNotOptimize(density.soft(space, {i % 500, i / 500}));
  }
  state.SetLabel("baseline=DensityOfACell_Transcription/" + std::to_string(state.range(0)));
}
BENCHMARK(DensityOfACell)->Arg(15)->Arg(30)->Arg(50)->Unit(benchmark::kNanosecond);

// ---- the filter on a map of 2000 x 2000 cells ----

const hyselam::OccupancyGrid& bigMap() {
  static const auto map = bench::building(kBigSide, 11);
  return map;
}
LikelihoodFieldModel likelihood60() {
  LikelihoodFieldParams params;
  params.max_beams = 60;
  return LikelihoodFieldModel(bigMap(), params);
}
std::shared_ptr<const FsdMap> bigFields() {
  static const auto fields = std::make_shared<const FsdMap>(bigMap(), FsdMapParams{});
  return fields;
}
Observation aLook() {
  Observation o;
  o.scan = drive()[50].first;
  FsdSensor sensor;
  for (const auto& [scan, pose] : drive()) sensor.integrate(scan, pose);
  o.fsd = sensor.observe();
  return o;
}

void FieldTablesOfThreeKernels(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(FsdMap(bigMap(), FsdMapParams{}).bytes());
  state.counters["bytes"] = static_cast<double>(bigFields()->bytes());
}
BENCHMARK(FieldTablesOfThreeKernels)->Unit(benchmark::kMillisecond)->Iterations(1)->UseRealTime();

/// Weighing alone, particles spread over the map; per particle.
template <typename MakeModel>
void weigh(benchmark::State& state, std::size_t n, MakeModel make, const char* baseline) {
  const auto model = make();
  const Observation look = aLook();
  Particles particles = uniformParticles(*bigFields(), n, 5);
  for (auto _ : state) {
    std::fill(particles.weight.begin(), particles.weight.end(), 1.0F);
    benchmark::DoNotOptimize(model.weigh(look, particles));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * n));
  if (baseline != nullptr) state.SetLabel(baseline);
}
void WeighBeam19(benchmark::State& s) {
  weigh(
      s, kParticles, [] { return BeamModel(std::make_shared<const GridRayCaster>(bigMap())); },
      nullptr);
}
void WeighLikelihood60(benchmark::State& s) {
  weigh(
      s, kParticles, [] { return likelihood60(); }, nullptr);
}
void WeighFsd3(benchmark::State& s) {
  weigh(
      s, kParticles, [] { return FsdObservationModel(bigFields()); }, "baseline=WeighBeam19");
}
void WeighFsd3AgainstLikelihood(benchmark::State& s) {
  weigh(
      s, kParticles, [] { return FsdObservationModel(bigFields()); }, "baseline=WeighLikelihood60");
}
BENCHMARK(WeighBeam19)->Unit(benchmark::kMillisecond);
BENCHMARK(WeighLikelihood60)->Unit(benchmark::kMillisecond);
BENCHMARK(WeighFsd3)->Unit(benchmark::kMillisecond);
BENCHMARK(WeighFsd3AgainstLikelihood)->Unit(benchmark::kMillisecond);

/// Move, weigh, resample (forced), 40,000 particles spread over the map.
template <typename Model>
void iterate(benchmark::State& state, const Model& model, const char* baseline) {
  FilterParams p;
  p.max_particles = kParticles;
  p.resample_threshold = 1.0;
  ParticleFilter filter(bigFields(), p, 3);
  const Observation look = aLook();
  int i = 0;
  for (auto _ : state) {
    if (++i % 5 == 0) {  // before it concentrates
      state.PauseTiming();
      filter.spreadOverMap();
      state.ResumeTiming();
    }
    benchmark::DoNotOptimize(filter.step({0.1, 0.0, 0.02}, model, look));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * kParticles));
  if (baseline != nullptr) state.SetLabel(baseline);
}
void IterationLikelihood60(benchmark::State& s) {
  iterate(s, likelihood60(), nullptr);
}
void IterationFsd3(benchmark::State& s) {
  iterate(s, FsdObservationModel(bigFields()), "baseline=IterationLikelihood60");
}
BENCHMARK(IterationLikelihood60)->Unit(benchmark::kMillisecond);
BENCHMARK(IterationFsd3)->Unit(benchmark::kMillisecond);

void EstimateOf40000Particles(benchmark::State& state) {
  const Particles particles = uniformParticles(*bigFields(), kParticles, 5);
  for (auto _ : state) benchmark::DoNotOptimize(estimatePose(particles));
}
BENCHMARK(EstimateOf40000Particles)->Unit(benchmark::kMillisecond);

}  // namespace
