#include "app/panel/panel.h"

#include <gtest/gtest.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/panel/interface_context.h"
#include "app/report/quantity_text.h"
#include "app/session/session.h"
#include "app/session/view_choice.h"
#include "engine/exchange/document.h"
#include "haptic/virtual_device.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

PanelModel full_model() {
  PanelModel model;
  model.title = "A spoon handle with a long name";
  model.time_s = 123.45;
  model.can_undo = model.can_redo = true;
  model.material.name = "modelling-clay";
  model.material.source = "test";
  model.material.youngs_modulus_pa = 2e5;
  model.material.poissons_ratio = 0.45;
  model.material.density_kg_per_m3 = 1700.0;
  model.material.damping_time_s = 2e-5;
  model.material.plastic = true;
  model.material.yield_strain = 0.01;
  model.material.flow_rate_per_s = 300.0;
  model.presets = {model.material};
  model.inertia_scale = 1225.0;
  model.mass_kg = 1.2345;
  model.fixed_node_count = 39999;
  model.node_count = 40000;
  model.plane_count = 64;
  model.device = "virtual";
  model.force_n = 3.3;
  model.force_limit_n = 3.3;
  model.rate_hz = 1000.0;
  model.substeps = 24;
  model.flags =
      tick_flag_nodes_slowed | tick_flag_speed_capped | tick_flag_contact_overflow | tick_flag_force_limited;
  return model;
}

// Lays out the panel without drawing it.
class Frame {
 public:
  Frame(int width_px, int height_px)
      : width_px_(width_px),
        height_px_(height_px),
        context_(InterfaceContext::make(font_file, panel_scale(height_px)).value()) {
    unsigned char* pixels = nullptr;
    int width = 0;
    int height = 0;
    context_.fonts().GetTexDataAsAlpha8(&pixels, &width, &height);
  }

  std::vector<Request> draw(const PanelModel& model) { return draw_answer(model).requests; }

  PanelAnswer draw_answer(const PanelModel& model) {
    context_.begin_frame(width_px_, height_px_);
    auto answer = draw_panel(model, context_.theme(), picture_panel_rectangle(width_px_, height_px_));
    context_.end_frame();
    return answer;
  }

  // Returns all texts of the panel.
  std::string draw_text(const PanelModel& model) {
    context_.begin_frame(width_px_, height_px_);
    ImGui::LogToClipboard();
    draw_panel(model, context_.theme(), picture_panel_rectangle(width_px_, height_px_));
    std::string text = ImGui::GetClipboardText();
    context_.end_frame();
    return text;
  }

  void press_at(float x, float y) {
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = ImVec2(x, y);
    io.MouseDown[0] = true;
  }

  void release() { ImGui::GetIO().MouseDown[0] = false; }

 private:
  int width_px_;
  int height_px_;
  InterfaceContext context_;
};

TEST(Panel, ClipsNothingAtTheUsualSizes) {
  for (const auto& [width, height] :
       {std::pair{1280, 720}, {1366, 768}, {1920, 1080}, {2560, 1440}, {3840, 2160}}) {
    Frame frame(width, height);
    PanelModel model = full_model();
    model.tool.body = std::make_shared<ToolBody>();
    model.region_count = 16;
    model.unheld_count = 1;
    model.force_on = true;
    model.rate_is_nominal = false;
    frame.draw(model);
    frame.draw(model);
    const ImGuiWindow* window = ImGui::FindWindowByName("Panel");
    ASSERT_NE(window, nullptr);
    EXPECT_LE(window->ContentSize.y + 2.0F * window->WindowPadding.y, window->Size.y)
        << width << "x" << height;
    EXPECT_LE(window->ContentSize.x + 2.0F * window->WindowPadding.x, window->Size.x)
        << width << "x" << height;
  }
}

TEST(Panel, AsksForNothingWhenNobodyTouchesIt) {
  Frame frame(1280, 720);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(frame.draw(full_model()).empty());
}

TEST(Panel, UndoButtonAsksForUndo) {
  Frame frame(1280, 720);
  frame.draw(full_model());
  frame.draw(full_model());
  const float x = 220.0F;
  const float y = 38.0F;
  ImGui::GetIO().MousePos = ImVec2(x, y);
  frame.draw(full_model());
  frame.press_at(x, y);
  frame.draw(full_model());
  frame.release();
  const auto requests = frame.draw(full_model());
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<UndoStroke>(requests[0]));
}

std::vector<Request> click_once(const PanelModel& model, float x, float y) {
  Frame frame(1280, 720);
  frame.draw(model);
  frame.draw(model);
  ImGui::GetIO().MousePos = ImVec2(x, y);
  frame.draw(model);
  frame.press_at(x, y);
  frame.draw(model);
  frame.release();
  return frame.draw(model);
}

// Returns the requests of a click on the third tool kind.
std::vector<Request> click_third_kind(const PanelModel& model) {
  return click_once(model, 241.0F, 83.0F);
}

TEST(Panel, OffersASolidWhereTheToolHasABody) {
  PanelModel model = full_model();
  EXPECT_TRUE(click_third_kind(model).empty());

  model.tool.body = std::make_shared<ToolBody>();
  const auto requests = click_third_kind(model);
  ASSERT_EQ(requests.size(), 1U);
  const auto* command = std::get_if<Command>(&requests[0]);
  ASSERT_NE(command, nullptr);
  const auto* set = std::get_if<SetTool>(command);
  ASSERT_NE(set, nullptr);
  EXPECT_EQ(set->tool.kind, ToolKind::solid);
  EXPECT_EQ(set->tool.body, model.tool.body);
}

TEST(Panel, SwitchesTheForceOfALiveDevice) {
  // Clicks at one height after another along the right edge of the panel, until a click requests to switch
  // the force. Returns whether the request is to switch it on.
  const auto find_switch = [](const PanelModel& model) -> std::optional<bool> {
    for (float y = 500.0F; y < 700.0F; y += 10.0F) {
      for (const Request& request : click_once(model, 275.0F, y)) {
        if (const auto* force = std::get_if<SwitchForce>(&request)) return force->on;
      }
    }
    return {};
  };
  PanelModel model = full_model();
  EXPECT_EQ(find_switch(model), std::nullopt) << "a replay moves no device";
  model.force_on = true;
  EXPECT_EQ(find_switch(model), false);
  model.force_on = false;
  EXPECT_EQ(find_switch(model), true);
}

TEST(Panel, LetsBodiesSettleAndSwingAgain) {
  PanelModel model = full_model();
  for (const bool is_critically_damped : {true, false}) {
    const auto requests = click_once(model, 275.0F, 309.0F);
    ASSERT_EQ(requests.size(), 1U);
    const auto* command = std::get_if<Command>(&requests[0]);
    ASSERT_NE(command, nullptr);
    const auto* set = std::get_if<SetSculpting>(command);
    ASSERT_NE(set, nullptr);
    EXPECT_EQ(set->sculpting.is_critically_damped, is_critically_damped);
    EXPECT_EQ(set->sculpting.drag_per_s, model.sculpting.drag_per_s);
    model.sculpting = set->sculpting;
  }
}

TEST(Panel, SaysHowMuchSlowerABodyResponds) {
  Frame frame(1280, 720);
  PanelModel model = full_model();
  frame.draw(model);
  EXPECT_NE(frame.draw_text(model).find("35 times slower"), std::string::npos);
  model.inertia_scale = 1.0;
  EXPECT_EQ(frame.draw_text(model).find("slower"), std::string::npos);
}

TEST(Panel, SaysHowFastTimePassesLive) {
  Frame frame(1280, 720);
  PanelModel model = full_model();
  model.rate_hz = 250.0;
  frame.draw(model);
  EXPECT_EQ(frame.draw_text(model).find("25 %"), std::string::npos) << "no clock measures it in lock-step";
  model.rate_is_nominal = false;
  EXPECT_NE(frame.draw_text(model).find("25 %"), std::string::npos);
}

TEST(Panel, SwitchesRealTime) {
  PanelModel model = full_model();
  for (const bool real_time : {true, false}) {
    const auto requests = click_once(model, 275.0F, 285.0F);
    ASSERT_EQ(requests.size(), 1U);
    const auto* command = std::get_if<Command>(&requests[0]);
    ASSERT_NE(command, nullptr);
    const auto* set = std::get_if<SetSculpting>(command);
    ASSERT_NE(set, nullptr);
    EXPECT_EQ(set->sculpting.real_time, real_time);
    model.sculpting = set->sculpting;
  }
}

TEST(Panel, LetsUnfixedBodiesMoveAndKeepsThemAgain) {
  // Clicks at one height after another along the right edge of the panel. Returns the settings requested by
  // the first click that changes `free`.
  const auto find_switch = [](const PanelModel& model) -> std::optional<Sculpting> {
    for (float y = 330.0F; y < 480.0F; y += 10.0F) {
      for (const Request& request : click_once(model, 275.0F, y)) {
        const auto* command = std::get_if<Command>(&request);
        const auto* set = command != nullptr ? std::get_if<SetSculpting>(command) : nullptr;
        if (set != nullptr && set->sculpting.free != model.sculpting.free) return set->sculpting;
      }
    }
    return {};
  };
  PanelModel model = full_model();
  EXPECT_FALSE(find_switch(model)) << "every body is fixed";
  model.unheld_count = 1;
  for (const bool is_free : {true, false}) {
    const auto sculpting = find_switch(model);
    ASSERT_TRUE(sculpting);
    EXPECT_EQ(sculpting->free, is_free);
    EXPECT_EQ(sculpting->is_critically_damped, model.sculpting.is_critically_damped);
    EXPECT_EQ(sculpting->drag_per_s, model.sculpting.drag_per_s);
    EXPECT_EQ(sculpting->force_scale, model.sculpting.force_scale);
    model.sculpting = *sculpting;
  }
}

// Ctrl+clicks the slider at this height and types `text`. Returns the panel's answer.
PanelAnswer type_over_slider(float y, const char* text) {
  Frame frame(1280, 720);
  const PanelModel model = full_model();
  ImGuiIO& io = ImGui::GetIO();
  constexpr int enter = 7;
  io.KeyMap[ImGuiKey_Enter] = enter;
  frame.draw(model);
  frame.draw(model);
  io.MousePos = ImVec2(200.0F, y);
  frame.draw(model);
  io.KeyCtrl = true;
  frame.press_at(200.0F, y);
  EXPECT_TRUE(frame.draw(model).empty()) << "the slider stays";
  io.KeyCtrl = false;
  frame.release();
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(frame.draw(model).empty());
  io.AddInputCharactersUTF8(text);
  EXPECT_TRUE(frame.draw(model).empty());
  io.KeysDown[enter] = true;
  PanelAnswer answer = frame.draw_answer(model);
  io.KeysDown[enter] = false;
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(frame.draw(model).empty()) << "the field closes";
  return answer;
}

constexpr float modulus_y = 209.0F, poisson_y = 229.0F, density_y = 249.0F;

TEST(Panel, TakesATypedMaterialWithItsUnit) {
  const auto material = [](const PanelAnswer& answer) {
    EXPECT_EQ(answer.refusal, "");
    EXPECT_EQ(answer.requests.size(), 1U);
    if (answer.requests.size() != 1U) return Material{};
    return std::get<SetMaterial>(std::get<Command>(answer.requests[0])).material;
  };
  EXPECT_DOUBLE_EQ(material(type_over_slider(modulus_y, "1.5 MPa")).youngs_modulus_pa, 1.5e6);
  EXPECT_DOUBLE_EQ(material(type_over_slider(modulus_y, "300")).youngs_modulus_pa, 3e5) << "kPa, as shown";
  EXPECT_DOUBLE_EQ(material(type_over_slider(poisson_y, "0.3")).poissons_ratio, 0.3);
  EXPECT_DOUBLE_EQ(material(type_over_slider(density_y, "900 kg/m3")).density_kg_per_m3, 900.0);
}

TEST(Panel, RefusesWrongMaterialsWithTheRange) {
  const auto refusal = [](float y, const char* text) {
    const PanelAnswer answer = type_over_slider(y, text);
    EXPECT_TRUE(answer.requests.empty()) << text;
    return answer.refusal;
  };
  EXPECT_EQ(refusal(modulus_y, "-5 kPa"), "E is -5 kPa, must be from 0.001 kPa to 1e+09 kPa");
  EXPECT_EQ(refusal(modulus_y, "nan"), "E is nan kPa, must be from 0.001 kPa to 1e+09 kPa");
  EXPECT_EQ(refusal(modulus_y, "5 psi"), "E: unit psi is unknown; units: Pa, kPa, MPa, GPa");
  EXPECT_EQ(refusal(poisson_y, "0.5"), "Poisson is 0.5, must be from 0 to 0.49");
  EXPECT_EQ(refusal(density_y, "0"),
            "Density is 0 g/cm\u00b3, must be from 0.001 g/cm\u00b3 to 30 g/cm\u00b3");
  EXPECT_EQ(refusal(density_y, "wet"), "Density: \"wet\" is not a number");
  EXPECT_EQ(refusal(poisson_y, "0.1"),
            "material modelling-clay: poissons_ratio is 0.1, must be 0.2 or more for a material that is "
            "plastic, creeps or stiffens");
}

// A session whose panel receives typed values.
class TypedSession {
 public:
  PanelModel model() const {
    Snapshot snapshot;
    SessionFacts facts;
    write_snapshot(session_, snapshot);
    write_facts(session_, facts);
    return make_panel_model(facts, snapshot, {});
  }

  // Applies what the panel requests, advances, and checks the document and every text that the panel shows.
  void apply(const std::vector<Request>& requests) {
    for (const Request& request : requests) {
      const Status applied = apply_request(session_, request);
      EXPECT_TRUE(applied) << applied.error().message;
    }
    Pose pose;
    pose.position_m = Vector3(0.03, 0.2, 0.0);
    for (int i = 0; i < 3; ++i) advance(session_, DeviceReading::from(pose, 0));
    // Reading a document checks every number against its range.
    const auto document =
        document_from_json(document_to_json(make_session_document(session_)), "the document");
    EXPECT_TRUE(document) << document.error().message;
    expect_finite(shown_text());
  }

 private:
  std::string shown_text() const {
    Frame frame(1280, 720);
    frame.draw(model());
    return frame.draw_text(model());
  }

  static void expect_finite(const std::string& text) {
    EXPECT_NE(text.find("Poisson"), std::string::npos) << text;
    std::string word;
    for (const char letter : text + " ") {
      if (std::isalpha(static_cast<unsigned char>(letter)) != 0) {
        word += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
        continue;
      }
      EXPECT_TRUE(word != "nan" && word != "inf") << text;
      word.clear();
    }
  }

  Session session_ = Session::make({"handle", small_handle(), Json::object()}, "test",
                                   VirtualDevice::default_specification(), InstructionSet::baseline)
                         .value();
};

// Opens the field at this height with Ctrl+click. Returns its identity, or 0 if no field is there.
ImGuiID open_field(Frame& frame, const PanelModel& model, float y) {
  ImGuiIO& io = ImGui::GetIO();
  frame.draw(model);
  frame.draw(model);
  io.MousePos = ImVec2(200.0F, y);
  frame.draw(model);
  io.KeyCtrl = true;
  frame.press_at(200.0F, y);
  frame.draw(model);
  io.KeyCtrl = false;
  frame.release();
  for (int i = 0; i < 3; ++i) frame.draw(model);
  return io.WantTextInput ? ImGui::GetActiveID() : 0;
}

// Returns the heights of all fields that accept a typed number.
std::vector<float> find_fields(const PanelModel& model) {
  std::map<ImGuiID, float> heights;
  for (float y = 60.0F; y < 710.0F; y += 10.0F) {
    Frame frame(1280, 720);
    if (const ImGuiID field = open_field(frame, model, y); field != 0) heights.emplace(field, y);
  }
  std::vector<float> all;
  for (const auto& [field, y] : heights) all.push_back(y);
  return all;
}

// Types the text into the field at this height, in place of its value, and confirms it. Returns all requests.
std::vector<Request> replace_field(const PanelModel& model, float y, const char* text) {
  Frame frame(1280, 720);
  constexpr int enter = 7, backspace = 8;
  ImGuiIO& io = ImGui::GetIO();
  io.KeyMap[ImGuiKey_Enter] = enter;
  io.KeyMap[ImGuiKey_Backspace] = backspace;
  EXPECT_NE(open_field(frame, model, y), 0U);
  std::vector<Request> all;
  const auto draw = [&] {
    for (Request& request : frame.draw(model)) all.push_back(std::move(request));
  };
  const auto press = [&](int key) {
    io.KeysDown[key] = true;
    draw();
    io.KeysDown[key] = false;
    draw();
  };
  press(backspace);
  io.AddInputCharactersUTF8(text);
  draw();
  press(enter);
  draw();
  return all;
}

TEST(Panel, ShowsAndAcceptsOnlyFiniteNumbersInRange) {
  TypedSession session;
  const auto count_sliders = [](const auto& fields) {
    return std::count_if(fields.begin(), fields.end(),
                         [](const auto& field) { return field.form.slider.label; });
  };
  const std::vector<float> fields = find_fields(session.model());
  // The radius of a local stroke is shown only if the reach is local.
  ASSERT_EQ(static_cast<std::ptrdiff_t>(fields.size()) + 1, count_sliders(fields_of<Tool>) +
                                                                count_sliders(fields_of<Material>) +
                                                                count_sliders(fields_of<Sculpting>));
  for (const float y : fields) {
    for (const char* text : {"nan", "-nan(1)", "inf", "-infinity", "1e300", "-1e300", "1e999", "1e-320", "",
                             "text", "99999999999999999999", "-1", "0"}) {
      SCOPED_TRACE(std::to_string(y) + ": \"" + text + "\"");
      session.apply(replace_field(session.model(), y, text));
    }
  }
}

// Clicks at one height after another along the right edge. Clicks that miss the button make other requests.
TEST(Panel, AddsKnotsToTheBodyThatLagsMost) {
  Snapshot snapshot;
  snapshot.bodies.resize(3);
  snapshot.bodies[0].residual.largest_m = 1e-5;
  snapshot.bodies[1].residual.largest_m = 3e-5;
  snapshot.bodies[2].residual.largest_m = 2e-5;
  const PanelModel model = make_panel_model({}, snapshot, {});
  EXPECT_EQ(model.residual_m, 3e-5);
  Frame frame(1280, 720);
  frame.draw(model);
  std::vector<int> refined;
  for (int row = 0; row < 20; ++row) {
    const float y = 300.0F + 8.0F * static_cast<float>(row);
    ImGui::GetIO().MousePos = ImVec2(270.0F, y);
    frame.draw(model);
    frame.press_at(270.0F, y);
    frame.draw(model);
    frame.release();
    for (const Request& request : frame.draw(model)) {
      const auto* command = std::get_if<Command>(&request);
      const auto* refine = command != nullptr ? std::get_if<RefineKnots>(command) : nullptr;
      if (refine != nullptr) refined.push_back(refine->body);
    }
  }
  ASSERT_FALSE(refined.empty());
  EXPECT_EQ(refined.front(), 1);
}

// Opens the list of contact stages, which covers the last rows of the panel, and clicks its second entry.
TEST(Panel, OffersTheStagesOfContact) {
  Frame frame(1280, 720);
  const auto click = [&](float x, float y) {
    ImGui::GetIO().MousePos = ImVec2(x, y);
    frame.draw(full_model());
    frame.press_at(x, y);
    frame.draw(full_model());
    frame.release();
    return frame.draw(full_model());
  };
  frame.draw(full_model());
  frame.draw(full_model());
  EXPECT_TRUE(click(200.0F, 521.0F).empty());
  frame.draw(full_model());
  const ImGuiWindow* list = nullptr;
  for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows) {
    if (window->WasActive && (window->Flags & ImGuiWindowFlags_Popup) != 0) list = window;
  }
  ASSERT_NE(list, nullptr);
  const float row = list->Size.y / static_cast<float>(stage_choices.size());
  const auto requests = click(list->Pos.x + 40.0F, list->Pos.y + 1.5F * row);
  ASSERT_EQ(requests.size(), 1U);
  const auto* change = std::get_if<ChangeView>(&requests[0]);
  ASSERT_NE(change, nullptr);
  ViewChoice choice;
  ASSERT_TRUE(apply_view_command(change->command, "panel", choice));
  EXPECT_EQ(choice.overlays.contact_stage, ContactStage::hulls);
}

TEST(Panel, LeavesSmallPicturesAlone) {
  EXPECT_EQ(picture_panel_rectangle(640, 480).width, 0.0);
  EXPECT_EQ(picture_panel_rectangle(1280, 720).width, 300.0);
  EXPECT_EQ(picture_panel_rectangle(2560, 1440).width, 600.0);
}

TEST(QuantityText, HasThreeDigitsAndAUnit) {
  EXPECT_EQ(modulus_text(163.2), "163 Pa");
  EXPECT_EQ(modulus_text(2e5), "200 kPa");
  EXPECT_EQ(modulus_text(1.234e6), "1.23 MPa");
  EXPECT_EQ(volume_text(1.234e-9), "0.00123 cm\u00b3");
  EXPECT_EQ(volume_text(9.996e-8), "0.10 cm\u00b3");
  for (const double rounding_error : {0.0, 1e-22, -1e-22}) {
    EXPECT_EQ(volume_text(rounding_error), "0.00 cm\u00b3");
  }
  EXPECT_EQ(modulus_text(999.9), "1.00 kPa");
  EXPECT_EQ(modulus_text(2.1e11), "210 GPa");
  EXPECT_EQ(millimetres_text(0.008), "8.0 mm");
  EXPECT_EQ(grams_text(0.0342), "34.2 g");
  EXPECT_EQ(percent_text(0.25), "25 %");
  EXPECT_EQ(percent_text(0.00081), "0.081 %");
}

}  // namespace
}  // namespace spoonbill
