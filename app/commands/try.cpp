#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/files/documents.h"
#include "app/frames/frame_painter.h"
#include "app/frames/session_frames.h"
#include "app/report/document_facts.h"
#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "app/session/lockstep.h"
#include "app/session/run_log.h"
#include "app/session/session.h"
#include "engine/base/text.h"
#include "engine/trial/body_measures.h"
#include "engine/trial/trial.h"
#include "engine/trial/trial_report.h"
#include "haptic/recording_lines.h"
#include "haptic/virtual_device.h"
#include "render/gl/context.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {
namespace {

struct TryOptions {
  OutputOptions how;
  std::filesystem::path model, out, log;
  FrameOptions frames;
  std::optional<double> seconds, tilt_deg;
  int step_division = 0;  // 0: that of the document
  InstructionSet instruction_set = best_instruction_set();
  bool progress = false;
  bool json = false;
};

std::string outside_text(const Spill& spill) {
  return decimals_text(100.0 * spill.outside_fraction, 1) + " % outside the rim";
}

TrialRows make_trial_rows(const Trial& trial, const Simulation& simulation) {
  TrialRows rows;
  rows.phase = trial_phase_names[static_cast<std::size_t>(trial.phase())];
  if (const std::optional<double> turned_deg = trial.turned_deg(simulation)) {
    rows.tilt =
        decimals_text(*turned_deg, 1) + "° of " + decimals_text(simulation.scene().trial->angle_deg, 1) + "°";
  }
  rows.is_settled = trial.is_settled();
  rows.largest_speed_m_per_s = trial.largest_speed_m_per_s();
  rows.largest_overlap_m = trial.largest_penetration_m();
  const std::vector<Body>& bodies = simulation.scene().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].kind != BodyKind::deformable) {
      const RigidDynamics* const rigid = simulation.rigid_dynamics(static_cast<int>(b));
      const std::string kind = kind_text(bodies[b]);
      rows.bodies.push_back({bodies[b].name, rigid ? kind + ", " + grams_text(rigid->mass().mass_kg) : kind});
      continue;
    }
    const SpringLattice& lattice = simulation.lattice(static_cast<int>(b));
    rows.inverted_cells += measure_cells(lattice).inverted_cells;
    rows.bodies.push_back({bodies[b].name, lattice.material().name + ", " + grams_text(lattice.mass_kg())});
    if (const Spill* const spill = trial.spill(b)) rows.bodies.push_back({"", outside_text(*spill)});
  }
  return rows;
}

std::unique_ptr<SessionFrames> make_frames(const TryOptions& options, const Session& session) {
  Snapshot start;
  write_snapshot(session, start);
  const Scene& scene = session.simulation.scene();
  Framing framing = find_framing(scene, start);
  framing.box = find_box_of_motions(scene, framing.box);
  framing.lowest_y_m = ground_below(find_box_of_motions(scene, drawn_bounds(start)));
  return std::make_unique<SessionFrames>(options.out, options.frames.picture_size(), options.frames.every,
                                         framing, session);
}

// A trial that has ended, because it is over or because the simulation could not hold a body.
struct EndedTrial {
  Trial trial;
  Status held;
  double elapsed_s = 0.0;  // wall time of all ticks
};

Result<EndedTrial> run_trial(const TryOptions& options, Session& session, SessionFrames* pictures,
                             RunLog* log, Console& console) {
  TrialSettings settings;
  settings.seconds = options.seconds.value_or(settings.seconds);
  EndedTrial ended{Trial(session.simulation.scene(), settings), {}};
  Trial& trial = ended.trial;
  InterruptWatch interrupt;
  ProgressBar progress(console, "Trying", options.progress);
  const auto expected_ms = static_cast<std::uint64_t>(1e3 * (settings.seconds + settings.longest_settling_s));
  const auto fill_panel = [&](PanelModel& panel) {
    panel.trial = make_trial_rows(trial, session.simulation);
  };
  while (trial.phase() != TrialPhase::done) {
    if (interrupt.requested()) {
      interrupt.answer();
      return Error{ErrorCode::cancelled,
                   "stopped after " + std::to_string(session.simulation.tick()) + " ticks"};
    }
    if (pictures) {
      if (Status drawn = pictures->draw(session, fill_panel); !drawn) return drawn.error();
    }
    while (const std::optional<Command> command = trial.next_command()) {
      if (Status applied = session.simulation.apply(*command); !applied) return applied.error();
    }
    const auto start = std::chrono::steady_clock::now();
    const Reaction reaction = session.simulation.advance(trial_input());
    ended.elapsed_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto phase = static_cast<std::size_t>(trial.phase());
    ended.held = trial.follow(session.simulation, reaction.flags);
    if (log) {
      if (Status added = log->add(session, trial_phase_names[phase]); !added) return added.error();
    }
    if (!ended.held) break;
    const std::uint64_t tick = session.simulation.tick();
    if (tick % 10 == 0) progress.show(std::min(tick, expected_ms), expected_ms);
  }
  if (pictures) {
    if (Status drawn = pictures->draw_end(session, fill_panel); !drawn) return drawn.error();
    if (Status finished = pictures->finish(); !finished) return finished.error();
  }
  if (log) {
    if (Status committed = log->commit(); !committed) return committed.error();
  }
  return ended;
}

void add_spill(FactSheet& facts, const Spill& spill, Json& json) {
  const auto when_text = [](const std::optional<double>& time_s, const char* what, const char* has_not) {
    return time_s ? std::string(what) + " after " + decimals_text(*time_s, 2) + " s" : std::string(has_not);
  };
  facts.add("  Rim",
            outside_text(spill) + ", " + decimals_text(100.0 * spill.spilled_fraction, 1) +
                " % also below it; " + when_text(spill.first_spill_s, "spilled", "has not spilled") + ", " +
                when_text(spill.left_s, "left", "has not left"),
            "", nullptr);
  const auto time_json = [](const std::optional<double>& time_s) { return time_s ? Json(*time_s) : Json(); };
  json["outside_fraction"] = spill.outside_fraction;
  json["spilled_fraction"] = spill.spilled_fraction;
  json["first_spill_s"] = time_json(spill.first_spill_s);
  json["left_s"] = time_json(spill.left_s);
}

void add_trial_body(FactSheet& facts, const TrialBodyReport& body, const Body& source, Json& list) {
  const bool deforms = source.kind == BodyKind::deformable;
  facts.add("Body", body.name + (deforms ? "" : ", " + kind_text(source)), "", nullptr);
  facts.add("  Centre of mass", position_text(body.centre_of_mass_m), "", nullptr);
  if (body.is_gone) facts.add("  Gone", "more than 1 m away, where it stays", "", nullptr);
  if (deforms) {
    facts.add("  Volume", percent_text(body.volume_ratio) + " of that at rest", "", nullptr);
    facts.add(
        "  Cells",
        "smallest Jacobian " + decimals_text(body.smallest_jacobian, 2) + ", " +
            count_text(static_cast<std::size_t>(body.inverted_cells), "inverted cell", "inverted cells"),
        "", nullptr);
  }
  if (body.contact_radius_m > 0.0) {
    facts.add("  Contact",
              "as large as a circle with a radius of " + short_length_text(body.contact_radius_m) +
                  "; the cells resolve " + short_length_text(body.smallest_contact_radius_m),
              "", nullptr);
  }
  facts.add("  Forces",
            newtons_text(body.support_force_n.norm()) + " of supports, " +
                newtons_text(body.ground_force_n.norm()) + " of the ground, " +
                newtons_text(body.contact_force_n.norm()) + " of other bodies",
            "", nullptr);
  list.push_back({{"name", body.name},
                  {"kind", body_kind_names[static_cast<std::size_t>(source.kind)]},
                  {"centre_of_mass_m", components_json(body.centre_of_mass_m)},
                  {"volume_ratio", body.volume_ratio},
                  {"smallest_jacobian", body.smallest_jacobian},
                  {"inverted_cells", body.inverted_cells},
                  {"gone", body.is_gone},
                  {"contact_radius_m", body.contact_radius_m},
                  {"smallest_contact_radius_m", body.smallest_contact_radius_m},
                  {"support_force_n", components_json(body.support_force_n)},
                  {"ground_force_n", components_json(body.ground_force_n)},
                  {"contact_force_n", components_json(body.contact_force_n)}});
  if (body.spill) add_spill(facts, *body.spill, list.back());
}

void warn_of_small_contacts(const TrialReport& report, Console& console) {
  for (const TrialBodyReport& body : report.bodies) {
    if (!has_small_contact(body)) continue;
    console.err << "body " << body.name << ": its contact has a radius of "
                << short_length_text(body.contact_radius_m) << ", but its cells resolve contacts from "
                << short_length_text(body.smallest_contact_radius_m)
                << "; its force and depth are not reliable; give the body more nodes\n";
  }
}

void add_trial_facts(FactSheet& facts, const EndedTrial& ended, const Session& session, Console& console) {
  const Trial& trial = ended.trial;
  const Simulation& simulation = session.simulation;
  const TrialReport report = report_on(trial, simulation);
  warn_of_small_contacts(report, console);
  const std::uint64_t ticks = simulation.tick();
  facts.add("Ticks", std::to_string(ticks) + " of 1 ms", "ticks", ticks);
  facts.add("Substeps", std::to_string(simulation.substeps()) + " a tick", "substeps", simulation.substeps());
  const double factor = ended.elapsed_s > 0.0 ? trial.time_s() / ended.elapsed_s : 0.0;
  facts.add("Speed", decimals_text(factor, 2) + " times real time", "real_time_factor", factor);
  const std::string unsettled = "no, a node moved faster than " +
                                decimals_text(1e3 * settled_speed_m_per_s, 1) + " mm/s in the last " +
                                decimals_text(settled_time_s, 1) + " s";
  facts.add("Settled", trial.is_settled() ? "yes" : unsettled, "settled", trial.is_settled());
  facts.add("Largest speed", decimals_text(1e3 * trial.largest_speed_m_per_s(), 3) + " mm/s",
            "largest_speed_m_per_s", trial.largest_speed_m_per_s());
  facts.add("Largest overlap", short_length_text(trial.largest_penetration_m()), "largest_penetration_m",
            trial.largest_penetration_m());
  facts.add("Inverted cells", std::to_string(report.inverted_cells), "inverted_cells", report.inverted_cells);
  facts.add("", "", "inertia_scale", report.inertia_scale);
  facts.add("", "", "energy_j", report.energy_j ? Json(*report.energy_j) : Json());
  facts.add("", "", "stopped", ended.held ? Json() : Json(ended.held.error().message));
  Json list = Json::array();
  for (std::size_t b = 0; b < report.bodies.size(); ++b) {
    add_trial_body(facts, report.bodies[b], simulation.scene().bodies[b], list);
  }
  facts.add("", "", "bodies", list);
}

Status try_document(const TryOptions& options, Console& console) {
  if (Status checked = check_output(options.log, options.how); !checked) return checked;
  if (Status checked = check_is_not_source(options.log, options.model, "--log"); !checked) return checked;
  auto document = read_document_file(options.model);
  if (!document) return document.error();
  const std::string source = options.model.string();
  if (options.step_division > 0) document->scene.sculpting.step_division = options.step_division;
  auto scene = make_trial_scene(document->scene, options.tilt_deg);
  if (!scene) return scene.error().in(source);
  document->scene = std::move(scene).value();
  auto session = [&] {
    MapProgress maps(console, options.progress);
    return Session::make(document.value(), source, VirtualDevice::default_specification(),
                         options.instruction_set, maps.watch());
  }();
  if (!session) return session.error();
  if (Status ready = check_trial_start(session->simulation); !ready) return ready.error().in(source);
  session->keeps_documents = false;
  session->reading.position_nm[1] = 10'000'000'000;
  session->reading.buttons = button_hover;
  std::unique_ptr<SessionFrames> pictures;
  if (!options.out.empty()) {
    if (Status prepared = prepare_frame_folder(options.out, options.how.replaces_read_only); !prepared)
      return prepared;
    pictures = make_frames(options, session.value());
  }
  std::optional<RunLog> log;
  if (!options.log.empty()) {
    auto created = RunLog::create(options.log, options.how, session.value(), LoggedTool::none);
    if (!created) return created.error();
    log.emplace(std::move(created).value());
  }
  auto ended = run_trial(options, session.value(), pictures.get(), log ? &*log : nullptr, console);
  if (!ended) return ended.error().in(source);
  FactSheet facts;
  facts.add("File", source, "file", source);
  add_trial_facts(facts, ended.value(), session.value(), console);
  if (pictures) {
    facts.add("Frames", std::to_string(pictures->count()), "frames", pictures->count());
    facts.add("Folder", options.out.string(), "out", options.out.string());
  }
  if (log) facts.add("Log", options.log.string(), "log", options.log.string());
  const std::string hash = hash_text(state_hash(session.value()));
  facts.add("State hash", hash, "state_hash", hash);
  facts.print(console.out, options.json);
  return ended->held ? Status() : Status(ended->held.error().in(source));
}

}  // namespace

CommandEntry add_try(OptionSet root) {
  auto options = std::make_shared<TryOptions>();
  const OptionSet parser = root.add_command("try", "Try bodies with their true inertia under gravity");
  parser.set_footer(
      "Gives all bodies their true inertia and lets gravity act; without gravity in the document, standard\n"
      "gravity along -y. The document's \"trial\" may name a body that is lowered until others bear it, and\n"
      "a fixed or held body that then turns. Then fixed and held bodies that state a \"motion\"\n"
      "move through its waypoints. The bodies settle before the turn, for 10 s at most. Bodies have settled\n"
      "when no node has moved faster than 0.1 mm/s for 0.2 s. A trial that cannot hold a body, or in which\n"
      "nothing bears the lowered body within 30 s, ends with an error.\n"
      "If the body that bears the others has a known rim (rim_uv), like one from `spoonbill new bowl`, the\n"
      "report says how much of each is outside it, when it spilled (more than 1 % of its mass is outside\n"
      "the rim and below its plane) and when it left (its centre of mass is outside).\n"
      "Example: spoonbill try assets/models/jelly-on-spoon.json --tilt 10deg --out output/tilt");
  parser.add_option("DOCUMENT", options->model, "Document (.json)").require();
  parser
      .add_option("--seconds", options->seconds,
                  "Time after the last turn or motion, or after the settling; default: 3, range: 0 to 600")
      .limit(trial_seconds_range);
  add_parsed_option(
      parser, "--tilt", "ANGLE",
      [](const std::string& text) { return parse_angle_deg(text, turn_angle_range_deg); },
      [options](double angle_deg) { options->tilt_deg = angle_deg; },
      "Angle of the turn, such as 10deg; default: the document's, range: -360deg to 360deg");
  parser
      .add_option("--step-division", options->step_division,
                  "Number that divides each substep, to see whether the result depends on them; default: the "
                  "document's, range: 1 to 8")
      .limit(step_division_range);
  parser
      .add_option("--out", options->out,
                  "Folder for frame-####.png, the last of which shows the end; default: none")
      .show_as("DIR");
  add_frame_options(parser, options->frames);
  add_log_option(parser, options->log);
  add_force_option(parser, options->how);
  add_instruction_set_option(parser, options->instruction_set);
  parser.add_flag("--progress", options->progress, "Show progress even if the output is not a terminal");
  add_json_option(parser, options->json);
  return {parser, [options](Console& console) { return try_document(*options, console); }};
}

}  // namespace spoonbill
