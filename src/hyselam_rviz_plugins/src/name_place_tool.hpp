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
  /// Asks for the name and tells the robot, who answers some time later.
  void nameAt(double x, double y);
  /// Shows what went wrong with the names that were told.
  void showAnswers();
  QWidget* window() const;

  ros::NodeHandle nh_;
  std::vector<std::future<QString>> answers_;  ///< what was wrong; empty: nothing
  QTimer timer_;                               ///< looks for answers while some are missing
};

}  // namespace hyselam_rviz_plugins
