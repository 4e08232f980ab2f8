#include "hyselam_topo/ros/goal_driver.hpp"

#include "hyselam_common/ros/conversions.hpp"

#ifdef HYSELAM_HAVE_MOVE_BASE
#include <actionlib/client/simple_action_client.h>
#include <move_base_msgs/MoveBaseAction.h>
#endif

namespace hyselam_topo {

#ifdef HYSELAM_HAVE_MOVE_BASE

class GoalDriver::Client {
 public:
  explicit Client(const ros::NodeHandle& nh) : nh_(nh), action_(nh_, "move_base", false) {}

  bool connected() const { return action_.isServerConnected(); }

  void drive(std::vector<hyselam::Pose2> goals, const std::string& frame_id) {
    stop();
    goals_ = std::move(goals);
    frame_id_ = frame_id;
    next_ = 0;
    sendNext();
  }

  void stop() {
    ++run_;
    if (status_ != "driving") return;
    action_.cancelAllGoals();
    status_ = "stopped";
  }

  const std::string& status() const { return status_; }

 private:
  void sendNext() {
    if (next_ == goals_.size()) {
      status_ = goals_.empty() ? "" : "arrived";
      return;
    }
    status_ = "driving";
    move_base_msgs::MoveBaseGoal goal;
    goal.target_pose.header.frame_id = frame_id_;
    goal.target_pose.header.stamp = ros::Time::now();
    goal.target_pose.pose = hyselam::toPoseMsg(goals_[next_]);
    action_.sendGoal(goal, [this, run = run_](const actionlib::SimpleClientGoalState& state,
                                              const move_base_msgs::MoveBaseResultConstPtr&) {
      if (run != run_) return;  // of a way that was given up
      if (state != actionlib::SimpleClientGoalState::SUCCEEDED) {
        status_ = state.toString() + " at " + std::to_string(next_ + 1) + " of " +
                  std::to_string(goals_.size());
        return;
      }
      ++next_;
      // Not at once: the client takes a goal that is sent within this call for done when it
      // returns.
      timer_ = nh_.createWallTimer(
          ros::WallDuration(0.01),
          [this, run](const ros::WallTimerEvent&) {
            if (run == run_) sendNext();
          },
          true);
    });
  }

  ros::NodeHandle nh_;
  ros::WallTimer timer_;
  actionlib::SimpleActionClient<move_base_msgs::MoveBaseAction> action_;
  std::vector<hyselam::Pose2> goals_;
  std::string frame_id_;
  std::size_t next_ = 0;
  int run_ = 0;
  std::string status_;
};

GoalDriver::GoalDriver(const ros::NodeHandle& nh) : client_(std::make_unique<Client>(nh)) {}
bool GoalDriver::available() const {
  return client_->connected();
}
void GoalDriver::drive(std::vector<hyselam::Pose2> goals, const std::string& frame_id) {
  if (available()) client_->drive(std::move(goals), frame_id);
}
void GoalDriver::stop() {
  client_->stop();
}
const std::string& GoalDriver::status() const {
  return client_->status();
}

#else

class GoalDriver::Client {
 public:
  std::string status;
};

GoalDriver::GoalDriver(const ros::NodeHandle&) : client_(std::make_unique<Client>()) {}
bool GoalDriver::available() const {
  return false;
}
void GoalDriver::drive(std::vector<hyselam::Pose2>, const std::string&) {}
void GoalDriver::stop() {}
const std::string& GoalDriver::status() const {
  return client_->status;
}

#endif

GoalDriver::~GoalDriver() = default;

}  // namespace hyselam_topo
