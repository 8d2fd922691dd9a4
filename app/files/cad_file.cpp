#include "app/files/cad_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/files/foreign_file.h"
#include "app/process/child_output.h"
#include "engine/base/number_text.h"
#include "engine/exchange/cad_names.h"
#include "engine/exchange/cad_solid_stream.h"
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

// Frames of a child until the last; what is neither progress nor the last goes to take(), which says whether
// it is welcome.
class Conversation {
 public:
  enum class Work { reading, writing };

  Conversation(ChildOutput output, const std::filesystem::path& file, const CadChild& child, Work work)
      : output_(std::move(output)), file_(file), child_(child), work_(work) {
    if (child.stop) output_.give_up_when(child.stop);
  }

  // The content of the last frame.
  template <class Take>
  Result<std::string> listen(const Take& take) {
    for (;;) {
      auto frame = read_frame([&](void* to, std::size_t bytes) { return output_.read(to, bytes); });
      if (!frame) return end_without_answer();
      if (frame->kind == CadFrameKind::ending) return std::move(frame->content);
      if (frame->kind == CadFrameKind::failure) return refusal(frame->content);
      if (frame->kind == CadFrameKind::progress) {
        show(frame->content);
        continue;
      }
      if (Status taken = take(*frame); !taken) return taken.error();
    }
  }

 private:
  void show(const std::string& thousandths) const {
    int number = 0;
    std::from_chars(thousandths.data(), thousandths.data() + thousandths.size(), number);
    if (child_.progress) child_.progress(std::clamp(number, 0, 1000) / 1000.0);
  }

  Error end_without_answer() {
    if (child_.stop && child_.stop()) return Error{file_.string() + ": stopped"};
    const ChildEnd end = output_.wait();
    if (work_ == Work::reading) return explain_end(file_, end, child_.patience, "model", smaller);
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(child_.patience).count();
    const std::string name = file_.string(), remedy = std::string("; ") + fewer;
    if (end.out_of_time) {
      return Error{name + ": writing it took longer than " + std::to_string(seconds) + " s" + remedy};
    }
    if (end.signal != 0) {
      return Error{name + ": the writer crashed (signal " + std::to_string(end.signal) + ")" + remedy};
    }
    return Error{name + ": the writer ended without a file (exit code " + std::to_string(end.exit_code) +
                 ")" + remedy};
  }

  Error refusal(const std::string& reason) const {
    if (reason.find("bad alloc") != std::string::npos) {
      return Error{file_.string() + ": takes more than " + std::to_string(ChildOutput::memory_limit >> 30) +
                   " GiB; " + (work_ == Work::reading ? smaller : fewer)};
    }
    return Error{file_.string() + ": " +
                 clean_cad_name(reason, "the program that handles CAD files refuses it", longest_line)};
  }

  ChildOutput output_;
  const std::filesystem::path& file_;
  const CadChild& child_;
  Work work_;
};

Error not_in_form(const std::filesystem::path& file) {
  return Error{file.string() +
               ": the program that handles CAD files did not answer in its own form; build it anew"};
}

// What the child says last. Whatever a hostile file made of it, its answer is data.
template <class Read>
Status read_ending(const std::string& text, const std::filesystem::path& file, const Read& read) {
  const auto json = parse_json(text, file.string());
  if (!json) return not_in_form(file);
  FieldReader reader(json.value(), file.string());
  read(reader);
  reader.finish();
  return reader.status() ? Status() : not_in_form(file);
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
      write_frame(text, CadFrameKind::surface, json_to_line(cad_surface_to_json(surface)));
      append(text.str());
    }
    std::ostringstream text;
    write_frame(text, CadFrameKind::ending, "{}");
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

const char* name_of(CadFormat format) {
  return format == CadFormat::step ? "step" : "iges";
}

}  // namespace

bool is_cad_file(const std::filesystem::path& file) {
  const std::string format = format_of(file);
  return format == "step" || format == "stp" || format == "iges" || format == "igs";
}

CadFormat cad_format_of(const std::filesystem::path& file) {
  return format_of(file).starts_with("i") ? CadFormat::iges : CadFormat::step;
}

Result<CadModel> read_cad_file(const std::filesystem::path& file, const CadReading& reading,
                               const CadChild& child) {
  if (Status status = check_foreign_file(file, file_bytes_limit, smaller); !status) return status.error();
  auto output = ChildOutput::start(
      {program_of(child), "read", name_of(reading.format), std::filesystem::absolute(file).string(),
       number_text(reading.unit_m), number_text(reading.tolerance_m), std::to_string(reading.face_limit)},
      child.patience);
  if (!output) return Error{file.string() + ": " + output.error().message};
  Conversation conversation(std::move(output).value(), file, child, Conversation::Work::reading);
  CadModel model;
  const auto ending = conversation.listen([&](const CadFrame& frame) -> Status {
    if (frame.kind != CadFrameKind::surface || model.surfaces.size() >= reading.face_limit) {
      return not_in_form(file);
    }
    auto surface = cad_surface_from_json(frame.content, file.string());
    if (!surface) return surface.error();
    model.surfaces.push_back(std::move(surface).value());
    return {};
  });
  if (!ending) return ending.error();
  const Status read = read_ending(ending.value(), file, [&](FieldReader& reader) {
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
                                     const std::filesystem::path& file, const CadChild& child) {
  const ModelInMemory input(model);
  if (!input.complete()) return Error{file.string() + ": there is no memory left to write it through"};
  auto output = ChildOutput::start({program_of(child), "write", name_of(writing.format),
                                    writing.schema == StepSchema::ap242 ? "ap242" : "ap214", writing.unit},
                                   child.patience, input.descriptor());
  if (!output) return Error{file.string() + ": " + output.error().message};
  Conversation conversation(std::move(output).value(), file, child, Conversation::Work::writing);
  CadFileContent content;
  const auto ending = conversation.listen([&](CadFrame& frame) -> Status {
    if (frame.kind != CadFrameKind::file) {
      return not_in_form(file);
    }
    content.text = std::move(frame.content);
    return {};
  });
  if (!ending) return ending.error();
  const Status read = read_ending(ending.value(), file, [&](FieldReader& reader) {
    content.solids = reader.integer("solids", count_range);
    content.open_shells = reader.integer("open_shells", count_range);
    content.notes = read_notes(reader);
  });
  if (!read) return read.error();
  if (content.text.empty()) return Error{file.string() + ": the writer made nothing of it"};
  return content;
}

Result<CadSolids> make_cad_solids(const CadModel& model, const SolidMeshing& meshing,
                                  const std::filesystem::path& file, const CadChild& child) {
  const ModelInMemory input(model);
  if (!input.complete()) return Error{file.string() + ": there is no memory left to mesh it through"};
  auto output = ChildOutput::start(
      {program_of(child), "solids", number_text(meshing.chord_m), std::to_string(meshing.triangle_limit)},
      child.patience, input.descriptor());
  if (!output) return Error{file.string() + ": " + output.error().message};
  Conversation conversation(std::move(output).value(), file, child, Conversation::Work::writing);
  CadSolids found;
  const auto ending = conversation.listen([&](const CadFrame& frame) -> Status {
    if (frame.kind != CadFrameKind::solid || found.solids.size() >= model.surfaces.size()) {
      return not_in_form(file);
    }
    auto solid = cad_solid_from_bytes(frame.content, model.surfaces.size(), file.string());
    if (!solid) return solid.error();
    found.solids.push_back(std::move(solid).value());
    return {};
  });
  if (!ending) return ending.error();
  const Status read = read_ending(ending.value(), file, [&](FieldReader& reader) {
    found.loose = read_places(reader, "loose", model.surfaces.size());
    found.notes = read_notes(reader);
  });
  if (!read) return read.error();
  return found;
}

}  // namespace spoonbill
