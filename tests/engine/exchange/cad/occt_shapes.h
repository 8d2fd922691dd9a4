// Shapes that OpenCASCADE's own builders make, in millimetres.
#pragma once

#include <gtest/gtest.h>

#include <IFSelect_ReturnStatus.hxx>
#include <TopAbs_ShapeEnum.hxx>
#include <TopoDS_Shape.hxx>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/exchange/cad_model.h"

namespace spoonbill {

struct NamedShape {
  std::string name;
  TopoDS_Shape shape;
};

// Primitives and parts of them, sweeps, lofts, fillets, cuts, shells.
std::vector<NamedShape> solid_shapes();
// Solids with cavities.
std::vector<NamedShape> hollow_solids();
// A box with a hole drilled through it and an edge rounded.
TopoDS_Shape drilled_box();
// Single faces: rational, of high degrees, trimmed, offset, of revolution.
std::vector<NamedShape> single_faces();

// Returns what is read from a STEP file that OpenCASCADE writes into the folder. prepare_occt() must have
// been called.
CadModel read_through_step(const TopoDS_Shape& shape, const std::filesystem::path& folder);

int count_of(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind);

// Reads the shape with OpenCASCADE's own reader of STEP or IGES.
template <class Reader>
TopoDS_Shape shape_in(const std::filesystem::path& file) {
  Reader reader;
  EXPECT_EQ(reader.ReadFile(file.c_str()), IFSelect_RetDone);
  reader.TransferRoots();
  return reader.OneShape();
}

}  // namespace spoonbill
