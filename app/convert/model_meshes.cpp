#include "app/convert/model_meshes.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "engine/exchange/cad_model.h"
#include "engine/exchange/mesh_export/tessellation.h"

namespace spoonbill {
namespace {

bool is_face_of_solid(const CadSurface& surface) {
  return !surface.solid.empty();
}

class Mesher {
 public:
  Mesher(const CadModel& model, const ModelMeshing& meshing) : model_(model), meshing_(meshing) {}

  Status mesh() {
    CadSolids solids = joined_solids();
    std::map<std::size_t, CadSolid*> starts;
    for (CadSolid& solid : solids.solids) starts[solid.places.front()] = &solid;
    const std::set<std::size_t> loose(solids.loose.begin(), solids.loose.end());
    for (std::size_t k = 0; k < model_.surfaces.size(); ++k) {
      if (const auto solid = starts.find(k); solid != starts.end()) {
        add({solid->second->name, std::move(solid->second->mesh), true}, solid->second->chord_error_m);
      }
      if (loose.contains(k)) {
        if (Status added = add_alone(k); !added) return added;
      }
      meshing_.progress.report(fraction_after(k + 1));
    }
    return {};
  }

  ModelMeshes take() {
    std::vector<std::string> names;
    for (const NamedMesh& mesh : made_.meshes) names.push_back(mesh.name);
    names = make_names_unique(names, "body");
    for (std::size_t k = 0; k < names.size(); ++k) made_.meshes[k].name = std::move(names[k]);
    return std::move(made_);
  }

 private:
  // Once so many surfaces are meshed; the file is still to be written.
  double fraction_after(std::size_t surfaces) const {
    return static_cast<double>(surfaces) / static_cast<double>(model_.surfaces.size() + 1);
  }

  CadSolids joined_solids() {
    CadSolids none;
    none.loose.resize(model_.surfaces.size());
    std::iota(none.loose.begin(), none.loose.end(), std::size_t{0});
    if (std::none_of(model_.surfaces.begin(), model_.surfaces.end(), is_face_of_solid)) return none;
    auto found =
        make_cad_solids(model_, {meshing_.chord_m, exported_triangle_limit}, meshing_.file, meshing_.child);
    if (!found) {
      made_.notes.push_back("the faces of solids are not joined, and each is a mesh of its own: " +
                            found.error().message);
      return none;
    }
    for (const CadSolid& solid : found->solids) triangles_ += solid.mesh.triangles.size();
    made_.notes = found->notes;
    const auto loose = std::count_if(found->loose.begin(), found->loose.end(), [&](std::size_t place) {
      return is_face_of_solid(model_.surfaces[place]);
    });
    if (loose > 0) {
      made_.notes.push_back("faces that are joined to no solid: " + std::to_string(loose) +
                            ", each a mesh of its own");
    }
    return std::move(found).value();
  }

  Status add_alone(std::size_t place) {
    const CadSurface& part = model_.surfaces[place];
    const std::size_t left = exported_triangle_limit - std::min(triangles_, exported_triangle_limit);
    // A shell has its surface twice, and its walls.
    const std::size_t limit = part.shell_thickness_m > 0.0 ? left / 3 : left;
    const double before = fraction_after(place);
    auto alone =
        tessellate(part.surface, part.trims, meshing_.chord_m, limit, meshing_.progress.part(before, before));
    const std::string file = meshing_.file.string();
    if (!meshing_.progress.report(before)) return Error{file + ": stopped"};
    if (!alone) return Error{file + ": '" + part.name + "': " + alone.error().message};
    if (part.shell_thickness_m > 0.0) thicken(part, alone.value());
    triangles_ += alone->mesh.triangles.size();
    add({part.name, std::move(alone->mesh), alone->closed}, alone->chord_error_m);
    return {};
  }

  void thicken(const CadSurface& part, Tessellation& tessellation) {
    auto shell = thicken_mesh(tessellation.mesh, part.shell_thickness_m);
    if (shell) {
      tessellation.mesh = std::move(shell).value();
      tessellation.closed = true;
    } else {
      made_.notes.push_back("'" + part.name +
                            "' is written as the surface that it lies behind: " + shell.error().message);
    }
  }

  void add(NamedMesh mesh, double chord_error_m) {
    made_.chord_error_m = std::max(made_.chord_error_m, chord_error_m);
    made_.meshes.push_back(std::move(mesh));
  }

  const CadModel& model_;
  const ModelMeshing& meshing_;
  ModelMeshes made_;
  std::size_t triangles_ = 0;
};

}  // namespace

Result<ModelMeshes> mesh_model(const CadModel& model, const ModelMeshing& meshing) {
  Mesher mesher(model, meshing);
  if (Status meshed = mesher.mesh(); !meshed) return meshed.error();
  return mesher.take();
}

}  // namespace spoonbill
