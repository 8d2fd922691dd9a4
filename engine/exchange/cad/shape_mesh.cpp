#include "engine/exchange/cad/shape_mesh.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Geom_Surface.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/text.h"
#include "engine/collision/meshes/triangle.h"
#include "engine/exchange/cad/occt_surface.h"

namespace spoonbill {
namespace {

// Radians that neighbouring triangles of a face may turn by, however small it is.
constexpr double largest_turn = 0.5;
// The mesher aims at its deflection and does not hold it.
constexpr double first_share = 0.7, least_step = 0.2;
constexpr int most_tries = 6;
// Of a triangle's sides, between samples of what lies over it.
constexpr int parts = 3;

using Triangulation = opencascade::handle<Poly_Triangulation>;
using Chain = opencascade::handle<Poly_PolygonOnTriangulation>;

Vector3 metres(const gp_Pnt& at) {
  return Vector3(at.X(), at.Y(), at.Z()) / millimetres_per_metre;
}

struct MeshedFace {
  TopoDS_Face face;
  Triangulation triangulation;
  std::size_t first = 0;  // of its nodes among those of all faces
};

// An edge as one face has it: its nodes, and where they are along its curve.
struct MeshedEdge {
  TopoDS_Edge edge;
  std::vector<std::size_t> nodes;
  std::vector<double> parameters;
};

MeshedEdge edge_of(const MeshedFace& meshed, const TopoDS_Edge& edge, const Chain& chain) {
  MeshedEdge found{edge, {}, {}};
  for (int k = 1; k <= chain->NbNodes(); ++k) {
    found.nodes.push_back(meshed.first + static_cast<std::size_t>(chain->Nodes().Value(k)) - 1);
    if (chain->HasParameters()) found.parameters.push_back(chain->Parameters()->Value(k));
  }
  return found;
}

// The nodes of all faces of a shape that the mesher has been over, and which of them are one.
class Nodes {
 public:
  // False where a face has no triangles.
  bool collect(const TopoDS_Shape& shape) {
    for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) {
      TopLoc_Location place;
      const TopoDS_Face& face = TopoDS::Face(each.Current());
      const Triangulation triangulation = BRep_Tool::Triangulation(face, place);
      if (triangulation.IsNull() || !triangulation->HasUVNodes() || !place.IsIdentity()) return false;
      faces_.push_back({face, triangulation, points_.size()});
      for (int k = 1; k <= triangulation->NbNodes(); ++k) {
        points_.push_back(metres(triangulation->Node(k)));
      }
      add_edges(faces_.back());
    }
    return true;
  }

  std::size_t triangles() const {
    std::size_t count = 0;
    for (const MeshedFace& meshed : faces_) {
      count += static_cast<std::size_t>(meshed.triangulation->NbTriangles());
    }
    return count;
  }

  // Where an edge has as many points in each of its faces.
  bool join(DisjointSets& unions) const {
    std::map<int, std::size_t> at_vertex;
    std::map<int, const MeshedEdge*> known;
    for (const MeshedEdge& one : edges_) {
      const auto [other, is_new] = known.try_emplace(edge_index_.FindIndex(one.edge), &one);
      if (other->second->nodes.size() != one.nodes.size()) return false;
      for (std::size_t k = 0; k < one.nodes.size(); ++k) unions.join(one.nodes[k], other->second->nodes[k]);
      const std::pair<TopoDS_Vertex, std::size_t> ends[] = {
          {TopExp::FirstVertex(one.edge), one.nodes.front()},
          {TopExp::LastVertex(one.edge), one.nodes.back()}};
      for (const auto& [vertex, node] : ends) {
        if (vertex.IsNull()) continue;
        unions.join(node, at_vertex.try_emplace(vertex_index_.FindIndex(vertex), node).first->second);
      }
      // A pole is one point, along whatever stands for it in (u, v).
      if (!BRep_Tool::Degenerated(one.edge)) continue;
      for (const std::size_t node : one.nodes) unions.join(node, one.nodes.front());
    }
    return true;
  }

  const std::vector<MeshedFace>& faces() const { return faces_; }
  const std::vector<MeshedEdge>& edges() const { return edges_; }
  const std::vector<Vector3>& points() const { return points_; }

 private:
  void add_edges(const MeshedFace& meshed) {
    TopExp::MapShapes(meshed.face, TopAbs_VERTEX, vertex_index_);
    TopTools_IndexedMapOfShape once;
    TopExp::MapShapes(meshed.face, TopAbs_EDGE, once);
    for (int k = 1; k <= once.Extent(); ++k) {
      const TopLoc_Location place;
      const TopoDS_Edge edge = TopoDS::Edge(once(k).Oriented(TopAbs_FORWARD));
      edge_index_.Add(edge);
      const Chain chain = BRep_Tool::PolygonOnTriangulation(edge, meshed.triangulation, place);
      if (!chain.IsNull()) edges_.push_back(edge_of(meshed, edge, chain));
      if (!BRep_Tool::IsClosed(edge, meshed.face)) continue;
      const Chain back =
          BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(edge.Reversed()), meshed.triangulation, place);
      if (!back.IsNull()) edges_.push_back(edge_of(meshed, edge, back));
    }
  }

  std::vector<MeshedFace> faces_;
  std::vector<MeshedEdge> edges_;
  std::vector<Vector3> points_;
  TopTools_IndexedMapOfShape edge_index_, vertex_index_;
};

using Corners = std::array<std::size_t, 3>;

// Counter-clockwise in (u, v).
std::array<int, 3> corners_of(const Triangulation& triangulation, int k) {
  std::array<int, 3> corners{};
  triangulation->Triangle(k).Get(corners[0], corners[1], corners[2]);
  return corners;
}

template <class Visit>
void visit_triangles(const Nodes& nodes, DisjointSets& unions, const Visit& visit) {
  for (const MeshedFace& meshed : nodes.faces()) {
    for (int k = 1; k <= meshed.triangulation->NbTriangles(); ++k) {
      const std::array<int, 3> local = corners_of(meshed.triangulation, k);
      Corners joined{};
      for (std::size_t c = 0; c < 3; ++c) {
        joined[c] = unions.find(meshed.first + static_cast<std::size_t>(local[c]) - 1);
      }
      visit(meshed, local, joined);
    }
  }
}

TriangleMesh joined_mesh(const Nodes& nodes, DisjointSets& unions) {
  TriangleMesh mesh;
  std::map<std::size_t, std::uint32_t> index;
  visit_triangles(nodes, unions, [&](const MeshedFace& meshed, const std::array<int, 3>&, Corners corners) {
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return;
    if (meshed.face.Orientation() == TopAbs_REVERSED) std::swap(corners[1], corners[2]);
    TriangleCorners places{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [place, is_new] =
          index.try_emplace(corners[c], static_cast<std::uint32_t>(mesh.vertices_m.size()));
      if (is_new) mesh.vertices_m.push_back(nodes.points()[corners[c]]);
      places[c] = place->second;
    }
    mesh.triangles.push_back(places);
  });
  return mesh;
}

bool is_watertight(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ways, back;
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      ways.emplace_back(corners[c], corners[(c + 1) % 3]);
      back.emplace_back(corners[(c + 1) % 3], corners[c]);
    }
  }
  std::sort(ways.begin(), ways.end());
  std::sort(back.begin(), back.end());
  return !ways.empty() && ways == back && std::adjacent_find(ways.begin(), ways.end()) == ways.end();
}

// Of samples over a triangle in (u, v), the farthest from the triangle in space.
double error_over(const MeshedFace& meshed, const Geom_Surface& surface, const std::array<int, 3>& local,
                  const std::array<Vector3, 3>& corners) {
  std::array<gp_XY, 3> uv;
  for (std::size_t c = 0; c < 3; ++c) uv[c] = meshed.triangulation->UVNode(local[c]).XY();
  double largest = 0.0;
  for (int i = 0; i <= parts; ++i) {
    for (int j = 0; i + j <= parts; ++j) {
      const double a = static_cast<double>(i) / parts, b = static_cast<double>(j) / parts;
      const gp_XY at = uv[0] * (1.0 - a - b) + uv[1] * a + uv[2] * b;
      const Vector3 point = metres(surface.Value(at.X(), at.Y()));
      largest = std::max(
          largest, (nearest_on_triangle(corners[0], corners[1], corners[2], point).point - point).norm());
    }
  }
  return largest;
}

double distance_to_line_m(const Vector3& point, const Vector3& a, const Vector3& b) {
  const Vector3 along = b - a;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (a + share * along - point).norm();
}

double error_along(const MeshedEdge& one, const std::vector<Vector3>& points, DisjointSets& unions) {
  if (BRep_Tool::Degenerated(one.edge) || one.parameters.size() != one.nodes.size()) return 0.0;
  const BRepAdaptor_Curve curve(one.edge);
  double largest = 0.0;
  for (std::size_t k = 0; k + 1 < one.nodes.size(); ++k) {
    const Vector3 &a = points[unions.find(one.nodes[k])], &b = points[unions.find(one.nodes[k + 1])];
    for (int i = 1; i < parts; ++i) {
      const double share = static_cast<double>(i) / parts;
      const Vector3 point =
          metres(curve.Value(one.parameters[k] + share * (one.parameters[k + 1] - one.parameters[k])));
      largest = std::max(largest, distance_to_line_m(point, a, b));
    }
  }
  return largest;
}

double error_of(const Nodes& nodes, DisjointSets& unions) {
  double largest = 0.0;
  visit_triangles(
      nodes, unions, [&](const MeshedFace& meshed, const std::array<int, 3>& local, const Corners& joined) {
        const auto& points = nodes.points();
        largest = std::max(largest, error_over(meshed, *BRep_Tool::Surface(meshed.face), local,
                                               {points[joined[0]], points[joined[1]], points[joined[2]]}));
      });
  for (const MeshedEdge& edge : nodes.edges()) {
    largest = std::max(largest, error_along(edge, nodes.points(), unions));
  }
  return largest;
}

Result<std::optional<ShapeMesh>> mesh_at(const TopoDS_Shape& shape, double deflection_m,
                                         std::size_t triangle_limit) {
  BRepTools::Clean(shape);
  const BRepMesh_IncrementalMesh mesher(shape, deflection_m * millimetres_per_metre, false, largest_turn);
  Nodes nodes;
  if (!nodes.collect(shape)) return std::optional<ShapeMesh>();
  if (nodes.triangles() > triangle_limit) {
    return Error{"its mesh would take more than " + std::to_string(triangle_limit) +
                 " triangles; choose a larger --chord"};
  }
  DisjointSets unions(nodes.points().size());
  if (!nodes.join(unions)) return std::optional<ShapeMesh>();
  ShapeMesh found{joined_mesh(nodes, unions), 0.0};
  if (!is_watertight(found.mesh)) return std::optional<ShapeMesh>();
  found.chord_error_m = error_of(nodes, unions);
  return std::optional(std::move(found));
}

}  // namespace

Result<std::optional<ShapeMesh>> shape_mesh(const TopoDS_Shape& shape, const SolidMeshing& meshing,
                                            double gap_m) {
  std::optional<ShapeMesh> best;
  double deflection_m = first_share * meshing.chord_m;
  for (int k = 0; k < most_tries; ++k) {
    auto found = mesh_at(shape, deflection_m, meshing.triangle_limit);
    if (!found && best) break;
    if (!found) return found.error();
    double step = first_share;
    if (found.value()) {
      const double error_m = found.value()->chord_error_m;
      step = std::clamp(first_share * meshing.chord_m / error_m, least_step, first_share);
      if (!best || error_m < best->chord_error_m) best = std::move(found).value();
      if (error_m <= meshing.chord_m + gap_m) break;
    }
    deflection_m *= step;
  }
  BRepTools::Clean(shape);
  return best;
}

}  // namespace spoonbill
