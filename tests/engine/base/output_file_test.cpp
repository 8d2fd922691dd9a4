// Tests that an output file appears complete or not at all, whatever was at its path before.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>

#include "engine/base/file.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

constexpr std::size_t limit = std::size_t{1} << 24;

std::size_t files_in(const TemporaryFolder& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder.path()), {}));
}

TEST(OutputFile, AppearsWholeAtItsCommit) {
  const TemporaryFolder folder;
  const auto file = folder.write("a.csv", "old");
  auto out = OutputFile::create(file);
  ASSERT_TRUE(out.ok()) << out.error().message;
  const std::string half(100'000, 'x');  // larger than the file's write buffer
  ASSERT_TRUE(out->write(half).ok());
  EXPECT_EQ(content_of(file), "old");
  ASSERT_TRUE(out->write("end").ok());
  ASSERT_TRUE(out->commit().ok());
  EXPECT_EQ(content_of(file), half + "end");
  EXPECT_EQ(files_in(folder), 1u) << "nothing is left beside it";
}

TEST(OutputFile, LeavesNothingWithoutItsCommit) {
  const TemporaryFolder folder;
  const auto file = folder.write("a.csv", "old");
  {
    auto out = OutputFile::create(file);
    ASSERT_TRUE(out.ok());
    ASSERT_TRUE(out->write(std::string(100'000, 'x')).ok());
  }
  EXPECT_EQ(content_of(file), "old");
  EXPECT_EQ(files_in(folder), 1u);
}

TEST(OutputFile, AGrowingFileCanBeReadMeanwhileAndStays) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.jsonl";
  {
    auto out = OutputFile::create_growing(file);
    ASSERT_TRUE(out.ok());
    ASSERT_TRUE(out->write("one\n").ok());
    EXPECT_EQ(content_of(file.string() + ".part"), "one\n");
  }
  EXPECT_EQ(content_of(file.string() + ".part"), "one\n");
}

TEST(OutputFile, AGrowingFileReplacesAnOlderAtItsCommit) {
  const TemporaryFolder folder;
  const auto file = folder.write("a.jsonl", "old");
  auto out = OutputFile::create_growing(file);
  ASSERT_TRUE(out.ok());
  ASSERT_TRUE(out->write("new").ok());
  EXPECT_EQ(content_of(file), "old");
  EXPECT_EQ(content_of(file.string() + ".part"), "new");
  ASSERT_TRUE(out->flush().ok());
  ASSERT_TRUE(out->commit().ok());
  EXPECT_EQ(content_of(file), "new");
  EXPECT_EQ(files_in(folder), 1u);
}

TEST(OutputFile, KeepsTheMeaningOfWhatItReplaces) {
  const TemporaryFolder folder;
  const auto real = folder.write("real.png", "old"), link = folder.path() / "link.png";
  std::filesystem::permissions(real, std::filesystem::perms(0600));
  std::filesystem::create_symlink(real, link);
  for (const Durability durability : {Durability::now, Durability::later}) {
    ASSERT_TRUE(write_file(link, "new", durability).ok());
    EXPECT_TRUE(std::filesystem::is_symlink(link));
    EXPECT_EQ(content_of(real), "new");
    EXPECT_EQ(std::filesystem::status(real).permissions(), std::filesystem::perms(0600));
  }
  EXPECT_FALSE(std::filesystem::exists(real.string() + ".bak"));
  EXPECT_TRUE(flush_to_disk(folder.path()).ok());
}

TEST(OutputFile, ANameOfTheProgramsOwnIsNeverFollowed) {
  const TemporaryFolder folder;
  const auto foreign = folder.write("foreign", "mine"), link = folder.path() / "saved-a.json";
  for (const std::filesystem::path& target : {foreign, folder.path() / "missing"}) {
    std::filesystem::remove(link);
    std::filesystem::create_symlink(target, link);
    ASSERT_TRUE(replace_file(link, "new", {NamedBy::program}).ok());
    EXPECT_FALSE(std::filesystem::is_symlink(link));
    EXPECT_EQ(content_of(link), "new");
  }
  EXPECT_EQ(content_of(foreign), "mine");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "missing"));
  const auto pipe = folder.path() / "picture-a.png";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  ASSERT_TRUE(write_file(pipe, "new", Durability::later, {NamedBy::program}).ok());
  EXPECT_EQ(content_of(pipe), "new");
}

TEST(OutputFile, AReadOnlyFileStays) {
  const TemporaryFolder folder;
  const auto file = folder.write("a.csv", "old");
  std::filesystem::permissions(file, std::filesystem::perms(0444));
  EXPECT_EQ(write_file(file, "new").error().code, ErrorCode::unwritable);
  EXPECT_EQ(OutputFile::create_growing(file).error().code, ErrorCode::unwritable);
  EXPECT_EQ(content_of(file), "old");
  ASSERT_TRUE(write_file(file, "new", Durability::now, {NamedBy::person, true}).ok());
  EXPECT_EQ(content_of(file), "new");
  EXPECT_EQ(std::filesystem::status(file).permissions(), std::filesystem::perms(0444));
}

TEST(OutputFile, WritesDevicesAsTheyAre) {
  EXPECT_TRUE(write_file("/dev/null", "x").ok());
  EXPECT_EQ(write_file("/dev/full", "x").error().message,
            "/dev/full: cannot be written: No space left on device");
}

TEST(OutputFile, AFileOfAnotherProgramIsPutInItsPlace) {
  const TemporaryFolder folder;
  const auto finished = folder.write("a.new.mp4", "video"), file = folder.path() / "a.mp4";
  ASSERT_TRUE(publish_file(finished, file).ok());
  EXPECT_EQ(content_of(file), "video");
  EXPECT_EQ(publish_file(finished, file).error().message,
            file.string() + ": cannot be written: No such file or directory");
}

TEST(OutputFile, TheEndsOfFilesAreReadAsTheirStartsAre) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_last_bytes(folder.write("long", "0123456789"), 4), "6789");
  EXPECT_EQ(read_last_bytes(folder.write("short", "01"), 4), "01");
  EXPECT_EQ(read_last_bytes(folder.path() / "missing", 4), "");
  EXPECT_EQ(read_last_bytes(folder.path(), 4), "");
}

TEST(OutputFile, AFileTooLargeComesWithItsRemedy) {
  const TemporaryFolder folder;
  const auto file = folder.write("big", std::string((1 << 20) + 1, 'x'));
  const std::string message = file.string() + ": is larger than 1 MiB; thin it out";
  EXPECT_EQ(check_file(file, 1 << 20, "thin it out").error().message, message);
  EXPECT_EQ(read_file(file, 1 << 20, "thin it out").error().message, message);
  EXPECT_TRUE(check_file(file, limit).ok());
}

}  // namespace
}  // namespace spoonbill
