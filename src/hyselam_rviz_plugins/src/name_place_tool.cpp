#include "name_place_tool.hpp"

#include <OgrePlane.h>
#include <OgreVector3.h>
#include <hyselam_msgs/NamePlace.h>
#include <rviz/display_context.h>
#include <rviz/geometry.h>
#include <rviz/viewport_mouse_event.h>
#include <rviz/window_manager_interface.h>

#include <QInputDialog>
#include <QMessageBox>
#include <chrono>
#include <pluginlib/class_list_macros.hpp>
#include <thread>
#include <utility>

namespace hyselam_rviz_plugins {
namespace {

constexpr char kService[] = "name_place";
constexpr double kPatience = 1.0;  // until the service must be there [s]
constexpr int kLookAgain = 100;    // for an answer [ms]

/// Calls the service; returns why it failed, empty if it did not.
QString callService(ros::NodeHandle nh, hyselam_msgs::NamePlace call) {
  auto client = nh.serviceClient<hyselam_msgs::NamePlace>(kService);
  if (!client.waitForExistence(ros::Duration(kPatience)) || !client.call(call)) {
    return QString("Nobody offers the service %1.")
        .arg(QString::fromStdString(nh.resolveName(kService)));
  }
  return call.response.success ? QString() : QString::fromStdString(call.response.message);
}

}  // namespace

NamePlaceTool::NamePlaceTool() {
  shortcut_key_ = 'n';
}

void NamePlaceTool::onInitialize() {
  setName("Name Place");
  connect(&timer_, &QTimer::timeout, this, [this] { showAnswers(); });
}

void NamePlaceTool::activate() {
  setStatus("Click on a place of the map to name it.");
}

int NamePlaceTool::processMouseEvent(rviz::ViewportMouseEvent& event) {
  if (!event.leftDown()) return 0;
  Ogre::Vector3 point;
  Ogre::Plane floor(Ogre::Vector3::UNIT_Z, 0.0f);
  if (!rviz::getPointOnPlaneFromWindowXY(event.viewport, floor, event.x, event.y, point)) return 0;
  nameAt(point.x, point.y);
  return Finished;
}

QWidget* NamePlaceTool::window() const {
  return context_->getWindowManager() != nullptr ? context_->getWindowManager()->getParentWindow()
                                                 : nullptr;
}

void NamePlaceTool::nameAt(double x, double y) {
  bool accepted = false;
  const QString name = QInputDialog::getText(
      window(), "Name of the place", "Name (empty: forget those it has):", QLineEdit::Normal,
      QString(), &accepted);
  if (!accepted) return;
  hyselam_msgs::NamePlace call;
  call.request.point.header.frame_id = context_->getFixedFrame().toStdString();
  call.request.point.point.x = x;
  call.request.point.point.y = y;
  if (!name.trimmed().isEmpty()) call.request.names = {name.trimmed().toStdString()};
  // On its own: a robot that does not answer must not hold up the display. The thread may outlive
  // this tool; nothing of it is used there.
  std::packaged_task<QString()> task([nh = nh_, call] { return callService(nh, call); });
  answers_.push_back(task.get_future());
  std::thread(std::move(task)).detach();
  timer_.start(kLookAgain);
}

void NamePlaceTool::showAnswers() {
  std::vector<QString> problems;
  for (auto answer = answers_.begin(); answer != answers_.end();) {
    if (answer->wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
      ++answer;
      continue;
    }
    problems.push_back(answer->get());
    answer = answers_.erase(answer);
  }
  if (answers_.empty()) timer_.stop();
  for (const QString& problem : problems) {
    if (!problem.isEmpty()) QMessageBox::warning(window(), "The place is not named", problem);
  }
}

}  // namespace hyselam_rviz_plugins

PLUGINLIB_EXPORT_CLASS(hyselam_rviz_plugins::NamePlaceTool, rviz::Tool)
