#include "engine/exchange/cad/written_bodies.h"

#include <TopExp_Explorer.hxx>
#include <set>
#include <string>
#include <utility>

#include "engine/base/text.h"
#include "engine/exchange/cad/body_shape.h"
#include "engine/exchange/cad/closing.h"
#include "engine/exchange/cad/joined_faces.h"
#include "engine/exchange/cad_names.h"
#include "engine/inspection/surface_check.h"

namespace spoonbill {
namespace {

// What moves less is rounding.
constexpr double least_move_m = 1e-9;

int face_count(const TopoDS_Shape& shape) {
  int count = 0;
  for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) ++count;
  return count;
}

std::string open_text(const CadSurface& surface, const BodyShape& body) {
  if (surface.trims.empty()) {
    return "' closes, but OpenCASCADE finds no solid in it; an open shell is written";
  }
  const int faces = face_count(body.shape);
  return "' would close, but is trimmed; an open shell of what is left is written" +
         (faces > 1 ? ", cut in " + std::to_string(faces) + " faces, which come back as a body each"
                    : std::string());
}

// With a note where it is not what one expects of a body that closes.
void tell_of(const CadSurface& surface, const BodyShape& body, double moved_m, CadFileContent& content) {
  ++(body.solid ? content.solids : content.open_shells);
  if (body.solid && moved_m > least_move_m) {
    content.notes.push_back("'" + surface.name + "' misses closing by " + short_length_text(moved_m) +
                            "; it is written closed");
  }
  if (body.solid || !surface.solid.empty()) return;
  if (find_closing(surface.surface).closedness != Closedness::solid) return;
  content.notes.push_back("'" + surface.name + open_text(surface, body));
}

class Collector {
 public:
  Collector(const CadModel& model, CadFileContent& content) : model_(model), content_(content) {}

  Status add(const CadSurface& surface) {
    if (surface.solid.empty()) return add_alone(surface);
    return joined_.insert(surface.solid).second ? add_solid(surface.solid) : Status();
  }

  std::vector<WrittenBody> take() {
    std::vector<std::string> names;
    for (const WrittenBody& body : bodies_) names.push_back(body.name);
    names = told_apart(names, "body");
    for (std::size_t k = 0; k < names.size(); ++k) bodies_[k].name = std::move(names[k]);
    return std::move(bodies_);
  }

 private:
  Status add_alone(const CadSurface& surface) {
    CadSurface closed = surface;
    auto [exact, moved_m] = closed_exactly(surface.surface);
    closed.surface = std::move(exact);
    const auto body = body_shape(closed);
    if (!body) return Error{"'" + surface.name + "': " + body.error().message};
    tell_of(surface, body.value(), moved_m, content_);
    bodies_.push_back({surface.name, body->shape, body->solid, &surface});
    return {};
  }

  Status add_solid(const std::string& name) {
    std::vector<const CadSurface*> parts;
    for (const CadSurface& surface : model_.surfaces) {
      if (surface.solid == name) parts.push_back(&surface);
    }
    const auto joined = join_faces(parts);
    if (!joined) return joined.error();
    for (const JoinedSolid& solid : joined->solids) bodies_.push_back({name, solid.shape, true, nullptr});
    content_.solids += static_cast<int>(joined->solids.size());
    for (const std::size_t place : joined->loose) {
      if (Status added = add_alone(*parts[place]); !added) return added;
    }
    const auto notes = notes_of(joined.value(), name, parts, "; they are written one by one");
    content_.notes.insert(content_.notes.end(), notes.begin(), notes.end());
    return {};
  }

  const CadModel& model_;
  CadFileContent& content_;
  std::vector<WrittenBody> bodies_;
  std::set<std::string> joined_;
};

}  // namespace

Result<std::vector<WrittenBody>> written_bodies(const CadModel& model, const Progress& progress,
                                                CadFileContent& content) {
  Collector collector(model, content);
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    if (Status added = collector.add(model.surfaces[k]); !added) return added.error();
    const double fraction = static_cast<double>(k + 1) / static_cast<double>(model.surfaces.size());
    if (!progress.report(fraction)) return Progress::stopped();
  }
  return collector.take();
}

}  // namespace spoonbill
