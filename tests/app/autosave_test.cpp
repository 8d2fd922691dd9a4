#include "app/live/autosave.h"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <optional>
#include <vector>

#include "tests/app/workplace.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

Document handle(const std::string& name) {
  return {name, small_handle(), Json::object()};
}

TEST(Autosave, GivesBackWhatWasLeft) {
  const Workplace place;
  const Autosave autosave(place.path("."), {});
  EXPECT_FALSE(autosave.recovered_document().value().has_value());
  ASSERT_TRUE(autosave.write(handle("unfinished")));
  const auto found = autosave.recovered_document();
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found.value().has_value());
  EXPECT_EQ(found.value()->name, "unfinished");
  EXPECT_EQ(document_to_json(*found.value()), document_to_json(handle("unfinished")));
  autosave.remove();
  EXPECT_FALSE(autosave.recovered_document().value().has_value());
}

TEST(Autosave, DocumentsOfOneNameInTwoFoldersHaveTheirOwn) {
  const Workplace place;
  const Autosave one(place.path("."), "/a/spoon.json"), other(place.path("."), "/b/spoon.json");
  EXPECT_NE(one.file(), other.file());
}

TEST(AutosaveClaim, WindowsOnOneDocumentDoNotShareAnAutosave) {
  const Workplace place;
  auto one = std::optional(AutosaveClaim::acquire(place.path("."), "/a/spoon.json"));
  const auto other = AutosaveClaim::acquire(place.path("."), "/a/spoon.json");
  EXPECT_NE(one->autosave().file(), other.autosave().file());
  // The first of two open windows crashes. A third window, opened later, recovers the work of the first. The
  // second keeps its own autosave.
  ASSERT_TRUE(one->autosave().write(handle("first")));
  ASSERT_TRUE(other.autosave().write(handle("second")));
  one.reset();
  const auto next = AutosaveClaim::acquire(place.path("."), "/a/spoon.json");
  EXPECT_EQ(next.autosave().recovered_document().value()->name, "first");
}

TEST(AutosaveClaim, KnowsWhetherTheDocumentIsOpenElsewhere) {
  const Workplace place;
  EXPECT_FALSE(AutosaveClaim::acquire(place.path("."), "/a/spoon.json").is_open_elsewhere());
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t window = fork();
  if (window == 0) {
    const auto claim = AutosaveClaim::acquire(place.path("."), "/a/spoon.json");
    const char ready = claim.is_open_elsewhere() ? 1 : 0;
    if (write(ends[1], &ready, 1) == 1) pause();
    _exit(1);
  }
  char wrong = 1;
  EXPECT_EQ(read(ends[0], &wrong, 1), 1);
  EXPECT_EQ(wrong, 0);
  {
    // A window that continues the work of a crashed window also learns that a third window has the file open.
    ASSERT_TRUE(Autosave(place.path("."), "/a/spoon.json", 2).write(handle("left")));
    const auto second = AutosaveClaim::acquire(place.path("."), "/a/spoon.json");
    EXPECT_TRUE(second.is_open_elsewhere());
    EXPECT_TRUE(second.autosave().recovered_document().value().has_value());
    EXPECT_FALSE(AutosaveClaim::acquire(place.path("."), "/a/other.json").is_open_elsewhere());
  }
  kill(window, SIGKILL);
  waitpid(window, nullptr, 0);
  EXPECT_FALSE(AutosaveClaim::acquire(place.path("."), "/a/spoon.json").is_open_elsewhere());
  // Two untitled documents are different documents, so neither counts as open elsewhere.
  const auto untitled = AutosaveClaim::acquire(place.path("."), {});
  EXPECT_FALSE(AutosaveClaim::acquire(place.path("."), {}).is_open_elsewhere());
  close(ends[0]);
  close(ends[1]);
}

TEST(AutosaveClaim, FindsWhatASecondWindowLeft) {
  const Workplace place;
  ASSERT_TRUE(Autosave(place.path("."), {}, 2).write(handle("second")));
  const auto claim = AutosaveClaim::acquire(place.path("."), {});
  EXPECT_EQ(claim.autosave().recovered_document().value()->name, "second");
}

TEST(AutosaveClaim, LeavesNoLockBehind) {
  const Workplace place;
  const auto count = [&] {
    const std::filesystem::directory_iterator all(place.path("."));
    return std::distance(begin(all), end(all));
  };
  const auto before = count();
  { const auto claim = AutosaveClaim::acquire(place.path("."), {}); }
  EXPECT_EQ(count(), before);
}

// A checkout or a synchronisation after the crash can make the document's file newer than the autosave. The
// autosave must be offered all the same.
TEST(Autosave, IsOfferedBesideANewerFileOfOtherContent) {
  using namespace std::chrono_literals;
  const Workplace place;
  const auto file = place.path("spoon.json");
  const Autosave autosave(place.path("."), file);
  ASSERT_TRUE(write_document(handle("saved"), file));
  ASSERT_TRUE(autosave.write(handle("unsaved")));
  std::filesystem::last_write_time(autosave.file(), std::filesystem::last_write_time(file) - 10s);
  const auto found = autosave.recovered_document();
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found.value().has_value());
  EXPECT_EQ(found.value()->name, "unsaved");
  EXPECT_EQ(read_document(file).value().name, "saved");
}

TEST(Autosave, WithTheContentOfTheFileIsNothing) {
  using namespace std::chrono_literals;
  const Workplace place;
  const auto file = place.path("spoon.json");
  const Autosave autosave(place.path("."), file);
  ASSERT_TRUE(write_document(handle("saved"), file));
  ASSERT_TRUE(autosave.write(handle("saved")));
  std::filesystem::last_write_time(file, std::filesystem::last_write_time(autosave.file()) - 10s);
  EXPECT_FALSE(autosave.recovered_document().value().has_value());
}

TEST(Autosave, OneThatIsDeclinedStaysAsADocument) {
  const Workplace place;
  const Autosave autosave(place.path("."), {});
  std::vector<std::filesystem::path> kept;
  for (const char* name : {"first", "second"}) {
    ASSERT_TRUE(autosave.write(handle(name)));
    const auto aside = autosave.set_aside();
    ASSERT_TRUE(aside) << aside.error().message;
    kept.push_back(aside.value());
    EXPECT_FALSE(std::filesystem::exists(autosave.file()));
  }
  EXPECT_EQ(read_document(kept[0]).value().name, "first");
  EXPECT_EQ(read_document(kept[1]).value().name, "second");
  std::ofstream(autosave.file()) << "{";
  const auto unread = autosave.set_aside();
  ASSERT_TRUE(unread) << unread.error().message;
  EXPECT_EQ(content_of(unread.value()), "{");
  EXPECT_FALSE(autosave.set_aside());
}

TEST(Autosave, ABrokenOneIsAnErrorAndStays) {
  const Workplace place;
  const Autosave autosave(place.path("."), {});
  for (const char* content :
       {"", "{", "[]", "{\"spoonbill_autosave\":1}", "{\"spoonbill_autosave\":1,\"of\":\"\",\"document\":{}}",
        "{\"spoonbill_autosave\":2,\"of\":\"\",\"document\":{}}"}) {
    std::ofstream(autosave.file()) << content;
    const auto found = autosave.recovered_document();
    EXPECT_FALSE(found) << content;
    if (!found) {
      EXPECT_EQ(found.error().message.find('\n'), std::string::npos);
    }
    EXPECT_TRUE(std::filesystem::exists(autosave.file()));
  }
}

// A disk of 64 KiB, mounted for the test.
class SmallDisk {
 public:
  explicit SmallDisk(const std::filesystem::path& folder) : folder_(folder) {
    std::filesystem::create_directory(folder_);
    mounted_ = mount("none", folder_.c_str(), "tmpfs", 0, "size=64k") == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount(folder_.c_str());
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }

 private:
  std::filesystem::path folder_;
  bool mounted_;
};

TEST(Autosave, AFullDiskKeepsTheLastWholeOne) {
  const Workplace place;
  const SmallDisk disk(place.path("disk"));
  if (!disk.mounted()) GTEST_SKIP() << "only root may mount a small disk";
  const Autosave autosave(place.path("disk"), {});
  ASSERT_TRUE(autosave.write(handle("first")));
  std::ofstream filler(place.path("disk") / "filler");
  const std::string block(4096, 'x');
  while (filler.write(block.data(), 4096).flush()) {
  }
  const Status failed = autosave.write(handle("second"));
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::unwritable);
  EXPECT_NE(failed.error().message.find("autosave"), std::string::npos) << failed.error().message;
  const auto found = autosave.recovered_document();
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found.value()->name, "first");
}

}  // namespace
}  // namespace spoonbill
