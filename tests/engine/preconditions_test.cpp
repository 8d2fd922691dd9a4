// Tests that functions assert the preconditions stated in their headers, for some functions of each folder.
// The preconditions that only Debug builds check are at the end.
#include <gtest/gtest.h>

#include <limits>

#include "engine/bspline/basis.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/change_knots.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/quadrature.h"
#include "engine/bspline/trim_loop.h"
#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/collision/solids/implicit_shapes.h"
#include "engine/collision/solids/tool_shape.h"
#include "engine/collision/surfaces/pair_search.h"
#include "engine/fitting/point_sets.h"
#include "engine/fitting/scan.h"
#include "engine/inspection/mass_properties.h"
#include "engine/material/cells/spring_cell.h"
#include "engine/material/contact/body_contacts.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/merging/bridge.h"
#include "engine/merging/patch_edge.h"
#include "engine/shapes/fit_shape.h"
#include "engine/shapes/lathe.h"
#include "engine/shapes/smooth_curve.h"
#include "engine/simulation/rest_shape.h"
#include "engine/simulation/tool_contact.h"
#include "tests/engine/throwing_asserts.h"

namespace spoonbill {
namespace {

class Preconditions : public testing::Test {
 protected:
  KnotVector line_ = KnotVector::clamped_uniform(1, 2).value();
  Surface square_ = make_surface(line_, line_, ControlNet(2, 2)).value();
  ThrowingAsserts throwing_;
};

TEST_F(Preconditions, OfSplines) {
  const std::vector<double> parameters{0.0, 1.0};
  EXPECT_NO_THROW(blending_matrix(line_, parameters, 2));
  EXPECT_THROW(blending_matrix(line_, parameters, 3), FailedAssertion);
  EXPECT_THROW(nested_parameters(line_, 0, 1), FailedAssertion);
  EXPECT_THROW(largest_deviation_m(square_, {parameters, parameters, {}}), FailedAssertion);
  EXPECT_THROW(combine_along(square_, Direction::u, Eigen::MatrixXd::Zero(2, 3), line_), FailedAssertion);
  EXPECT_THROW(find_crossing({}, Eigen::Vector2d::Zero()), FailedAssertion);
  ControlNet smaller(1, 2);
  EXPECT_THROW(place(square_.net, Eigen::Matrix3d::Identity(), Vector3::Zero(), smaller), FailedAssertion);
}

TEST_F(Preconditions, OfShapes) {
  EXPECT_THROW(Meridian::half_circle(0.0), FailedAssertion);
  EXPECT_THROW(SmoothCurve().end(), FailedAssertion);
  EXPECT_THROW(ShapeKnots(ShapeDirection{}, 0, 1), FailedAssertion);
}

TEST_F(Preconditions, OfCollision) {
  EXPECT_THROW(join_vertices({}, 0.0), FailedAssertion);
  EXPECT_THROW(make_signed_distance(SphereShape{-1.0}), FailedAssertion);
  EXPECT_THROW(ToolShape::half_space(Vector3::Zero(), Vector3(0.0, 2.0, 0.0)), FailedAssertion);
  EXPECT_THROW(hulls_are_apart(ControlNet(), square_.net), FailedAssertion);
}

TEST_F(Preconditions, OfMaterials) {
  EXPECT_THROW(box_mesh(Vector3::Ones(), {1, 2, 2}), FailedAssertion);
  const CellCorners corners = box_mesh(Vector3::Ones(), {2, 2, 2}).cell(0, 0, 0);
  EXPECT_NO_THROW(cell_springs(corners, 1.0));
  EXPECT_THROW(cell_springs(corners, 0.0), FailedAssertion);
  EXPECT_THROW(GroundContacts(4).begin(Vector3::UnitY(), 0.0), FailedAssertion);
}

TEST_F(Preconditions, OfSimulation) {
  EXPECT_THROW(compute_rest_shape(Scene{}, 0), FailedAssertion);
  Tool tool;
  tool.kind = ToolKind::solid;
  EXPECT_THROW(make_tool_model(tool, best_instruction_set()), FailedAssertion);
}

TEST_F(Preconditions, OfInspection) {
  EXPECT_THROW(make_piece_quadrature(line_, 0), FailedAssertion);
  EXPECT_THROW(compute_shell_mass(square_, 0.0), FailedAssertion);
}

TEST_F(Preconditions, OfFittingAndMerging) {
  EXPECT_THROW(quantile({1.0, 2.0}, 1.5), FailedAssertion);
  EXPECT_THROW(group_by_voxels(Scan{}, 0.0), FailedAssertion);
  EXPECT_THROW(bridge(square_, square_, -1), FailedAssertion);
  EXPECT_THROW(edge_samples(edge_curve(square_, Side::v_end), 1), FailedAssertion);
}

TEST_F(Preconditions, AreCheckedThroughWholeSurfacesInDebugBuilds) {
  EXPECT_TRUE(is_valid(square_));
  square_.net.y[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(has_matching_net(square_));
  EXPECT_FALSE(is_valid(square_));
  square_.net.x.pop_back();
  EXPECT_FALSE(has_matching_net(square_));
#ifndef NDEBUG
  EXPECT_THROW(fit_coarser_knots(square_, Direction::u, line_), FailedAssertion);
  EXPECT_THROW(basis_functions(line_, 1.5), FailedAssertion);
#endif
}

}  // namespace
}  // namespace spoonbill
