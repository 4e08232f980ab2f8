#include "chat_panel.hpp"

#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QTextBrowser>
#include <QVBoxLayout>
#include <algorithm>
#include <pluginlib/class_list_macros.hpp>

namespace hyselam_rviz_plugins {
namespace {

constexpr int kMaxSaid = 1000;    // lines that the arrow keys bring back
constexpr int kMaxBlocks = 5000;  // paragraphs of the talk that are shown

QString fromUtf8(const std::string& text) {
  return QString::fromUtf8(text.data(), static_cast<int>(text.size()));
}

}  // namespace

ChatPanel::ChatPanel(QWidget* parent) : rviz::Panel(parent) {
  auto* layout = new QVBoxLayout;
  place_ = new QLabel("The robot's place is not known.");
  place_->setTextFormat(Qt::PlainText);
  place_->setWordWrap(true);
  talk_ = new QTextBrowser;
  talk_->document()->setMaximumBlockCount(kMaxBlocks);
  line_ = new QLineEdit;
  line_->setPlaceholderText("Say something, e.g. where are you?");
  line_->installEventFilter(this);
  auto* buttons = new QHBoxLayout;
  for (const char* text : {"Yes", "No", "Where are you?"}) {
    auto* button = new QPushButton(text);
    connect(button, &QPushButton::clicked, this, [this, text] { say(text); });
    buttons->addWidget(button);
  }
  connect(line_, &QLineEdit::returnPressed, this, [this] {
    const QString text = line_->text().trimmed();
    line_->clear();
    if (!text.isEmpty()) say(text);
  });
  layout->addWidget(place_);
  layout->addWidget(talk_, 1);
  layout->addWidget(line_);
  layout->addLayout(buttons);
  setLayout(layout);
  connectTopics();
}

void ChatPanel::connectTopics() {
  const std::string prefix = namespace_.empty() ? "" : namespace_ + "/";
  human_ = nh_.advertise<std_msgs::String>(prefix + "human_text", 20);
  talk_subscriber_ = nh_.subscribe(prefix + "conversation", 100, &ChatPanel::onTalk, this);
  place_subscriber_ = nh_.subscribe(prefix + "place", 1, &ChatPanel::onPlace, this);
  names_subscriber_ = nh_.subscribe(prefix + "known_names", 1, &ChatPanel::onNames, this);
}

void ChatPanel::say(const QString& text) {
  if (human_.getNumSubscribers() == 0) append("Chat", "nobody listens", "#a01010");
  if (said_.isEmpty() || said_.last() != text) said_.append(text);
  while (said_.size() > kMaxSaid) said_.removeFirst();
  recalled_ = 0;
  std_msgs::String msg;
  msg.data = text.toStdString();
  human_.publish(msg);
}

void ChatPanel::append(const QString& who, const QString& text, const QString& colour) {
  talk_->append(QString("<b style=\"color:%1\">%2</b> %3").arg(colour, who, text.toHtmlEscaped()));
}

/// The talk as the robot takes it down: two topics would come in any order.
void ChatPanel::onTalk(const std_msgs::String::ConstPtr& msg) {
  const QString text = fromUtf8(msg->data);
  const QString human = "human: ", robot = "robot: ";
  if (text.startsWith(human)) {
    append("Human", text.mid(human.size()), "#1a4fa0");
  } else if (text.startsWith(robot)) {
    append("Robot", text.mid(robot.size()), "#157030");
  }
}

void ChatPanel::onPlace(const hyselam_msgs::PlaceState::ConstPtr& msg) {
  QString text = "The robot's place is not known.";
  if (msg->place != 0) {
    text = QString("The robot is in place %1").arg(msg->place);
    if (!msg->name.empty()) text += ": " + fromUtf8(msg->name) + (msg->confirmed ? "" : "?");
    if (msg->in_doorway) text += " (in the doorway)";
    text += ".";
  }
  if (text != place_->text()) place_->setText(text);
}

void ChatPanel::onNames(const std_msgs::String::ConstPtr& msg) {
  names_.clear();
  for (const QString& name : fromUtf8(msg->data).split('\n')) {
    if (!name.isEmpty()) names_.append(name);
  }
}

/// The end of the line to the first name that begins so.
void ChatPanel::complete() {
  const QString text = line_->text();
  for (int begin = 0; begin < text.size(); ++begin) {
    if (begin > 0 && text[begin - 1] != ' ') continue;
    const QString part = text.mid(begin);
    for (const QString& name : names_) {
      if (!name.startsWith(part, Qt::CaseInsensitive) || name.size() == part.size()) continue;
      line_->setText(text.left(begin) + name);
      const int typed = static_cast<int>(text.size());
      line_->setSelection(typed, static_cast<int>(line_->text().size()) - typed);
      return;
    }
  }
}

bool ChatPanel::eventFilter(QObject* object, QEvent* event) {
  if (object == line_ && event->type() == QEvent::KeyPress) {
    const int key = static_cast<QKeyEvent*>(event)->key();
    if (key == Qt::Key_Tab) {
      complete();
      return true;
    }
    if (key == Qt::Key_Up || key == Qt::Key_Down) {
      const int said = static_cast<int>(said_.size());  // Qt 6 counts in 64 bits
      recalled_ = std::max(0, std::min(said, recalled_ + (key == Qt::Key_Up ? 1 : -1)));
      line_->setText(recalled_ == 0 ? QString() : said_[said - recalled_]);
      return true;
    }
  }
  return rviz::Panel::eventFilter(object, event);
}

void ChatPanel::load(const rviz::Config& config) {
  rviz::Panel::load(config);
  QString name;
  if (!config.mapGetString("Namespace", &name) || name.toStdString() == namespace_) return;
  std::string error;
  if (!name.isEmpty() && !ros::names::validate(name.toStdString(), error)) {
    append("Chat", QString("the namespace is not used: ") + fromUtf8(error), "#a01010");
    return;
  }
  namespace_ = name.toStdString();
  connectTopics();
}

void ChatPanel::save(rviz::Config config) const {
  rviz::Panel::save(config);
  config.mapSetValue("Namespace", fromUtf8(namespace_));
}

}  // namespace hyselam_rviz_plugins

PLUGINLIB_EXPORT_CLASS(hyselam_rviz_plugins::ChatPanel, rviz::Panel)
