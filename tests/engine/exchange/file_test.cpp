#include "engine/base/file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "engine/exchange/document.h"
#include "tests/engine/effort.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

std::string reading_refusal(const std::filesystem::path& file, std::size_t limit = std::size_t{1} << 20) {
  const auto text = read_file(file, limit);
  return text.ok() ? "accepted" : text.error().message;
}

TEST(File, HasALineForEveryFileThatCannotBeRead) {
  const TemporaryFolder folder;
  const std::string here = folder.path().string();
  EXPECT_EQ(reading_refusal(folder.path() / "none.json"), here + "/none.json: no such file");
  EXPECT_EQ(reading_refusal(folder.path()), here + ": is a folder; name a file in it");
  EXPECT_EQ(reading_refusal(folder.write("empty.json", "")), here + "/empty.json: is empty");
  EXPECT_EQ(reading_refusal(folder.write("big.json", std::string((1 << 20) + 1, ' '))),
            here + "/big.json: is larger than 1 MiB");
  EXPECT_EQ(reading_refusal("/dev/zero"), "/dev/zero: is not a regular file");
  EXPECT_EQ(reading_refusal(folder.write("file", "x") / "inside"),
            here + "/file/inside: cannot be opened: Not a directory");
  ASSERT_EQ(mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(reading_refusal(folder.path() / "pipe"), here + "/pipe: is not a regular file");
}

TEST(File, CannotReadWithoutPermission) {
  const TemporaryFolder folder;
  const auto file = folder.write("secret.json", "{}");
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
  std::filesystem::permissions(file, std::filesystem::perms::none);
  const uid_t user = geteuid();
  const bool is_root = user == 0;  // root can read every file, whatever its permissions
  ASSERT_EQ(is_root ? seteuid(65534) : 0, 0);
  const std::string message = reading_refusal(file);
  ASSERT_EQ(is_root ? seteuid(user) : 0, 0);
  EXPECT_EQ(message, file.string() + ": cannot be opened: Permission denied");
}

TEST(File, ReplacesWholeAndKeepsOneBackup) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.json";
  ASSERT_TRUE(replace_file(file, "one").ok());
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".bak"));
  ASSERT_TRUE(replace_file(file, "two").ok());
  ASSERT_TRUE(replace_file(file, "three").ok());
  EXPECT_EQ(content_of(file), "three");
  EXPECT_EQ(content_of(file.string() + ".bak"), "two");
  const auto count = std::distance(std::filesystem::directory_iterator(folder.path()), {});
  EXPECT_EQ(count, 2) << "temporary files were left";
}

TEST(File, FollowsLinksAndKeepsPermissions) {
  const TemporaryFolder folder;
  const auto file = folder.write("real.json", "one");
  std::filesystem::permissions(file, std::filesystem::perms(0640));
  std::filesystem::create_symlink(file, folder.path() / "link.json");
  ASSERT_TRUE(replace_file(folder.path() / "link.json", "two").ok());
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "link.json"));
  EXPECT_EQ(content_of(file), "two");
  EXPECT_EQ(std::filesystem::status(file).permissions(), std::filesystem::perms(0640));
}

// A file keeps its group permissions whatever the umask. If the name of the temporary file is a symbolic
// link, nothing is written through it.
TEST(File, KeepsPermissionsThatTheMaskTakesAway) {
  const TemporaryFolder folder;
  const auto file = folder.write("shared.json", "one"), other = folder.write("other", "untouched");
  std::filesystem::permissions(file, std::filesystem::perms(0664));
  std::filesystem::create_symlink(other, file.string() + ".new-" + std::to_string(::getpid()));
  const mode_t before = ::umask(022);
  const Status replaced = replace_file(file, "two");
  ::umask(before);
  ASSERT_TRUE(replaced.ok()) << replaced.error().message;
  EXPECT_EQ(content_of(file), "two");
  EXPECT_EQ(std::filesystem::status(file).permissions(), std::filesystem::perms(0664));
  EXPECT_EQ(content_of(other), "untouched");
}

TEST(File, TheFirstBytesAreThoseOfFilesAlone) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_first_bytes(folder.write("long", "0123456789"), 4), "0123");
  EXPECT_EQ(read_first_bytes(folder.write("short", "01"), 4), "01");
  EXPECT_EQ(read_first_bytes(folder.path() / "missing", 4), "");
  EXPECT_EQ(read_first_bytes(folder.path(), 4), "");
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(read_first_bytes(pipe, 4), "");
}

TEST(File, RefusesToReplaceWhatIsNoFile) {
  const TemporaryFolder folder;
  EXPECT_EQ(replace_file(folder.path(), "x").error().message,
            folder.path().string() + ": is not a regular file; choose another name");
  const auto in_none = folder.path() / "none" / "a.json";
  EXPECT_EQ(replace_file(in_none, "x").error().message,
            in_none.string() + ": cannot be written: No such file or directory");
}

TEST(File, ReportsAFullDisk) {
  auto full = OutputFile::create_growing("/dev/full");
  ASSERT_TRUE(full.ok());
  EXPECT_EQ(full->write("x").error().message, "/dev/full: cannot be written: No space left on device");
}

TEST(File, WritesDocumentsThatReadBack) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "spoon.json";
  const Document document = deformed_document(11);
  ASSERT_TRUE(write_document(document, file).ok());
  const auto read = read_document(file);
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_TRUE(same_bits(document, read.value()));
}

// A program killed at any moment of a save leaves either the whole old document or the whole new one.
TEST(File, AKillDuringASaveLeavesAWholeDocument) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "spoon.json";
  const Document one = deformed_document(1), other = deformed_document(2);
  ASSERT_TRUE(write_document(one, file).ok());
  int changed = 0;
  for (int attempt = 0; attempt < 40; ++attempt) {
    const pid_t saver = fork();
    if (saver == 0) {
      while (write_document(other, file).ok() && write_document(one, file).ok()) {
      }
      _exit(1);
    }
    usleep(static_cast<useconds_t>((500 + 700 * attempt) * (sanitized ? 20 : 1)));
    kill(saver, SIGKILL);
    int status = 0;
    waitpid(saver, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the saver could not save";
    const auto read = read_document(file);
    ASSERT_TRUE(read.ok()) << read.error().message;
    const bool is_other = same_bits(other, read.value());
    EXPECT_TRUE(is_other || same_bits(one, read.value()));
    changed += is_other ? 1 : 0;
  }
  EXPECT_GT(changed, 0);  // at least one save was completed before the program was killed
}

TEST(File, NeverReplacesADocumentByOneThatCannotBeRead) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "spoon.json";
  ASSERT_TRUE(write_document(sample_document(), file).ok());
  const std::string before = content_of(file);
  Document broken = sample_document();
  broken.scene.bodies[0].surface.net.x[3] = std::numeric_limits<double>::quiet_NaN();
  const Status status = write_document(broken, file);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().message,
            file.string() +
                ": not saved: body.surface.control_points_mm[0][3] must be 3 numbers from "
                "-100000 to 100000");
  EXPECT_EQ(content_of(file), before);
}

TEST(File, ReadsMaterials) {
  const TemporaryFolder folder;
  const Material clay = sample_document().scene.bodies[0].material;
  const auto file = folder.write("clay.json", json_to_page(material_to_json(clay)));
  const auto read = read_material(file);
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(material_to_json(read.value()), material_to_json(clay));
  EXPECT_EQ(read_material(folder.write("bad.json", "{\"name\": \"x\"}")).error().message,
            (folder.path() / "bad.json").string() + ": source is missing");
}

}  // namespace
}  // namespace spoonbill
