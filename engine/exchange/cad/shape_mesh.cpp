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
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/base/containers.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/cad/refinable_mesh.h"

namespace spoonbill {
namespace {

// Largest angle between neighbouring triangles of a face in OpenCASCADE's mesh, in radians.
constexpr double angle_limit = 0.5;
// Deflections of OpenCASCADE's meshes in the order in which they are tried, as fractions of the chord error.
// A mesh may have errors, such as a missing triangle, that a mesh of another deflection does not have.
constexpr double deflection_fractions[] = {1.0, 0.4, 2.5, 0.1};

using Triangulation = opencascade::handle<Poly_Triangulation>;
using Chain = opencascade::handle<Poly_PolygonOnTriangulation>;

// An edge of the shape in one face: its nodes in the face's triangulation, their parameters on the edge's
// curve, and the curve in the face's parameters.
struct EdgeInFace {
  TopoDS_Edge edge;
  std::uint32_t edge_index = 0, curve = 0;
  std::vector<int> nodes;  // numbers in the triangulation, from 1
  std::vector<double> parameters;
};

struct MeshedFace {
  TopoDS_Face face;
  Triangulation triangulation;
  std::size_t first = 0;  // index of the face's first node among the nodes of all faces
  std::vector<EdgeInFace> edges;
};

// A side of a triangle within its face: the numbers of its nodes, the smaller one first.
using FaceSide = std::pair<int, int>;

FaceSide sorted_pair(int a, int b) {
  return a < b ? FaceSide(a, b) : FaceSide(b, a);
}

// Builder of a RefinableMesh from the triangulations that OpenCASCADE has stored in a shape.
class MeshBuilder {
 public:
  // Returns nullopt if a face has no triangles with parameters (u, v), if two faces have different nodes on
  // their edge, or if the mesh is not closed.
  std::optional<RefinableMesh> build(const TopoDS_Shape& shape) {
    for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) {
      if (!collect(TopoDS::Face(each.Current()))) return std::nullopt;
    }
    DisjointSets nodes(node_count_);
    if (!join_nodes(nodes)) return std::nullopt;
    add_vertices(nodes);
    for (std::uint32_t f = 0; f < faces_.size(); ++f) add_sides(f);
    add_triangles();
    if (!mesh_.is_closed()) return std::nullopt;
    return std::move(mesh_);
  }

 private:
  bool collect(const TopoDS_Face& face) {
    TopLoc_Location location;
    const Triangulation triangulation = BRep_Tool::Triangulation(face, location);
    const opencascade::handle<Geom_Surface> surface = BRep_Tool::Surface(face);
    if (triangulation.IsNull() || !triangulation->HasUVNodes() || !location.IsIdentity() || surface.IsNull())
      return false;
    mesh_.add_face(GeomAdaptor_Surface(surface));
    faces_.push_back({face, triangulation, node_count_, {}});
    node_count_ += static_cast<std::size_t>(triangulation->NbNodes());
    TopTools_IndexedMapOfShape edges;
    TopExp::MapShapes(face, TopAbs_EDGE, edges);
    for (int k = 1; k <= edges.Extent(); ++k) {
      const TopoDS_Edge edge = TopoDS::Edge(edges(k).Oriented(TopAbs_FORWARD));
      if (!collect_edge(faces_.back(), edge)) return false;
      if (BRep_Tool::IsClosed(edge, face) && !collect_edge(faces_.back(), TopoDS::Edge(edge.Reversed())))
        return false;
    }
    return true;
  }

  bool collect_edge(MeshedFace& meshed, const TopoDS_Edge& edge) {
    const Chain chain = BRep_Tool::PolygonOnTriangulation(edge, meshed.triangulation, TopLoc_Location());
    if (chain.IsNull()) return true;
    EdgeInFace found;
    found.edge = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    const bool is_degenerated = BRep_Tool::Degenerated(edge);
    double first = 0.0, last = 0.0;
    const RefinableMesh::FaceCurve curve = BRep_Tool::CurveOnSurface(edge, meshed.face, first, last);
    if (!is_degenerated && (!chain->HasParameters() || curve.IsNull())) return false;
    for (int k = 1; k <= chain->NbNodes(); ++k) {
      found.nodes.push_back(chain->Nodes().Value(k));
      if (!is_degenerated) found.parameters.push_back(chain->Parameters()->Value(k));
    }
    if (!is_degenerated) {
      const int known = edge_index_.Extent();
      const int index = edge_index_.Add(found.edge);
      found.edge_index = static_cast<std::uint32_t>(index - 1);
      if (index > known) mesh_.add_edge(BRepAdaptor_Curve(found.edge));
      found.curve = mesh_.add_face_curve(curve);
    }
    meshed.edges.push_back(std::move(found));
    return true;
  }

  static std::size_t node_index(const MeshedFace& meshed, int number) {
    return meshed.first + static_cast<std::size_t>(number) - 1;
  }

  bool join_nodes(DisjointSets& nodes) {
    std::map<int, std::size_t> node_at_vertex;
    std::map<std::uint32_t, std::pair<const MeshedFace*, const EdgeInFace*>> known;
    TopTools_IndexedMapOfShape vertices;
    for (const MeshedFace& meshed : faces_) {
      for (const EdgeInFace& one : meshed.edges) {
        const std::pair<TopoDS_Vertex, int> ends[] = {{TopExp::FirstVertex(one.edge), one.nodes.front()},
                                                      {TopExp::LastVertex(one.edge), one.nodes.back()}};
        for (const auto& [vertex, number] : ends) {
          if (vertex.IsNull()) continue;
          const std::size_t node = node_index(meshed, number);
          nodes.join(node, node_at_vertex.try_emplace(vertices.Add(vertex), node).first->second);
        }
        // A degenerated edge is a pole, all of whose nodes are one point.
        if (one.parameters.empty()) {
          for (const int number : one.nodes)
            nodes.join(node_index(meshed, number), node_index(meshed, one.nodes.front()));
          continue;
        }
        const auto [other, is_new] = known.try_emplace(one.edge_index, &meshed, &one);
        const auto& [other_face, other_edge] = other->second;
        if (other_edge->nodes.size() != one.nodes.size()) return false;
        for (std::size_t k = 0; k < one.nodes.size(); ++k)
          nodes.join(node_index(meshed, one.nodes[k]), node_index(*other_face, other_edge->nodes[k]));
      }
    }
    return true;
  }

  void add_vertices(DisjointSets& nodes) {
    vertex_of_node_.resize(node_count_);
    for (const MeshedFace& meshed : faces_) {
      for (int number = 1; number <= meshed.triangulation->NbNodes(); ++number) {
        const std::size_t node = node_index(meshed, number), representative = nodes.find(node);
        if (representative != node) {
          vertex_of_node_[node] = vertex_of_node_[representative];
          continue;
        }
        const gp_Pnt at = meshed.triangulation->Node(number);
        vertex_of_node_[node] = mesh_.add_vertex(Vector3(at.X(), at.Y(), at.Z()) / millimetres_per_metre);
      }
    }
  }

  // Adds the sides of a face. Sides along an edge are shared by its faces.
  void add_sides(std::uint32_t face) {
    const MeshedFace& meshed = faces_[face];
    std::map<FaceSide, std::pair<std::uint32_t, std::uint32_t>> known;  // side and face curve
    const auto vertex = [&](int number) { return vertex_of_node_[node_index(meshed, number)]; };
    for (const EdgeInFace& one : meshed.edges) {
      if (one.parameters.empty()) continue;
      std::vector<std::uint32_t>& sides = sides_of_edge_[one.edge_index];
      for (std::size_t k = 0; k + 1 < one.nodes.size(); ++k) {
        if (sides.size() == k) {
          sides.push_back(add_side({{vertex(one.nodes[k]), vertex(one.nodes[k + 1])},
                                    one.edge_index,
                                    {one.parameters[k], one.parameters[k + 1]}}));
        }
        known[sorted_pair(one.nodes[k], one.nodes[k + 1])] = {sides[k], one.curve};
      }
    }
    for (int number = 1; number <= meshed.triangulation->NbTriangles(); ++number) {
      std::array<int, 3> nodes{};
      meshed.triangulation->Triangle(number).Get(nodes[0], nodes[1], nodes[2]);
      if (meshed.face.Orientation() == TopAbs_REVERSED) std::swap(nodes[1], nodes[2]);
      RefinableMesh::Triangle triangle;
      triangle.face = face;
      for (std::size_t k = 0; k < 3; ++k) {
        const int from = nodes[k], to = nodes[(k + 1) % 3];
        const gp_Pnt2d uv = meshed.triangulation->UVNode(from);
        triangle.corners[k] = vertex(from);
        triangle.uv[k] = Vector2(uv.X(), uv.Y());
        auto found = known.find(sorted_pair(from, to));
        if (found == known.end()) {
          const std::uint32_t side = add_side({{vertex(from), vertex(to)}, RefinableMesh::none, {}});
          found = known.emplace(sorted_pair(from, to), std::pair(side, RefinableMesh::none)).first;
        }
        std::tie(triangle.sides[k], triangle.curves[k]) = found->second;
      }
      triangles_.push_back(triangle);
    }
  }

  std::uint32_t add_side(const RefinableMesh::Side& side) {
    sides_.push_back(side);
    return static_cast<std::uint32_t>(sides_.size() - 1);
  }

  // Adds the triangles. One of which two corners are the same vertex has no area: it is left out, and its two
  // other sides become one.
  void add_triangles() {
    DisjointSets joined(sides_.size());
    const auto equal_corner = [](const RefinableMesh::Triangle& triangle) -> std::optional<std::size_t> {
      for (std::size_t k = 0; k < 3; ++k) {
        if (triangle.corners[k] == triangle.corners[(k + 1) % 3]) return k;
      }
      return std::nullopt;
    };
    for (const RefinableMesh::Triangle& triangle : triangles_) {
      if (const auto k = equal_corner(triangle))
        joined.join(triangle.sides[(*k + 1) % 3], triangle.sides[(*k + 2) % 3]);
    }
    std::map<std::size_t, std::uint32_t> used;
    for (RefinableMesh::Triangle& triangle : triangles_) {
      if (equal_corner(triangle)) continue;
      for (std::uint32_t& side : triangle.sides) {
        const std::size_t representative = joined.find(side);
        const auto [place, is_new] = used.try_emplace(representative, 0);
        if (is_new) place->second = mesh_.add_side(sides_[representative]);
        side = place->second;
      }
      mesh_.add_triangle(triangle);
    }
  }

  RefinableMesh mesh_;
  std::vector<MeshedFace> faces_;
  std::size_t node_count_ = 0;
  std::vector<std::uint32_t> vertex_of_node_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> sides_of_edge_;
  std::vector<RefinableMesh::Side> sides_;
  std::vector<RefinableMesh::Triangle> triangles_;
  TopTools_IndexedMapOfShape edge_index_;
};

std::optional<RefinableMesh> make_coarse_mesh(const TopoDS_Shape& shape, double deflection_m) {
  BRepTools::Clean(shape);
  const BRepMesh_IncrementalMesh mesher(shape, deflection_m * millimetres_per_metre, false, angle_limit);
  return MeshBuilder().build(shape);
}

}  // namespace

Result<std::optional<ShapeMesh>> mesh_shape(const TopoDS_Shape& shape, double chord_m,
                                            std::size_t triangle_limit) {
  std::optional<RefinableMesh> mesh;
  for (const double fraction : deflection_fractions) {
    mesh = make_coarse_mesh(shape, fraction * chord_m);
    if (mesh) break;
  }
  BRepTools::Clean(shape);
  if (!mesh) return std::optional<ShapeMesh>();
  if (Status refined = mesh->refine(chord_m, triangle_limit); !refined) return refined.error();
  const double error_m = mesh->chord_error_m();
  return std::optional(ShapeMesh{mesh->release_mesh(), error_m});
}

}  // namespace spoonbill
