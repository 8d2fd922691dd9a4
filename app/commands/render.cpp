#include <algorithm>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/files/documents.h"
#include "app/files/shown_model.h"
#include "app/frames/frame_painter.h"
#include "app/frames/model_picture.h"
#include "app/frames/replay_pictures.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "engine/exchange/file_format.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {
namespace {

constexpr Range<int> turntable_range{2, 3600};
constexpr int turntable_pictures_per_s = 30;

struct RenderOptions {
  std::vector<std::filesystem::path> models;
  std::filesystem::path out;
  std::filesystem::path video;
  Extent size{1280, 720};
  PictureSettings picture;
  std::string material;            // its name; empty to keep those of the models
  std::optional<LengthUnit> unit;  // of the numbers in meshes and clouds
  int turntable = 0;               // number of pictures of the video
  OutputOptions how;
  bool json = false;
};

Result<ShownModel> read_models(const RenderOptions& options, Console& console) {
  InterruptWatch interrupt;
  std::vector<ShownModel> models;
  for (const std::filesystem::path& file : options.models) {
    ProgressBar bar(console, "Reading", false);
    auto model = read_shown_model(file, options.unit, Progress([&](double fraction) {
                                    bar.show(fraction);
                                    return !interrupt.requested();
                                  }));
    if (interrupt.requested()) interrupt.answer();
    if (!model) return model.error();
    models.push_back(std::move(model).value());
  }
  ShownModel joined = join_models(models);
  if (!options.material.empty()) show_material(options.material, joined);
  if (options.picture.overlays.tool) rest_tool_on_top(joined);
  return joined;
}

Result<Image> paint(FramePainter& painter, const ShownModel& model, const ViewSettings& view) {
  Image image;
  if (Status painted = painter.paint(model.snapshot, view, {}, image); !painted) return painted.error();
  if (view.is_transparent) make_alpha_straight(image);
  return image;
}

// Writes a video in which the model turns once.
Status write_turntable(const RenderOptions& options, const ShownModel& model, FramePainter& painter,
                       Console& console) {
  auto encoder = VideoEncoder::start(options.video, options.size.width, options.size.height,
                                     turntable_pictures_per_s, 1);
  if (!encoder) return encoder.error();
  InterruptWatch interrupt;
  ProgressBar bar(console, "Drawing", false);
  int done = 0;
  for (const ViewSettings& view : make_turntable(model, options.picture, options.turntable)) {
    if (interrupt.requested()) {
      interrupt.answer();
      return Error{ErrorCode::cancelled, "stopped; no video was written"};
    }
    const auto image = paint(painter, model, view);
    if (!image) return image.error();
    if (Status added = encoder->add(image.value()); !added) return added;
    bar.show(static_cast<std::uint64_t>(++done), static_cast<std::uint64_t>(options.turntable));
  }
  return encoder->finish();
}

Status render(RenderOptions options, Console& console) {
  for (const auto& out : {options.out, options.video}) {
    if (Status checked = check_output(out, options.how); !checked) return checked;
    for (const std::filesystem::path& model : options.models) {
      if (Status checked = check_is_not_source(out, model, "the output"); !checked) return checked;
    }
  }
  if (options.turntable > 0 && !VideoEncoder::available())
    return Error{ErrorCode::unsupported, "ffmpeg is not installed; install it, or leave out --turntable"};
  options.picture.width_px = options.size.width;
  options.picture.height_px = options.size.height;
  const auto model = read_models(options, console);
  if (!model) return model.error();
  auto painter = FramePainter::make(options.size.width, options.size.height);
  if (!painter) return painter.error();
  const auto image = paint(painter.value(), model.value(), make_picture_view(model.value(), options.picture));
  if (!image) return image.error();
  if (Status written = write_png(options.out, image.value(), options.how); !written) return written;
  FactSheet facts;
  facts.add("Picture", options.out.string(), "out", options.out.string());
  const std::size_t bodies = model->snapshot.bodies.size();
  facts.add("Bodies", std::to_string(bodies), "bodies", bodies);
  const Vector3 size_m = drawn_bounds(model->snapshot).extent();
  facts.add("Size", size_text(size_m), "size_m", components_json(size_m));
  for (const std::string& note : model->notes) facts.add("Note", note, "", nullptr);
  facts.add("", "", "notes", model->notes);
  if (options.turntable > 0) {
    if (Status written = write_turntable(options, model.value(), painter.value(), console); !written)
      return written;
    facts.add("Video", options.video.string(), "video", options.video.string());
  }
  facts.print(console.out, options.json);
  return {};
}

Result<std::string> parse_material(const std::string& text) {
  const auto material = shipped_material(text);
  if (!material) return material.error();
  return material->name;
}

}  // namespace

CommandEntry add_render(OptionSet root) {
  auto options = std::make_shared<RenderOptions>();
  const OptionSet parser = root.add_command("render", "Draw a picture of a model, without simulating it");
  parser.set_footer(
      "Draws documents, the models of recordings and scripts, CAD files, meshes and point clouds. Several\n"
      "models are drawn together, as they are. They stand on the level ground of the first document that\n"
      "has one, or on a ground at their lowest point. A cloud is drawn as discs.\n"
      "Example: spoonbill render assets/models/spoon-handle.json --out handle.png --material steel");
  parser.add_option("MODEL", options->models, "Models of any format that the program reads").require();
  parser.add_option("--out", options->out, "Picture to write (.png)").require().show_as("FILE");
  add_size_option(parser, options->size, "Size of the picture");
  add_parsed_option(
      parser, "--view", "VIEW", parse_view_direction,
      [options](const ViewDirection& direction) { options->picture.direction = direction; },
      "perspective, front, back, left, right, top or bottom, or azimuth,elevation in degrees; default: "
      "30,28");
  add_parsed_option(
      parser, "--material", "NAME", parse_material,
      [options](const std::string& name) { options->material = name; },
      "Material that all bodies look like, such as steel; default: their own");
  add_parsed_option(
      parser, "--studio", "NAME[,DEGREES]", parse_studio,
      [options](const StudioChoice& studio) { options->picture.studio = studio; },
      "Lights and backdrop: " + list_studios() +
          "; turned about the vertical by so many degrees; default: " + std::string(studios().front().name));
  add_parsed_option(
      parser, "--overlays", "LIST", parse_picture_overlays,
      [options](const Overlays& overlays) { options->picture.overlays = overlays; },
      "What is shown beside the model, separated by commas: grid, scale, legend, net, planes, and tool, on "
      "the highest point; default: nothing");
  add_parsed_option(
      parser, "--unit", "UNIT", [](const std::string& text) { return parse_unit(text); },
      [options](const LengthUnit& unit) { options->unit = unit; },
      "Unit of the numbers in meshes and clouds: mm, cm, m or in; default: m for .ply and .pcd, else mm");
  const CommandOption transparent =
      parser.add_flag("--transparent", options->picture.is_transparent, "Leave out the background");
  const CommandOption video =
      parser.add_option("--video", options->video, "Video to write; its ending selects the format");
  const CommandOption turntable =
      parser
          .add_option("--turntable", options->turntable,
                      "Number of pictures of a video in which the model turns once, 30 per second")
          .limit(turntable_range)
          .show_as("N");
  turntable.need(video).exclude(transparent);
  video.show_as("FILE").need(turntable);
  add_force_option(parser, options->how);
  add_json_option(parser, options->json);
  parser.set_final_check([options]() -> Status {
    const auto has_no_unit = [](const std::filesystem::path& model) {
      const FileFormat format = format_from_name(model);
      return is_mesh(format) || is_cloud(format);
    };
    if (options->unit && std::none_of(options->models.begin(), options->models.end(), has_no_unit)) {
      return Error{ErrorCode::inconsistent,
                   "--unit: no model is a mesh or a cloud; the others have their own unit", "--unit"};
    }
    const std::string ending = options->out.extension().string();
    if (ending == ".png" || ending == ".PNG") return {};
    return Error{ErrorCode::unsupported, "--out: '" + options->out.string() + "' must end in .png", "--out"};
  });
  return {parser, [options](Console& console) { return render(*options, console); }};
}

}  // namespace spoonbill
