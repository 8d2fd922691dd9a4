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

constexpr std::size_t file_bytes_limit = std::size_t{512} << 20;
// What to do about a file that is too much for the child.
const char* const smaller = "export fewer or simpler faces";
const char* const fewer = "write fewer or simpler bodies (--bodies)";
constexpr std::size_t longest_line = 400;  // of a note, in bytes
constexpr Range<int> note_count_range{0, 2000}, count_range{0, 1000000};

std::string program_of(const CadChild& child) {
  if (!child.program.empty()) return child.program.string();
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (self.parent_path() / "spoonbill-cad").string();
}

ForeignTask task_for(const std::filesystem::path& file, ForeignTask::Work work) {
  const bool reads = work == ForeignTask::Work::reading;
  ForeignTask task;
  task.file = file;
  task.thing = reads ? "model" : "file";
  task.remedy = reads ? smaller : fewer;
  task.work = work;
  task.too_much = "takes more than ";
  task.not_in_form = "the program that handles CAD files did not answer in its own form; build it anew";
  task.refusal = [](const std::string& reason) {
    return clean_cad_name(reason, "the program that handles CAD files refuses it", longest_line);
  };
  return task;
}

// Frames of the child until the last, whose content is returned; take() gets the others and says whether they
// are welcome.
template <class Take>
Result<std::string> listen(ForeignChild& child, const Take& take) {
  for (;;) {
    const auto head = child.next();
    if (!head) return head.error();
    auto content = child.content(head.value());
    if (!content || head->kind == FrameKind::ending) return content;
    Frame frame{head->kind, std::move(content).value()};
    if (Status taken = take(frame); !taken) return taken.error();
  }
}

// What the child says last. Whatever a hostile file made of it, its answer is data.
template <class Read>
Status read_ending(const std::string& text, const std::filesystem::path& file, const ForeignChild& child,
                   const Read& read) {
  const auto json = parse_json(text, file.string());
  if (!json) return child.not_in_form();
  FieldReader reader(json.value(), file.string());
  read(reader);
  reader.finish();
  return reader.status() ? Status() : child.not_in_form();
}

std::vector<std::string> read_notes(FieldReader& reader) {
  std::vector<std::string> notes;
  for (const Json& note : reader.list("notes", note_count_range)) {
    if (note.is_string()) notes.push_back(clean_cad_name(note.get<std::string>(), "...", longest_line));
  }
  return notes;
}

// A file without a name that holds the model for a child to read; -1 where there is none to be had.
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
  int descriptor() const { return descriptor_; }

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

std::string name_of(FileFormat format) {
  return std::string(usual_ending(format));
}

}  // namespace

Result<CadModel> read_cad_file(const std::filesystem::path& file, const CadReading& reading,
                               const CadChild& run) {
  if (Status status = check_file(file, file_bytes_limit, smaller); !status) return status.error();
  auto child = ForeignChild::start(
      task_for(file, ForeignTask::Work::reading),
      {program_of(run), "read", name_of(reading.format), std::filesystem::absolute(file).string(),
       number_text(reading.unit_m), number_text(reading.tolerance_m), std::to_string(reading.face_limit)},
      run.patience);
  if (!child) return child.error();
  child->watch(run.progress);
  CadModel model;
  const auto ending = listen(child.value(), [&](const Frame& frame) -> Status {
    if (frame.kind != FrameKind::surface || model.surfaces.size() >= reading.face_limit) {
      return child->not_in_form();
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
    model.notes.push_back("'" + surface.name + "' is whole, without its trims: " + surface.trim_problem);
  }
  if (model.surfaces.empty()) return Error{file.string() + ": holds no surface"};
  return model;
}

Result<CadFileContent> make_cad_file(const CadModel& model, const CadWriting& writing,
                                     const std::filesystem::path& file, const CadChild& run) {
  const ModelInMemory input(model);
  if (!input.complete()) return Error{file.string() + ": there is no memory left to write it through"};
  auto child = ForeignChild::start(task_for(file, ForeignTask::Work::writing),
                                   {program_of(run), "write", name_of(writing.format),
                                    writing.schema == StepSchema::ap242 ? "ap242" : "ap214", writing.unit},
                                   run.patience, input.descriptor());
  if (!child) return child.error();
  child->watch(run.progress);
  CadFileContent content;
  const auto ending = listen(child.value(), [&](Frame& frame) -> Status {
    if (frame.kind != FrameKind::file) {
      return child->not_in_form();
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
  if (content.text.empty()) return Error{file.string() + ": the writer made nothing of it"};
  return content;
}

Result<CadSolids> make_cad_solids(const CadModel& model, const SolidMeshing& meshing,
                                  const std::filesystem::path& file, const CadChild& run) {
  const ModelInMemory input(model);
  if (!input.complete()) return Error{file.string() + ": there is no memory left to mesh it through"};
  auto child = ForeignChild::start(
      task_for(file, ForeignTask::Work::writing),
      {program_of(run), "solids", number_text(meshing.chord_m), std::to_string(meshing.triangle_limit)},
      run.patience, input.descriptor());
  if (!child) return child.error();
  child->watch(run.progress);
  CadSolids found;
  const auto ending = listen(child.value(), [&](const Frame& frame) -> Status {
    if (frame.kind != FrameKind::solid || found.solids.size() >= model.surfaces.size()) {
      return child->not_in_form();
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
