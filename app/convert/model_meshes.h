// A model as the meshes that go out of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/files/cad_file.h"
#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/mesh_export/mesh_writer.h"

namespace spoonbill {

struct ModelMeshing {
  double chord_m = 5e-5;
  std::filesystem::path file;  // its name in messages
  CadChild child;              // that joins the faces of solids
  Progress progress;           // of the meshes after that
};

struct ModelMeshes {
  std::vector<NamedMesh> meshes;  // no two of one name
  double chord_error_m = 0.0;
  std::vector<std::string> notes;
};

// In the order of the surfaces; a solid that several of them bound is one mesh, where the first of its faces
// stands; a shell has both faces and the walls between, or a note says why it is its surface alone. Faces
// that the child joins to none are meshes each, and a note says why. Refused: more triangles than a file is
// written with, loops that bound nothing; when asked to stop.
Result<ModelMeshes> mesh_model(const CadModel& model, const ModelMeshing& meshing);

}  // namespace spoonbill
