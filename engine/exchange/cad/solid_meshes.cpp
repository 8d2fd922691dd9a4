// Meshes of the solids that are joined from a model's faces.
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <Standard_Failure.hxx>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/exchange/cad/cad.h"
#include "engine/exchange/cad/joined_faces.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/cad/shape_mesh.h"
#include "engine/exchange/mesh_export/tessellation.h"

namespace spoonbill {
namespace {

// Relative tolerance to which OpenCASCADE integrates volume and area; its default has an error of about 1 %.
constexpr double integration_tolerance = 1e-6;
// The volumes of mesh and solid may differ by volume_slack x area x chord error, plus integral_slack x volume
// for the error of integration. volume_slack is above 1, because narrow bends add to the difference.
constexpr double volume_slack = 2.0, integral_slack = 1e-3;

CadSolid measure_solid(const std::string& name, const JoinedSolid& joined) {
  CadSolid solid;
  solid.name = name;
  solid.gap_m = joined.gap_m;
  GProp_GProps volume, area;
  BRepGProp::VolumeProperties(joined.shape, volume, integration_tolerance);
  BRepGProp::SurfaceProperties(joined.shape, area, integration_tolerance);
  solid.volume_m3 = volume.Mass() / std::pow(millimetres_per_metre, 3);
  solid.area_m2 = area.Mass() / std::pow(millimetres_per_metre, 2);
  const gp_Pnt centre = volume.CentreOfMass();
  solid.centre_m = Vector3(centre.X(), centre.Y(), centre.Z()) / millimetres_per_metre;
  return solid;
}

// Mesher of the solids of a model, in the order of their first faces.
class SolidMesher {
 public:
  SolidMesher(const CadModel& model, const SolidMeshing& meshing) : model_(model), remaining_(meshing) {}

  // Adds the solid to which the surface `index` belongs, unless another face of this solid has added it. A
  // surface without a solid is loose.
  Status add(std::size_t index) {
    const std::string& name = model_.surfaces[index].solid;
    if (name.empty()) {
      result_.loose.push_back(index);
      return {};
    }
    return added_.insert(name).second ? add_solid(name) : Status();
  }

  CadSolids release_solids() {
    // A surface with faces in several solids is not loose if one of these solids has a mesh.
    std::set<std::size_t> loose(result_.loose.begin(), result_.loose.end());
    for (const CadSolid& solid : result_.solids) {
      for (const std::size_t index : solid.surface_indices) loose.erase(index);
    }
    result_.loose.assign(loose.begin(), loose.end());
    return std::move(result_);
  }

 private:
  Status add_solid(const std::string& name) {
    std::vector<const CadSurface*> parts;
    std::vector<std::size_t> indices;
    for (std::size_t k = 0; k < model_.surfaces.size(); ++k) {
      if (model_.surfaces[k].solid != name) continue;
      parts.push_back(&model_.surfaces[k]);
      indices.push_back(k);
    }
    const auto joined = join_faces(parts);
    if (!joined) {
      result_.notes.push_back("'" + name + "': " + joined.error().message);
      result_.loose.insert(result_.loose.end(), indices.begin(), indices.end());
      return {};
    }
    for (std::string& note : describe_joining(joined.value(), name, parts, "")) {
      result_.notes.push_back(std::move(note));
    }
    for (const std::size_t loose : joined->loose) result_.loose.push_back(indices[loose]);
    for (const JoinedSolid& solid : joined->solids) {
      if (Status added = add_joined(name, solid, indices); !added) return added;
    }
    return {};
  }

  Status add_joined(const std::string& name, const JoinedSolid& joined,
                    const std::vector<std::size_t>& indices) {
    CadSolid solid = measure_solid(name, joined);
    for (const std::size_t part : joined.parts) solid.surface_indices.push_back(indices[part]);
    auto found = mesh_shape(joined.shape, remaining_.chord_m + joined.gap_m, remaining_.triangle_limit);
    if (!found) return found.error().in("'" + name + "'");
    if (!found.value() || !has_same_volume(found.value().value(), solid)) {
      result_.notes.push_back("OpenCASCADE cannot make a watertight mesh of '" + name + "'");
      result_.loose.insert(result_.loose.end(), solid.surface_indices.begin(), solid.surface_indices.end());
      return {};
    }
    solid.mesh = std::move(found.value()->mesh);
    solid.chord_error_m = found.value()->chord_error_m;
    remaining_.triangle_limit -= solid.mesh.triangles.size();
    result_.solids.push_back(std::move(solid));
    return {};
  }

  // Returns true if mesh and solid have nearly the same volume. A mesh that folds over itself has a different
  // volume.
  static bool has_same_volume(const ShapeMesh& found, const CadSolid& solid) {
    const double difference_m3 = enclosed_volume_m3(found.mesh) - solid.volume_m3;
    return std::abs(difference_m3) <=
           volume_slack * solid.area_m2 * found.chord_error_m + integral_slack * solid.volume_m3;
  }

  const CadModel& model_;
  SolidMeshing remaining_;
  CadSolids result_;
  std::set<std::string> added_;
};

Result<CadSolids> mesh_all_solids(const CadModel& model, const SolidMeshing& meshing,
                                  const Progress& progress) {
  SolidMesher mesher(model, meshing);
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    if (Status added = mesher.add(k); !added) return added.error();
    const double fraction = static_cast<double>(k + 1) / static_cast<double>(model.surfaces.size());
    if (!progress.report(fraction)) return Progress::stopped();
  }
  return mesher.release_solids();
}

}  // namespace

Result<CadSolids> mesh_solids(const CadModel& model, const SolidMeshing& meshing, const Progress& progress) {
  try {
    return mesh_all_solids(model, meshing, progress);
  } catch (const Standard_Failure& failure) {
    return Error{ErrorCode::unsupported,
                 std::string("OpenCASCADE failed to mesh the model (") + failure.DynamicType()->Name() + ")"};
  }
}

}  // namespace spoonbill
