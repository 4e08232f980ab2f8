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

namespace ngram_slam {

using hyselam::addRemark;
using hyselam::addValue;
using Status = diagnostic_msgs::DiagnosticStatus;

namespace {
constexpr std::uint32_t kQueue = 1000;
constexpr double kStampSlack = 2.0;  // [s] an older observation is not late: the bag began again
constexpr std::size_t kShownLines = 2000;  // matches
constexpr std::size_t kRegionsPerWord = 4;
}  // namespace

WordsServer::WordsServer(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : who_(hyselam::logName(private_nh)),
      params_(hyselam::loadAndLogParams(private_nh, loadWordsParams)),
      segmenter_(params_.semantic),
      sensor_(params_.sensor),
      sampler_(params_.sensor.step),
      drops_(who_, "observation"),
      gui_rate_(params_.gui_publish_rate) {
  Corpus corpus;
  if (!params_.corpus.empty()) {
    journal_ = std::make_unique<CorpusJournal>(params_.corpus);
    CorpusJournal::Loaded loaded = journal_->load();
    if (!loaded.remark.empty()) ROS_WARN_STREAM(who_ << " " << loaded.remark);
    corpus = std::move(loaded.corpus);
    ROS_INFO_STREAM(who_ << " corpus " << params_.corpus << ": " << corpus.observations.size()
                         << " observations of " << corpus.observations.runs() << " runs");
  }
  restart(std::move(corpus));

  word_publisher_ = nh.advertise<hyselam_msgs::WordArray>("words", 1000);
  match_publisher_ = nh.advertise<hyselam_msgs::WordMatchArray>("word_matches", 1000);
  region_publisher_ = nh.advertise<hyselam_msgs::SemanticRegionArray>("semantic_regions", 1000);
  marker_publisher_ = nh.advertise<visualization_msgs::MarkerArray>("word_markers", 1);
  save_service_ = private_nh.advertiseService("save", &WordsServer::onSave, this);
  load_service_ = private_nh.advertiseService("load", &WordsServer::onLoad, this);
  start_service_ = private_nh.advertiseService("start_run", &WordsServer::onStartRun, this);
  if (journal_ && params_.save_period > 0.0)
    save_timer_ =
        nh.createWallTimer(ros::WallDuration(params_.save_period),
                           [this](const ros::WallTimerEvent&) { saveNow("now and then"); });
  if (params_.from_scan) {
    scan_input_ = std::make_unique<hyselam::ScanInput>(
        nh, params_.input, who_,
        [this](const hyselam::LaserScan& scan, const hyselam::Pose2& base_in_odom,
               const ros::Time&) {
          take(sensor_.add(scan, base_in_odom));
          return true;
        },
        [this] { startAnew("time went back"); });
  } else {
    subscriber_ = nh.subscribe("fsd_observation", kQueue, &WordsServer::onFsd, this);
  }
  diagnostics_ = std::make_unique<hyselam::Diagnostics>(
      nh, private_nh.getNamespace().substr(1) + ": words", params_.diagnostic_period,
      [this](Status& status) { report(status); });
}

WordsServer::~WordsServer() {
  // No callback may change the corpus while it is written.
  diagnostics_.reset();
  subscriber_.shutdown();
  scan_input_.reset();
  save_timer_.stop();
  for (ros::ServiceServer* service : {&save_service_, &load_service_, &start_service_}) {
    service->shutdown();
  }
  try {
    if (params_.from_scan) take(sensor_.finish());
  } catch (const std::exception& e) {
    ROS_ERROR_STREAM(who_ << " " << e.what());
  }
  saveNow("at the end");
}

/// Goes on from a corpus.
void WordsServer::restart(Corpus corpus) {
  recogniser_ = std::make_unique<NgramRecognizer>(params_.recogniser, std::move(corpus));
  segmenter_ = SemanticSegmenter(params_.semantic);
  segmenter_begin_ = recogniser_->observations().size();
  told_words_ = recogniser_->text().words();
  sensor_.finish();
  sampler_.reset();
  last_.reset();
  shown_ = {};
}

void WordsServer::onFsd(const hyselam_msgs::FsdObservation::ConstPtr& msg) {
  ++received_;
  const ros::Time stamp = msg->header.stamp;
  if (stamp.isZero()) return drops_.drop("refused", "the observation has no stamp");
  std::string frame = msg->header.frame_id;
  if (!frame.empty() && frame[0] == '/') frame.erase(0, 1);
  if (frame != params_.input.odom_frame_id)
    return drops_.drop("refused", "the observation is in frame '" + frame + "', not in '" +
                                      params_.input.odom_frame_id + "'");
  if (stamp <= last_stamp_) {
    const double back = (last_stamp_ - stamp).toSec();
    if (back < kStampSlack)
      return drops_.drop("refused", "its stamp is not later than that of the observation before");
    ++time_jumps_;
    ROS_WARN_STREAM(who_ << " time went back by " << back << " s; a new run begins");
    startAnew("time went back");
  }
  last_stamp_ = stamp;
  try {
    const DensityObservation reading =
        fromMsg(*msg, params_.sensor.bandwidth, subscriber_.getTopic());
    const auto due = sampler_.due(reading.base_in_odom);
    if (!due.empty()) take(sampler_.take(reading, due));
    ++used_;
  } catch (const hyselam::InputError& e) {
    drops_.drop("refused", e.what());
  }
}

void WordsServer::take(const std::vector<DensityObservation>& observations) {
  for (const DensityObservation& o : observations) take(o);
}

void WordsServer::take(const DensityObservation& observation) {
  if (last_ && leapt(*last_, observation)) {
    ++leaps_;
    endRun("the odometry jumped by " +
           std::to_string(hyselam::distance(last_->base_in_odom, observation.base_in_odom)) + " m");
  }
  const ros::WallTime begin = ros::WallTime::now();
  const NgramRecognizerUpdate update = recogniser_->add(observation);
  last_ = observation;
  const std::vector<SemanticRegion> regions =
      params_.semantics
          ? segmenter_.add(recogniser_->observations()[recogniser_->observations().size() - 1])
          : std::vector<SemanticRegion>{};
  if (update.word || update.requantised) {
    word_ms_ = 1e3 * (ros::WallTime::now() - begin).toSec();
    worst_word_ms_ = std::max(worst_word_ms_, word_ms_);
  }
  told(update);
  told(regions);
  if (gui_rate_.pass(hyselam::toRosTime(observation.stamp))) show();
}

/// What follows is another run, and nothing lies between it and what was seen.
void WordsServer::startAnew(const std::string& why) {
  if (params_.from_scan) take(sensor_.finish());
  sampler_.reset();
  endRun(why);
}

/// What follows starts at an unknown place.
void WordsServer::endRun(const std::string& why) {
  if (!last_) return;
  ROS_INFO_STREAM(who_ << " the run ends: " << why);
  last_.reset();
  told(recogniser_->endRun());
  if (params_.semantics) told(segmenter_.finish());
  shown_ = {};
}

void WordsServer::told(const NgramRecognizerUpdate& update) {
  const WordLattice& text = recogniser_->text();
  if (!update.word && !update.requantised) return;
  if (update.requantised) shown_.matches.clear();
  hyselam_msgs::WordArray words;
  words.header = header();
  words.anew = update.requantised;
  for (std::size_t i = update.requantised ? 0 : told_words_; i < text.words(); ++i)
    words.words.push_back(wordMsg(*recogniser_, static_cast<WordIndex>(i)));
  told_words_ = text.words();
  word_publisher_.publish(words);

  hyselam_msgs::WordMatchArray matches;
  matches.header = words.header;
  matches.anew = update.requantised;
  const ObservationStore& observations = recogniser_->observations();
  const std::uint32_t run_begin = observations.runBegin(observations.runs() - 1);
  for (const NgramMatch& m : update.matches) {
    const auto place = placeOf(*recogniser_, m);
    if (!place) continue;
    matches.matches.push_back(matchMsg(*recogniser_, m, *place));
    if (place->older >= run_begin) shown_.matches.push_back({*place, m.direction});
    while (shown_.matches.size() > kShownLines) shown_.matches.pop_front();
  }
  matches_ = (update.requantised ? 0 : matches_) + matches.matches.size();
  match_publisher_.publish(matches);
}

void WordsServer::told(const std::vector<SemanticRegion>& regions) {
  if (regions.empty()) return;
  hyselam_msgs::SemanticRegionArray out;
  out.header = header();
  for (SemanticRegion region : regions) {
    region.first += segmenter_begin_;
    region.last += segmenter_begin_;
    out.regions.push_back(regionMsg(recogniser_->observations(), region, params_.sensor.step));
    shown_.regions.push_back(region);
    // As many as words may cover.
    while (shown_.regions.size() > kRegionsPerWord * static_cast<std::size_t>(params_.shown_words))
      shown_.regions.pop_front();
  }
  regions_ += out.regions.size();
  region_publisher_.publish(out);
}

std_msgs::Header WordsServer::header() const {
  std_msgs::Header header;
  header.frame_id = params_.input.odom_frame_id;
  const ObservationStore& observations = recogniser_->observations();
  if (observations.size() > 0)
    header.stamp = hyselam::toRosTime(observations.stamp(observations.size() - 1));
  return header;
}

void WordsServer::show() {
  if (marker_publisher_.getNumSubscribers() > 0)
    marker_publisher_.publish(wordMarkers(*recogniser_, shown_, params_.shown_words, header()));
}

void WordsServer::saveNow(const char* when) {
  if (!journal_ || !recogniser_) return;
  if (journal_->saved() == recogniser_->observations().size()) return;
  const ros::WallTime begin = ros::WallTime::now();
  try {
    journal_->save(recogniser_->observations(), recogniser_->classes(), recogniser_->histogram());
    save_error_.clear();
    saved_at_ = ros::WallTime::now();
    save_ms_ = 1e3 * (saved_at_ - begin).toSec();
  } catch (const std::exception& e) {
    save_error_ = e.what();
    ROS_ERROR_STREAM(who_ << " not saved (" << when << "): " << save_error_);
  }
}

bool WordsServer::onSave(hyselam_msgs::CorpusPath::Request& request,
                         hyselam_msgs::CorpusPath::Response& out) {
  const std::string path = request.path.empty() ? params_.corpus : request.path;
  out.success = false;
  if (path.empty()) {
    out.message = "no path given, and the parameter corpus is empty";
    return true;
  }
  try {
    if (journal_ && path == journal_->path()) {
      journal_->save(recogniser_->observations(), recogniser_->classes(), recogniser_->histogram());
    } else {
      // A whole file by itself; a journal that lies beside it belonged to the one before.
      CorpusJournal(path).saveWhole(recogniser_->observations(), recogniser_->classes(),
                                    recogniser_->histogram());
    }
    out.success = true;
    out.message = path + ": " + std::to_string(recogniser_->observations().size()) +
                  " observations of " + std::to_string(recogniser_->observations().runs()) +
                  " runs";
  } catch (const std::exception& e) {
    out.message = e.what();
    ROS_ERROR_STREAM(who_ << " not saved: " << e.what());
  }
  return true;
}

bool WordsServer::onLoad(hyselam_msgs::CorpusPath::Request& request,
                         hyselam_msgs::CorpusPath::Response& out) {
  const std::string path = request.path.empty() ? params_.corpus : request.path;
  out.success = false;
  if (path.empty()) {
    out.message = "no path given, and the parameter corpus is empty";
    return true;
  }
  try {
    // An empty corpus is where nothing was saved; asked for by name, the file must be there.
    CorpusJournal from(path);
    CorpusJournal::Loaded loaded = from.load();
    if (from.fileBytes() == 0) throw hyselam::InputError(path, "", "does not exist");
    out.message = path + ": " + std::to_string(loaded.corpus.observations.size()) +
                  " observations of " + std::to_string(loaded.corpus.observations.runs()) +
                  " runs" + (loaded.remark.empty() ? "" : "; " + loaded.remark);
    restart(std::move(loaded.corpus));
    // Another text than the file holds: what is saved next is written whole.
    if (journal_) {
      if (path == journal_->path())
        *journal_ = from;
      else
        *journal_ = CorpusJournal(journal_->path());
    }
    out.success = true;
    ROS_INFO_STREAM(who_ << " loaded " << out.message);
  } catch (const std::exception& e) {
    out.message = e.what();
    ROS_ERROR_STREAM(who_ << " not loaded: " << e.what());
  }
  return true;
}

bool WordsServer::onStartRun(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& out) {
  startAnew("asked for");
  out.success = true;
  out.message =
      "the next observation starts run " + std::to_string(recogniser_->observations().runs());
  return true;
}

void WordsServer::report(Status& status) {
  const WordLattice& text = recogniser_->text();
  addRemark(status, Status::OK,
            std::to_string(text.positions()) + " words, " + std::to_string(matches_) + " matches");
  if (scan_input_) {
    scan_input_->checkClock();
    scan_input_->report(status);
  } else {
    const std::size_t fresh = received_ - reported_received_;
    const std::size_t dropped = drops_.total() - reported_drops_;
    reported_received_ = received_;
    reported_drops_ = drops_.total();
    if (fresh == 0) addRemark(status, Status::WARN, "no observations");
    if (dropped > 0)
      addRemark(status, Status::WARN, "dropping observations (" + drops_.last() + ")");
    addValue(status, "observations received", received_);
    addValue(status, "observations used", used_);
    drops_.report(status);
    addValue(status, "time went back", time_jumps_);
  }
  const ObservationStore& observations = recogniser_->observations();
  addValue(status, "odometry jumped", leaps_);
  addValue(status, "runs", observations.runs());
  addValue(status, "observations", observations.size());
  addValue(status, "words", text.positions());
  addValue(status, "alternative words", text.words() - text.positions());
  addValue(status, "matches told", matches_);
  addValue(status, "regions told", regions_);
  addValue(status, "density classes", recogniser_->classes().list().size());
  addValue(status, "requantisations", recogniser_->requantisations());
  addValue(status, "last word [ms]", word_ms_);
  addValue(status, "slowest word [ms]", worst_word_ms_);
  addValue(status, "memory [MB]", static_cast<double>(recogniser_->bytes()) / 1e6);
  if (!journal_) return;
  addValue(status, "corpus", journal_->path());
  addValue(status, "observations saved", journal_->saved());
  addValue(status, "last saving [ms]", save_ms_);
  addValue(status, "file and journal [MB]",
           static_cast<double>(journal_->fileBytes() + journal_->journalBytes()) / 1e6);
  if (!save_error_.empty()) addRemark(status, Status::ERROR, "not saved: " + save_error_);
}

}  // namespace ngram_slam
