#include <gtest/gtest.h>

#include <utility>

#include "app/frames/frame_painter.h"
#include "app/panel/panel.h"
#include "tests/engine/simulation/handle.h"
#include "tests/render/compare.h"

namespace spoonbill {
namespace {

constexpr int width_px = 800, height_px = 704;  // large enough for the panel

// Makes painting jobs in which a control point rises from frame to frame and the time advances.
class Crew : public ::testing::Test {
 protected:
  static Session make_session() {
    auto session =
        Session::make({"handle", small_handle(), Json::object()}, "handle", {}, best_instruction_set());
    EXPECT_TRUE(session) << session.error().message;
    return std::move(session).value();
  }

  PaintingJob job(std::uint64_t frame) {
    PaintingJob job;
    job.frame = frame;
    write_snapshot(session_, job.snapshot);
    job.view =
        frame_view(session_.view, Framing{framed_box(job.snapshot), {}, 0.0}, {width_px, height_px, true});
    SessionFacts facts;
    write_facts(session_, facts);
    job.panel = make_panel_model(facts, job.snapshot, job.view);
    SurfaceSnapshot& surface = job.snapshot.bodies[0].surface;
    // The control point is far from the ends of the body, so that the ends stay closed.
    const int raised = surface.v.control_point_count() / 2;
    surface.y[static_cast<std::size_t>(raised)] += 0.002F * static_cast<float>(frame);
    job.panel.time_s = 0.1 * static_cast<double>(frame);
    return job;
  }

  Session session_ = make_session();
};

TEST_F(Crew, PaintsInOrderWhatOnePainterPaints) {
  constexpr std::uint64_t frames = 9;
  PaintingCrew crew(width_px, height_px);
  std::vector<PaintedFrame> painted;
  const auto take = [&] {
    auto frame = crew.receive();
    ASSERT_TRUE(frame) << frame.error().message;
    painted.push_back(std::move(frame).value());
  };
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    if (crew.is_full()) take();
    crew.start(job(frame));
  }
  while (crew.in_flight() > 0) take();

  auto alone = FramePainter::make(width_px, height_px);
  ASSERT_TRUE(alone) << alone.error().message;
  ASSERT_EQ(painted.size(), frames);
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const PaintingJob expected = job(frame);
    Image picture;
    ASSERT_TRUE(alone->paint(expected.snapshot, expected.view, expected.panel, picture));
    EXPECT_EQ(painted[frame].frame, frame);
    const auto difference = worst_block_difference(picture, painted[frame].picture);
    ASSERT_TRUE(difference) << difference.error().message;
    EXPECT_EQ(difference->worst, 0.0)
        << "frame " << frame << " at " << difference->x_px << ", " << difference->y_px;
  }
}

TEST_F(Crew, APainterThatCannotPaintSaysSo) {
  PaintingCrew crew(width_px, height_px);
  PaintingJob broken = job(0);
  broken.snapshot.bodies[0].surface.y.clear();
  crew.start(std::move(broken));
  EXPECT_FALSE(crew.receive());
}

TEST_F(Crew, WhatNobodyTakesIsThrownAway) {
  PaintingCrew crew(width_px, height_px);
  while (!crew.is_full()) crew.start(job(0));
}

}  // namespace
}  // namespace spoonbill
