#include "fsd_localization/localizer.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/coarsen.hpp"
#include "hyselam_common/errors.hpp"

namespace fsd_localization {

using hyselam::ParameterError;
using hyselam::Pose2;

namespace {

constexpr std::pair<Model, const char*> kModelNames[] = {{Model::kFsd, "fsd"},
                                                         {Model::kBeam, "beam"},
                                                         {Model::kCosine, "cosine"},
                                                         {Model::kLikelihood, "likelihood"},
                                                         {Model::kHybrid, "hybrid"}};
constexpr Pose2 kCandidateBlur{0.1, 0.1, hyselam::radians(4.0)};  // between particles of the search
constexpr std::size_t kParticlesPerBin = 10;  // fewer: the bins are few because the particles are
constexpr double kFastMemory = 1.0;           // [m] of motion
constexpr double kSlowMemory = 30.0;          // [m]
constexpr double kTurnAsTravel = 0.5;         // [m/rad] a turn shows as much as so much travel
constexpr double kFarthest = 1e6;             // [m] beyond it cell numbers would not fit an int
constexpr double kGuessShare = 0.1;  // of the particles stays with the old belief when lost

FsdSensorParams sensorParams(const LocalizerParams& p) {
  FsdSensorParams s;
  s.local_map = p.local_map;
  s.kernels = p.map.kernels;
  s.gradient = p.map.gradient;
  s.with_frontiers = false;
  return s;
}

}  // namespace

Model modelFromName(const std::string& name) {
  for (const auto& [model, text] : kModelNames)
    if (name == text) return model;
  throw ParameterError("model", name, "one of fsd, beam, cosine, likelihood, hybrid");
}

const char* toString(Model model) {
  for (const auto& [m, text] : kModelNames)
    if (m == model) return text;
  return "?";
}

const char* toString(Phase phase) {
  switch (phase) {
    case Phase::kGlobal:
      return "global";
    case Phase::kTracking:
      return "tracking";
    case Phase::kLost:
      break;
  }
  return "lost";
}

void LocalizerParams::validate() const {
  if (!(update_min_d >= 0.0)) throw ParameterError("update_min_d", update_min_d, ">= 0 m");
  if (!(update_min_a >= 0.0)) throw ParameterError("update_min_a", update_min_a, ">= 0 rad");
  if (!(converged_share > 0.0 && converged_share <= 1.0))
    throw ParameterError("converged_share", converged_share, "in (0, 1]");
  if (!(converged_stddev > 0.0))
    throw ParameterError("converged_stddev", converged_stddev, "> 0 m");
  if (tracking_particles < 1)
    throw ParameterError("tracking_particles", tracking_particles, ">= 1");
  if (candidate_particles < tracking_particles)
    throw ParameterError("candidate_particles", candidate_particles, ">= tracking_particles");
  if (!(candidate_beams > 0.0 && candidate_beams <= 1e4))
    throw ParameterError("candidate_beams", candidate_beams, "in (0, 10000]");
  if (max_candidate_bins < 1)
    throw ParameterError("max_candidate_bins", max_candidate_bins, ">= 1");
  if (!(explained_tolerance > 0.0))
    throw ParameterError("explained_tolerance", explained_tolerance, "> 0 m");
  if (!(found_above >= 0.0 && found_above < 1.0))
    throw ParameterError("found_above", found_above, "in [0, 1)");
  if (!(lost_below >= 0.0 && lost_below < 1.0))
    throw ParameterError("lost_below", lost_below, "in [0, 1)");
  if (!(lost_ratio >= 0.0 && lost_ratio < 1.0))
    throw ParameterError("lost_ratio", lost_ratio, "in [0, 1)");
  map.validate();
  sensorParams(*this).validate();
  fsd.validate();
  beam.validate();
  cosine.validate();
  likelihood.validate();
  filter.validate();
}

namespace {

/// Densities are compared like with like: fields on the local map's cells, if the map's are finer.
/// It also closes the gaps in walls of finely drawn maps, through which free space would leak.
hyselam::OccupancyGrid forDensities(const hyselam::OccupancyGrid& map,
                                    const LocalizerParams& params) {
  return hyselam::coarsen(
      map, hyselam::coarseningFactor(map.geometry.resolution, params.local_map.resolution));
}

std::shared_ptr<const FsdMap> densities(const hyselam::OccupancyGrid& map,
                                        const LocalizerParams& params,
                                        const std::string& cache_path,
                                        const std::function<void(double)>& progress, bool* cached,
                                        std::string* problem) {
  const hyselam::OccupancyGrid coarse = forDensities(map, params);
  return std::make_shared<const FsdMap>(
      cache_path.empty()
          ? FsdMap(coarse, params.map, 0, progress)
          : FsdMap::cached(cache_path, coarse, params.map, 0, progress, cached, problem));
}

}  // namespace

void Localizer::checkMap(const hyselam::OccupancyGrid& map, const LocalizerParams& params) {
  const hyselam::OccupancyGrid coarse = forDensities(map, params);
  const auto free = [&](std::int8_t v) { return v >= 0 && v < params.map.thresholds.free_below; };
  if (std::none_of(coarse.cells.begin(), coarse.cells.end(), free))
    throw hyselam::InputError("map", "", "has no free cell to put particles on");
  for (const KernelSpec& spec : params.map.kernels) Kernel(spec, coarse.geometry.resolution);
}

Localizer::Localizer(const hyselam::OccupancyGrid& map, const LocalizerParams& params,
                     const std::string& cache_path, const std::function<void(double)>& progress)
    : params_((params.validate(), params)),
      map_(densities(map, params, cache_path, progress, &map_was_cached_, &map_cache_problem_)),
      sensor_(sensorParams(params)),
      filter_(map_, params_.filter, params.seed) {
  const auto rays = [&] { return std::make_shared<const RayCaster>(map, params.map.thresholds); };
  switch (params_.model) {
    case Model::kBeam:
      model_ = std::make_unique<BeamModel>(rays(), params_.beam);
      break;
    case Model::kCosine:
      model_ = std::make_unique<CosineModel>(rays(), params_.cosine);
      break;
    case Model::kLikelihood:
      model_ =
          std::make_unique<LikelihoodFieldModel>(map, params_.likelihood, params_.map.thresholds);
      break;
    case Model::kHybrid:
      tracker_ =
          std::make_unique<LikelihoodFieldModel>(map, params_.likelihood, params_.map.thresholds);
      [[fallthrough]];
    case Model::kFsd:
      model_ = std::make_unique<FsdModel>(map_, params_.fsd);
  }
}
Localizer::~Localizer() = default;

const ObservationModel& Localizer::activeModel() const {
  if (stage_ == Stage::kSearch) return *model_;
  return *tracker_;
}

void Localizer::relocalizeGlobally() {
  filter_ = ParticleFilter(map_, params_.filter, hyselam::splitmix64(params_.seed));
  startSearch();
  phase_ = Phase::kGlobal;
  travelled_ = 0.0;
  restartClock();
}

void Localizer::setInitialPose(const Pose2& base_in_map, const Pose2& stddev) {
  if (!base_in_map.isFinite()) throw hyselam::InputError("initial pose", "", "not finite");
  if (!stddev.isFinite() || stddev.x < 0.0 || stddev.y < 0.0 || stddev.theta < 0.0)
    throw hyselam::InputError("initial pose", "standard deviations",
                              "must be finite and not negative");
  const Pose2 base_in_grid = map_->geometry().origin.inverse() * base_in_map;
  if (std::hypot(base_in_grid.x, base_in_grid.y) > kFarthest ||
      std::hypot(stddev.x, stddev.y) > kFarthest)
    throw hyselam::InputError("initial pose", "",
                              "or its standard deviation lies more than 1000 km off the map");
  travelled_ = 0.0;
  restartClock();
  phase_ = Phase::kGlobal;
  if (params_.model == Model::kHybrid)
    startChoice(gaussianParticles(base_in_grid, stddev, params_.candidate_particles,
                                  hyselam::mix(params_.seed, 0x1217)));
  else
    filter_.concentrate(base_in_grid, stddev);
}

void Localizer::restartClock() {
  sensor_.reset();
  observation_ = {};
  last_stamp_.reset();
  last_odom_.reset();
  updated_odom_.reset();
}

void Localizer::startSearch() {
  stage_ = Stage::kSearch;
  sensor_.reset();
}

void Localizer::startChoice(Particles particles) {
  stage_ = Stage::kChoice;
  explained_fast_.reset();
  explained_slow_.reset();
  judged_ = 0.0;
  // Few particles would let places die out by chance, and a sharp model by the luck of the nearest.
  continueWith(std::move(particles), params_.candidate_particles, params_.candidate_beams);
}

void Localizer::startTracking() {
  stage_ = Stage::kTrack;
  phase_ = Phase::kTracking;
  continueWith(filter_.particles(),
               std::min(params_.tracking_particles, params_.candidate_particles),
               params_.likelihood.independent_beams);
}

void Localizer::continueWith(Particles particles, std::size_t min_particles,
                             double independent_beams) {
  tracker_->setIndependentBeams(independent_beams);
  FilterParams p = params_.filter;
  p.adaptive_size = true;
  p.min_particles = min_particles;
  p.max_particles = params_.candidate_particles;
  p.recovery_alpha_slow = p.recovery_alpha_fast = 0.0;  // supervise() sees to that
  filter_ =
      ParticleFilter(map_, p,
                     hyselam::mix(params_.seed, 2 * static_cast<std::uint64_t>(travelled_ * 1000) +
                                                    (stage_ == Stage::kTrack ? 1 : 0)));
  filter_.take(std::move(particles));
}

void Localizer::searchAgain() {
  const Particles old = filter_.particles();
  filter_ = ParticleFilter(
      map_, params_.filter,
      hyselam::mix(params_.seed, 0x5ea7c4 + static_cast<std::uint64_t>(travelled_ * 1000)));
  if (phase_ == Phase::kTracking && old.size() > 0) {  // the alarm may be false
    Particles mixed = filter_.particles();
    const auto every = static_cast<std::size_t>(1.0 / kGuessShare);
    for (std::size_t i = 0, k = 0; i < mixed.size(); i += every, k = (k + 1) % old.size())
      mixed.set(i, old.pose(k), 1.0F);
    filter_.take(std::move(mixed));
    phase_ = Phase::kLost;
  }
  startSearch();
}

std::optional<LocalizationResult> Localizer::update(const hyselam::LaserScan& scan,
                                                    const Pose2& base_in_odom, bool force) {
  if (!std::isfinite(scan.stamp)) throw hyselam::InputError("laser scan", "stamp", "not finite");
  if (last_stamp_ && scan.stamp <= *last_stamp_)
    throw hyselam::InputError("laser scan", "stamp", "not later than the scan before");
  sensor_.integrate(scan, base_in_odom);  // refuses what cannot be used, before anything changes
  last_stamp_ = scan.stamp;
  if (last_odom_) travelled_ += hyselam::distance(*last_odom_, base_in_odom);
  last_odom_ = base_in_odom;

  const Pose2 delta = updated_odom_ ? hyselam::between(*updated_odom_, base_in_odom) : Pose2{};
  const double moved = std::hypot(delta.x, delta.y);
  if (updated_odom_ && !force && moved < params_.update_min_d &&
      std::abs(delta.theta) < params_.update_min_a)
    return std::nullopt;
  updated_odom_ = base_in_odom;

  observation_.scan = scan;
  observation_.fsd = usesFsd() ? sensor_.observe() : FsdObservation{};
  const FilterStep step = filter_.step(delta, activeModel(), observation_);
  const PoseEstimate estimate = estimatePose(filter_.particles());

  LocalizationResult result;
  result.stamp = scan.stamp;
  const Pose2& origin = map_->geometry().origin;
  result.base_in_map = origin * estimate.mean;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  const double c = std::cos(origin.theta), s = std::sin(origin.theta);
  rotation.topLeftCorner<2, 2>() << c, -s, s, c;
  result.covariance = rotation * estimate.covariance * rotation.transpose();
  result.converged = estimate.share >= params_.converged_share &&
                     estimate.positionStddev() <= params_.converged_stddev;
  result.cluster_share = estimate.share;
  result.particles = filter_.particles().size();
  result.effective_size = step.effective_size;
  result.travelled = travelled_;
  if (params_.model == Model::kHybrid) {
    // Turning shows the same surroundings again: enough to see that they do not fit, too little to
    // tell places apart that look alike.
    const double turned = stage_ == Stage::kTrack ? std::abs(delta.theta) : 0.0;
    supervise(estimate, moved + kTurnAsTravel * turned, result);
  } else {
    phase_ = result.converged ? Phase::kTracking : Phase::kGlobal;
  }
  result.phase = phase_;
  return result;
}

void Localizer::supervise(const PoseEstimate& estimate, double motion, LocalizationResult& result) {
  if (stage_ == Stage::kSearch) {
    result.converged = false;  // the search alone is coarse; the likelihood field has the last word
    const std::size_t limit =
        std::min(params_.max_candidate_bins, filter_.particles().size() / kParticlesPerBin);
    if (estimate.bins > 0 && estimate.bins <= limit)
      startChoice(filter_.resampledCopy(params_.candidate_particles, kCandidateBlur));
    return;
  }
  judged_ += motion;
  result.explained =
      tracker_->explainedShare(observation_.scan, estimate.mean, params_.explained_tolerance);
  if (result.explained) {
    const auto follow = [&](std::optional<double>& average, double memory) {
      const double before = average.value_or(*result.explained);
      average = before + std::min(1.0, motion / memory) * (*result.explained - before);
    };
    follow(explained_fast_, kFastMemory);
    follow(explained_slow_, kSlowMemory);
    const double limit =
        std::max(stage_ == Stage::kChoice ? params_.found_above : params_.lost_below,
                 params_.lost_ratio * *explained_slow_);
    if (judged_ > kFastMemory && *explained_fast_ < limit) {
      result.converged = false;
      searchAgain();
      return;
    }
  }
  if (stage_ == Stage::kTrack) return;
  result.converged = result.converged && explained_fast_.value_or(0.0) >= params_.found_above;
  if (result.converged) startTracking();
}

}  // namespace fsd_localization
