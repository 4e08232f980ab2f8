// The text of a live robot: densities in; words, matches and regions out.
#pragma once

#include <hyselam_msgs/CorpusPath.h>
#include <hyselam_msgs/FsdObservation.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <memory>
#include <optional>

#include "hyselam_common/ros/diagnostics.hpp"
#include "hyselam_common/ros/drop_counter.hpp"
#include "hyselam_common/ros/rate_limit.hpp"
#include "hyselam_common/ros/scan_input.hpp"
#include "ngram_slam/ros/parameters.hpp"
#include "ngram_slam/ros/word_markers.hpp"
#include "ngram_slam/words/corpus_journal.hpp"

namespace ngram_slam {

/// Topics: in `fsd_observation`, or `scan` and tf; out `words`, `word_matches`, `semantic_regions`,
/// `word_markers` (only while someone listens), /diagnostics. Services `~save`, `~load`,
/// `~start_run`. All callbacks on the queue of `nh`, one at a time.
class WordsServer {
 public:
  /// Reads and checks the parameters of `private_nh` and the corpus, before anything is subscribed.
  /// @throws hyselam::ParameterError, hyselam::InputError for a corpus that cannot be used.
  WordsServer(ros::NodeHandle nh, ros::NodeHandle private_nh);
  /// Saves the corpus.
  ~WordsServer();
  WordsServer(const WordsServer&) = delete;
  WordsServer& operator=(const WordsServer&) = delete;

 private:
  void onFsd(const hyselam_msgs::FsdObservation::ConstPtr& msg);
  void take(const std::vector<DensityObservation>& observations);
  void take(const DensityObservation& observation);
  void startAnew(const std::string& why);
  void endRun(const std::string& why);
  void told(const NgramRecognizerUpdate& update);
  void told(const std::vector<SemanticRegion>& regions);
  std_msgs::Header header() const;
  void show();
  void restart(Corpus corpus);
  void saveNow(const char* when);
  bool onSave(hyselam_msgs::CorpusPath::Request& request, hyselam_msgs::CorpusPath::Response& out);
  bool onLoad(hyselam_msgs::CorpusPath::Request& request, hyselam_msgs::CorpusPath::Response& out);
  bool onStartRun(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& out);
  void report(diagnostic_msgs::DiagnosticStatus& status);

  std::string who_;
  WordsServerParams params_;
  std::unique_ptr<CorpusJournal> journal_;  // empty: no corpus is kept
  std::unique_ptr<NgramRecognizer> recogniser_;
  SemanticSegmenter segmenter_;
  std::uint32_t segmenter_begin_ = 0;  // observations of the corpus before the segmenter's first
  ObservationSensor sensor_;           // with input scan
  WaySampler sampler_;                 // with input fsd_observation
  std::optional<DensityObservation> last_;  // of this run
  std::size_t told_words_ = 0;
  ShownRun shown_;

  std::size_t received_ = 0, used_ = 0, matches_ = 0, regions_ = 0, time_jumps_ = 0, leaps_ = 0;
  std::size_t reported_received_ = 0, reported_drops_ = 0;
  double word_ms_ = 0.0, worst_word_ms_ = 0.0;
  ros::Time last_stamp_;
  ros::WallTime saved_at_;
  double save_ms_ = 0.0;
  std::string save_error_;
  hyselam::DropCounter drops_;
  hyselam::RateLimit gui_rate_;
  ros::Publisher word_publisher_, match_publisher_, region_publisher_, marker_publisher_;
  ros::ServiceServer save_service_, load_service_, start_service_;
  ros::WallTimer save_timer_;
  std::unique_ptr<hyselam::ScanInput> scan_input_;
  ros::Subscriber subscriber_;
  std::unique_ptr<hyselam::Diagnostics> diagnostics_;
};

}  // namespace ngram_slam
