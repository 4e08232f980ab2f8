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
  struct Publishers {
    ros::Publisher words, matches, regions, markers;
  };
  struct Services {
    ros::ServiceServer save, load, start_run;
  };
  /// For the diagnostics.
  struct Statistics {
    std::size_t received = 0, used = 0, matches = 0, regions = 0;
    std::size_t time_jumps = 0, odometry_jumps = 0;
    std::size_t reported_received = 0, reported_drops = 0;
    double word_ms = 0.0, max_word_ms = 0.0, save_ms = 0.0;
    std::string save_error;
  };

  void advertise(ros::NodeHandle nh, ros::NodeHandle private_nh);
  void onFsd(const hyselam_msgs::FsdObservation::ConstPtr& msg);
  bool isUsable(const hyselam_msgs::FsdObservation& msg);
  void addObservations(const std::vector<DensityObservation>& observations);
  void addObservation(const DensityObservation& observation);
  void startNewRun(const std::string& reason);
  void endRun(const std::string& reason);
  void publishUpdate(const NgramRecognizerUpdate& update);
  void publishRegions(const std::vector<SemanticRegion>& regions);
  void publishMarkers();
  std_msgs::Header header() const;
  void goOnFrom(Corpus corpus);
  void saveIfChanged(const char* when);
  /// Of the request, else the parameter's; empty, and the answer says why, if there is none.
  std::string corpusPath(const hyselam_msgs::CorpusPath::Request& request,
                         hyselam_msgs::CorpusPath::Response* out) const;
  bool onSave(hyselam_msgs::CorpusPath::Request& request, hyselam_msgs::CorpusPath::Response& out);
  bool onLoad(hyselam_msgs::CorpusPath::Request& request, hyselam_msgs::CorpusPath::Response& out);
  bool onStartRun(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& out);
  void report(diagnostic_msgs::DiagnosticStatus& status);
  void reportInput(diagnostic_msgs::DiagnosticStatus& status);

  std::string log_name_;
  WordsServerParams params_;
  std::unique_ptr<CorpusJournal> journal_;  // empty: no corpus is kept
  std::unique_ptr<NgramRecognizer> recognizer_;
  std::shared_ptr<const SemanticClassifier> classifier_;
  SemanticSegmenter segmenter_;
  std::uint32_t segmenter_begin_ = 0;  // observations of the corpus before the segmenter's first
  ObservationSensor sensor_;           // with input scan
  ObservationSampler sampler_;         // with input fsd_observation
  std::optional<DensityObservation> last_;  // of this run
  std::size_t published_words_ = 0;
  ShownRun shown_;
  Statistics statistics_;
  ros::Time last_stamp_;
  hyselam::DropCounter drops_;
  hyselam::RateLimit marker_rate_;
  Publishers publishers_;
  Services services_;
  ros::WallTimer save_timer_;
  std::unique_ptr<hyselam::ScanInput> scan_input_;
  ros::Subscriber subscriber_;
  std::unique_ptr<hyselam::Diagnostics> diagnostics_;
};

}  // namespace ngram_slam
