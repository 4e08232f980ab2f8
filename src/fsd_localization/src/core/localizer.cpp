#include "fsd_localization/localizer.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/coarsen.hpp"
#include "hyselam_common/errors.hpp"

namespace fsd_localization {

using hyselam::ParameterError;
using hyselam::Pose2;
using hyselam::Range;

namespace {

constexpr Pose2 kHypothesisBlur{0.1, 0.1, hyselam::radians(4.0)};  // between particles of a search
constexpr std::size_t kParticlesPerBin = 10;  // fewer: the bins are few because the particles are
constexpr double kMatchedNoise = 0.3;   // of the wheels' noise, where scans confirm the motion
constexpr double kQuickTurn = 0.3;      // [rad] in an update: its scans may be matched a little off
constexpr double kFarthest = 1e6;       // [m] beyond it cell numbers would not fit an int
constexpr double kWeakMatch = 0.4;      // a scan of which less lies on what was seen last
constexpr double kSuddenMatch = 0.65;   // of the usual share of a scan on what was seen last
constexpr double kMatchMemory = 0.2;    // weight of a scan in the usual share
constexpr std::size_t kStayEvery = 10;  // each tenth particle stays at the old place when lost

// Streams of random numbers that differ from each other: one per cause, and per millimetre
// travelled.
constexpr std::uint64_t kInitialPoseStream = 0x1217;
constexpr std::uint64_t kSearchAgainStream = 0x5ea7c4;
std::uint64_t millimeters(double travelled) {
  return static_cast<std::uint64_t>(travelled * 1000);
}

/// Each scan of an update is matched, and few others.
hyselam_scan_matching::ScanOdometryParams scanOdometryParams() {
  hyselam_scan_matching::ScanOdometryParams p;
  p.scan_step = p.scan_turn = 0.08;
  return p;
}

FsdSensorParams sensorParams(const LocalizerParams& p) {
  FsdSensorParams s;
  s.local_map = p.local_map;
  s.kernels = p.map.kernels;
  s.gradient = p.map.gradient;
  s.with_frontiers = false;
  return s;
}

}  // namespace

void LocalizerParams::describe(hyselam::ParameterVisitor& visit) {
  visit("model", model,
        {{"fsd", ObservationModelKind::kFsd},
         {"beam", ObservationModelKind::kBeam},
         {"cosine", ObservationModelKind::kCosine},
         {"likelihood", ObservationModelKind::kLikelihood},
         {"hybrid", ObservationModelKind::kHybrid}},
        "observation model");
  visit("seed", seed, Range::atLeast(0), "", "equal seeds and input give equal results");
  visit("update_min_d", update_min_d, Range::atLeast(0.0), "m", "travel between updates");
  visit("update_min_a", update_min_a, Range::atLeast(0.0), "rad", "or turn");
  visit("refine_odometry", refine_odometry,
        "hybrid: odometry is refined by matching scans with what was seen last");
  visit("submap_search", submap_search,
        "hybrid: the scans of the last metres are searched on the whole map");
  visit("short_term_layer", short_term_layer,
        "with submap_search: what the last scans saw where the map has nothing does not count in "
        "tracking");
  visit("search_latency", search_latency, Range::between(0.0, 60.0), "s",
        "an answer of the search counts so long after its question, so that equal runs are equal");
  const Range probability = Range::inside(0.0, 1.0);
  visit("found_probability", found_probability, probability, "",
        "a place that the search found is believed from this probability on");
  visit("lost_probability", lost_probability, probability, "",
        "lost, if another place is right with this probability");
  visit.group("place_judge_", place_odds);
  visit.group("", filter);
  visit.renamed("converged_share", "converged_cluster_weight");
  visit("converged_cluster_weight", converged_cluster_weight, Range::aboveUpTo(0.0, 1.0), "",
        "share of the weight in the heaviest cluster, for its pose to count as converged");
  visit("converged_stddev", converged_stddev, Range::above(0.0), "m",
        "and largest standard deviation of its position");
  describeHybrid(visit);
  visit.group("", map);
  visit.group("fsd_", fsd);
  visit.group("local_map_", local_map);
  // amcl's laser_* belong to the model that weighs beams.
  if (model == ObservationModelKind::kBeam) {
    visit.group("laser_", beam);
  } else if (model == ObservationModelKind::kCosine) {
    visit.group("laser_", cosine, {{"exponent", "cosine_exponent"}});
  } else if (model != ObservationModelKind::kFsd) {
    visit.group("laser_", likelihood, {{"max_distance", "laser_likelihood_max_dist"}});
  }
}

void LocalizerParams::describeHybrid(hyselam::ParameterVisitor& visit) {
  const Range count = Range::between(1, 1e7);
  visit("tracking_particles", tracking_particles, count, "",
        "hybrid: fewest particles while tracking");
  visit.renamed("candidate_particles", "hypothesis_particles");
  visit("hypothesis_particles", hypothesis_particles, count, "",
        "hybrid: while the likelihood field chooses among places");
  visit.renamed("candidate_beams", "hypothesis_beams");
  visit("hypothesis_beams", hypothesis_beams, Range::aboveUpTo(0.0, 1e4), "",
        "hybrid: what the beams of a scan count as meanwhile; few, so that it chooses slowly");
  visit.renamed("max_candidate_bins", "max_hypothesis_bins");
  visit("max_hypothesis_bins", max_hypothesis_bins, count, "",
        "hybrid without submap_search: it does when the particles fill no more bins of 0.5 m and "
        "15 deg");
  visit.renamed("explained_tolerance", "inlier_distance");
  visit("inlier_distance", inlier_distance, Range::above(0.0), "m",
        "hybrid: a return this near to a mapped obstacle is an inlier");
  const Range ratio = Range::fromBelow(0.0, 1.0);
  visit.renamed("found_above", "found_inlier_ratio");
  visit("found_inlier_ratio", found_inlier_ratio, ratio, "",
        "hybrid: share of inliers, averaged over about 1 m, that a place needs that was told, or "
        "that "
        "the search is not sure of; without submap_search: each");
  visit.renamed("lost_below", "lost_inlier_ratio");
  visit(
      "lost_inlier_ratio", lost_inlier_ratio, ratio, "",
      "hybrid: below this share of inliers, averaged over about 1 m, the map is searched, and the "
      "pose not relied on until that confirms it; without submap_search: lost");
  visit.renamed("lost_ratio", "lost_relative_ratio");
  visit("lost_relative_ratio", lost_relative_ratio, ratio, "",
        "hybrid: below this times its average over about 30 m the map is searched; without "
        "submap_search: lost");
}

void LocalizerParams::validate() const {
  hyselam::checkParameters(*this);
  if (hypothesis_particles < tracking_particles) {
    throw ParameterError("hypothesis_particles", hypothesis_particles, ">= tracking_particles");
  }
  map.validate();
  sensorParams(*this).validate();
  beam.validate();  // also those of models that are not in use
  cosine.validate();
  likelihood.validate();
  filter.validate();
}

namespace {

/// Densities are compared on cells of equal size: those of the local map, if the map's are finer.
/// This also closes the gaps in walls of finely drawn maps, through which free space would leak.
hyselam::OccupancyGrid coarsenForDensities(const hyselam::OccupancyGrid& map,
                                           const LocalizerParams& params) {
  return hyselam::coarsen(
      map, hyselam::coarseningFactor(map.geometry.resolution, params.local_map.resolution));
}

std::shared_ptr<const FsdMap> densityMap(const hyselam::OccupancyGrid& map,
                                         const LocalizerParams& params,
                                         const std::string& cache_path,
                                         const std::function<void(double)>& progress, bool* cached,
                                         std::string* problem) {
  const hyselam::OccupancyGrid coarse = coarsenForDensities(map, params);
  return std::make_shared<const FsdMap>(
      cache_path.empty()
          ? FsdMap(coarse, params.map, 0, progress)
          : FsdMap::cached(cache_path, coarse, params.map, 0, progress, cached, problem));
}

}  // namespace

void Localizer::checkMap(const hyselam::OccupancyGrid& map, const LocalizerParams& params) {
  const hyselam::OccupancyGrid coarse = coarsenForDensities(map, params);
  const auto free = [&](std::int8_t v) { return params.map.thresholds.isFree(v); };
  if (std::none_of(coarse.cells.begin(), coarse.cells.end(), free)) {
    throw hyselam::InputError("map", "", "has no free cell to put particles on");
  }
  for (const KernelSpec& spec : params.map.kernels) Kernel(spec, coarse.geometry.resolution);
}

Localizer::Localizer(const hyselam::OccupancyGrid& map, const LocalizerParams& params,
                     const std::string& cache_path, const std::function<void(double)>& progress)
    : params_((params.validate(), params)),
      map_(densityMap(map, params, cache_path, progress, &map_was_cached_, &map_cache_problem_)),
      sensor_(sensorParams(params)),
      filter_(map_, params_.filter, params.seed),
      scan_odometry_(scanOdometryParams()) {
  const auto rays = [&] {
    return std::make_shared<const GridRayCaster>(map, params.map.thresholds);
  };
  switch (params_.model) {
    case ObservationModelKind::kBeam:
      model_ = std::make_unique<BeamModel>(rays(), params_.beam);
      break;
    case ObservationModelKind::kCosine:
      model_ = std::make_unique<CosineModel>(rays(), params_.cosine);
      break;
    case ObservationModelKind::kLikelihood:
      model_ =
          std::make_unique<LikelihoodFieldModel>(map, params_.likelihood, params_.map.thresholds);
      break;
    case ObservationModelKind::kHybrid:
      likelihood_model_ =
          std::make_unique<LikelihoodFieldModel>(map, params_.likelihood, params_.map.thresholds);
      [[fallthrough]];
    case ObservationModelKind::kFsd:
      model_ = std::make_unique<FsdObservationModel>(map_, params_.fsd);
  }
  if (isHybrid() && params_.submap_search) {
    search_.background = std::make_unique<BackgroundSearch>(
        std::make_shared<const PlaceSearch>(map, params_.map.thresholds), params_.search_latency);
  }
}
Localizer::~Localizer() = default;

const ObservationModel& Localizer::activeModel() const {
  return isHybrid() && !isSearching(state_) ? *likelihood_model_ : *model_;
}

void Localizer::relocalizeGlobally() {
  filter_ = ParticleFilter(map_, params_.filter, hyselam::splitmix64(params_.seed));
  state_ = LocalizerState::kGlobalSearch;
  travelled_ = 0.0;
  restartClock();
}

void Localizer::setInitialPose(const Pose2& base_in_map, const Pose2& stddev) {
  if (!base_in_map.isFinite()) throw hyselam::InputError("initial pose", "", "not finite");
  if (!stddev.isFinite() || stddev.x < 0.0 || stddev.y < 0.0 || stddev.theta < 0.0) {
    throw hyselam::InputError("initial pose", "standard deviations",
                              "must be finite and not negative");
  }
  const Pose2 base_in_grid = map_->geometry().origin.inverse() * base_in_map;
  if (std::hypot(base_in_grid.x, base_in_grid.y) > kFarthest ||
      std::hypot(stddev.x, stddev.y) > kFarthest) {
    throw hyselam::InputError("initial pose", "",
                              "or its standard deviation lies more than 1000 km off the map");
  }
  travelled_ = 0.0;
  restartClock();
  state_ = LocalizerState::kGlobalSearch;
  search_.guided = true;
  if (isHybrid()) {
    startHypotheses(gaussianParticles(base_in_grid, stddev, params_.hypothesis_particles,
                                      hyselam::mix(params_.seed, kInitialPoseStream)));
  } else {
    filter_.concentrateAround(base_in_grid, stddev);
  }
}

void Localizer::restartClock() {
  sensor_.reset();
  observation_ = {};
  last_stamp_.reset();
  last_odom_.reset();
  updated_odom_.reset();
  scan_odometry_.reset();
  forgetSearch();
}

void Localizer::startHypotheses(Particles particles) {
  state_ = withHypotheses(state_);
  inliers_.reset();
  // Few particles would let places die out by chance, and a sharp model by the luck of the nearest.
  startLikelihoodFilter(std::move(particles), params_.hypothesis_particles,
                        params_.hypothesis_beams);
}

void Localizer::startTracking() {
  state_ = LocalizerState::kTracking;
  startLikelihoodFilter(filter_.particles(),
                        std::min(params_.tracking_particles, params_.hypothesis_particles),
                        params_.likelihood.independent_beams);
}

void Localizer::startLikelihoodFilter(Particles particles, std::size_t min_particles,
                                      double independent_beams) {
  likelihood_model_->setIndependentBeams(independent_beams);
  FilterParams p = params_.filter;
  p.adaptive_size = true;
  p.min_particles = min_particles;
  p.max_particles = params_.hypothesis_particles;
  p.recovery_alpha_slow = p.recovery_alpha_fast = 0.0;  // a search recovers
  const std::uint64_t stream =
      2 * millimeters(travelled_) + (state_ == LocalizerState::kTracking ? 1 : 0);
  filter_ = ParticleFilter(map_, p, hyselam::mix(params_.seed, stream));
  filter_.setParticles(std::move(particles));
}

void Localizer::searchAgain() {
  const Particles old = filter_.particles();
  filter_ =
      ParticleFilter(map_, params_.filter,
                     hyselam::mix(params_.seed, kSearchAgainStream + millimeters(travelled_)));
  if (phaseOf(state_) != Phase::kGlobal && old.size() > 0) {  // the alarm may be false
    Particles mixed = filter_.particles();
    for (std::size_t i = 0, k = 0; i < mixed.size(); i += kStayEvery, k = (k + 1) % old.size()) {
      mixed.set(i, old.pose(k), 1.0F);
    }
    filter_.setParticles(std::move(mixed));
  }
  state_ = backToSearch(state_);
  sensor_.reset();
}

/// The pose in the smooth frame of the motion.
Pose2 Localizer::addScan(const hyselam::LaserScan& scan, const Pose2& base_in_odom) {
  Pose2 smooth = base_in_odom;
  if (refinesOdometry()) {
    const auto step = scan_odometry_.add(scan, base_in_odom);
    smooth = step.pose;
    if (step.broken || (step.matched && step.inlier_ratio < kWeakMatch)) by_wheels_ = true;
    if (step.matched) {
      std::optional<double>& usual = search_.usual_match;
      if (usual && step.inlier_ratio < kSuddenMatch * *usual) search_.signs.unmatched = true;
      usual = usual.value_or(step.inlier_ratio) +
              kMatchMemory * (step.inlier_ratio - usual.value_or(step.inlier_ratio));
    }
    if (step.broken && search_.background) {  // what was seen before lies nobody knows where
      search_.submap.reset();
      search_.short_term.clear();
      search_.followed.reset();
      search_.background->drop();
      search_.signs.broken = search_.signs.broken || !step.matched;  // the odometry jumped
    }
  }
  if (keeps_local_map_ || usesFsd()) {
    if (local_map_is_old_) sensor_.reset();
    sensor_.integrate(scan, smooth);
    local_map_is_old_ = false;
  } else {
    local_map_is_old_ = true;
  }
  if (search_.background) search_.submap.add(scan, smooth);
  return smooth;
}

std::optional<LocalizationResult> Localizer::update(const hyselam::LaserScan& scan,
                                                    const Pose2& base_in_odom, bool force) {
  if (!std::isfinite(scan.stamp)) throw hyselam::InputError("laser scan", "stamp", "not finite");
  if (last_stamp_ && scan.stamp <= *last_stamp_) {
    throw hyselam::InputError("laser scan", "stamp", "not later than the scan before");
  }
  sensor_.check(scan, base_in_odom);  // refuses what cannot be used, before anything changes
  const Pose2 smooth = addScan(scan, base_in_odom);
  last_stamp_ = scan.stamp;
  if (last_odom_) travelled_ += hyselam::distance(*last_odom_, base_in_odom);
  last_odom_ = base_in_odom;

  const Pose2 delta = updated_odom_ ? hyselam::between(*updated_odom_, smooth) : Pose2{};
  const double moved = std::hypot(delta.x, delta.y);
  const bool answered = search_.background && search_.background->isDue(scan.stamp);
  const bool stands =
      updated_odom_ && moved < params_.update_min_d && std::abs(delta.theta) < params_.update_min_a;
  const bool turned_odd = watchStanding(stands, scan, delta);
  if (stands && !force && !answered && !turned_odd) return std::nullopt;
  updated_odom_ = smooth;

  observation_.scan = scan;
  observation_.fsd = usesFsd() ? sensor_.observe() : FsdObservation{};
  const bool is_sure = refinesOdometry() && !by_wheels_ && !isSearching(state_) &&
                       std::abs(delta.theta) <= kQuickTurn;
  by_wheels_ = false;
  if (state_ == LocalizerState::kTracking && !search_.short_term.empty()) {
    observation_.scan = search_.short_term.without(scan, smooth);
  }
  const FilterStep step =
      filter_.step(delta, activeModel(), observation_, is_sure ? kMatchedNoise : 1.0);
  observation_.scan = scan;
  const PoseEstimate estimate = estimatePose(filter_.particles());

  LocalizationResult result = resultOf(estimate, step.effective_size);
  if (isHybrid()) {
    // Turning shows the same surroundings again: enough to see that they do not fit, too little to
    // distinguish places that look alike.
    const double turned = state_ == LocalizerState::kTracking ? std::abs(delta.theta) : 0.0;
    const double motion = moved + kTurnAsTravel * turned;
    if (search_.background) {
      search_.way += moved + kTurnAsTravel * std::abs(delta.theta);
      updateBySearch(estimate, motion, result);
      learnShortTerm(estimate.mean);
    } else {
      updateByInliers(estimate, motion, result);
    }
  } else {
    state_ = result.converged ? LocalizerState::kTracking : LocalizerState::kGlobalSearch;
  }
  result.phase = phaseOf(state_);
  return result;
}

LocalizationResult Localizer::resultOf(const PoseEstimate& estimate, double effective_size) const {
  LocalizationResult result;
  result.stamp = observation_.scan.stamp;
  const Pose2& origin = map_->geometry().origin;
  result.base_in_map = origin * estimate.mean;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  const double c = std::cos(origin.theta), s = std::sin(origin.theta);
  rotation.topLeftCorner<2, 2>() << c, -s, s, c;
  result.covariance = rotation * estimate.covariance * rotation.transpose();
  result.converged = estimate.cluster_weight >= params_.converged_cluster_weight &&
                     estimate.positionStddev() <= params_.converged_stddev;
  result.cluster_weight = estimate.cluster_weight;
  result.particles = filter_.particles().size();
  result.effective_size = effective_size;
  result.travelled = travelled_;
  return result;
}

void Localizer::updateByInliers(const PoseEstimate& estimate, double motion,
                                LocalizationResult& result) {
  if (isSearching(state_)) {
    result.converged = false;  // the search alone is coarse; the likelihood field has to confirm
    const std::size_t limit =
        std::min(params_.max_hypothesis_bins, filter_.particles().size() / kParticlesPerBin);
    if (estimate.bins > 0 && estimate.bins <= limit) {
      startHypotheses(filter_.resampledCopy(params_.hypothesis_particles, kHypothesisBlur));
    }
    return;
  }
  result.inlier_ratio =
      likelihood_model_->inlierRatio(observation_.scan, estimate.mean, params_.inlier_distance);
  inliers_.add(result.inlier_ratio, motion);
  const bool tracking = state_ == LocalizerState::kTracking;
  if (inliers_.isBelow(tracking ? params_.lost_inlier_ratio : params_.found_inlier_ratio,
                       params_.lost_relative_ratio)) {
    result.converged = false;
    searchAgain();
    return;
  }
  if (tracking) return;
  result.converged = result.converged && inliers_.average() >= params_.found_inlier_ratio;
  if (result.converged) startTracking();
}

}  // namespace fsd_localization
