// Sentences with what they mean: test/data/language/*.yaml.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <iostream>

#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_language/testing/language_outlines.hpp"
#include "hyselam_language/testing/lost_words.hpp"
#include "shipped_parser.hpp"

namespace hyselam_topo {
namespace {

struct Item {
  std::string text;
  std::string language = "auto";
  std::vector<std::string> graph, says, issues;
  std::set<std::string> expected;
  std::string refused;
};

std::vector<std::string> lines(const YAML::Node& node) {
  std::vector<std::string> all;
  for (const auto& each : node) all.push_back(each.as<std::string>());
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<Item> corpus(const std::string& name) {
  std::vector<Item> items;
  const YAML::Node file =
      YAML::LoadFile(HYSELAM_PACKAGE_DIR "/test/data/language/" + name + ".yaml");
  for (const auto& node : file) {
    Item item;
    for (const auto& entry : node) {
      const auto key = entry.first.as<std::string>();
      if (key == "text") {
        item.text = entry.second.as<std::string>();
      } else if (key == "graph") {
        item.graph = lines(entry.second);
      } else if (key == "says") {
        item.says = lines(entry.second);
      } else if (key == "issues") {
        item.issues = lines(entry.second);
      } else if (key == "refused") {
        item.refused = entry.second.as<std::string>();
      } else if (key == "expected") {
        for (const std::string& each : lines(entry.second)) item.expected.insert(each);
      } else if (key == "language") {
        item.language = entry.second.as<std::string>();
      } else if (key != "note") {
        ADD_FAILURE() << name << ": unknown key " << key;
      }
    }
    items.push_back(item);
  }
  return items;
}

std::string joined(const std::vector<std::string>& all) {
  std::string text;
  for (const std::string& each : all) text += (text.empty() ? "" : "; ") + each;
  return text;
}

struct Score {
  int right = 0;
  int told = 0;    ///< wrong, but something was reported as not understood or contradictory
  int silent = 0;  ///< wrong without a word
  std::string report;
};

Score scoreOf(const std::vector<Item>& items) {
  Score score;
  for (const Item& item : items) {
    ParseOptions options;
    options.language = item.language;
    options.expected = item.expected;
    const ParsedText parsed = testing::shippedParser().parse(item.text, options);
    DescriptionBuilder builder(testing::shippedParser());
    const auto found_issues = builder.add(parsed);
    std::vector<std::string> says, issues, refused;
    for (const Utterance& utterance : parsed.utterances) {
      if (!utterance.understood()) {
        refused.push_back(utterance.reason_code);
      } else if (!DescriptionBuilder::handles(utterance.intent)) {
        says.push_back(testing::outline(utterance));
      }
    }
    for (const auto& issue : found_issues) {
      if (issue.kind != IssueKind::kNotice) issues.push_back(toString(issue.kind));
    }
    std::sort(says.begin(), says.end());
    std::sort(issues.begin(), issues.end());
    const auto graph = testing::outline(builder.building());
    const bool refusal_fits =
        item.refused.empty() ? refused.empty()
                             : !refused.empty() && (item.refused == "any" || refused.size() != 1 ||
                                                    refused[0] == item.refused);
    // "No, the kitchen is on the right": the answer itself is no line of the corpus.
    if (graph == item.graph && says == item.says && issues == item.issues && refusal_fits) {
      ++score.right;
      continue;
    }
    const bool silent = refused.empty() && issues.empty();
    ++(silent ? score.silent : score.told);
    score.report += std::string(silent ? "SILENT " : "told   ") + item.text + "\n    language " +
                    parsed.language + "\n    graph   " + joined(graph) + "\n    wanted  " +
                    joined(item.graph) + "\n    says    " + joined(says) + " | wanted " +
                    joined(item.says) + "\n    issues  " + joined(issues) + " | refused " +
                    joined(refused) + " | wanted " + joined(item.issues) + " " + item.refused +
                    "\n";
    for (const Utterance& u : parsed.utterances) {
      score.report +=
          "      " + testing::outline(u) + (u.understood() ? "" : " " + u.reason) + "\n";
    }
  }
  return score;
}

void expectGood(const std::string& name, double least) {
  const std::vector<Item> items = corpus(name);
  const Score score = scoreOf(items);
  std::cout << name << ": " << score.right << " of " << items.size() << " right, " << score.told
            << " reported, " << score.silent << " silently wrong\n";
  EXPECT_GE(score.right, least * static_cast<double>(items.size())) << score.report;
  EXPECT_EQ(score.silent, 0) << score.report;
  if (score.told > 0 && std::getenv("HYSELAM_SHOW_CORPUS") != nullptr) std::cout << score.report;
}

TEST(LanguageCorpus, UnderstandsTheThesis) {
  expectGood("thesis", 1.0);
}

TEST(LanguageCorpus, English) {
  expectGood("corpus_en", 0.97);
}

TEST(LanguageCorpus, Portuguese) {
  expectGood("corpus_pt", 0.97);
}

TEST(LanguageCorpus, RefusesWhatItMust) {
  expectGood("refused", 1.0);
}

TEST(LanguageCorpus, SecondHoldOut) {
  expectGood("holdout_2", 0.97);
}

TEST(LanguageCorpus, HoldOut) {
  expectGood("holdout", 0.97);
}

TEST(LanguageCorpus, WaysOfSayingEnglish) {
  expectGood("ways_en", 1.0);
}

TEST(LanguageCorpus, WaysOfSayingPortuguese) {
  expectGood("ways_pt", 1.0);
}

/// Every refusal says what would work, in the language of the speaker, and that does work.
TEST(LanguageCorpus, RefusalsTeach) {
  std::size_t refusals = 0, meant = 0;
  for (const char* name : {"thesis", "corpus_en", "corpus_pt", "refused", "holdout", "holdout_2",
                           "ways_en", "ways_pt"}) {
    for (const Item& item : corpus(name)) {
      ParseOptions options;
      options.language = item.language;
      const ParsedText said = testing::shippedParser().parse(item.text, options);
      for (const Utterance& utterance : said.utterances) {
        const bool is_text =
            utterance.reason_code != "not_text" && utterance.reason_code != "too_long";
        if (utterance.understood() || !is_text) continue;
        ++refusals;
        meant += utterance.suggests_meaning ? 1 : 0;
        EXPECT_FALSE(utterance.suggestion.empty()) << item.text;
        ParseOptions same;
        same.language = said.language;
        const ParsedText again = testing::shippedParser().parse(utterance.suggestion, same);
        EXPECT_EQ(again.misunderstood(), 0u) << item.text << "\n  -> " << utterance.suggestion;
      }
    }
  }
  EXPECT_GT(refusals, 50u);
  std::cout << refusals << " refusals, of " << meant << " the meaning is proposed\n";
}

/// What a pattern passes over ("after the fire door") is told as left out.
TEST(LanguageCorpus, NothingIsDroppedSilently) {
  std::size_t texts = 0;
  for (const char* name : {"thesis", "corpus_en", "corpus_pt", "refused", "holdout", "holdout_2",
                           "ways_en", "ways_pt"}) {
    for (const Item& item : corpus(name)) {
      ++texts;
      const std::string language = testing::shippedParser().parse(item.text, {}).language;
      for (const std::string& lost :
           testing::lostWords(testing::shippedParser(), item.text, language)) {
        ADD_FAILURE() << name << ": " << lost;
      }
    }
  }
  EXPECT_GT(texts, 1000u);
}

TEST(LanguageCorpus, WhatIsPassedOnTheWayIsToldAndAsked) {
  const Utterance right =
      testing::shippedParser()
          .parse("The fuse room is on the right, immediately after the fire door.")
          .utterances[0];
  EXPECT_EQ(right.intent, "neighbours");
  EXPECT_EQ(right.left_out, std::vector<std::string>{"immediately after the fire door"});
  EXPECT_EQ(right.to_confirm, "The fuse room is on the right.");
  // What the robot stands in is no matter of words left out.
  EXPECT_TRUE(testing::shippedParser()
                  .parse("The kitchen is down the corridor on the left.")
                  .utterances[0]
                  .left_out.empty());
}

/// Where a part of a sentence was not understood that may say more of a place, the rest is asked.
TEST(LanguageCorpus, PartsOfASentenceAreAsked) {
  const ParsedText said =
      testing::shippedParser().parse("The archive is downstairs, right above the quarry deck.");
  ASSERT_EQ(said.utterances.size(), 2u);
  ASSERT_TRUE(said.utterances[0].understood());
  EXPECT_EQ(said.utterances[0].to_confirm, "The archive is downstairs.");
  EXPECT_FALSE(said.utterances[1].understood());
}

}  // namespace
}  // namespace hyselam_topo
