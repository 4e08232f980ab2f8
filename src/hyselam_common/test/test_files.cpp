// Files in and out: whole or not at all, and what is wrong with them.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <limits>
#include <sstream>
#include <stdexcept>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/binary_io.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/put_aside.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/trajectory_io.hpp"

namespace hyselam {
namespace {

using testing::fileBytes;
using testing::messageOf;
using testing::TemporaryDirectory;
using testing::writeFile;

std::string gzipped(const std::string& text, const TemporaryDirectory& directory) {
  const std::string path = directory / "packed.gz";
  gzFile file = gzopen(path.c_str(), "wb");
  gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
  gzclose(file);
  return fileBytes(path);
}

bool mentions(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

TEST(Folder, IsMadeWithThoseAboveItUnlessItIsThere) {
  TemporaryDirectory d;
  makeFolder(d / "a/b/c");
  writeFile(d / "a/b/c/kept", "x");
  makeFolder(d / "a/b/c/");
  EXPECT_EQ(fileBytes(d / "a/b/c/kept"), "x");
  for (const std::string& path : {d / "a/b/c/kept", d / "a/b/c/kept/below", std::string()}) {
    EXPECT_EQ(messageOf<InputError>([&] { makeFolder(path); }),
              path + ": is not a folder and cannot be made one");
  }
}

TEST(Folder, OfAStateThatIsNotThereIsToldWithTheArgumentThatNamesItAndNotMade) {
  TemporaryDirectory d;
  checkFolderOfState("state", "");
  checkFolderOfState("state", "beside");
  checkFolderOfState("state", d / "x.state");
  const std::string message =
      messageOf<ParameterError>([&] { checkFolderOfState("state", d / "work/x.state"); });
  for (const std::string& part : {std::string("'state'"), std::string("work_dir"),
                                  d / "work/x.state", "mkdir -p " + d / "work"}) {
    EXPECT_TRUE(mentions(message, part)) << message;
  }
  EXPECT_EQ(d.fileCount(), 0U);
}

TEST(PutAside, NeverTakesThePlaceOfWhatWasPutAsideBefore) {
  TemporaryDirectory d;
  for (const char* content : {"first", "second", "third"}) {
    writeFile(d / "a", content);
    EXPECT_TRUE(mayExist(d / "a"));
    const auto aside = putAside(d / "a");
    ASSERT_TRUE(aside);
    EXPECT_EQ(fileBytes(*aside), content);
    EXPECT_TRUE(mentions(keptAs(aside), *aside));
    EXPECT_FALSE(mayExist(d / "a"));
  }
  EXPECT_EQ(fileBytes(d / "a.damaged"), "first");
  EXPECT_EQ(fileBytes(d / "a.damaged.3"), "third");
  EXPECT_EQ(d.fileCount(), 3U);
}

TEST(PutAside, SaysWhatCannotBeRenamed) {
  TemporaryDirectory d;
  const auto aside = putAside(d / "none");
  EXPECT_FALSE(aside);
  EXPECT_EQ(keptAs(aside), "");
  std::filesystem::create_symlink(d / "loop", d / "loop");
  EXPECT_TRUE(mayExist(d / "loop")) << "what lies there cannot be looked at";
}

TEST(AtomicFile, ReplacesAFileAndLeavesNothingElse) {
  TemporaryDirectory d;
  writeFile(d / "a.txt", "old");
  ::chmod((d / "a.txt").c_str(), 0640);
  writeFileAtomically(d / "a.txt", [](std::ostream& out) { out << "new"; });
  EXPECT_EQ(fileBytes(d / "a.txt"), "new");
  EXPECT_EQ(d.fileCount(), 1U);
  struct stat info {};
  ASSERT_EQ(::stat((d / "a.txt").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777U, 0640U);
}

TEST(AtomicFile, FailureKeepsTheOldFileAndLeavesNothingElse) {
  TemporaryDirectory d;
  writeFile(d / "a.txt", "old");
  EXPECT_THROW(writeFileAtomically(d / "a.txt",
                                   [](std::ostream& out) {
                                     out << "half";
                                     throw std::runtime_error("stop");
                                   }),
               std::runtime_error);
  EXPECT_EQ(fileBytes(d / "a.txt"), "old");
  EXPECT_EQ(d.fileCount(), 1U);
}

TEST(AtomicFile, PlaceThatCannotBeWrittenIsNamed) {
  TemporaryDirectory d;
  const auto nothing = [](std::ostream&) {};
  const std::string missing = d / "no/such/a.txt";
  EXPECT_TRUE(
      mentions(messageOf<InputError>([&] { writeFileAtomically(missing, nothing); }), missing));
  EXPECT_TRUE(mentions(messageOf<InputError>([&] { writeFileAtomically(d.path(), nothing); }),
                       "is a directory"));
  EXPECT_THROW(writeFileAtomically("", nothing), InputError);
}

TEST(AtomicFile, FullDiskIsAnError) {
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "this system has no /dev/full";
  EXPECT_THROW(
      writeFileAtomically("/dev/full", [](std::ostream& out) { out << std::string(100000, 'x'); }),
      InputError);
}

TEST(ReadTextFile, ReadsPlainAndGzipAlike) {
  TemporaryDirectory d;
  const std::string text = "one\ntwo\n" + std::string(3000000, 'x');
  writeFile(d / "plain.log", text);
  writeFile(d / "packed.log", gzipped(text, d));
  EXPECT_EQ(readTextFile(d / "plain.log"), text);
  EXPECT_EQ(readTextFile(d / "packed.log"), text);
  writeFile(d / "empty", "");
  EXPECT_EQ(readTextFile(d / "empty"), "");
}

TEST(ReadTextFile, TruncatedGzipIsAnErrorWhereverItIsCut) {
  TemporaryDirectory d;
  const std::string packed = gzipped(std::string(5000, 'x') + "end", d);
  for (std::size_t size = 2; size < packed.size(); ++size) {
    writeFile(d / "cut.gz", packed.substr(0, size));
    EXPECT_THROW(readTextFile(d / "cut.gz"), InputError) << "cut to " << size << " bytes";
  }
}

TEST(ReadTextFile, DamagedGzipIsAnError) {
  TemporaryDirectory d;
  std::string text;
  for (int i = 0; i < 5000; ++i) text += std::to_string(i * i);
  std::string packed = gzipped(text, d);
  packed[packed.size() / 2] = static_cast<char>(packed[packed.size() / 2] ^ 0x55);
  writeFile(d / "bad.gz", packed);
  EXPECT_TRUE(mentions(messageOf<InputError>([&] { readTextFile(d / "bad.gz"); }), "damaged"));
}

TEST(ReadTextFile, MissingFileDirectoryAndTooLargeAreErrors) {
  TemporaryDirectory d;
  EXPECT_TRUE(mentions(messageOf<InputError>([&] { readTextFile(d / "none"); }), d / "none"));
  EXPECT_TRUE(mentions(messageOf<InputError>([&] { readTextFile(d.path()); }), "is a directory"));
  writeFile(d / "big", std::string(1000, 'x'));
  EXPECT_THROW(readTextFile(d / "big", 999), InputError);
}

TEST(Tum, RoundTrip) {
  TemporaryDirectory d;
  const std::vector<StampedPose2> poses{{0.0, {1, 2, 3}},
                                        {1234567890.123456, {-1e3, 1e-4, -kPi / 3}}};
  writeTum(d / "t.tum", poses);
  const auto back = readTum(d / "t.tum");
  ASSERT_EQ(back.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(back[i].stamp, poses[i].stamp, 1e-6);
    EXPECT_NEAR(back[i].pose.x, poses[i].pose.x, 1e-9);
    EXPECT_NEAR(back[i].pose.y, poses[i].pose.y, 1e-9);
    EXPECT_NEAR(back[i].pose.theta, poses[i].pose.theta, 1e-8);
  }
}

TEST(Tum, BadLinesAreNamed) {
  TemporaryDirectory d;
  const auto error = [&](const std::string& text) {
    writeFile(d / "t.tum", text);
    return messageOf<InputError>([&] { readTum(d / "t.tum"); });
  };
  EXPECT_TRUE(mentions(error("# c\n\n1 0 0 0 0 0 0 1\n2 0 0 0 0 0 1\n"), "line 4: 7 columns"));
  EXPECT_TRUE(mentions(error("1 nan 0 0 0 0 0 1\n"), "line 1: column 2"));
  EXPECT_TRUE(mentions(error("1 0 0 0 0 0 0 0.5\n"), "quaternion"));
  EXPECT_TRUE(mentions(error("1 0 0 0 0 0 0 0\n"), "quaternion"));
  EXPECT_TRUE(mentions(error("# nothing\n"), "no pose"));
}

TEST(ReferenceTable, IsReadAndToldFromTum) {
  TemporaryDirectory d;
  writeFile(d / "r.txt",
            "# scan_index ipc_timestamp monotone_timestamp x y theta u e\n"
            "0 976052857.3 0.0 1 2 0.5 0 0\n1 976052857.4 0.2 3 4 7 0 0\n");
  const PoseFile file = readPoses(d / "r.txt");
  EXPECT_TRUE(file.one_per_scan);
  ASSERT_EQ(file.poses.size(), 2U);
  EXPECT_EQ(file.poses[1].stamp, 0.2);
  EXPECT_NEAR(file.poses[1].pose.theta, 7 - 2 * kPi, 1e-12);
  EXPECT_TRUE(file.estimated.empty());
  writeFile(d / "t.tum", "0 0 0 0 0 0 0 1\n");
  EXPECT_FALSE(readPoses(d / "t.tum").one_per_scan);
}

TEST(ReferenceTable, TellsWhichPosesWereEstimated) {
  TemporaryDirectory d;
  const std::string header =
      "# scan_index ipc_timestamp monotone_timestamp x y theta is_rbpf_update stamp_exact\n";
  writeFile(d / "r.txt", header + "0 9 0.0 1 2 0.5 1 0\n1 9 0.2 3 4 0.6 0 1\n");
  EXPECT_EQ(readPoses(d / "r.txt").estimated, (std::vector<bool>{true, false}));
  writeFile(d / "short.txt", header + "0 9 0.0 1 2 0.5\n");
  EXPECT_TRUE(mentions(messageOf<InputError>([&] { readPoses(d / "short.txt"); }), "columns"));
}

TEST(ReferenceTable, GapInTheIndexIsAnError) {
  TemporaryDirectory d;
  writeFile(d / "r.txt", "# scan_index\n0 0 0 0 0 0\n2 0 0 0 0 0\n");
  EXPECT_TRUE(mentions(messageOf<InputError>([&] { readReferenceTable(d / "r.txt"); }), "line 3"));
}

TEST(BinaryIo, NumbersAreLittleEndianAndReadBackExactly) {
  std::ostringstream out;
  {
    BinaryWriter writer(out);
    writer.put(std::uint32_t{0x01020304});
    writer.put(-2.5);
    writer.put(std::int16_t{-7});
    writer.putSized(std::vector<float>{1.5F, std::numeric_limits<float>::infinity()});
    writer.putText("abc");
  }
  const std::string bytes = out.str();
  EXPECT_EQ(bytes.substr(0, 4), "\x04\x03\x02\x01");
  BinaryReader reader(bytes);
  EXPECT_EQ(reader.get<std::uint32_t>(), 0x01020304U);
  EXPECT_EQ(reader.get<double>(), -2.5);
  EXPECT_EQ(reader.get<std::int16_t>(), -7);
  EXPECT_EQ(reader.getSized<float>(),
            (std::vector<float>{1.5F, std::numeric_limits<float>::infinity()}));
  EXPECT_EQ(reader.left(), 3U);
  reader.skip(3);
  reader.requireEnd();
}

TEST(BinaryIo, ChecksumCoversWhatWasWrittenSinceTheLastOne) {
  std::ostringstream out;
  BinaryWriter writer(out);
  writer.put(std::uint64_t{42});
  writer.putChecksum();
  writer.put(std::uint8_t{1});
  writer.putChecksum();
  const std::string bytes = out.str();
  BinaryReader reader(bytes);
  reader.skip(8);
  EXPECT_EQ(reader.get<std::uint32_t>(), checksumOf(bytes, 0, 8));
  reader.skip(1);
  EXPECT_EQ(reader.get<std::uint32_t>(), checksumOf(bytes, 12, 13));
}

TEST(BinaryIo, MissingAndLeftBytesAreErrors) {
  const std::string five(5, '\xff');
  BinaryReader reader(five, "model");
  reader.skip(2);
  EXPECT_EQ(messageOf<InputError>([&] { reader.get<std::uint32_t>(); }),
            "model: byte 2: ends early");
  EXPECT_EQ(messageOf<InputError>([&] { reader.requireEnd(); }),
            "model: byte 2: has bytes after its end");
  const std::string eight(8, '\xff');
  BinaryReader sized(eight);  // says that 2^64 - 1 values follow
  EXPECT_THROW(sized.getSized<double>(), InputError);
}

}  // namespace
}  // namespace hyselam
