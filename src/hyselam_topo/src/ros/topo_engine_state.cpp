// The state file of TopoEngine, and its diagnostics.
#include "hyselam_common/put_aside.hpp"
#include "hyselam_topo/dialogue/dialogue_state.hpp"
#include "hyselam_topo/ros/dialogue_markers.hpp"
#include "hyselam_topo/ros/topo_engine_server.hpp"

namespace hyselam_topo {
namespace {

constexpr double kPatience = 5.0;    // without a map until diagnostics warn [s]
constexpr double kSavePeriod = 2.0;  // at most so often [s]

}  // namespace

// ---- Files ----

void TopoEngineServer::restoreState() {
  if (params_.state_file.empty() || !hyselam::mayExist(params_.state_file)) return;
  try {
    load(params_.state_file);
  } catch (const std::exception& e) {
    const auto aside = hyselam::putAside(params_.state_file);
    ROS_ERROR_STREAM(who_ << " begins without its state: " << e.what() << hyselam::keptAs(aside));
    if (aside) {
      input_.put_aside = "begins without its state, kept as " + *aside + ": " + e.what();
    } else {
      input_.file_error = e.what();
      params_.state_file.clear();
    }
  }
}

void TopoEngineServer::load(const std::string& path) {
  shared_.restore(loadDialogueState(path));
  // Of the talk before; at the start there was none.
  if (forwarder_) {
    forwarder_->dropAll();
    forwarder_->endQuestion();
  }
  changed_ = false;
  // What was shown before is gone, also if the state has no map and no question.
  if (!dialogue_.places().hasMap())
    publishers_.markers.publish(namedMapMarkers(dialogue_.map(), params_.markers));
  publishMap();
  publishWalls();
  publishQuestion();
  publishOpen();
  publishPlace();
  ROS_INFO_STREAM(who_ << " goes on with " << dialogue_.map().places.size() << " places of "
                       << path);
}

void TopoEngineServer::save(const std::string& path) {
  saveDialogueState(path, dialogue_.state());
}

void TopoEngineServer::autosave() {
  if ((ros::WallTime::now() - saved_).toSec() >= kSavePeriod) saveChanges();
}

void TopoEngineServer::saveChanges() {
  if (!changed_ || params_.state_file.empty()) return;
  saved_ = ros::WallTime::now();
  try {
    save(params_.state_file);
    changed_ = false;
    input_.file_error.clear();
  } catch (const std::exception& e) {
    if (input_.file_error.empty())
      ROS_ERROR_STREAM(who_ << " the state is not saved: " << e.what());
    input_.file_error = e.what();
  }
}

// ---- Diagnostics ----

void TopoEngineServer::report(diagnostic_msgs::DiagnosticStatus& status) {
  using diagnostic_msgs::DiagnosticStatus;
  using hyselam::addRemark;
  using hyselam::addValue;
  for (const std::string* error :
       {&input_.map_error, &input_.grid_error, &input_.text_error, &input_.file_error}) {
    if (!error->empty()) addRemark(status, DiagnosticStatus::ERROR, *error);
  }
  if (!input_.put_aside.empty()) addRemark(status, DiagnosticStatus::WARN, input_.put_aside);
  const bool long_ago = (ros::WallTime::now() - started_).toSec() > kPatience;
  std::size_t confirmed = 0, guessed = 0;
  for (const Place& place : dialogue_.map().places) {
    const NameState state = nameStateOf(place);
    confirmed += state == NameState::kConfirmed ? 1 : 0;
    guessed += state == NameState::kUnconfirmed ? 1 : 0;
  }
  if (!dialogue_.places().hasMap()) {
    addRemark(status, long_ago ? DiagnosticStatus::WARN : DiagnosticStatus::OK,
              "no topological map has come");
  } else if (!input_.pose_error.empty()) {
    addRemark(status, DiagnosticStatus::WARN, "no pose: " + input_.pose_error);
  } else {
    addRemark(status, DiagnosticStatus::OK,
              std::to_string(dialogue_.map().places.size()) + " places, " +
                  std::to_string(confirmed) + " named");
  }
  addValue(status, "maps", input_.maps);
  addValue(status, "texts", input_.texts);
  addValue(status, "refused", input_.refused);
  addValue(status, "places", dialogue_.map().places.size());
  addValue(status, "names confirmed", confirmed);
  addValue(status, "names guessed", guessed);
  addValue(status, "described walls", dialogue_.places().walls().size());
  addValue(status, "place", dialogue_.robot().place);
  addValue(status, "in doorway", dialogue_.robot().in_doorway);
  addValue(status, "waits for an answer", dialogue_.question().kind != Question::Kind::kNone);
  addValue(status, "driving", driver_.status());
  if (dialogue_.match() && dialogue_.match()->found()) {
    addValue(status, "fitness", dialogue_.match()->best().fitness);
    addValue(status, "equally good", dialogue_.match()->equal);
    addValue(status, "matching [us]", dialogue_.match()->microseconds);
  }
}

}  // namespace hyselam_topo
