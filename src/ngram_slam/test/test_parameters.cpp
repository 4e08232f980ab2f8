// Parameters of Words: README.md holds every one with its default, presets change defaults,
// impossible values are named.
#include <gtest/gtest.h>

#include <regex>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "ngram_slam/ros/parameters.hpp"
#include "written_parameters.hpp"

using namespace ngram_slam;  // NOLINT: a test, not a header

namespace {

WordsServerParams load(const Values& values) {
  return loadFrom(loadWordsParams, values);
}

std::map<std::string, std::string> defaults() {
  return defaultsOf(loadWordsParams);
}

std::string escaped(const std::string& text) {
  return std::regex_replace(text, std::regex(R"([.\[\]+*()^$|?\\])"), R"(\$&)");
}

std::string refusal(const Values& values) {
  return hyselam::testing::messageOf<hyselam::ParameterError>([&] { load(values); });
}

}  // namespace

TEST(WrittenWordsParameters, readmeHasEveryParameter) {
  const std::string readme = written("README.md");
  const auto all = defaults();
  EXPECT_GT(all.size(), 25U);
  for (const auto& [name, value] : all) {
    const std::string cell = value.empty() ? "\\(empty\\)" : escaped(value);
    EXPECT_TRUE(std::regex_search(readme, std::regex("\\| `" + name + "` \\| " + cell + " \\|")))
        << name << " = " << value;
  }
}

TEST(WordsParameters, aPresetSetsDefaultsThatCanBeChanged) {
  const WordsServerParams thesis = load({});
  EXPECT_EQ(thesis.recognizer.matcher.min_n, (std::vector<int>{7, 10, 13}));
  EXPECT_FALSE(thesis.recognizer.reverse);
  const WordsServerParams improved =
      load({{"preset", "improved"}, {"input", "scan"}, {"bandwidth", 4.0}});
  const NgramRecognizerParams expected = NgramRecognizerParams::improved();
  EXPECT_EQ(improved.recognizer.matcher.min_n, expected.matcher.min_n);
  EXPECT_EQ(improved.recognizer.min_probability, expected.min_probability);
  EXPECT_TRUE(improved.recognizer.reverse && improved.recognizer.with_probability);
  EXPECT_EQ(improved.recognizer.word_density, WordDensity::kFull);
  EXPECT_EQ(improved.sensor.look_back, 4.5);
  const WordsServerParams changed =
      load({{"preset", "improved"}, {"input", "scan"}, {"min_probability", 0.5}, {"levels", 5}});
  EXPECT_EQ(changed.recognizer.min_probability, 0.5);
  EXPECT_EQ(changed.recognizer.matcher.min_n, (std::vector<int>{3, 3, 3, 3, 3}));
  EXPECT_EQ(load({{"levels", 4}}).recognizer.matcher.min_n, (std::vector<int>{7, 10, 13, 16}));
  EXPECT_EQ(load({{"levels", 1}}).recognizer.matcher.min_n, (std::vector<int>{7}));
}

TEST(WordsParameters, refusalsNameTheParameter) {
  EXPECT_NE(refusal({{"preset", "improved"}}).find("preset"), std::string::npos);
  EXPECT_NE(refusal({{"look_back", 2.0}}).find("look_back"), std::string::npos);
  EXPECT_NE(refusal({{"max_followed", 0}}).find("max_followed"), std::string::npos);
  EXPECT_NE(refusal({{"levels", 17}}).find("levels"), std::string::npos);
  EXPECT_NE(refusal({{"gui_publish_rate", 0.0}}).find("gui_publish_rate"), std::string::npos);
  EXPECT_NE(refusal({{"corpus", "/no/such/folder/c"}}).find("corpus"), std::string::npos);
}
