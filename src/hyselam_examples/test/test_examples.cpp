// Each example runs and prints what the text beside it says.
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/testing/files.hpp"

namespace {

std::vector<std::string> examples() {
  std::vector<std::string> names;
  std::istringstream list(HYSELAM_EXAMPLES);
  for (std::string name; std::getline(list, name, ',');) names.push_back(name);
  return names;
}

class Example : public testing::TestWithParam<std::string> {};

TEST_P(Example, PrintsItsText) {
  const hyselam::testing::TemporaryDirectory folder;
  const std::string out = folder / "out.txt";
  const std::string program = std::string(HYSELAM_TOOLS) + "/" + GetParam();
  ASSERT_EQ(std::system((program + " > " + out).c_str()), 0);
  EXPECT_EQ(hyselam::readTextFile(out),
            hyselam::readTextFile(HYSELAM_PACKAGE_DIR "/" + GetParam() + ".txt"));
}

INSTANTIATE_TEST_SUITE_P(All, Example, testing::ValuesIn(examples()),
                         [](const auto& example) { return example.param; });

TEST(Examples, EachHasARowInTheReadme) {
  const std::string readme = hyselam::readTextFile(HYSELAM_PACKAGE_DIR "/README.md");
  EXPECT_FALSE(examples().empty());
  for (const std::string& name : examples()) {
    EXPECT_NE(readme.find("[`" + name + "`](" + name + ".cpp)"), std::string::npos) << name;
  }
}

}  // namespace
