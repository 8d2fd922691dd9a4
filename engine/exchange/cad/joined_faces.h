// Joining of the faces of a solid, which are separate surfaces in the program.
#pragma once

#include <TopoDS_Solid.hxx>
#include <cstddef>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

struct JoinedSolid {
  TopoDS_Solid shape;  // the solid, including its cavities
  double gap_m = 0.0;  // widest gap between two faces at a shared edge
  // Indices, in the argument of join_faces(), of the surfaces that form the solid.
  std::vector<std::size_t> parts;
};

struct JoinedFaces {
  std::vector<JoinedSolid> solids;
  // Indices, in the argument of join_faces(), of the surfaces that belong to no solid.
  std::vector<std::size_t> loose;
};

// Joins faces into solids by sewing their edges. Edges may be up to 0.1 mm apart, because approximated faces
// may have such gaps. The orientation of most of a shell's faces decides which side is outside. A shell whose
// normals point inwards is a cavity of the solid around it, or loose if no solid is around it. Refused: a
// surface or trim loops from which OpenCASCADE cannot build a face.
Result<JoinedFaces> join_faces(const std::vector<const CadSurface*>& parts);

// Returns notes about the joined faces of the solid `name`, one line each. They report bridged gaps that are
// wider than the approximation of two faces explains, and the number of loose faces. `loose_outcome` is
// appended to the note about loose faces, for example "; they are written one by one".
std::vector<std::string> describe_joining(const JoinedFaces& joined, const std::string& name,
                                          const std::vector<const CadSurface*>& parts,
                                          const std::string& loose_outcome);

}  // namespace spoonbill
