#include "engine/exchange/cad/solid_meshes.h"

#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <Standard_Failure.hxx>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "engine/exchange/cad/joined_faces.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/cad/shape_mesh.h"
#include "engine/exchange/mesh_export/tessellation.h"

namespace spoonbill {
namespace {

// Of volume and area, to which OpenCASCADE integrates; without being told it misses by a hundredth.
constexpr double measuring_share = 1e-6;
// A body whose surface moves by no more than an error loses no more than that from each square metre, but for
// what narrow bends add, and what its integral misses.
constexpr double volume_slack = 2.0, integral_slack = 1e-3;

CadSolid measured(const std::string& name, const JoinedSolid& joined) {
  CadSolid solid;
  solid.name = name;
  solid.gap_m = joined.gap_m;
  GProp_GProps volume, area;
  BRepGProp::VolumeProperties(joined.shape, volume, measuring_share);
  BRepGProp::SurfaceProperties(joined.shape, area, measuring_share);
  solid.volume_m3 = volume.Mass() / std::pow(millimetres_per_metre, 3);
  solid.area_m2 = area.Mass() / std::pow(millimetres_per_metre, 2);
  const gp_Pnt middle = volume.CentreOfMass();
  solid.centre_m = Vector3(middle.X(), middle.Y(), middle.Z()) / millimetres_per_metre;
  return solid;
}

class Mesher {
 public:
  Mesher(const CadModel& model, const SolidMeshing& meshing) : model_(model), left_(meshing) {}

  // All faces of the solid that the surface in this place is of.
  Status add(std::size_t place) {
    const std::string& name = model_.surfaces[place].solid;
    if (name.empty()) {
      found_.loose.push_back(place);
      return {};
    }
    return known_.insert(name).second ? add_solid(name) : Status();
  }

  CadSolids take() {
    std::sort(found_.loose.begin(), found_.loose.end());
    return std::move(found_);
  }

 private:
  Status add_solid(const std::string& name) {
    std::vector<const CadSurface*> parts;
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < model_.surfaces.size(); ++k) {
      if (model_.surfaces[k].solid != name) continue;
      parts.push_back(&model_.surfaces[k]);
      places.push_back(k);
    }
    const auto joined = join_faces(parts);
    if (!joined) {
      found_.notes.push_back("'" + name + "': " + joined.error().message);
      found_.loose.insert(found_.loose.end(), places.begin(), places.end());
      return {};
    }
    for (std::string& note : notes_of(joined.value(), name, parts, "")) {
      found_.notes.push_back(std::move(note));
    }
    for (const std::size_t loose : joined->loose) found_.loose.push_back(places[loose]);
    for (const JoinedSolid& solid : joined->solids) {
      if (Status added = add_joined(name, solid, places); !added) return added;
    }
    return {};
  }

  Status add_joined(const std::string& name, const JoinedSolid& joined,
                    const std::vector<std::size_t>& places) {
    CadSolid solid = measured(name, joined);
    for (const std::size_t part : joined.places) solid.places.push_back(places[part]);
    auto meshed = shape_mesh(joined.shape, left_, joined.gap_m);
    if (!meshed) return Error{"'" + name + "': " + meshed.error().message};
    if (!meshed.value() || !fits(meshed.value().value(), solid)) {
      found_.notes.push_back("OpenCASCADE finds no watertight mesh of '" + name + "'");
      found_.loose.insert(found_.loose.end(), solid.places.begin(), solid.places.end());
      return {};
    }
    solid.mesh = std::move(meshed.value()->mesh);
    solid.chord_error_m = meshed.value()->chord_error_m;
    left_.triangle_limit -= solid.mesh.triangles.size();
    found_.solids.push_back(std::move(solid));
    return {};
  }

  // A mesh that is folded over somewhere has not the volume.
  static bool fits(const ShapeMesh& meshed, const CadSolid& solid) {
    const double difference_m3 = enclosed_volume_m3(meshed.mesh) - solid.volume_m3;
    return std::abs(difference_m3) <=
           volume_slack * solid.area_m2 * meshed.chord_error_m + integral_slack * solid.volume_m3;
  }

  const CadModel& model_;
  SolidMeshing left_;
  CadSolids found_;
  std::set<std::string> known_;
};

Result<CadSolids> mesh_all(const CadModel& model, const SolidMeshing& meshing, const Progress& progress) {
  Mesher mesher(model, meshing);
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    if (Status added = mesher.add(k); !added) return added.error();
    const double fraction = static_cast<double>(k + 1) / static_cast<double>(model.surfaces.size());
    if (!progress.report(fraction)) return Progress::stopped();
  }
  return mesher.take();
}

}  // namespace

Result<CadSolids> mesh_solids(const CadModel& model, const SolidMeshing& meshing, const Progress& progress) {
  try {
    return mesh_all(model, meshing, progress);
  } catch (const Standard_Failure& failure) {
    return Error{std::string("OpenCASCADE fails on it (") + failure.DynamicType()->Name() + ")"};
  }
}

}  // namespace spoonbill
