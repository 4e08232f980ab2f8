// A small file of each format, as it is written now, is read by all later programs; the same file
// of a version to come is refused by a sentence that names it, its version, and those that are
// read. The files were made by the stack's own tools (file_versions/README.md); docs/versions.md
// tells of all formats.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/model_text.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_gr2to/segmentation/border_model.hpp"
#include "hyselam_language/building/description_xml.hpp"
#include "hyselam_language/grammar/grammar.hpp"
#include "hyselam_objects/mapping/object_map.hpp"
#include "hyselam_objects/recognition/object_dictionary.hpp"
#include "hyselam_topo/dialogue/dialogue_state.hpp"
#include "hyselam_topo/dialogue/phrases.hpp"
#include "hyselam_topological_map/topological_map_xml.hpp"
#include "ngram_slam/semantics/semantic_forest.hpp"
#include "ngram_slam/semantics/way_forest.hpp"
#include "ngram_slam/signatures/place_signature.hpp"
#include "ngram_slam/slam/slam_state_io.hpp"
#include "ngram_slam/words/corpus_journal.hpp"
#include "selovis/learning/place_model.hpp"

namespace {

namespace fs = std::filesystem;
using hyselam::testing::fileBytes;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

const std::string kRoot = HYSELAM_ROOT;
constexpr const char* kSamples = "test/file_versions/";

/// Text that tells the version, and the same of the version after it.
struct Mark {
  std::string now, next;
};

/// The number at the end of a text, one higher.
Mark mark(const std::string& name, int version, const std::string& behind = "") {
  return {name + std::to_string(version) + behind, name + std::to_string(version + 1) + behind};
}

/// A little-endian number behind eight letters.
Mark binaryMark(const std::string& name, int version) {
  const std::string zeros(3, '\0');
  return {name + static_cast<char>(version) + zeros, name + static_cast<char>(version + 1) + zeros};
}

struct Format {
  std::string name;
  std::string path;  ///< below the root; its folder is what the program is given
  std::string file;  ///< in which the mark stands
  int newest;
  int oldest;
  Mark mark;
  std::function<void(const std::string& folder)> read;
  bool checksum_line = false;  ///< the last line is hyselam::withChecksum()'s
};

void PrintTo(const Format& f, std::ostream* out) {  // NOLINT: gtest's name
  *out << f.path << f.file;
}

std::vector<Format> formats() {
  std::vector<Format> all;
  const auto sample = [&](const std::string& file, int newest, int oldest, const Mark& mark,
                          const std::function<void(const std::string&)>& load) {
    all.push_back({file, kSamples, file, newest, oldest, mark,
                   [load, file](const std::string& folder) { load(folder + "/" + file); }});
  };
  const auto shipped = [&](const std::string& folder, const std::string& file, const Mark& mark,
                           const std::function<void(const std::string&)>& load, int newest,
                           bool checksum_line = false) {
    all.push_back({file, "src/" + folder + "/", file, newest, newest, mark,
                   [load, file](const std::string& at) { load(at + "/" + file); }, checksum_line});
  };
  sample("slam.state", 4, 1, binaryMark("NGRAMSLM", 4), [](const std::string& path) {
    EXPECT_GE(ngram_slam::SlamStateFile::load(path, {}).keyframes.size(), 5u);
  });
  sample("words.corpus", 2, 2, binaryMark("NGRAMTXT", 2), [](const std::string& path) {
    EXPECT_GE(ngram_slam::CorpusFile::load(path).observations.size(), 5u);
  });
  all.push_back({"journal", std::string(kSamples) + "journal/", "words.corpus.journal", 1, 1,
                 binaryMark("NGRAMJNL", 1), [](const std::string& folder) {
                   const auto loaded = ngram_slam::CorpusJournal(folder + "/words.corpus").load();
                   EXPECT_EQ(loaded.blocks, 1u);
                   EXPECT_EQ(loaded.corpus.observations.size(), 20u);
                 }});
  sample("topo.xml", 1, 1, mark("version=\"", 1, "\" frame"),
         [](const std::string& path) { EXPECT_EQ(hyselam_topo::loadXml(path).places.size(), 2u); });
  sample("description.xml", 2, 1, mark("version=\"", 2, "\" robot"), [](const std::string& path) {
    EXPECT_EQ(hyselam_topo::loadDescription(path).places.size(), 2u);
  });
  sample("dialogue.state", 2, 1, mark("hyselam_dialogue ", 2, " "), [](const std::string& path) {
    const auto state = hyselam_topo::loadDialogueState(path);
    EXPECT_EQ(state.places.map.places.size(), 2u);
    EXPECT_EQ(hyselam_topo::wordedPlaces(state.places.shelf), 1u);
  });
  sample("objects.xml", 2, 1, mark("map:1\" version=\"", 2), [](const std::string& path) {
    EXPECT_EQ(hyselam_objects::loadObjectMap(path).objects.size(), 4u);
  });
  sample("dictionary.xml", 1, 1, mark("y:1\" version=\"", 1), [](const std::string& path) {
    EXPECT_EQ(hyselam_objects::loadDictionary(path).objects.size(), 1u);
  });
  all.push_back({"visual places", std::string(kSamples) + "visual_places/", "model.json", 2, 1,
                 mark("selovis model ", 2), [](const std::string& folder) {
                   EXPECT_EQ(selovis::loadPlaceModel(folder).samples.count(), 4u);
                 }});
  // Models and grammars that come with the stack are samples of their formats.
  shipped(
      "hyselam_gr2to/models", "border_trees.txt", mark("hyselam_border_trees ", 1),
      [](const std::string& path) { hyselam_topo::BorderModel::load(path); }, 1, true);
  shipped(
      "ngram_slam/models", "semantic_forest.txt", mark("ngram_slam semantic forest ", 3),
      [](const std::string& path) { ngram_slam::SemanticForest::load(path); }, 3);
  shipped(
      "ngram_slam/models", "way_forest.txt", mark("ngram_slam way forest ", 1),
      [](const std::string& path) { ngram_slam::WayForest::load(path); }, 1);
  shipped(
      "ngram_slam/models", "place_signatures.txt", mark("ngram_slam place signatures ", 2),
      [](const std::string& path) { ngram_slam::SignatureModel::load(path); }, 2);
  shipped(
      "hyselam_language/grammar", "en.yaml", mark("version: ", 1),
      [](const std::string& path) { hyselam_topo::Grammar::load({path}); }, 1);
  shipped(
      "hyselam_topo/dialogue", "en.yaml", mark("version: ", 1),
      [](const std::string& path) { hyselam_topo::Phrases::load(path); }, 1);
  return all;
}

class FileVersions : public ::testing::TestWithParam<Format> {};

TEST_P(FileVersions, OfTodayAreRead) {
  const Format& f = GetParam();
  EXPECT_NE(fileBytes(kRoot + "/" + f.path + f.file).find(f.mark.now), std::string::npos);
  f.read(kRoot + "/" + f.path);
}

TEST_P(FileVersions, OfTheFutureAreRefusedInWords) {
  const Format& f = GetParam();
  const TemporaryDirectory folder;
  const std::string copy = folder / "copy";
  fs::create_directory(copy);
  for (const auto& entry : fs::directory_iterator(kRoot + "/" + f.path)) {
    if (entry.is_regular_file()) fs::copy(entry.path(), copy);
  }
  const std::string path = copy + "/" + f.file;
  std::string text = fileBytes(path);
  const std::size_t at = text.find(f.mark.now);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, f.mark.now.size(), f.mark.next);
  if (f.checksum_line) text = hyselam::withChecksum(text.substr(0, text.rfind("checksum ")));
  writeFile(path, text);
  const std::string said = messageOf<hyselam::InputError>([&] { f.read(copy); });
  EXPECT_NE(said.find(path), std::string::npos) << said;
  std::string read = std::to_string(f.oldest);
  if (f.oldest < f.newest) read += " to " + std::to_string(f.newest);
  EXPECT_NE(said.find("has version " + std::to_string(f.newest + 1) + ", this program reads " +
                      read + "; it was written by a newer HySeLAM"),
            std::string::npos)
      << said;
  EXPECT_EQ(fileBytes(path), text) << "what is refused stays as it is";
}

TEST(OlderFileVersions, OfSlamAreRead) {
  const std::string folder = kRoot + "/src/ngram_slam/test/data/fuzz/slam_state/";
  for (const auto& [file, version] : {std::pair{"empty.state", 1}, {"settled.state", 3}}) {
    const std::string text = fileBytes(folder + file);
    ASSERT_EQ(text.compare(0, 9, binaryMark("NGRAMSLM", version).now, 0, 9), 0) << file;
    EXPECT_NO_THROW(ngram_slam::SlamStateFile::load(folder + file, {})) << file;
  }
}

TEST(OlderFileVersions, DescriptionsWithoutCertaintiesAreReadAsSure) {
  const std::string folder = kRoot + "/" + kSamples;
  const auto old = hyselam_topo::loadDescription(folder + "description_1.xml");
  ASSERT_EQ(old.connections.size(), 1u);
  EXPECT_EQ(old.connections[0].side_certainty, 1.0);
  EXPECT_EQ(hyselam_topo::loadDescription(folder + "description.xml").connections[0].side_certainty,
            0.93);
}

TEST(OlderFileVersions, DialoguesWithoutAShelfAreRead) {
  const auto old = hyselam_topo::loadDialogueState(kRoot + "/" + kSamples + "dialogue_1.state");
  EXPECT_EQ(old.places.map.places.size(), 2u);
  EXPECT_TRUE(old.places.shelf.empty());
}

std::string nameOf(const ::testing::TestParamInfo<Format>& info) {
  std::string name = info.param.path + info.param.name;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, FileVersions, ::testing::ValuesIn(formats()), nameOf);

}  // namespace
