// Shapes that OpenCASCADE's own builders make, in millimetres.
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

namespace spoonbill {

struct NamedShape {
  std::string name;
  TopoDS_Shape shape;
};

// Primitives and parts of them, sweeps, lofts, fillets, cuts, shells.
std::vector<NamedShape> solid_shapes();
// Single faces: rational, of high degrees, trimmed, offset, of revolution.
std::vector<NamedShape> single_faces();

}  // namespace spoonbill
