// Shapes, in millimetres, that OpenCASCADE's own builders make.
#pragma once

#include <gtest/gtest.h>

#include <IFSelect_ReturnStatus.hxx>
#include <TopAbs_ShapeEnum.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Shape.hxx>
#include <filesystem>
#include <gp_Pnt.hxx>
#include <string>
#include <vector>

#include "engine/exchange/cad_model.h"

namespace spoonbill {

struct NamedShape {
  std::string name;
  TopoDS_Shape shape;
};

// Returns the edge of a curve that interpolates the points.
TopoDS_Edge spline_edge(const std::vector<gp_Pnt>& points, bool is_periodic = false);
// Returns the shape with all edges rounded.
TopoDS_Shape rounded(const TopoDS_Shape& shape, double radius);

// Returns solids: primitives and parts of them, sweeps, lofts, and solids with fillets, cuts and shells.
std::vector<NamedShape> solid_shapes();
// Returns every second shape, from the first or the second one on; in a full run, returns all shapes. Two
// tests that take different halves together try every shape.
std::vector<NamedShape> every_second(std::vector<NamedShape> shapes, bool from_first);
// Returns solids with cavities.
std::vector<NamedShape> hollow_solids();
// Returns a box with a hole drilled through it and one rounded edge.
TopoDS_Shape drilled_box();
// Returns single faces: rational, of high degree, trimmed, offset, and of revolution.
std::vector<NamedShape> single_faces();

// Writes the shape with OpenCASCADE to a STEP file in the folder and returns what our reader reads from it.
// prepare_occt() must have been called.
CadModel read_through_step(const TopoDS_Shape& shape, const std::filesystem::path& folder,
                           const CadReading& reading = {});

int count_of(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind);

// Reads the shape with OpenCASCADE's own reader for STEP or IGES.
template <class Reader>
TopoDS_Shape shape_in(const std::filesystem::path& file) {
  Reader reader;
  EXPECT_EQ(reader.ReadFile(file.c_str()), IFSelect_RetDone);
  reader.TransferRoots();
  return reader.OneShape();
}

}  // namespace spoonbill
