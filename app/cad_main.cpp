// spoonbill-cad: the child process of spoonbill that converts CAD files. Only this program loads OpenCASCADE.
// It answers with frames (engine/exchange/frame_stream.h) on its standard output:
//
//   spoonbill-cad read step|iges FILE UNIT_M TOLERANCE_M SEW_M FACE_LIMIT
//   spoonbill-cad write step|iges ap214|ap242 mm|cm|m|in
//   spoonbill-cad solids CHORD_M TRIANGLE_LIMIT
//
// A UNIT_M of 0 stands for the unit that FILE declares, a SEW_M of 0 for its tolerance. `write` and `solids`
// read the frames of a model from standard input; `write` answers with the content of a file, `solids` with
// meshes.
#include <fcntl.h>
#include <unistd.h>

#include <charconv>
#include <cstddef>
#include <exception>
#include <iostream>
#include <new>
#include <ostream>
#include <streambuf>
#include <string>
#include <utility>
#include <vector>

#include "app/reader_confinement.h"
#include "engine/base/assert.h"
#include "engine/base/progress.h"
#include "engine/exchange/cad/cad.h"
#include "engine/exchange/cad_stream.h"
#include "engine/exchange/frame_stream.h"

namespace spoonbill {
namespace {

constexpr int exit_wrong_use = 2;

// The standard output that the program was started with. Everything that OpenCASCADE prints goes to
// /dev/null, so that it cannot corrupt the frames.
class AnswerStream : public std::streambuf {
 public:
  AnswerStream() : descriptor_(dup(STDOUT_FILENO)) {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    close(nowhere);
  }

 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    std::streamsize written = 0;
    while (written < count) {
      const ssize_t more = write(descriptor_, text + written, static_cast<std::size_t>(count - written));
      if (more <= 0) return written;
      written += more;
    }
    return written;
  }
  int overflow(int letter) override {
    const char byte = static_cast<char>(letter);
    return xsputn(&byte, 1) == 1 ? letter : traits_type::eof();
  }

 private:
  int descriptor_;
};

template <class Number>
bool parse(const std::string& text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

FileFormat format_named(const std::string& name) {
  return name == "iges" ? FileFormat::iges : FileFormat::step;
}

Progress report_to(std::ostream& out) {
  return Progress([&out](double fraction) {
    write_progress(out, fraction);
    return true;
  });
}

void answer_read(const std::vector<std::string>& arguments, CadReading reading, std::ostream& out) {
  reading.format = format_named(arguments[1]);
  const auto model = read_cad(
      arguments[2], reading,
      [&](const CadSurface& surface) {
        write_frame(out, FrameKind::surface, json_to_line(cad_surface_to_json(surface)));
      },
      report_to(out));
  if (!model) return write_failure(out, model.error().message);
  const Json ending = {
      {"unit", model->unit}, {"unit_declared", model->unit_declared}, {"notes", model->notes}};
  write_frame(out, FrameKind::ending, json_to_line(ending));
}

Result<CadModel> read_model(std::istream& in) {
  CadModel model;
  for (;;) {
    const auto frame = read_frame([&](void* to, std::size_t bytes) {
      return static_cast<bool>(in.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes)));
    });
    if (!frame) return Error{ErrorCode::malformed, "the model is incomplete"};
    if (frame->kind == FrameKind::ending) return model;
    auto surface = cad_surface_from_json(frame->content, "model");
    if (!surface) return surface.error();
    model.surfaces.push_back(std::move(surface).value());
  }
}

void answer_write(const std::vector<std::string>& arguments, std::ostream& out) {
  const auto model = read_model(std::cin);
  if (!model) return write_failure(out, model.error().message);
  CadWriting writing;
  writing.format = format_named(arguments[1]);
  writing.schema = arguments[2] == "ap242" ? StepSchema::ap242 : StepSchema::ap214;
  writing.unit = arguments[3];
  const auto content = write_cad(model.value(), writing, report_to(out));
  if (!content) return write_failure(out, content.error().message);
  write_frame(out, FrameKind::file, content->text);
  const Json ending = {
      {"solids", content->solids}, {"open_shells", content->open_shells}, {"notes", content->notes}};
  write_frame(out, FrameKind::ending, json_to_line(ending));
}

// Sends one frame per solid, then a last frame with the notes and with the indices of the surfaces that
// belong to no solid.
void answer_solids(const SolidMeshing& meshing, std::ostream& out) {
  const auto model = read_model(std::cin);
  if (!model) return write_failure(out, model.error().message);
  const auto found = mesh_solids(model.value(), meshing, report_to(out));
  if (!found) return write_failure(out, found.error().message);
  for (const CadSolid& solid : found->solids) {
    write_frame(out, FrameKind::solid, cad_solid_to_bytes(solid));
  }
  const Json ending = {{"loose", found->loose}, {"notes", found->notes}};
  write_frame(out, FrameKind::ending, json_to_line(ending));
}

int serve(const std::vector<std::string>& arguments, const Status& confined) {
  CadReading reading;
  const bool reads = arguments.size() == 7 && arguments[0] == "read" && parse(arguments[3], reading.unit_m) &&
                     parse(arguments[4], reading.tolerance_m) && parse(arguments[5], reading.sew_m) &&
                     parse(arguments[6], reading.face_limit);
  const bool writes = arguments.size() == 4 && arguments[0] == "write";
  SolidMeshing meshing;
  const bool meshes = arguments.size() == 3 && arguments[0] == "solids" &&
                      parse(arguments[1], meshing.chord_m) && parse(arguments[2], meshing.triangle_limit);
  if (!reads && !writes && !meshes) {
    std::cerr << "spoonbill-cad: for use by spoonbill only; see `spoonbill convert --help`\n";
    return exit_wrong_use;
  }
  AnswerStream answers;
  std::ostream out(&answers);
  if (!confined) {
    write_failure(out, confined.error());
    return 1;
  }
  set_assertion_handler(throw_failed_assertion);
  try {
    prepare_occt();
    if (reads) answer_read(arguments, reading, out);
    if (writes) answer_write(arguments, out);
    if (meshes) answer_solids(meshing, out);
  } catch (const std::bad_alloc&) {
    write_failure(out, bad_allocation);
  } catch (const std::exception& exception) {
    write_failure(out, exception.what());
  }
  return out ? 0 : 1;
}

}  // namespace
}  // namespace spoonbill

int main(int argc, char** argv) {
  const spoonbill::Status confined = spoonbill::confine_reader();
  return spoonbill::serve(std::vector<std::string>(argv + (argc > 0 ? 1 : 0), argv + argc), confined);
}
