// Triangles on exact faces and edges, refined until they are within a chord error. A mesh that is watertight
// stays so, because each side is split once for both of its triangles. Lengths are metres. Owned by one
// thread.
#pragma once

#include <BRepAdaptor_Curve.hxx>
#include <Geom2d_Curve.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

class RefinableMesh {
 public:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  // A curve on which an edge of the shape runs in the parameters of one of its faces.
  using FaceCurve = opencascade::handle<Geom2d_Curve>;

  // A side of one or two triangles. A side along an edge of the shape has parameters on the edge's curve.
  struct Side {
    std::array<std::uint32_t, 2> vertices{};
    std::uint32_t edge = none;
    std::array<double, 2> parameters{};  // at both vertices; only along an edge
  };

  // A triangle, counter-clockwise seen from outside. Side k begins at corner k.
  struct Triangle {
    std::array<std::uint32_t, 3> corners{}, sides{};
    // Index of the face curve of each side; none for a side inside its face.
    std::array<std::uint32_t, 3> curves{none, none, none};
    std::array<Vector2, 3> uv;  // of the corners, on the face
    std::uint32_t face = 0;
  };

  // add_face(), add_edge(), add_face_curve(), add_vertex(), add_side() and add_triangle() describe the mesh
  // to refine. All but the last return the index of what they add. OpenCASCADE's lengths are millimetres.
  std::uint32_t add_face(const GeomAdaptor_Surface& surface);
  std::uint32_t add_edge(const BRepAdaptor_Curve& curve);
  std::uint32_t add_face_curve(const FaceCurve& curve);
  std::uint32_t add_vertex(const Vector3& position_m);
  std::uint32_t add_side(const Side& side);
  void add_triangle(const Triangle& triangle);

  // Returns whether each side belongs to two triangles, which use it in opposite directions.
  bool is_closed() const;

  // Splits sides until samples of all triangles and edges are within `chord_m`. Sides shorter than this are
  // not split. Refused: more triangles than the limit.
  Status refine(double chord_m, std::size_t triangle_limit);

  // Returns the largest distance of a sample of a face or an edge from its triangle or side, as of refine().
  double chord_error_m() const;
  // Returns the triangles. No two sides have the same two vertices.
  TriangleMesh release_mesh();

 private:
  // State of a side in refine().
  struct SideState {
    double error_m = -1.0;  // negative until measured
    bool is_marked = false;
    Vector2 uv = Vector2::Zero();  // of the midpoint, for a marked side inside a face
    std::uint32_t face = none;     // of this uv
    std::uint32_t midpoint = none;
    std::array<std::uint32_t, 2> halves{none, none};  // at the first and at the second vertex
  };

  Vector3 surface_point_m(std::uint32_t face, const Vector2& uv) const;
  Vector3 edge_point_m(std::uint32_t edge, double parameter) const;
  double length_m(std::uint32_t side) const;
  double measure_triangle_m(const Triangle& triangle) const;
  double measure_edge_side_m(const Side& side) const;
  double measure_inner_side_m(const Triangle& triangle, std::size_t k) const;
  void measure();
  void mark(const Triangle& triangle, std::size_t k);
  // Marks sides that are too far from their face or edge. Returns whether there are any.
  bool mark_far_sides(double chord_m);
  bool mark_sides_with_equal_vertices();
  void split_marked_sides();
  void split_side(std::uint32_t side);
  Vector2 midpoint_uv(const Triangle& triangle, std::size_t k) const;
  std::uint32_t half_at(std::uint32_t side, std::uint32_t vertex) const;
  std::uint32_t add_inner_side(std::uint32_t from, std::uint32_t to);
  void split_triangle(std::size_t index);
  void replace(std::size_t index, const Triangle& triangle);

  std::vector<GeomAdaptor_Surface> faces_;
  std::vector<BRepAdaptor_Curve> edges_;
  std::vector<FaceCurve> face_curves_;
  std::vector<Vector3> vertices_m_;
  std::vector<Side> sides_;
  std::vector<SideState> side_states_;  // of sides_
  std::vector<Triangle> triangles_;
  std::vector<double> errors_m_;  // of triangles_; negative until measured
};

}  // namespace spoonbill
