#include "ngram_slam/ros/words_server.hpp"

#include <hyselam_msgs/SemanticRegionArray.h>
#include <hyselam_msgs/WordArray.h>
#include <hyselam_msgs/WordMatchArray.h>

#include <algorithm>
#include <utility>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/conversions.hpp"
#include "hyselam_common/ros/server_setup.hpp"
#include "ngram_slam/matching/match_place.hpp"
#include "ngram_slam/ros/conversions.hpp"
#include "ngram_slam/semantics/semantic_forest.hpp"
#include "wall_milliseconds.hpp"

namespace ngram_slam {

using hyselam::addRemark;
using hyselam::addValue;
using Status = diagnostic_msgs::DiagnosticStatus;

namespace {
constexpr std::uint32_t kQueue = 1000;
constexpr double kStampSlack = 2.0;  // [s] an older observation is not late: the bag began again
constexpr std::size_t kShownLines = 2000;  // matches
constexpr std::size_t kRegionsPerWord = 4;

/// @throws hyselam::InputError for a file of a forest that cannot be used
std::shared_ptr<const SemanticClassifier> classifierOf(const WordsServerParams& p) {
  if (p.semantic_classifier == SemanticClassifierKind::kTree) {
    return std::make_shared<DecisionTree>();
  }
  return std::make_shared<SemanticForest>(p.semantic_forest.empty()
                                              ? SemanticForest::shipped()
                                              : SemanticForest::load(p.semantic_forest));
}

}  // namespace

WordsServer::WordsServer(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : log_name_(hyselam::logName(private_nh)),
      params_(hyselam::loadAndLogParams(private_nh, loadWordsParams)),
      classifier_(classifierOf(params_)),
      segmenter_(params_.semantic, classifier_),
      sensor_(params_.sensor),
      sampler_(params_.sensor.step),
      drops_(log_name_, "observation"),
      marker_rate_(params_.gui_publish_rate) {
  Corpus corpus;
  if (!params_.corpus.empty()) {
    journal_ = std::make_unique<CorpusJournal>(params_.corpus);
    CorpusJournal::Loaded loaded = journal_->load();
    if (!loaded.remark.empty()) ROS_WARN_STREAM(log_name_ << " " << loaded.remark);
    corpus = std::move(loaded.corpus);
    ROS_INFO_STREAM(log_name_ << " corpus " << params_.corpus << ": " << corpus.observations.size()
                              << " observations of " << corpus.observations.runs() << " runs");
  }
  goOnFrom(std::move(corpus));

  advertise(nh, private_nh);
  if (journal_ && params_.save_period > 0.0) {
    save_timer_ =
        nh.createWallTimer(ros::WallDuration(params_.save_period),
                           [this](const ros::WallTimerEvent&) { saveIfChanged("now and then"); });
  }
  if (params_.fromScan()) {
    scan_input_ = std::make_unique<hyselam::ScanInput>(
        nh, params_.input, log_name_,
        [this](const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom,
               const ros::Time&) {
          addObservations(sensor_.add(scan, base_in_odom));
          return true;
        },
        [this] { startNewRun("time went back"); });
  } else {
    subscriber_ = nh.subscribe("fsd_observation", kQueue, &WordsServer::onFsd, this);
  }
  diagnostics_ = std::make_unique<hyselam::Diagnostics>(
      nh, private_nh.getNamespace().substr(1) + ": words", params_.diagnostic_period,
      [this](Status& status) { report(status); });
}

void WordsServer::advertise(ros::NodeHandle nh, ros::NodeHandle private_nh) {
  publishers_.words = nh.advertise<hyselam_msgs::WordArray>("words", kQueue);
  publishers_.matches = nh.advertise<hyselam_msgs::WordMatchArray>("word_matches", kQueue);
  publishers_.regions = nh.advertise<hyselam_msgs::SemanticRegionArray>("semantic_regions", kQueue);
  publishers_.markers = nh.advertise<visualization_msgs::MarkerArray>("word_markers", 1);
  services_.save = private_nh.advertiseService("save", &WordsServer::onSave, this);
  services_.load = private_nh.advertiseService("load", &WordsServer::onLoad, this);
  services_.start_run = private_nh.advertiseService("start_run", &WordsServer::onStartRun, this);
}

WordsServer::~WordsServer() {
  // No callback may change the corpus while it is written.
  diagnostics_.reset();
  subscriber_.shutdown();
  scan_input_.reset();
  save_timer_.stop();
  for (auto* service : {&services_.save, &services_.load, &services_.start_run}) {
    service->shutdown();
  }
  try {
    if (params_.fromScan()) addObservations(sensor_.finish());
  } catch (const std::exception& e) {
    ROS_ERROR_STREAM(log_name_ << " " << e.what());
  }
  saveIfChanged("at the end");
}

/// Goes on from a corpus.
void WordsServer::goOnFrom(Corpus corpus) {
  recognizer_ = std::make_unique<NgramRecognizer>(params_.recognizer, std::move(corpus));
  segmenter_ = SemanticSegmenter(params_.semantic, classifier_);
  segmenter_begin_ = recognizer_->observations().size();
  published_words_ = recognizer_->text().words();
  sensor_.finish();
  sampler_.reset();
  last_.reset();
  shown_ = {};
}

void WordsServer::onFsd(const hyselam_msgs::FsdObservation::ConstPtr& msg) {
  ++statistics_.received;
  if (!isUsable(*msg)) return;
  last_stamp_ = msg->header.stamp;
  try {
    const DensityObservation reading =
        fromMsg(*msg, params_.sensor.bandwidth, subscriber_.getTopic());
    const auto due = sampler_.due(reading.base_in_odom);
    if (!due.empty()) addObservations(sampler_.sampleAt(reading, due));
    ++statistics_.used;
  } catch (const hyselam::InputError& e) {
    drops_.drop("refused", e.what());
  }
}

/// Whether stamp and frame of an observation can be used; begins a new run when time went back.
bool WordsServer::isUsable(const hyselam_msgs::FsdObservation& msg) {
  const auto refuse = [this](const std::string& reason) {
    drops_.drop("refused", reason);
    return false;
  };
  const ros::Time stamp = msg.header.stamp;
  if (stamp.isZero()) return refuse("the observation has no stamp");
  std::string frame = msg.header.frame_id;
  if (!frame.empty() && frame[0] == '/') frame.erase(0, 1);
  if (frame != params_.input.odom_frame_id) {
    return refuse("the observation is in frame '" + frame + "', not in '" +
                  params_.input.odom_frame_id + "'");
  }
  if (stamp > last_stamp_) return true;
  const double back = (last_stamp_ - stamp).toSec();
  if (back < kStampSlack) {
    return refuse("its stamp is not later than that of the observation before");
  }
  ++statistics_.time_jumps;
  ROS_WARN_STREAM(log_name_ << " time went back by " << back << " s; a new run begins");
  startNewRun("time went back");
  return true;
}

void WordsServer::addObservations(const std::vector<DensityObservation>& observations) {
  for (const DensityObservation& o : observations) addObservation(o);
}

void WordsServer::addObservation(const DensityObservation& observation) {
  if (last_ && odometryJumped(*last_, observation)) {
    ++statistics_.odometry_jumps;
    endRun("the odometry jumped by " +
           std::to_string(hyselam::distance(last_->base_in_odom, observation.base_in_odom)) + " m");
  }
  const ros::WallTime begin = ros::WallTime::now();
  const NgramRecognizerUpdate update = recognizer_->add(observation);
  last_ = observation;
  std::vector<SemanticRegion> regions;
  if (params_.semantics) {
    const ObservationStore& observations = recognizer_->observations();
    regions = segmenter_.add(observations[observations.size() - 1]);
  }
  if (update.word || update.requantised) {
    statistics_.word_ms = millisecondsSince(begin);
    statistics_.max_word_ms = std::max(statistics_.max_word_ms, statistics_.word_ms);
  }
  publishUpdate(update);
  publishRegions(regions);
  if (marker_rate_.pass(hyselam::toRosTime(observation.stamp))) publishMarkers();
}

/// What follows is another run, and nothing lies between it and what was seen.
void WordsServer::startNewRun(const std::string& reason) {
  if (params_.fromScan()) addObservations(sensor_.finish());
  sampler_.reset();
  endRun(reason);
}

/// What follows starts at an unknown place.
void WordsServer::endRun(const std::string& reason) {
  if (!last_) return;
  ROS_INFO_STREAM(log_name_ << " the run ends: " << reason);
  last_.reset();
  publishUpdate(recognizer_->endRun());
  if (params_.semantics) publishRegions(segmenter_.finish());
  shown_ = {};
}

void WordsServer::publishUpdate(const NgramRecognizerUpdate& update) {
  const WordLattice& text = recognizer_->text();
  if (!update.word && !update.requantised) return;
  if (update.requantised) shown_.matches.clear();
  hyselam_msgs::WordArray words;
  words.header = header();
  words.replaces_previous = update.requantised;
  for (std::size_t i = update.requantised ? 0 : published_words_; i < text.words(); ++i)
    words.words.push_back(wordMsg(*recognizer_, static_cast<WordIndex>(i)));
  published_words_ = text.words();
  publishers_.words.publish(words);

  hyselam_msgs::WordMatchArray matches;
  matches.header = words.header;
  matches.replaces_previous = update.requantised;
  const ObservationStore& observations = recognizer_->observations();
  const std::uint32_t run_begin = observations.runBegin(observations.runs() - 1);
  for (const NgramMatch& m : update.matches) {
    const auto place = placeOf(*recognizer_, m);
    if (!place) continue;
    matches.matches.push_back(matchMsg(*recognizer_, m, *place));
    if (place->older >= run_begin) shown_.matches.push_back({*place, m.direction});
    while (shown_.matches.size() > kShownLines) shown_.matches.pop_front();
  }
  if (update.requantised) statistics_.matches = 0;
  statistics_.matches += matches.matches.size();
  publishers_.matches.publish(matches);
}

void WordsServer::publishRegions(const std::vector<SemanticRegion>& regions) {
  if (regions.empty()) return;
  hyselam_msgs::SemanticRegionArray out;
  out.header = header();
  for (SemanticRegion region : regions) {
    region.first += segmenter_begin_;
    region.last += segmenter_begin_;
    out.regions.push_back(regionMsg(recognizer_->observations(), region, params_.sensor.step));
    shown_.regions.push_back(region);
    // As many as words may cover.
    while (shown_.regions.size() > kRegionsPerWord * static_cast<std::size_t>(params_.shown_words))
      shown_.regions.pop_front();
  }
  statistics_.regions += out.regions.size();
  publishers_.regions.publish(out);
}

std_msgs::Header WordsServer::header() const {
  std_msgs::Header header;
  header.frame_id = params_.input.odom_frame_id;
  const ObservationStore& observations = recognizer_->observations();
  if (observations.size() > 0)
    header.stamp = hyselam::toRosTime(observations.stamp(observations.size() - 1));
  return header;
}

void WordsServer::publishMarkers() {
  if (publishers_.markers.getNumSubscribers() == 0) return;
  publishers_.markers.publish(wordMarkers(*recognizer_, shown_, params_.shown_words, header()));
}

void WordsServer::saveIfChanged(const char* when) {
  if (!journal_ || !recognizer_) return;
  if (journal_->saved() == recognizer_->observations().size()) return;
  const ros::WallTime begin = ros::WallTime::now();
  try {
    journal_->save(recognizer_->observations(), recognizer_->classes(), recognizer_->histogram());
    statistics_.save_error.clear();
    statistics_.save_ms = millisecondsSince(begin);
  } catch (const std::exception& e) {
    statistics_.save_error = e.what();
    ROS_ERROR_STREAM(log_name_ << " not saved (" << when << "): " << statistics_.save_error);
  }
}

std::string WordsServer::corpusPath(const hyselam_msgs::CorpusPath::Request& request,
                                    hyselam_msgs::CorpusPath::Response* out) const {
  std::string path = request.path.empty() ? params_.corpus : request.path;
  out->success = false;
  if (path.empty()) out->message = "no path given, and the parameter corpus is empty";
  return path;
}

bool WordsServer::onSave(hyselam_msgs::CorpusPath::Request& request,
                         hyselam_msgs::CorpusPath::Response& out) {
  const std::string path = corpusPath(request, &out);
  if (path.empty()) return true;
  try {
    if (journal_ && path == journal_->path()) {
      journal_->save(recognizer_->observations(), recognizer_->classes(), recognizer_->histogram());
    } else {
      // A whole file by itself; a journal that lies beside it belonged to the one before.
      CorpusJournal(path).saveWhole(recognizer_->observations(), recognizer_->classes(),
                                    recognizer_->histogram());
    }
    out.success = true;
    out.message = path + ": " + std::to_string(recognizer_->observations().size()) +
                  " observations of " + std::to_string(recognizer_->observations().runs()) +
                  " runs";
  } catch (const std::exception& e) {
    out.message = e.what();
    ROS_ERROR_STREAM(log_name_ << " not saved: " << e.what());
  }
  return true;
}

bool WordsServer::onLoad(hyselam_msgs::CorpusPath::Request& request,
                         hyselam_msgs::CorpusPath::Response& out) {
  const std::string path = corpusPath(request, &out);
  if (path.empty()) return true;
  try {
    // An empty corpus is where nothing was saved; asked for by name, the file must be there.
    CorpusJournal from(path);
    CorpusJournal::Loaded loaded = from.load();
    if (from.fileBytes() == 0) throw hyselam::InputError(path, "", "does not exist");
    out.message = path + ": " + std::to_string(loaded.corpus.observations.size()) +
                  " observations of " + std::to_string(loaded.corpus.observations.runs()) +
                  " runs" + (loaded.remark.empty() ? "" : "; " + loaded.remark);
    goOnFrom(std::move(loaded.corpus));
    // Another text than the file holds: what is saved next is written whole.
    if (journal_) {
      if (path == journal_->path())
        *journal_ = from;
      else
        *journal_ = CorpusJournal(journal_->path());
    }
    out.success = true;
    ROS_INFO_STREAM(log_name_ << " loaded " << out.message);
  } catch (const std::exception& e) {
    out.message = e.what();
    ROS_ERROR_STREAM(log_name_ << " not loaded: " << e.what());
  }
  return true;
}

bool WordsServer::onStartRun(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& out) {
  startNewRun("asked for");
  out.success = true;
  out.message =
      "the next observation starts run " + std::to_string(recognizer_->observations().runs());
  return true;
}

void WordsServer::reportInput(Status& status) {
  if (scan_input_) {
    scan_input_->checkClock();
    scan_input_->report(status);
    return;
  }
  Statistics& s = statistics_;
  const std::size_t fresh = s.received - s.reported_received;
  const std::size_t dropped = drops_.total() - s.reported_drops;
  s.reported_received = s.received;
  s.reported_drops = drops_.total();
  if (fresh == 0) addRemark(status, Status::WARN, "no observations");
  if (dropped > 0) {
    addRemark(status, Status::WARN, "dropping observations (" + drops_.last() + ")");
  }
  addValue(status, "observations received", s.received);
  addValue(status, "observations used", s.used);
  drops_.report(status);
  addValue(status, "time went back", s.time_jumps);
}

void WordsServer::report(Status& status) {
  const WordLattice& text = recognizer_->text();
  const ObservationStore& observations = recognizer_->observations();
  addRemark(status, Status::OK,
            std::to_string(text.positions()) + " words, " + std::to_string(statistics_.matches) +
                " matches");
  reportInput(status);
  addValue(status, "odometry jumps", statistics_.odometry_jumps);
  addValue(status, "runs", observations.runs());
  addValue(status, "observations", observations.size());
  addValue(status, "words", text.positions());
  addValue(status, "alternative words", text.words() - text.positions());
  addValue(status, "matches published", statistics_.matches);
  addValue(status, "regions published", statistics_.regions);
  addValue(status, "density classes", recognizer_->classes().list().size());
  addValue(status, "requantizations", recognizer_->requantisations());
  addValue(status, "last word [ms]", statistics_.word_ms);
  addValue(status, "slowest word [ms]", statistics_.max_word_ms);
  addValue(status, "memory [MB]", static_cast<double>(recognizer_->bytes()) / 1e6);
  if (!journal_) return;
  addValue(status, "corpus", journal_->path());
  addValue(status, "observations saved", journal_->saved());
  addValue(status, "last saving [ms]", statistics_.save_ms);
  addValue(status, "file and journal [MB]",
           static_cast<double>(journal_->fileBytes() + journal_->journalBytes()) / 1e6);
  if (!statistics_.save_error.empty()) {
    addRemark(status, Status::ERROR, "not saved: " + statistics_.save_error);
  }
}

}  // namespace ngram_slam
