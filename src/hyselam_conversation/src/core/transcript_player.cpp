#include "hyselam_conversation/transcript_player.hpp"

#include <utility>

#include "hyselam_conversation/exchange_json.hpp"

namespace hyselam_conversation {
namespace {

/// The first corridor, else the largest place; "" for a map without places.
std::string defaultStart(const hyselam_topo::AugmentedTopologicalMap& map) {
  const hyselam_topo::Place* best = nullptr;
  for (const hyselam_topo::Place& place : map.places) {
    if (place.kind == hyselam_topo::PlaceKind::kCorridor) return codeOf(place);
    if (best == nullptr || place.area > best->area) best = &place;
  }
  return best == nullptr ? "" : codeOf(*best);
}

}  // namespace

TranscriptPlayer::TranscriptPlayer(Beginning beginning, std::shared_ptr<const Languages> languages)
    : beginning_(std::move(beginning)), languages_(std::move(languages)) {
  begin("");
}

void TranscriptPlayer::begin(const std::string& language) {
  ConversationParams params = beginning_.params;
  if (!language.empty()) params.dialogue.language = language;
  conversation_.emplace(params, beginning_.objects, languages_);
  if (beginning_.state) conversation_->restore(*beginning_.state);
  if (beginning_.map) conversation_->setMap(*beginning_.map);
  const std::string& told = beginning_.start;
  const std::string start = told.empty() ? defaultStart(conversation_->dialogue().map()) : told;
  hyselam::Pose2 pose;
  if (parsePose(start, &pose)) {
    conversation_->stand(pose);
  } else if (!start.empty()) {
    conversation_->standAt(start);
  }
}

std::optional<nlohmann::json> TranscriptPlayer::play(const Step& step) {
  const auto description = descriptionLines(*conversation_);
  const auto objects = summaryLines(conversation_->objects());
  const std::optional<Exchange> exchange = perform(step);
  if (!exchange) return std::nullopt;
  reply_ = exchange->replyText();
  nlohmann::json record = recordOf(*exchange, *conversation_, description, objects);
  record["session"] = session_;
  if (step.kind == Step::Kind::kSay) record["id"] = std::exchange(id_, "");
  return record;
}

std::optional<Exchange> TranscriptPlayer::perform(const Step& step) {
  switch (step.kind) {
    case Step::Kind::kSay:
      return conversation_->say(step.text);
    case Step::Kind::kPlace:
      return conversation_->standAt(step.place);
    case Step::Kind::kPose:
      return conversation_->stand(step.pose);
    case Step::Kind::kAsk:
      return conversation_->askHere();
    case Step::Kind::kDrive:
      return conversation_->driveTo(step.place);
    case Step::Kind::kArrive:
      return conversation_->arrive();
    case Step::Kind::kName:
      conversation_->confirmNames(step.place, step.names);
      return std::nullopt;
    case Step::Kind::kGuess:
      conversation_->guessNames(step.place, step.names);
      return std::nullopt;
    case Step::Kind::kId:
      id_ = step.text;
      return std::nullopt;
    case Step::Kind::kExpect:
      if (reply_.find(step.text) == std::string::npos) {
        failures_.push_back("line " + std::to_string(step.line) + ": expected '" + step.text +
                            "', the robot said '" + reply_ + "'");
      }
      return std::nullopt;
    case Step::Kind::kReset:
      ++session_;
      begin(step.text);
      return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace hyselam_conversation
