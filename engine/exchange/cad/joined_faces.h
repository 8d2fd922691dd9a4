// The faces of solids, which are surfaces of their own here, as those solids again.
#pragma once

#include <TopoDS_Solid.hxx>
#include <cstddef>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"

namespace spoonbill {

struct JoinedSolid {
  TopoDS_Solid shape;               // with its cavities
  double gap_m = 0.0;               // the widest between the two faces of an edge that was bridged
  std::vector<std::size_t> places;  // of its faces among the parts
};

struct JoinedFaces {
  std::vector<JoinedSolid> solids;
  std::vector<std::size_t> loose;  // places among the parts of those that are no faces of them
};

// Edges are sewn where they are no farther apart than what approximated faces may miss each other by. Which
// side of them is outside most faces of a shell tell by their normals: one that is inside out is a cavity of
// the solid around it, and loose where there is none, never a solid by itself. Refused: a surface or trim
// loops of which OpenCASCADE can build no face.
Result<JoinedFaces> join_faces(const std::vector<const CadSurface*>& parts);

// What there is to say of the joined faces of the solid of that name, a line each: gaps that were bridged and
// are wider than two approximated faces explain, and how many faces are loose, with what becomes of those
// ("; they are written one by one").
std::vector<std::string> notes_of(const JoinedFaces& joined, const std::string& name,
                                  const std::vector<const CadSurface*>& parts,
                                  const std::string& what_becomes_of_loose);

}  // namespace spoonbill
