// A click on the map names the place there.
#pragma once

#include <ros/ros.h>
#include <rviz/tool.h>

#include <QTimer>
#include <future>
#include <vector>

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
  /// Asks for the name and sends it to the robot, which answers later.
  void nameAt(double x, double y);
  /// Shows why names were refused.
  void showAnswers();
  QWidget* window() const;

  ros::NodeHandle nh_;
  std::vector<std::future<QString>> answers_;  ///< why a name was refused; empty: it was accepted
  QTimer timer_;                               ///< polls for answers while some are missing
};

}  // namespace hyselam_rviz_plugins
