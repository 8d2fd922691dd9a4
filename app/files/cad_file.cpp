#include "app/files/cad_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/files/foreign_child.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/cad_stream.h"
#include "engine/exchange/field_reader.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {
namespace {

constexpr std::size_t cad_file_bytes_limit = std::size_t{512} << 20;
// Remedies for error messages about files that exceed the limits of the child process.
const char* const simpler_export = "export fewer or simpler faces";
const char* const fewer_bodies = "write fewer or simpler bodies (--bodies)";
constexpr std::size_t note_bytes_limit = 400;
constexpr Range<int> note_count_range{0, 2000}, count_range{0, 1000000};

std::string program_of(const CadChild& child) {
  if (!child.program.empty()) return child.program.string();
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (self.parent_path() / "spoonbill-cad").string();
}

ForeignTask cad_task(const std::filesystem::path& file, ForeignTask::Work work) {
  const bool reads = work == ForeignTask::Work::reading;
  ForeignTask task;
  task.file = file;
  task.thing = reads ? "model" : "file";
  task.remedy = reads ? simpler_export : fewer_bodies;
  task.work = work;
  task.too_much = "needs more than ";
  task.invalid_answer = "the CAD converter spoonbill-cad gave an invalid answer; rebuild it";
  task.refusal = [](const std::string& reason) {
    return clean_cad_name(reason, "the CAD converter spoonbill-cad rejects it", note_bytes_limit);
  };
  return task;
}

// Reads all frames and returns the content of the last one. Passes the frames before it to handle(); an error
// of handle() ends the reading.
template <class Handle>
Result<std::string> read_frames(ForeignChild& child, const Handle& handle) {
  for (;;) {
    const auto head = child.next();
    if (!head) return head.error();
    auto content = child.content(head.value());
    if (!content || head->kind == FrameKind::ending) return content;
    Frame frame{head->kind, std::move(content).value()};
    if (Status handled = handle(frame); !handled) return handled.error();
  }
}

// Parses the last frame. A hostile file may have taken over the child, so its answer is untrusted input.
template <class Read>
Status read_ending(const std::string& text, const std::filesystem::path& file, const ForeignChild& child,
                   const Read& read) {
  const auto json = parse_json(text, file.string());
  if (!json) return child.invalid_answer();
  FieldReader reader(json.value(), file.string());
  read(reader);
  reader.finish();
  return reader.status() ? Status() : child.invalid_answer();
}

std::vector<std::string> read_notes(FieldReader& reader) {
  std::vector<std::string> notes;
  for (const Json& note : reader.list("notes", note_count_range)) {
    if (note.is_string()) notes.push_back(clean_cad_name(note.get<std::string>(), "...", note_bytes_limit));
  }
  return notes;
}

// An anonymous file in memory that holds a model for a child to read. Check complete() before use.
class ModelInMemory {
 public:
  explicit ModelInMemory(const CadModel& model) : descriptor_(memfd_create("cad-model", MFD_CLOEXEC)) {
    if (descriptor_ < 0) return;
    complete_ = true;
    for (const CadSurface& surface : model.surfaces) {
      std::ostringstream text;
      write_frame(text, FrameKind::surface, json_to_line(cad_surface_to_json(surface)));
      append(text.str());
    }
    std::ostringstream text;
    write_frame(text, FrameKind::ending, "{}");
    append(text.str());
    complete_ = complete_ && lseek(descriptor_, 0, SEEK_SET) == 0;
  }
  ModelInMemory(const ModelInMemory&) = delete;
  ModelInMemory& operator=(const ModelInMemory&) = delete;
  ~ModelInMemory() {
    if (descriptor_ >= 0) close(descriptor_);
  }

  bool complete() const { return complete_; }
  int descriptor() const { return descriptor_; }  // -1 if the file could not be created

 private:
  void append(const std::string& text) {
    std::size_t written = 0;
    while (complete_ && written < text.size()) {
      const ssize_t count = write(descriptor_, text.data() + written, text.size() - written);
      complete_ = count > 0;
      written += static_cast<std::size_t>(std::max<ssize_t>(count, 0));
    }
  }

  int descriptor_;
  bool complete_ = false;
};

std::string cad_format_name(FileFormat format) {
  return std::string(usual_ending(format));
}

}  // namespace

Result<CadModel> read_cad_file(const std::filesystem::path& file, const CadReading& reading,
                               const CadChild& run) {
  if (Status status = check_file(file, cad_file_bytes_limit, simpler_export); !status) return status.error();
  auto child = ForeignChild::start(
      cad_task(file, ForeignTask::Work::reading),
      {program_of(run), "read", cad_format_name(reading.format), std::filesystem::absolute(file).string(),
       number_text(reading.unit_m), number_text(reading.tolerance_m), number_text(reading.sew_m),
       std::to_string(reading.face_limit)},
      run.patience);
  if (!child) return child.error();
  child->watch(run.progress);
  CadModel model;
  const auto ending = read_frames(child.value(), [&](const Frame& frame) -> Status {
    if (frame.kind != FrameKind::surface || model.surfaces.size() >= reading.face_limit) {
      return child->invalid_answer();
    }
    auto surface = cad_surface_from_json(frame.content, file.string());
    if (!surface) return surface.error();
    model.surfaces.push_back(std::move(surface).value());
    return {};
  });
  if (!ending) return ending.error();
  const Status read = read_ending(ending.value(), file, child.value(), [&](FieldReader& reader) {
    model.unit = clean_cad_name(reader.text("unit"), "mm");
    model.unit_declared = reader.boolean("unit_declared");
    model.notes = read_notes(reader);
  });
  if (!read) return read.error();
  for (const CadSurface& surface : model.surfaces) {
    if (surface.trim_problem.empty()) continue;
    model.notes.push_back("'" + surface.name + "' is read without its trims: " + surface.trim_problem);
  }
  if (model.surfaces.empty()) return Error{ErrorCode::too_few, file.string() + ": contains no surface"};
  return model;
}

Result<CadFileContent> make_cad_file(const CadModel& model, const CadWriting& writing,
                                     const std::filesystem::path& file, const CadChild& run) {
  const ModelInMemory input(model);
  if (!input.complete())
    return Error{ErrorCode::too_many, file.string() + ": there is not enough memory to write it"};
  auto child = ForeignChild::start(cad_task(file, ForeignTask::Work::writing),
                                   {program_of(run), "write", cad_format_name(writing.format),
                                    writing.schema == StepSchema::ap242 ? "ap242" : "ap214", writing.unit},
                                   run.patience, input.descriptor());
  if (!child) return child.error();
  child->watch(run.progress);
  CadFileContent content;
  const auto ending = read_frames(child.value(), [&](Frame& frame) -> Status {
    if (frame.kind != FrameKind::file) {
      return child->invalid_answer();
    }
    content.text = std::move(frame.content);
    return {};
  });
  if (!ending) return ending.error();
  const Status read = read_ending(ending.value(), file, child.value(), [&](FieldReader& reader) {
    content.solids = reader.integer("solids", count_range);
    content.open_shells = reader.integer("open_shells", count_range);
    content.notes = read_notes(reader);
  });
  if (!read) return read.error();
  if (content.text.empty())
    return Error{ErrorCode::process_failed, file.string() + ": the writer returned no content"};
  return content;
}

Result<CadSolids> make_cad_solids(const CadModel& model, const SolidMeshing& meshing,
                                  const std::filesystem::path& file, const CadChild& run) {
  const ModelInMemory input(model);
  if (!input.complete())
    return Error{ErrorCode::too_many, file.string() + ": there is not enough memory to mesh it"};
  auto child = ForeignChild::start(
      cad_task(file, ForeignTask::Work::writing),
      {program_of(run), "solids", number_text(meshing.chord_m), std::to_string(meshing.triangle_limit)},
      run.patience, input.descriptor());
  if (!child) return child.error();
  child->watch(run.progress);
  CadSolids found;
  const auto ending = read_frames(child.value(), [&](const Frame& frame) -> Status {
    if (frame.kind != FrameKind::solid || found.solids.size() >= model.surfaces.size()) {
      return child->invalid_answer();
    }
    auto solid = cad_solid_from_bytes(frame.content, model.surfaces.size(), file.string());
    if (!solid) return solid.error();
    found.solids.push_back(std::move(solid).value());
    return {};
  });
  if (!ending) return ending.error();
  const Status read = read_ending(ending.value(), file, child.value(), [&](FieldReader& reader) {
    found.loose = read_surface_indices(reader, "loose", model.surfaces.size());
    found.notes = read_notes(reader);
  });
  if (!read) return read.error();
  return found;
}

}  // namespace spoonbill
