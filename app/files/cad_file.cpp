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
#include "engine/exchange/cad_stream.h"
#include "engine/exchange/mesh_import.h"
#include "engine/number_text.h"

namespace spoonbill {
namespace {

constexpr std::size_t file_bytes_limit = std::size_t{512} << 20;
const char* const smaller = "export fewer or simpler faces";

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
  Conversation(ChildOutput output, const std::filesystem::path& file, const CadChild& child)
      : output_(std::move(output)), file_(file), child_(child) {
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
    return explain_end(file_, output_.wait(), child_.patience, "model", smaller);
  }

  Error refusal(const std::string& reason) const {
    if (reason.find("bad alloc") != std::string::npos) {
      return Error{file_.string() + ": takes more than " + std::to_string(ChildOutput::memory_limit >> 30) +
                   " GiB; " + smaller};
    }
    return Error{file_.string() + ": " + clean_cad_name(reason, "cannot be read; export it anew")};
  }

  ChildOutput output_;
  const std::filesystem::path& file_;
  const CadChild& child_;
};

Result<Json> parsed_ending(const std::string& text, const std::filesystem::path& file) {
  auto json = parse_json(text, file.string());
  if (!json) return json.error();
  if (!json->is_object()) return Error{file.string() + ": the reader did not answer in its own form"};
  return json;
}

std::vector<std::string> notes_of(const Json& ending) {
  std::vector<std::string> notes;
  for (const Json& note : ending.value("notes", Json::array())) {
    if (note.is_string()) notes.push_back(clean_cad_name(note.get<std::string>(), ""));
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
  Conversation conversation(std::move(output).value(), file, child);
  CadModel model;
  const auto ending = conversation.listen([&](const CadFrame& frame) -> Status {
    if (frame.kind != CadFrameKind::surface || model.surfaces.size() >= reading.face_limit) {
      return Error{file.string() + ": the reader did not answer in its own form; build the program anew"};
    }
    auto surface = cad_surface_from_json(frame.content, file.string());
    if (!surface) return surface.error();
    model.surfaces.push_back(std::move(surface).value());
    return {};
  });
  if (!ending) return ending.error();
  const auto json = parsed_ending(ending.value(), file);
  if (!json) return json.error();
  model.unit = clean_cad_name(json->value("unit", ""), "mm");
  model.unit_declared = json->value("unit_declared", true);
  model.notes = notes_of(json.value());
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
  Conversation conversation(std::move(output).value(), file, child);
  CadFileContent content;
  const auto ending = conversation.listen([&](CadFrame& frame) -> Status {
    if (frame.kind != CadFrameKind::file) {
      return Error{file.string() + ": the writer did not answer in its own form; build the program anew"};
    }
    content.text = std::move(frame.content);
    return {};
  });
  if (!ending) return ending.error();
  const auto json = parsed_ending(ending.value(), file);
  if (!json) return json.error();
  content.solids = json->value("solids", 0);
  content.open_shells = json->value("open_shells", 0);
  content.notes = notes_of(json.value());
  if (content.text.empty()) return Error{file.string() + ": the writer made nothing of it"};
  return content;
}

}  // namespace spoonbill
