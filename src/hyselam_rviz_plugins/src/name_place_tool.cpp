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
#include <pluginlib/class_list_macros.hpp>

namespace hyselam_rviz_plugins {
namespace {

constexpr char kService[] = "name_place";
constexpr double kPatience = 1.0;  // until the service must be there [s]

}  // namespace

NamePlaceTool::NamePlaceTool() {
  shortcut_key_ = 'n';
}

void NamePlaceTool::onInitialize() {
  setName("Name Place");
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

bool NamePlaceTool::nameAt(double x, double y) {
  QWidget* window = context_->getWindowManager() != nullptr
                        ? context_->getWindowManager()->getParentWindow()
                        : nullptr;
  bool accepted = false;
  const QString name = QInputDialog::getText(
      window, "Name of the place", "Name (empty: forget those it has):", QLineEdit::Normal,
      QString(), &accepted);
  if (!accepted) return false;
  hyselam_msgs::NamePlace call;
  call.request.point.header.frame_id = context_->getFixedFrame().toStdString();
  call.request.point.point.x = x;
  call.request.point.point.y = y;
  if (!name.trimmed().isEmpty()) call.request.names = {name.trimmed().toStdString()};
  auto client = nh_.serviceClient<hyselam_msgs::NamePlace>(kService);
  QString problem;
  if (!client.waitForExistence(ros::Duration(kPatience)) || !client.call(call)) {
    problem = QString("Nobody offers the service %1.")
                  .arg(QString::fromStdString(nh_.resolveName(kService)));
  } else if (!call.response.success) {
    problem = QString::fromStdString(call.response.message);
  }
  if (!problem.isEmpty()) QMessageBox::warning(window, "The place is not named", problem);
  return problem.isEmpty();
}

}  // namespace hyselam_rviz_plugins

PLUGINLIB_EXPORT_CLASS(hyselam_rviz_plugins::NamePlaceTool, rviz::Tool)
