// The targets of the fuzzer with the inputs that are kept: seeds, and what it once found.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "targets.hpp"

namespace fs = std::filesystem;

namespace {

using Target = void (*)(const std::uint8_t*, std::size_t);

void feed(const char* folder, Target target) {
  int files = 0;
  for (const fs::directory_entry& file :
       fs::directory_iterator(fs::path(HYSELAM_OBJECTS_SOURCE_DIR "/test/data/fuzz") / folder)) {
    SCOPED_TRACE(file.path().string());
    std::ifstream in(file.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    target(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    ++files;
  }
  EXPECT_GT(files, 0) << folder;
}

}  // namespace

TEST(FuzzSeeds, ObjectText) {
  feed("object_text", hyselam_objects::fuzz::objectText);
}

TEST(FuzzSeeds, ObjectMapXml) {
  feed("object_map_xml", hyselam_objects::fuzz::objectMapXml);
}

TEST(FuzzSeeds, ObjectDictionaryXml) {
  feed("object_dictionary_xml", hyselam_objects::fuzz::objectDictionaryXml);
}
