#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/files/cad_file.h"
#include "app/files/documents.h"
#include "app/report/document_facts.h"
#include "app/report/quantity_text.h"
#include "app/session/session.h"
#include "engine/base/text.h"
#include "engine/exchange/file_format.h"
#include "engine/material/lattice/body_lattice.h"
#include "haptic/recording.h"
#include "haptic/recording_lines.h"
#include "haptic/script.h"
#include "haptic/virtual_device.h"

namespace spoonbill {
namespace {

struct InfoOptions {
  std::filesystem::path file;
  bool json = false;
};

std::string duration_text(std::uint64_t ticks) {
  return number_text(static_cast<double>(ticks) / 1000.0) + " s";
}

void add_duration(FactSheet& facts, std::uint64_t ticks) {
  facts.add("Ticks", std::to_string(ticks) + " (" + duration_text(ticks) + ")", "ticks", ticks);
  facts.add("", "", "duration_s", static_cast<double>(ticks) / 1000.0);
}

bool has_lattices(const Scene& scene) {
  if (!check_body_count(scene)) return false;
  return std::all_of(scene.bodies.begin(), scene.bodies.end(),
                     [](const Body& body) { return make_body_lattice(body).ok(); });
}

// Makes the simulation of a document as a session does, but without reserving memory for undo.
Result<Simulation> make_simulation(const Document& document, const std::string& source,
                                   const FeatureMapWatch& watch) {
  const auto view = view_from_json(document.view, source);
  if (!view) return view.error();
  auto simulation = Simulation::make(document.scene, best_instruction_set(), watch);
  if (!simulation) return simulation.error().in(source);
  return simulation;
}

// Adds the facts of the document and of its simulation. A document without a lattice, or with more bodies
// than can be sculpted together, can still be viewed, merged and exported; its facts then state why there is
// no lattice. Any other failure is an error.
Status add_document_and_simulation(FactSheet& facts, const Document& document, const std::string& source,
                                   Console& console) {
  add_document_facts(facts, document);
  MapProgress maps(console);
  const auto simulation = make_simulation(document, source, maps.watch());
  if (!simulation) {
    if (has_lattices(document.scene)) return simulation.error();
    facts.add("Lattice", "none: " + simulation.error().message, "lattice", nullptr);
    facts.add("", "", "no_lattice_because", simulation.error().message);
    return {};
  }
  Snapshot snapshot;
  simulation->write_snapshot(snapshot);
  add_simulation_facts(facts, snapshot, document.scene.bodies);
  add_elasticity_facts(facts, simulation.value());
  add_notes(facts, simulation->warnings());
  add_cell_facts(facts, simulation.value(), maps.reports());
  facts.add("", "", "shape_hash", hash_text(shape_hash(simulation.value())));
  return {};
}

Status describe_document(FactSheet& facts, const std::filesystem::path& file, Console& console) {
  const auto document = read_document(file);
  if (!document) return document.error();
  facts.add("Kind", "document", "kind", "document");
  return add_document_and_simulation(facts, document.value(), file.string(), console);
}

Status describe_recording(FactSheet& facts, const std::filesystem::path& file, Console& console) {
  const auto recording = read_recording(file);
  if (!recording) return recording.error();
  if (Status checked = check_commands(recording->commands); !checked) return checked;
  const bool complete = recording->end.has_value();
  facts.add("Kind", "recording", "kind", "recording");
  facts.add("Complete", complete ? "yes" : "no: " + recording->notice, "complete", complete);
  add_duration(facts, recording->readings.size());
  facts.add("Commands", std::to_string(recording->commands.size()), "commands", recording->commands.size());
  if (complete) {
    const std::string hash = hash_text(recording->end->state_hash);
    facts.add("State hash", hash + " at the end", "state_hash", hash);
  }
  const DeviceSpecification& device = recording->header.device;
  facts.add("Device", device.name + ", at most " + number_text(device.maximum_force_n) + " N", "device",
            {{"name", device.name}, {"maximum_force_n", device.maximum_force_n}});
  return add_document_and_simulation(facts, recording->header.document, file.string(), console);
}

Status describe_script(FactSheet& facts, const std::filesystem::path& file) {
  const auto script = read_script(file);
  if (!script) return script.error();
  if (Status checked = check_commands(script->commands); !checked) return checked;
  facts.add("Kind", "script", "kind", "script");
  facts.add("Model", script->model_file.string(), "model", script->model_file.string());
  add_duration(facts, script->tick_count());
  facts.add("Commands", std::to_string(script->commands.size()), "commands", script->commands.size());
  return {};
}

Status describe_material(FactSheet& facts, const std::filesystem::path& file) {
  const auto material = read_material(file);
  if (!material) return material.error();
  facts.add("Kind", "material", "kind", "material");
  add_material_facts(facts, material.value());
  return {};
}

Status describe_cad(FactSheet& facts, const std::filesystem::path& file, Console& console) {
  InterruptWatch interrupt;
  ProgressBar bar(console, "Reading", false);
  CadReading reading;
  reading.format = format_from_name(file);
  CadChild child;
  child.progress = Progress([&](double fraction) {
    bar.show(fraction);
    return !interrupt.requested();
  });
  const auto model = read_cad_file(file, reading, child);
  if (interrupt.requested()) interrupt.answer();
  if (!model) return model.error();
  facts.add("Kind", reading.format == FileFormat::step ? "STEP file" : "IGES file", "kind",
            reading.format == FileFormat::step ? "step" : "iges");
  add_unit_facts(facts, model->unit, model->unit_declared);
  add_surface_facts(facts, model->surfaces);
  for (const std::string& note : model->notes) facts.add("Note", note, "", nullptr);
  facts.add("", "", "notes", model->notes);
  return {};
}

Status describe_file(FactSheet& facts, const std::filesystem::path& file, Console& console) {
  if (is_cad(format_from_name(file))) return describe_cad(facts, file, console);
  if (Status native = check_native_name(file); !native) return native;
  const auto format = find_native_format(file);
  if (!format) return format.error();
  switch (format.value()) {
    case FileFormat::document:
      return describe_document(facts, file, console);
    case FileFormat::recording:
      return describe_recording(facts, file, console);
    case FileFormat::script:
      return describe_script(facts, file);
    default:
      return describe_material(facts, file);
  }
}

Status info(const InfoOptions& options, Console& console) {
  FactSheet facts;
  facts.add("File", options.file.string(), "file", options.file.string());
  if (Status described = describe_file(facts, options.file, console); !described) return described;
  facts.print(console.out, options.json);
  return {};
}

}  // namespace

CommandEntry add_info(OptionSet root) {
  auto options = std::make_shared<InfoOptions>();
  const OptionSet parser =
      root.add_command("info", "Describe a model, recording, script, material or CAD file");
  parser.set_footer(
      "For a model: its size; the degrees, control points and knots of its surfaces; and the lattice of its\n"
      "simulation: nodes, quality of the cells, mass, how much slower than the real body it responds while\n"
      "sculpting, the substeps of a tick in real time, and the fraction of the material's elasticity that\n"
      "the lattice achieves along each axis.\n"
      "Example: spoonbill info assets/models/spoon-handle.json");
  parser
      .add_option("FILE", options->file, "Document, script or material (.json), recording, STEP or IGES file")
      .require();
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return info(*options, console); }};
}

}  // namespace spoonbill
