// Tests what happens to the autosave of a recovered document.
#include "app/edit/edited_document.h"

#include <gtest/gtest.h>

#include "haptic/virtual_device.h"
#include "tests/app/wait_for.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

// A session that edits a file and begins with the work recovered from an earlier session.
class RecoveredSession {
 public:
  RecoveredSession() {
    Document left = held_handle();
    left.name = "left";
    EXPECT_TRUE(autosave_.write(left));
    HandTarget start;
    start.pose.position_m = Vector3(0.05, 0.1, 0.0);
    LiveSettings settings;
    settings.real_time = false;
    auto session = LiveSession::start(left, "test", settings, SteeredDevice::make(Hand{}, start).value());
    EXPECT_TRUE(session) << session.error().message;
    live_ = std::move(session).value();
    live_->frame();
    edited_.begin_recovered(*live_);
  }

  LiveSession& live() { return *live_; }
  EditedDocument& edited() { return edited_; }
  const Autosave& autosave() const { return autosave_; }
  std::filesystem::path file() const { return place_.path("model.json"); }

  // Returns the documents in the files named *.kept-* beside the autosave.
  std::vector<Document> kept() const {
    std::vector<Document> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      if (entry.path().string().find(".kept-") == std::string::npos) continue;
      auto document = read_document(entry.path());
      EXPECT_TRUE(document) << document.error().message;
      if (document) found.push_back(std::move(document).value());
    }
    return found;
  }

 private:
  Workplace place_;
  std::filesystem::path folder_ = place_.path(".");
  Autosave autosave_{folder_, file()};
  EditedDocument edited_{folder_, file()};
  std::unique_ptr<LiveSession> live_;
};

TEST(EditedDocument, KeepsRecoveredWorkThatNobodySaved) {
  RecoveredSession session;
  EXPECT_TRUE(session.edited().has_unsaved_changes(session.live().last_frame()));
  EXPECT_TRUE(session.edited().switch_to("/elsewhere/other.json", session.live()));
  EXPECT_FALSE(std::filesystem::exists(session.autosave().file()));
  const std::vector<Document> kept = session.kept();
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].name, "left");
}

TEST(EditedDocument, KeepsWhatWasEditedAfterTheRecovery) {
  RecoveredSession session;
  ASSERT_TRUE(session.live().ask(Command(PlacePlane{{Vector3(0.01, 0, 0), Vector3::UnitX()}})));
  ASSERT_TRUE(wait_for(session.live(), [&](const LiveFrame&) {
    const auto saved = session.autosave().recovered_document();
    return saved && saved.value() && saved.value()->scene.planes.size() == 2;
  }));
  EXPECT_TRUE(session.edited().switch_to("/elsewhere/other.json", session.live()));
  const std::vector<Document> kept = session.kept();
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].scene.planes.size(), 2U);
}

TEST(EditedDocument, KeepsNoWorkThatWasSaved) {
  RecoveredSession session;
  ASSERT_TRUE(session.live().save(session.file(), Replaced::any));
  ASSERT_TRUE(wait_for(session.live(), [&](const LiveFrame&) {
    const auto saved = session.live().consume_saved_document();
    if (saved) session.edited().note_saved(*saved, session.live());
    return saved.has_value();
  }));
  EXPECT_TRUE(session.edited().switch_to("/elsewhere/other.json", session.live()));
  EXPECT_TRUE(session.kept().empty());
  EXPECT_FALSE(std::filesystem::exists(session.autosave().file()));
}

// The next document may change before the window has noticed that this document is open.
TEST(EditedDocument, KeepsNothingOfTheNextDocument) {
  RecoveredSession session;
  Document next = held_handle();
  next.name = "next";
  ASSERT_TRUE(session.live().open(next, "test"));
  ASSERT_TRUE(wait_for(session.live(), [](const LiveFrame& frame) { return frame.document == 1; }));
  ASSERT_TRUE(session.live().ask(Command(PlacePlane{{Vector3(0.01, 0, 0), Vector3::UnitX()}})));
  // The scene of the next document is passed to the journal every 400 ticks.
  const std::uint64_t tick = session.live().last_frame().snapshot.tick;
  ASSERT_TRUE(
      wait_for(session.live(), [&](const LiveFrame& frame) { return frame.snapshot.tick > tick + 900; }));
  EXPECT_TRUE(session.edited().switch_to("/elsewhere/other.json", session.live()));
  const std::vector<Document> kept = session.kept();
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].name, "left");
}

}  // namespace
}  // namespace spoonbill
