#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/files/documents.h"
#include "app/files/length_unit.h"
#include "app/files/scan_file.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/file_format.h"
#include "engine/scene/place_body.h"

namespace spoonbill {
namespace {

constexpr Range<int> model_count_range{1, 64};

struct AddOptions {
  OutputOptions how;
  std::vector<std::filesystem::path> models;
  std::vector<Pose> poses;
  std::vector<std::string> fixed, rigid, held;  // names of bodies, as they are in the new document
  std::string material;                         // of bodies from mesh files; empty: abs
  std::optional<LengthUnit> unit;               // of mesh files
  std::filesystem::path out;
  bool json = false;
};

// Reads a document, or makes one of a mesh file.
Result<Document> read_model(const std::filesystem::path& file, const AddOptions& options) {
  if (!is_mesh(format_from_name(file))) return read_document_file(file);
  const auto material = shipped_material(options.material.empty() ? "abs" : options.material);
  if (!material) return material.error();
  MeshReading reading;
  reading.unit = options.unit;
  auto read = read_mesh_file(file, reading);
  if (!read) return read.error();
  auto mesh = clean_mesh(std::move(read->mesh), file.string());
  if (!mesh) return mesh.error();
  auto document = make_mesh_document(clean_cad_name(file.stem().string(), "mesh"), std::move(mesh).value(),
                                     material.value());
  if (!document) return document.error().in(file.string());
  return document;
}

// Returns the name, with a number appended if it is taken.
std::string make_unique(const std::string& name, const std::vector<std::string>& taken) {
  std::string unique = name;
  for (int number = 2; std::find(taken.begin(), taken.end(), unique) != taken.end(); ++number) {
    unique = name + "-" + std::to_string(number);
  }
  return unique;
}

// Adds the bodies of `document` to those of `sum`.
void add_bodies(Document document, const Pose& pose, Document& sum) {
  std::vector<Body>& bodies = sum.scene.bodies;
  std::vector<std::string> names, solids;
  std::map<std::string, std::string> new_solids;  // new name of each solid of `document`
  for (const Body& body : bodies) {
    names.push_back(body.name);
    solids.push_back(body.solid);
  }
  for (Body& body : document.scene.bodies) {
    move_body(pose, body);
    body.name = make_unique(body.name, names);
    names.push_back(body.name);
    // A solid of another document is another solid, even if it has the same name.
    if (!body.solid.empty()) {
      const auto [renamed, is_new] = new_solids.try_emplace(body.solid);
      if (is_new) {
        renamed->second = make_unique(body.solid, solids);
        solids.push_back(renamed->second);
      }
      body.solid = renamed->second;
    }
    bodies.push_back(std::move(body));
  }
}

// Returns what of a further document does not enter the new one; empty if it has nothing else.
std::string describe_left_out(const Document& document, const std::string& source) {
  std::string rest;
  const auto add = [&](bool is_there, const char* what) {
    if (is_there) rest += (rest.empty() ? "" : ", ") + std::string(what);
  };
  add(!document.scene.planes.empty(), "fixing planes");
  add(document.scene.ground.has_value(), "ground");
  add(document.scene.trial.has_value(), "trial");
  return rest.empty() ? rest : source + ": left out: " + rest + "; they are those of the first model";
}

// Makes the named bodies rigid, each by `change`. `option` is the option that names them.
Status make_rigid(const std::vector<std::string>& names, const char* option, Document& document,
                  const std::function<void(Body&)>& change) {
  for (const std::string& name : names) {
    const auto body = std::find_if(document.scene.bodies.begin(), document.scene.bodies.end(),
                                   [&](const Body& candidate) { return candidate.name == name; });
    if (body == document.scene.bodies.end()) {
      std::string known;
      for (const Body& each : document.scene.bodies) known += (known.empty() ? "" : ", ") + each.name;
      return Error{ErrorCode::unknown, option + (": no body is called '" + name + "'; choose from " + known),
                   option};
    }
    change(*body);
    if (Status checked = check_kind(*body); !checked) return checked.error().in("body \"" + name + "\"");
  }
  return {};
}

Status choose_kinds(const AddOptions& options, Document& document) {
  std::vector<std::string> all = options.fixed;
  all.insert(all.end(), options.rigid.begin(), options.rigid.end());
  all.insert(all.end(), options.held.begin(), options.held.end());
  std::sort(all.begin(), all.end());
  if (const auto twice = std::adjacent_find(all.begin(), all.end()); twice != all.end()) {
    return Error{ErrorCode::inconsistent,
                 "'" + *twice + "' is named twice; name it in one of --fixed, --rigid and --held", "--fixed"};
  }
  const auto fix = [](Body& body) {
    body.kind = BodyKind::fixed;
    body.hand.reset();
  };
  const auto free = [](Body& body) {
    body.kind = BodyKind::rigid;
    body.hand.reset();
    body.motion.reset();
  };
  const auto hold = [](Body& body) {
    body.kind = BodyKind::rigid;
    if (!body.hand) body.hand.emplace();
  };
  if (Status made = make_rigid(options.fixed, "--fixed", document, fix); !made) return made;
  if (Status made = make_rigid(options.rigid, "--rigid", document, free); !made) return made;
  return make_rigid(options.held, "--held", document, hold);
}

// Appends an option that takes names of bodies.
void add_names_option(const OptionSet& parser, const char* option, std::vector<std::string>& names,
                      const char* help) {
  parser
      .add_parsed_list(
          option,
          [&names](const std::vector<std::string>& given) -> Status {
            names = given;
            return {};
          },
          help)
      .show_as("NAME");
}

Status add_models(const AddOptions& options, Console& console) {
  if (Status checked = check_output(options.out, options.how); !checked) return checked;
  const int models = static_cast<int>(options.models.size());
  if (Status count = check_range("the number of models", models, model_count_range); !count) return count;
  std::optional<Document> sum;
  std::vector<std::string> notes;
  for (std::size_t m = 0; m < options.models.size(); ++m) {
    auto document = read_model(options.models[m], options);
    if (!document) return document.error();
    const Pose pose = m < options.poses.size() ? options.poses[m] : Pose();
    if (!sum) {
      sum = document.value();
      sum->scene.bodies.clear();
      sum->view = Json::object();  // the default view frames all bodies
    } else if (const std::string rest = describe_left_out(document.value(), options.models[m].string());
               !rest.empty()) {
      notes.push_back(rest);
    }
    add_bodies(std::move(document).value(), pose, *sum);
  }
  sum->name = options.out.stem().string();
  const int bodies = static_cast<int>(sum->scene.bodies.size());
  if (Status count = check_range("the number of bodies", bodies, body_count_range); !count) return count;
  if (Status chosen = choose_kinds(options, *sum); !chosen) return chosen;
  if (const std::string note = drop_unfit_trial(sum->scene); !note.empty()) notes.push_back(note);
  const InterruptWatch until_written;
  if (Status written = write_document(*sum, options.out, options.how); !written) return written;
  FactSheet facts;
  Json list = Json::array();
  for (const Body& body : sum->scene.bodies) {
    const char* const kind = body_kind_names[static_cast<std::size_t>(body.kind)];
    facts.add("Body", body.name + ", " + kind, "", nullptr);
    list.push_back({{"name", body.name}, {"kind", kind}});
  }
  facts.add("", "", "bodies", list);
  add_notes(facts, notes);
  facts.add("Written", options.out.string(), "out", options.out.string());
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_add(OptionSet root) {
  auto options = std::make_shared<AddOptions>();
  const OptionSet parser = root.add_command("add", "Put bodies of several models into one document");
  parser.set_footer(
      "Tool, gravity, ground, fixing planes and trial are those of the first model, and --pose does not "
      "move\n"
      "them. Bodies keep their materials and lattices. A body whose name is taken gets a number. A closed\n"
      "mesh becomes a fixed body, or a rigid one with --rigid or --held; rigid tools pass through it.\n"
      "Example: spoonbill add assets/models/jelly.json assets/models/spoon-bowl.json \\\n"
      "  --pose 134mm,16mm,0,1,0,0,0 --fixed bowl --out served.json");
  parser
      .add_option(
          "MODEL", options->models,
          "Documents (.json), and closed meshes (.obj, .stl or .ply) of at most 20,000 triangles, 1 to 64")
      .require();
  parser
      .add_parsed_list(
          "--pose",
          [options](const std::vector<std::string>& texts) -> Status {
            for (const std::string& text : texts) {
              auto pose = parse_pose(text);
              if (!pose) return pose.error();
              options->poses.push_back(pose.value());
            }
            return {};
          },
          "Move of a model: x, y, z with units, then the orientation as a quaternion w,x,y,z. The first "
          "--pose "
          "moves the first model, and so on; default: none")
      .show_as("POSE");
  add_names_option(parser, "--fixed", options->fixed,
                   "Name of a body that becomes rigid and fixed; may be repeated. Default: none");
  add_names_option(parser, "--rigid", options->rigid,
                   "Name of a body that becomes rigid and free; may be repeated. Default: none");
  add_names_option(parser, "--held", options->held,
                   "Name of a body that becomes rigid and held by a hand; may be repeated. Default: none");
  parser.add_option("--material", options->material,
                    "Bundled material of bodies from meshes, or a part of its name; default: abs");
  add_parsed_option(
      parser, "--unit", "UNIT", [](const std::string& text) { return parse_unit(text); },
      [options](const LengthUnit& unit) { options->unit = unit; },
      "Unit of the numbers in meshes: mm, cm, m or in; default: m for .ply, mm for others");
  add_force_option(parser, options->how);
  add_document_output(parser, options->out).require();
  add_json_option(parser, options->json);
  parser.set_final_check([options]() -> Status {
    const bool has_mesh =
        std::any_of(options->models.begin(), options->models.end(),
                    [](const std::filesystem::path& model) { return is_mesh(format_from_name(model)); });
    if (!has_mesh && (options->unit || !options->material.empty())) {
      const char* const option = options->unit ? "--unit" : "--material";
      return Error{
          ErrorCode::inconsistent,
          std::string(option) + ": no model is a mesh; documents have units and materials of their own",
          option};
    }
    if (options->poses.size() <= options->models.size()) return {};
    return Error{ErrorCode::too_many, "--pose: there are more poses than models", "--pose"};
  });
  return {parser, [options](Console& console) { return add_models(*options, console); }};
}

}  // namespace spoonbill
