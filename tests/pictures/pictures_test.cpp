// Compares pictures with the approved pictures: a bend in the default view, the stages of a contact, presses
// into materials, lattices and merged patches.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "app/files/shown_model.h"
#include "app/frames/frame_painter.h"
#include "app/frames/model_picture.h"
#include "app/panel/interface_context.h"
#include "app/panel/panel.h"
#include "app/session/lockstep.h"
#include "engine/base/geometry.h"
#include "engine/exchange/document.h"
#include "engine/merging/merge.h"
#include "haptic/virtual_device.h"
#include "render/contact_sheet.h"
#include "render/image.h"
#include "render/tessellation/tessellated_surface.h"
#include "tests/pictures/approved.h"
#include "tests/render/compare.h"

namespace spoonbill {
namespace {

constexpr int width_px = 1280, height_px = 720;

const std::filesystem::path recording_folder = SPOONBILL_ASSETS "/recordings";
const std::filesystem::path model_folder = SPOONBILL_ASSETS "/models";

using Edit = std::function<void(ViewSettings&, PanelModel&)>;

// Paints moments of replays. Each moment can be painted several times with changed settings.
class MomentPictures : public ::testing::Test {
 protected:
  struct Moment {
    const char* name;
    double share;  // fraction of the recording's time
    const char* recording;
  };

  // State of a session that can be painted repeatedly.
  struct Stage {
    Snapshot snapshot;
    SessionFacts facts;
    ViewChoice view;
    Framing framing;
    std::shared_ptr<FramePainter> painter;  // draws only this session
  };

  static std::shared_ptr<FramePainter> make_painter() {
    auto painter = FramePainter::make(width_px, height_px);
    EXPECT_TRUE(painter) << painter.error().message;
    return std::make_shared<FramePainter>(std::move(painter).value());
  }

  // A replay that can continue from one moment to a later moment. The states up to each moment must have the
  // hashes in the recording.
  class Replay {
   public:
    explicit Replay(const char* recording) {
      auto read = read_recording(recording_folder / (std::string(recording) + ".recording.jsonl"));
      EXPECT_TRUE(read) << read.error().message;
      auto session =
          Session::make(read->header.document, "recording", read->header.device, best_instruction_set());
      EXPECT_TRUE(session) << session.error().message;
      session_ = std::make_unique<Session>(std::move(session).value());
      session_->reading = read->readings.front();
      Snapshot snapshot;
      write_snapshot(*session_, snapshot);
      framing_ = find_framing(session_->simulation.scene(), snapshot);
      readings_ = std::move(read->readings);
      device_ = std::make_unique<PlaybackDevice>(read->header.device, readings_);
      lockstep_ = std::make_unique<Lockstep>(
          *session_,
          LockstepInput{
              device_.get(), readings_.size(), read->commands, read->checkpoints, {}, 0, "recording"},
          nullptr);
    }

    bool is_after(double share) const { return lockstep_->tick() > tick_of(share); }

    Stage run_to(double share) {
      EXPECT_TRUE(lockstep_->run_to(tick_of(share)));
      session_->flags = tick_flag_none;  // clears flags that many frames have accumulated
      Stage stage;
      write_snapshot(*session_, stage.snapshot);
      write_facts(*session_, stage.facts);
      stage.view = session_->view;
      stage.framing = framing_;
      stage.framing.lowest_y_m = std::min(framing_.lowest_y_m, drawn_bounds(stage.snapshot).low.y());
      stage.painter = painter_;
      return stage;
    }

   private:
    std::uint64_t tick_of(double share) const {
      return frame_tick(
          static_cast<std::uint64_t>(share * static_cast<double>(frame_count(lockstep_->tick_count()) - 1)));
    }

    std::vector<DeviceReading> readings_;
    std::unique_ptr<Session> session_;
    std::unique_ptr<PlaybackDevice> device_;
    std::unique_ptr<Lockstep> lockstep_;
    Framing framing_;
    std::shared_ptr<FramePainter> painter_ = make_painter();
  };

  // Returns the state at a moment. The test cases share one replay of each recording. If the replay has
  // passed the moment, it restarts.
  static const Stage& stage_of(const Moment& moment) {
    static std::map<std::string, Replay> replays;
    static std::map<std::pair<std::string, double>, Stage> stages;
    const auto [stage, is_new] = stages.try_emplace({moment.recording, moment.share});
    if (!is_new) return stage->second;
    const auto before = replays.find(moment.recording);
    if (before != replays.end() && before->second.is_after(moment.share)) replays.erase(before);
    Replay& replay = replays.try_emplace(moment.recording, moment.recording).first->second;
    return stage->second = replay.run_to(moment.share);
  }

  static Document document_of(const char* model) {
    const auto document = read_document(model_folder / (std::string(model) + ".json"));
    EXPECT_TRUE(document) << document.error().message;
    return document.value();
  }

  // Returns a model as it is when opened, before any tick.
  static Stage stage_of_document(const Document& document) {
    auto session = Session::make(document, document.name, VirtualDevice::default_specification(),
                                 best_instruction_set());
    EXPECT_TRUE(session) << session.error().message;
    Stage stage;
    write_snapshot(session.value(), stage.snapshot);
    write_facts(session.value(), stage.facts);
    stage.view = session->view;
    stage.framing = find_framing(session->simulation.scene(), stage.snapshot);
    stage.painter = make_painter();
    return stage;
  }

  static Image paint(const Stage& stage, const Edit& edit, bool has_panel = false) {
    ViewSettings view = frame_view(stage.view, stage.framing, {width_px, height_px, has_panel});
    PanelModel panel = make_panel_model(stage.facts, stage.snapshot, view);
    if (edit) edit(view, panel);
    Image image;
    EXPECT_TRUE(stage.painter->paint(stage.snapshot, view, panel, image));
    return image;
  }

  static Image picture(const Moment& moment, const Edit& edit = {}, bool has_panel = false) {
    return paint(stage_of(moment), edit, has_panel);
  }

  static void compare_moment(const Moment& moment) { compare_with_approved(moment.name, picture(moment)); }

  // Returns the difference that each edit makes in the picture.
  static std::vector<double> changes(const Moment& moment, const std::vector<Edit>& edits) {
    const Stage& stage = stage_of(moment);
    const Image unchanged = paint(stage, {}, true);
    std::vector<double> result;
    result.reserve(edits.size());
    for (const Edit& edit : edits) {
      result.push_back(worst_block_difference(unchanged, paint(stage, edit, true)).value().worst);
    }
    return result;
  }
};

class BendPictures : public MomentPictures {
 protected:
  static constexpr const char* bend = "spoon-handle-bend";
  static constexpr Moment before{"bend-before", 0.0, bend};
  static constexpr Moment pushed{"bend-pushed", 0.72, bend};
  static constexpr Moment settled{"bend-settled", 1.0, bend};
};

TEST_F(BendPictures, Before) {
  compare_moment(before);
}

TEST_F(BendPictures, Pushed) {
  compare_moment(pushed);
}

TEST_F(BendPictures, Settled) {
  compare_moment(settled);
}

TEST_F(BendPictures, SettledWithPanelLatticeAndControlNet) {
  const auto edit = [](ViewSettings& view, PanelModel& panel) {
    view.overlays.lattice = view.overlays.control_net = true;
    view.see_through_body = true;
    panel.overlays = view.overlays;
    panel.see_through_body = true;
  };
  compare_with_approved("bend-lattice", picture(settled, edit, true));
}

TEST_F(BendPictures, WhatMustShowShows) {
  std::vector<Edit> edits = {
      [](ViewSettings&, PanelModel&) {},
      [](ViewSettings& view, PanelModel&) {
        view.toward_key_light =
            Eigen::AngleAxisd(5.0 * std::numbers::pi / 180.0, Vector3::UnitY()) * view.toward_key_light;
      },
      [](ViewSettings&, PanelModel& panel) { panel.device += "s"; },
  };
  for (bool Overlays::*overlay :
       {&Overlays::fixed_nodes, &Overlays::touched_nodes, &Overlays::force, &Overlays::fixing_planes,
        &Overlays::tool, &Overlays::scale_bar, &Overlays::legend}) {
    edits.emplace_back([overlay](ViewSettings& view, PanelModel&) { view.overlays.*overlay = false; });
  }
  const std::vector<double> change = changes(pushed, edits);
  EXPECT_EQ(change[0], 0.0);  // an edit that changes nothing leaves the picture equal
  EXPECT_GT(change[1], picture_tolerance) << "a light moved by 5 degrees";
  EXPECT_GT(change[2], picture_tolerance) << "one changed label";
  for (std::size_t overlay = 3; overlay < change.size(); ++overlay) {
    EXPECT_GT(change[overlay], picture_tolerance) << "missing overlay " << overlay - 3;
  }
}

// Finger ridges and dents of local strokes, as in Fig. 8 of Pungotra et al. (2013), and a bent handle with
// ridges.
class GripPictures : public MomentPictures {
 protected:
  static constexpr Moment pulled{"grip-pulled", 0.33, "grip-bulge"};
  static constexpr Moment bulges{"grip-bulge", 1.0, "grip-bulge"};
  static constexpr Moment dents{"grip-dent", 1.0, "grip-dent"};
  static constexpr Moment bent{"bent-grips", 1.0, "bent-grips"};
};

TEST_F(GripPictures, Pulled) {
  compare_moment(pulled);
}

TEST_F(GripPictures, Bulges) {
  compare_moment(bulges);
}

TEST_F(GripPictures, Dents) {
  compare_moment(dents);
}

TEST_F(GripPictures, Bent) {
  compare_moment(bent);
}

class ContactPictures : public MomentPictures {
 protected:
  static constexpr const char* sphere = "contact-stages";
  static constexpr const char* surfaces = "surface-contact-stages";
};

TEST_F(ContactPictures, Hulls) {
  compare_moment({"contact-hulls", 0.35, sphere});
}

TEST_F(ContactPictures, Spheres) {
  compare_moment({"contact-spheres", 0.45, sphere});
}

TEST_F(ContactPictures, Triangles) {
  compare_moment({"contact-triangles", 0.85, sphere});
}

TEST_F(ContactPictures, Points) {
  compare_moment({"contact-points", 0.95, sphere});
}

TEST_F(ContactPictures, SpheresOfTwoSurfaces) {
  compare_moment({"contact-surfaces", 0.625, surfaces});
}

class MaterialPictures : public MomentPictures {};

TEST_F(MaterialPictures, ClayPressed) {
  compare_moment({"clay-pressed", 0.55, "clay-press"});
}

TEST_F(MaterialPictures, ClayKeepsTheDent) {
  compare_moment({"clay-let-go", 1.0, "clay-press"});
}

TEST_F(MaterialPictures, SiliconePressed) {
  compare_moment({"silicone-pressed", 0.55, "silicone-press"});
}

TEST_F(MaterialPictures, SiliconeSpringsBack) {
  compare_moment({"silicone-let-go", 1.0, "silicone-press"});
}

TEST_F(MaterialPictures, GelatinHeld) {
  compare_moment({"gelatin-held", 0.6, "gelatin-press"});
}

TEST_F(MaterialPictures, GelatinComesBackSlowly) {
  compare_moment({"gelatin-let-go", 0.72, "gelatin-press"});
}

// Tests pictures of the boundaries of hexahedra in a translucent body. The boundaries on the far side are
// visible through the body.
using LatticePictures = MomentPictures;

TEST_F(LatticePictures, CellsOfJelly) {
  const Stage stage = stage_of_document(document_of("jelly"));
  compare_with_approved("jelly-cells", paint(stage, {}));
}

// Draws two patches with different counts of control points and different knots, and the merged patch.
class MergePictures : public MomentPictures {
 protected:
  static Document parts() {
    Document document = document_of("spoon-handle");
    document.name = "handle and bowl";
    document.scene.bodies.push_back(document_of("spoon-bowl").scene.bodies[0]);
    document.view = Json::parse(
        R"({"camera": {"yaw_deg": 30, "pitch_deg": 44, "target_mm": [86, -4, 0], "distance_mm": 350},
            "ground_mm": -30, "overlays": {"control_net": true, "tool": false}})");
    return document;
  }
  static Document spoon() {
    Document document = parts();
    auto merged = merge({document.scene.bodies[0].surface, document.scene.bodies[1].surface}, {});
    EXPECT_TRUE(merged) << merged.error().message;
    document.name = "spoon";
    document.scene.bodies.pop_back();
    document.scene.bodies[0].name = "spoon";
    document.scene.bodies[0].surface = std::move(merged->surface);
    return document;
  }
};

TEST_F(MergePictures, HandleAndBowl) {
  const Stage stage = stage_of_document(parts());
  compare_with_approved("spoon-parts", paint(stage, {}));
}

TEST_F(MergePictures, Spoon) {
  const Stage stage = stage_of_document(spoon());
  compare_with_approved("spoon-merged", paint(stage, {}));
}

// Pictures of models that nobody touches.
Image model_picture(const std::string& model, const std::string& material, int width, int height) {
  const auto shown = read_shown_model(model_folder / (model + ".json"), {}, Progress());
  EXPECT_TRUE(shown) << shown.error().message;
  ShownModel painted = shown.value();
  if (!material.empty()) show_material(material, painted);
  PictureSettings settings;
  settings.width_px = width;
  settings.height_px = height;
  auto painter = FramePainter::make(width, height);
  EXPECT_TRUE(painter) << painter.error().message;
  Image image;
  EXPECT_TRUE(painter->paint(painted.snapshot, make_picture_view(painted, settings), {}, image));
  return image;
}

TEST(ModelPictures, BentSpoon) {
  compare_with_approved("spoon-bent", model_picture("spoon-bent", "", width_px, height_px));
}

ContactSheet two_columns() {
  ContactSheetLayout layout;
  layout.columns = 2;
  layout.cell_width_px = 640;
  layout.caption_px = 22;
  layout.caption_font_path = font_file;
  return ContactSheet(layout);
}

// The spoons of section 5.1 of Pungotra et al. 2013.
TEST(ModelPictures, SixSpoons) {
  ContactSheet sheet = two_columns();
  for (const char* model : {"spoon-original", "spoon-bent", "spoon-grip-bulge", "spoon-grip-dent",
                            "spoon-thick", "spoon-rough"}) {
    sheet.add(model_picture(model, "", 640, 360), model);
  }
  compare_with_approved("spoons", sheet.compose().value());
}

TEST(ModelPictures, OneSpoonInTenMaterials) {
  ContactSheet sheet = two_columns();
  for (const char* material : {"modelling-clay", "wax", "steel-304", "aluminium-6061", "abs", "polypropylene",
                               "beech", "silicone-00-30", "gelatin-10-1", "foam"}) {
    sheet.add(model_picture("spoon-bent", material, 640, 360), material);
  }
  compare_with_approved("materials", sheet.compose().value());
}

}  // namespace
}  // namespace spoonbill
