// A click on the map names the place there.
#pragma once

#include <ros/ros.h>
#include <rviz/tool.h>

namespace hyselam_rviz_plugins {

class NamePlaceTool : public rviz::Tool {
  Q_OBJECT

 public:
  NamePlaceTool();

  void onInitialize() override;
  void activate() override;
  void deactivate() override {}
  int processMouseEvent(rviz::ViewportMouseEvent& event) override;

 private:
  /// Asks for the name and tells the robot. False if it was cancelled.
  bool nameAt(double x, double y);

  ros::NodeHandle nh_;
};

}  // namespace hyselam_rviz_plugins
