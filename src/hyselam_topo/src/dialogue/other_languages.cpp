#include "other_languages.hpp"

#include <algorithm>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_common/yaml_text.hpp"
#include "shipped_languages.hpp"

namespace hyselam_topo {
namespace {

constexpr std::size_t kMaxText = 4096;  // [bytes] that are looked at
constexpr std::size_t kLeast = 2;       // words that tell a language

std::vector<std::string> wordsOf(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  std::size_t length = 0;
  const std::size_t end = std::min(text.size(), kMaxText);
  for (std::size_t i = 0; i < end; i += length) {
    const std::uint32_t code = hyselam::utf8CodeAt(text, i, end, &length);
    if (hyselam::isUnicodeLetterOrDigit(code)) {
      word += text.substr(i, length);
    } else if (!word.empty()) {
      words.push_back(hyselam::utf8Lower(word));
      word.clear();
    }
  }
  if (!word.empty()) words.push_back(hyselam::utf8Lower(word));
  return words;
}

}  // namespace

OtherLanguages OtherLanguages::fromYaml(const std::string& source, const std::string& yaml) {
  OtherLanguages languages;
  const YAML::Node root = hyselam::parseYaml(yaml, source);
  if (!root.IsMap() || !root["format"] ||
      root["format"].as<std::string>("") != "hyselam_other_languages") {
    throw hyselam::InputError(source, "key 'format'", "it is not hyselam_other_languages");
  }
  if (!root["languages"] || !root["languages"].IsMap()) {
    throw hyselam::InputError(source, "key 'languages'", "it is missing");
  }
  for (const auto& entry : root["languages"]) {
    if (!entry.second.IsSequence()) {
      throw hyselam::InputError(source, "key 'languages'", "here must be lists of words");
    }
    std::set<std::string>& words = languages.words_[entry.first.as<std::string>("")];
    for (const auto& word : entry.second) {
      words.insert(hyselam::utf8Lower(word.as<std::string>("")));
    }
  }
  return languages;
}

const OtherLanguages& OtherLanguages::shipped() {
  static const OtherLanguages kLanguages =
      fromYaml("other_languages.yaml", kShippedLanguages[0].text);
  return kLanguages;
}

std::string OtherLanguages::find(const std::string& text,
                                 const std::set<std::string>& spoken) const {
  const std::vector<std::string> words = wordsOf(text);
  std::string best;
  std::size_t most = 0, own = 0;
  for (const auto& [language, known] : words_) {
    const auto hits = static_cast<std::size_t>(std::count_if(
        words.begin(), words.end(), [&](const std::string& word) { return known.count(word); }));
    if (spoken.count(language) != 0) {
      own = std::max(own, hits);
    } else if (hits > most) {
      most = hits;
      best = language;
    }
  }
  return most >= kLeast && most > own ? best : "";
}

}  // namespace hyselam_topo
