// A panel to talk with the robot about places.
#pragma once

#include <hyselam_msgs/PlaceState.h>
#include <ros/ros.h>
#include <rviz/panel.h>
#include <std_msgs/String.h>

#include <QStringList>

class QLabel;
class QLineEdit;
class QTextBrowser;

namespace hyselam_rviz_plugins {

/// Callbacks of topics run in the thread of the window, which rviz spins.
class ChatPanel : public rviz::Panel {
  Q_OBJECT

 public:
  explicit ChatPanel(QWidget* parent = nullptr);

  void load(const rviz::Config& config) override;
  void save(rviz::Config config) const override;

 protected:
  /// Arrow keys: what was said before. Tab: completes a name.
  bool eventFilter(QObject* object, QEvent* event) override;

 private:
  void connectTopics();
  void say(const QString& text);
  void onTalk(const std_msgs::String::ConstPtr& msg);
  void onPlace(const hyselam_msgs::PlaceState::ConstPtr& msg);
  void onNames(const std_msgs::String::ConstPtr& msg);
  void append(const QString& who, const QString& text, const QString& colour);
  void complete();

  ros::NodeHandle nh_;
  std::string namespace_;
  ros::Publisher human_;
  ros::Subscriber talk_subscriber_, place_subscriber_, names_subscriber_;
  QLabel* place_ = nullptr;
  QTextBrowser* talk_ = nullptr;
  QLineEdit* line_ = nullptr;
  QStringList names_;
  QStringList said_;
  int recalled_ = 0;  // how far back in said_
};

}  // namespace hyselam_rviz_plugins
