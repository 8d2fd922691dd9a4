// The faces of solids, which are surfaces of their own here, as those solids again.
#pragma once

#include <TopoDS_Solid.hxx>
#include <cstddef>
#include <vector>

#include "engine/exchange/cad_model.h"
#include "engine/result.h"

namespace spoonbill {

struct JoinedFaces {
  std::vector<TopoDS_Solid> solids;  // each with its cavities
  std::vector<std::size_t> loose;    // places among the parts of those that are no faces of them
};

// Edges are sewn where they are no farther apart than what approximated faces may miss each other by. Which
// side of them is outside most faces of a shell tell by their normals: one that is inside out is a cavity of
// the solid around it, and loose where there is none, never a solid by itself. Refused: a surface or trim
// loops of which OpenCASCADE can build no face.
Result<JoinedFaces> join_faces(const std::vector<const CadSurface*>& parts);

}  // namespace spoonbill
