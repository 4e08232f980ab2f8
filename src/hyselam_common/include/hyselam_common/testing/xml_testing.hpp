// What the tests of the XML formats have in common.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "hyselam_common/testing/files.hpp"

namespace hyselam::testing {

/// `text` with one thing changed, which must be in it.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "'" << from << "' is not in\n" << text;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

inline void expectError(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in: " << message;
  }
}

/// A text damaged in three places.
inline std::string damaged(std::string text, unsigned seed) {
  std::mt19937 rng(seed);
  for (int i = 0; i < 3; ++i) {
    const std::size_t at = rng() % text.size();
    switch (rng() % 4) {
      case 0:
        text[at] = static_cast<char>(rng());
        break;
      case 1:
        text.erase(at, rng() % 40);
        break;
      case 2:
        text.insert(at, text.substr(rng() % text.size(), rng() % 40));
        break;
      default:
        text.insert(at, 1, "<>&\"='/ 0-"[rng() % 10]);
    }
  }
  return text;
}

/// That `random(seed)` of each seed is the same, and has the same text, once it is read back.
template <typename Random, typename Read>
void expectReadBack(unsigned seeds, const Random& random, const Read& read) {
  for (unsigned seed = 0; seed < seeds; ++seed) {
    const auto value = random(seed);
    const std::string text = toXml(value);
    ASSERT_EQ(read(text), value) << "seed " << seed << "\n" << text;
    ASSERT_EQ(toXml(read(text)), text) << "seed " << seed;
  }
}

inline std::string nested(int levels) {
  std::string text;
  for (int i = 0; i < levels; ++i) text += "<a>";
  for (int i = 0; i < levels; ++i) text += "</a>";
  return text;
}

inline bool haveXmllint() {
  return std::system("xmllint --version > /dev/null 2>&1") == 0;
}

/// Whether xmllint finds `text` to follow `schema`, a file of this package's xsd/.
inline bool follows(const std::string& schema, const std::string& text) {
  const hyselam::testing::TemporaryDirectory dir;
  hyselam::testing::writeFile(dir / "tested.xml", text);
  const std::string command = "xmllint --noout --schema '" HYSELAM_PACKAGE_DIR "/xsd/" + schema +
                              "' '" + (dir / "tested.xml") + "' > /dev/null 2>&1";
  return std::system(command.c_str()) == 0;
}

}  // namespace hyselam::testing
