#include "engine/exchange/cad/refinable_mesh.h"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/triangle.h"
#include "engine/exchange/cad/occt_surface.h"

namespace spoonbill {
namespace {

// Number of sampling intervals on a side of a triangle.
constexpr int side_parts = 3;
// More rounds than any mesh needs: each divides sides in two, and sides shorter than the chord error stay.
constexpr int round_limit = 64;

Vector3 to_metres(const gp_Pnt& at) {
  return Vector3(at.X(), at.Y(), at.Z()) / millimetres_per_metre;
}

double distance_to_segment_m(const Vector3& point, const Vector3& a, const Vector3& b) {
  const Vector3 along = b - a;
  const double square = along.squaredNorm();
  const double fraction = square > 0.0 ? std::clamp((point - a).dot(along) / square, 0.0, 1.0) : 0.0;
  return (a + fraction * along - point).norm();
}

std::size_t next(std::size_t k) {
  return (k + 1) % 3;
}

// Returns the index of the item.
template <class Item>
std::uint32_t append(std::vector<Item>& items, const Item& item) {
  items.push_back(item);
  return static_cast<std::uint32_t>(items.size() - 1);
}

}  // namespace

std::uint32_t RefinableMesh::add_face(const GeomAdaptor_Surface& surface) {
  return append(faces_, surface);
}

std::uint32_t RefinableMesh::add_edge(const BRepAdaptor_Curve& curve) {
  return append(edges_, curve);
}

std::uint32_t RefinableMesh::add_face_curve(const FaceCurve& curve) {
  return append(face_curves_, curve);
}

std::uint32_t RefinableMesh::add_vertex(const Vector3& position_m) {
  return append(vertices_m_, position_m);
}

std::uint32_t RefinableMesh::add_side(const Side& side) {
  side_states_.emplace_back();
  return append(sides_, side);
}

void RefinableMesh::add_triangle(const Triangle& triangle) {
  triangles_.push_back(triangle);
  errors_m_.push_back(-1.0);
}

void RefinableMesh::replace(std::size_t index, const Triangle& triangle) {
  triangles_[index] = triangle;
  errors_m_[index] = -1.0;
}

bool RefinableMesh::is_closed() const {
  std::vector<std::array<int, 2>> uses(sides_.size(), {0, 0});  // forward, backward
  for (const Triangle& triangle : triangles_) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t side = triangle.sides[k];
      ++uses[side][triangle.corners[k] == sides_[side].vertices[0] ? 0 : 1];
    }
  }
  return !triangles_.empty() && std::all_of(uses.begin(), uses.end(), [](const std::array<int, 2>& count) {
    return count[0] == count[1] && count[0] <= 1;
  });
}

Vector3 RefinableMesh::surface_point_m(std::uint32_t face, const Vector2& uv) const {
  return to_metres(faces_[face].Value(uv.x(), uv.y()));
}

Vector3 RefinableMesh::edge_point_m(std::uint32_t edge, double parameter) const {
  return to_metres(edges_[edge].Value(parameter));
}

double RefinableMesh::length_m(std::uint32_t side) const {
  const auto [a, b] = sides_[side].vertices;
  return (vertices_m_[a] - vertices_m_[b]).norm();
}

double RefinableMesh::measure_triangle_m(const Triangle& triangle) const {
  const auto [a, b, c] = triangle.corners;
  double largest_m = 0.0;
  for (int i = 0; i <= side_parts; ++i) {
    for (int j = 0; i + j <= side_parts; ++j) {
      if (i == side_parts || j == side_parts || i + j == 0) continue;  // a corner
      const double first = static_cast<double>(i) / side_parts, second = static_cast<double>(j) / side_parts;
      const Vector2 uv =
          (1.0 - first - second) * triangle.uv[0] + first * triangle.uv[1] + second * triangle.uv[2];
      const Vector3 point_m = surface_point_m(triangle.face, uv);
      const Vector3 nearest_m =
          nearest_on_triangle(vertices_m_[a], vertices_m_[b], vertices_m_[c], point_m).point;
      largest_m = std::max(largest_m, (nearest_m - point_m).norm());
    }
  }
  return largest_m;
}

double RefinableMesh::measure_edge_side_m(const Side& side) const {
  double largest_m = 0.0;
  for (int i = 1; i < side_parts; ++i) {
    const double fraction = static_cast<double>(i) / side_parts;
    const double parameter = side.parameters[0] + fraction * (side.parameters[1] - side.parameters[0]);
    largest_m = std::max(
        largest_m, distance_to_segment_m(edge_point_m(side.edge, parameter), vertices_m_[side.vertices[0]],
                                         vertices_m_[side.vertices[1]]));
  }
  return largest_m;
}

double RefinableMesh::measure_inner_side_m(const Triangle& triangle, std::size_t k) const {
  const Vector3 &from_m = vertices_m_[triangle.corners[k]], &to_m = vertices_m_[triangle.corners[next(k)]];
  double largest_m = 0.0;
  for (int i = 1; i < side_parts; ++i) {
    const double fraction = static_cast<double>(i) / side_parts;
    const Vector2 uv = (1.0 - fraction) * triangle.uv[k] + fraction * triangle.uv[next(k)];
    largest_m = std::max(largest_m, distance_to_segment_m(surface_point_m(triangle.face, uv), from_m, to_m));
  }
  return largest_m;
}

void RefinableMesh::measure() {
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (errors_m_[t] < 0.0) errors_m_[t] = measure_triangle_m(triangles_[t]);
  }
  for (std::size_t s = 0; s < sides_.size(); ++s) {
    if (sides_[s].edge != none && side_states_[s].error_m < 0.0)
      side_states_[s].error_m = measure_edge_side_m(sides_[s]);
  }
}

void RefinableMesh::mark(const Triangle& triangle, std::size_t k) {
  SideState& state = side_states_[triangle.sides[k]];
  if (state.is_marked) return;
  state.is_marked = true;
  state.uv = 0.5 * (triangle.uv[k] + triangle.uv[next(k)]);
  state.face = triangle.face;
}

bool RefinableMesh::mark_far_sides(double chord_m) {
  bool has_marked = false;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Triangle& triangle = triangles_[t];
    std::size_t longest = 0;
    bool has_far_side = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t s = triangle.sides[k];
      if (length_m(s) > length_m(triangle.sides[longest])) longest = k;
      if (errors_m_[t] <= chord_m && sides_[s].edge == none) continue;
      SideState& state = side_states_[s];
      if (state.error_m < 0.0) state.error_m = measure_inner_side_m(triangle, k);
      if (state.error_m <= chord_m || length_m(s) <= chord_m) continue;
      mark(triangle, k);
      has_far_side = true;
    }
    if (errors_m_[t] > chord_m && !has_far_side && length_m(triangle.sides[longest]) > chord_m) {
      mark(triangle, longest);
      has_far_side = true;
    }
    has_marked |= has_far_side;
  }
  return has_marked;
}

bool RefinableMesh::mark_sides_with_equal_vertices() {
  std::vector<std::pair<std::array<std::uint32_t, 2>, std::uint32_t>> sorted;
  for (std::uint32_t s = 0; s < sides_.size(); ++s) {
    if (side_states_[s].midpoint != none) continue;
    std::array<std::uint32_t, 2> ends = sides_[s].vertices;
    std::sort(ends.begin(), ends.end());
    sorted.emplace_back(ends, s);
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<bool> is_double(sides_.size(), false);
  for (std::size_t k = 1; k < sorted.size(); ++k) {
    if (sorted[k].first == sorted[k - 1].first) is_double[sorted[k].second] = true;
  }
  bool has_marked = false;
  for (const Triangle& triangle : triangles_) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!is_double[triangle.sides[k]]) continue;
      mark(triangle, k);
      has_marked = true;
    }
  }
  return has_marked;
}

void RefinableMesh::split_side(std::uint32_t index) {
  const Side side = sides_[index];
  Side first = side, second = side;
  if (side.edge != none) {
    const double parameter = 0.5 * (side.parameters[0] + side.parameters[1]);
    side_states_[index].midpoint = add_vertex(edge_point_m(side.edge, parameter));
    first.parameters[1] = second.parameters[0] = parameter;
  } else {
    side_states_[index].midpoint =
        add_vertex(surface_point_m(side_states_[index].face, side_states_[index].uv));
  }
  first.vertices[1] = second.vertices[0] = side_states_[index].midpoint;
  const std::uint32_t first_index = add_side(first), second_index = add_side(second);
  side_states_[index].halves = {first_index, second_index};
}

Vector2 RefinableMesh::midpoint_uv(const Triangle& triangle, std::size_t k) const {
  const std::uint32_t s = triangle.sides[k];
  if (triangle.curves[k] == none) return side_states_[s].uv;
  const gp_Pnt2d at =
      face_curves_[triangle.curves[k]]->Value(0.5 * (sides_[s].parameters[0] + sides_[s].parameters[1]));
  return {at.X(), at.Y()};
}

std::uint32_t RefinableMesh::half_at(std::uint32_t side, std::uint32_t vertex) const {
  return side_states_[side].halves[sides_[side].vertices[0] == vertex ? 0 : 1];
}

std::uint32_t RefinableMesh::add_inner_side(std::uint32_t from, std::uint32_t to) {
  return add_side({{from, to}, none, {}});
}

void RefinableMesh::split_triangle(std::size_t index) {
  Triangle whole = triangles_[index];
  const auto is_split = [&](std::size_t k) { return side_states_[whole.sides[k]].midpoint != none; };
  const auto count =
      static_cast<int>(is_split(0)) + static_cast<int>(is_split(1)) + static_cast<int>(is_split(2));
  if (count == 0) return;
  // The corners are rotated until the side that is split alone, or the only one that is not split, is side 0.
  while (count < 3 && is_split(0) != (count == 1)) {
    std::rotate(whole.corners.begin(), whole.corners.begin() + 1, whole.corners.end());
    std::rotate(whole.sides.begin(), whole.sides.begin() + 1, whole.sides.end());
    std::rotate(whole.curves.begin(), whole.curves.begin() + 1, whole.curves.end());
    std::rotate(whole.uv.begin(), whole.uv.begin() + 1, whole.uv.end());
  }
  const auto& corners = whole.corners;
  std::array<std::uint32_t, 3> midpoints{none, none, none};
  std::array<Vector2, 3> uv;
  for (std::size_t k = 0; k < 3; ++k) {
    midpoints[k] = side_states_[whole.sides[k]].midpoint;
    uv[k] = is_split(k) ? midpoint_uv(whole, k) : whole.uv[k];
  }
  const auto half = [&](std::size_t side, std::size_t corner) {
    return half_at(whole.sides[side], corners[corner]);
  };
  const std::uint32_t face = whole.face;
  const auto& curves = whole.curves;
  if (count == 1) {
    const std::uint32_t cut = add_inner_side(midpoints[0], corners[2]);
    replace(index, {{corners[0], midpoints[0], corners[2]},
                    {half(0, 0), cut, whole.sides[2]},
                    {curves[0], none, curves[2]},
                    {whole.uv[0], uv[0], whole.uv[2]},
                    face});
    add_triangle({{midpoints[0], corners[1], corners[2]},
                  {half(0, 1), whole.sides[1], cut},
                  {curves[0], curves[1], none},
                  {uv[0], whole.uv[1], whole.uv[2]},
                  face});
    return;
  }
  const std::uint32_t across = add_inner_side(midpoints[1], midpoints[2]);
  const Triangle at_last{{midpoints[1], corners[2], midpoints[2]},
                         {half(1, 2), half(2, 2), across},
                         {curves[1], curves[2], none},
                         {uv[1], whole.uv[2], uv[2]},
                         face};
  if (count == 3) {
    const std::uint32_t at_first = add_inner_side(midpoints[0], midpoints[2]);
    const std::uint32_t at_second = add_inner_side(midpoints[0], midpoints[1]);
    replace(index, {{corners[0], midpoints[0], midpoints[2]},
                    {half(0, 0), at_first, half(2, 0)},
                    {curves[0], none, curves[2]},
                    {whole.uv[0], uv[0], uv[2]},
                    face});
    add_triangle({{midpoints[0], corners[1], midpoints[1]},
                  {half(0, 1), half(1, 1), at_second},
                  {curves[0], curves[1], none},
                  {uv[0], whole.uv[1], uv[1]},
                  face});
    add_triangle({{midpoints[0], midpoints[1], midpoints[2]},
                  {at_second, across, at_first},
                  {none, none, none},
                  {uv[0], uv[1], uv[2]},
                  face});
    add_triangle(at_last);
    return;
  }
  // The quadrilateral beside side 0 is divided along its shorter diagonal.
  const double first_m = (vertices_m_[corners[0]] - vertices_m_[midpoints[1]]).norm();
  const double second_m = (vertices_m_[corners[1]] - vertices_m_[midpoints[2]]).norm();
  if (first_m <= second_m) {
    const std::uint32_t cut = add_inner_side(corners[0], midpoints[1]);
    replace(index, {{corners[0], corners[1], midpoints[1]},
                    {whole.sides[0], half(1, 1), cut},
                    {curves[0], curves[1], none},
                    {whole.uv[0], whole.uv[1], uv[1]},
                    face});
    add_triangle({{corners[0], midpoints[1], midpoints[2]},
                  {cut, across, half(2, 0)},
                  {none, none, curves[2]},
                  {whole.uv[0], uv[1], uv[2]},
                  face});
  } else {
    const std::uint32_t cut = add_inner_side(corners[1], midpoints[2]);
    replace(index, {{corners[0], corners[1], midpoints[2]},
                    {whole.sides[0], cut, half(2, 0)},
                    {curves[0], none, curves[2]},
                    {whole.uv[0], whole.uv[1], uv[2]},
                    face});
    add_triangle({{corners[1], midpoints[1], midpoints[2]},
                  {half(1, 1), across, cut},
                  {curves[1], none, none},
                  {whole.uv[1], uv[1], uv[2]},
                  face});
  }
  add_triangle(at_last);
}

void RefinableMesh::split_marked_sides() {
  for (std::uint32_t s = 0, count = static_cast<std::uint32_t>(sides_.size()); s < count; ++s) {
    if (side_states_[s].is_marked && side_states_[s].midpoint == none) split_side(s);
  }
  for (std::size_t t = 0, count = triangles_.size(); t < count; ++t) split_triangle(t);
}

Status RefinableMesh::refine(double chord_m, std::size_t triangle_limit) {
  SPOONBILL_ASSERT(chord_m > 0.0);
  for (int round = 0; round < round_limit; ++round) {
    if (triangles_.size() > triangle_limit) {
      return Error{ErrorCode::too_many, "its mesh needs more than " + std::to_string(triangle_limit) +
                                            " triangles; choose a larger --chord"};
    }
    measure();
    if (!mark_far_sides(chord_m) && !mark_sides_with_equal_vertices()) return {};
    split_marked_sides();
  }
  measure();
  return {};
}

double RefinableMesh::chord_error_m() const {
  double largest_m = 0.0;
  for (const double error_m : errors_m_) largest_m = std::max(largest_m, error_m);
  for (std::size_t s = 0; s < sides_.size(); ++s) {
    if (sides_[s].edge != none && side_states_[s].midpoint == none)
      largest_m = std::max(largest_m, side_states_[s].error_m);
  }
  return largest_m;
}

TriangleMesh RefinableMesh::release_mesh() {
  TriangleMesh mesh;
  mesh.vertices_m = std::move(vertices_m_);
  mesh.triangles.reserve(triangles_.size());
  for (const Triangle& triangle : triangles_) {
    mesh.triangles.push_back({triangle.corners[0], triangle.corners[1], triangle.corners[2]});
  }
  return mesh;
}

}  // namespace spoonbill
