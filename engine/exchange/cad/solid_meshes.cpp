// Meshes of the solids that are joined from a model's faces.
#include <BRepAdaptor_Curve.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Geom_Surface.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/containers.h"
#include "engine/base/text.h"
#include "engine/collision/meshes/triangle.h"
#include "engine/exchange/cad/cad.h"
#include "engine/exchange/cad/joined_faces.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/exchange/mesh_export/tessellation.h"

namespace spoonbill {
namespace {

struct ShapeMesh {
  TriangleMesh mesh;
  double chord_error_m = 0.0;  // see CadSolid::chord_error_m
};

// Largest angle between neighbouring triangles of a face, in radians.
constexpr double angle_limit = 0.5;
// initial_fraction is the deflection (OpenCASCADE's target for the chord error) of the first try, as a
// fraction of the requested chord error. It is below 1, because meshes may exceed their deflection. Each
// further try multiplies the deflection by a factor from smallest_step to initial_fraction.
constexpr double initial_fraction = 0.7, smallest_step = 0.2;
constexpr int try_limit = 6;
// Number of sampling intervals on a side of a triangle.
constexpr int side_parts = 3;

using Triangulation = opencascade::handle<Poly_Triangulation>;
using Chain = opencascade::handle<Poly_PolygonOnTriangulation>;

Vector3 to_metres(const gp_Pnt& at) {
  return Vector3(at.X(), at.Y(), at.Z()) / millimetres_per_metre;
}

struct MeshedFace {
  TopoDS_Face face;
  Triangulation triangulation;
  std::size_t first = 0;  // index of the face's first node among the nodes of all faces
};

// Nodes of an edge in the mesh of one face, and their parameters along the curve of the edge.
struct MeshedEdge {
  TopoDS_Edge edge;
  std::vector<std::size_t> nodes;
  std::vector<double> parameters;
};

MeshedEdge collect_edge(const MeshedFace& meshed, const TopoDS_Edge& edge, const Chain& chain) {
  MeshedEdge found{edge, {}, {}};
  for (int k = 1; k <= chain->NbNodes(); ++k) {
    found.nodes.push_back(meshed.first + static_cast<std::size_t>(chain->Nodes().Value(k)) - 1);
    if (chain->HasParameters()) found.parameters.push_back(chain->Parameters()->Value(k));
  }
  return found;
}

// Nodes of all faces of a meshed shape, and the edges that join them.
class MeshNodes {
 public:
  // Collects the nodes of a shape. Returns false if a face has no surface, or no triangles with parameters
  // (u, v).
  bool collect(const TopoDS_Shape& shape) {
    for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) {
      TopLoc_Location location;
      const TopoDS_Face& face = TopoDS::Face(each.Current());
      const Triangulation triangulation = BRep_Tool::Triangulation(face, location);
      if (triangulation.IsNull() || !triangulation->HasUVNodes() || !location.IsIdentity() ||
          BRep_Tool::Surface(face).IsNull()) {
        return false;
      }
      faces_.push_back({face, triangulation, points_.size()});
      for (int k = 1; k <= triangulation->NbNodes(); ++k) {
        points_.push_back(to_metres(triangulation->Node(k)));
      }
      add_edges(faces_.back());
    }
    return true;
  }

  std::size_t triangle_count() const {
    std::size_t count = 0;
    for (const MeshedFace& meshed : faces_) {
      count += static_cast<std::size_t>(meshed.triangulation->NbTriangles());
    }
    return count;
  }

  // Joins the nodes that two faces share. Returns false if an edge has more nodes in one face than in the
  // other.
  bool join(DisjointSets& unions) const {
    std::map<int, std::size_t> node_at_vertex;
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
        unions.join(node, node_at_vertex.try_emplace(vertex_index_.FindIndex(vertex), node).first->second);
      }
      // A degenerated edge is a pole, all of whose nodes are one point.
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
    TopTools_IndexedMapOfShape unique_edges;
    TopExp::MapShapes(meshed.face, TopAbs_EDGE, unique_edges);
    for (int k = 1; k <= unique_edges.Extent(); ++k) {
      const TopLoc_Location location;
      const TopoDS_Edge edge = TopoDS::Edge(unique_edges(k).Oriented(TopAbs_FORWARD));
      edge_index_.Add(edge);
      const Chain chain = BRep_Tool::PolygonOnTriangulation(edge, meshed.triangulation, location);
      if (!chain.IsNull()) edges_.push_back(collect_edge(meshed, edge, chain));
      if (!BRep_Tool::IsClosed(edge, meshed.face)) continue;
      const Chain reversed_chain =
          BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(edge.Reversed()), meshed.triangulation, location);
      if (!reversed_chain.IsNull()) edges_.push_back(collect_edge(meshed, edge, reversed_chain));
    }
  }

  std::vector<MeshedFace> faces_;
  std::vector<MeshedEdge> edges_;
  std::vector<Vector3> points_;
  TopTools_IndexedMapOfShape edge_index_, vertex_index_;
};

using Corners = std::array<std::size_t, 3>;

// Returns the nodes of a triangle, counter-clockwise in (u, v).
std::array<int, 3> triangle_nodes(const Triangulation& triangulation, int k) {
  std::array<int, 3> corners{};
  triangulation->Triangle(k).Get(corners[0], corners[1], corners[2]);
  return corners;
}

template <class Visit>
void visit_triangles(const MeshNodes& nodes, DisjointSets& unions, const Visit& visit) {
  for (const MeshedFace& meshed : nodes.faces()) {
    for (int k = 1; k <= meshed.triangulation->NbTriangles(); ++k) {
      const std::array<int, 3> local = triangle_nodes(meshed.triangulation, k);
      Corners joined{};
      for (std::size_t c = 0; c < 3; ++c) {
        joined[c] = unions.find(meshed.first + static_cast<std::size_t>(local[c]) - 1);
      }
      visit(meshed, local, joined);
    }
  }
}

TriangleMesh make_joined_mesh(const MeshNodes& nodes, DisjointSets& unions) {
  TriangleMesh mesh;
  std::map<std::size_t, std::uint32_t> index;
  visit_triangles(nodes, unions, [&](const MeshedFace& meshed, const std::array<int, 3>&, Corners corners) {
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return;
    if (meshed.face.Orientation() == TopAbs_REVERSED) std::swap(corners[1], corners[2]);
    TriangleCorners indices{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [found, is_new] =
          index.try_emplace(corners[c], static_cast<std::uint32_t>(mesh.vertices_m.size()));
      if (is_new) mesh.vertices_m.push_back(nodes.points()[corners[c]]);
      indices[c] = found->second;
    }
    mesh.triangles.push_back(indices);
  });
  return mesh;
}

bool is_watertight(const TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges, reversed_edges;
  for (const TriangleCorners& corners : mesh.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      edges.emplace_back(corners[c], corners[(c + 1) % 3]);
      reversed_edges.emplace_back(corners[(c + 1) % 3], corners[c]);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(reversed_edges.begin(), reversed_edges.end());
  return !edges.empty() && edges == reversed_edges &&
         std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

// Returns the largest distance in metres between a triangle and the surface, at samples in (u, v).
double triangle_error_m(const MeshedFace& meshed, const Geom_Surface& surface,
                        const std::array<int, 3>& local, const std::array<Vector3, 3>& corners) {
  std::array<gp_XY, 3> uv;
  for (std::size_t c = 0; c < 3; ++c) uv[c] = meshed.triangulation->UVNode(local[c]).XY();
  double largest = 0.0;
  for (int i = 0; i <= side_parts; ++i) {
    for (int j = 0; i + j <= side_parts; ++j) {
      const double a = static_cast<double>(i) / side_parts, b = static_cast<double>(j) / side_parts;
      const gp_XY at = uv[0] * (1.0 - a - b) + uv[1] * a + uv[2] * b;
      const Vector3 point = to_metres(surface.Value(at.X(), at.Y()));
      largest = std::max(
          largest, (nearest_on_triangle(corners[0], corners[1], corners[2], point).point - point).norm());
    }
  }
  return largest;
}

double distance_to_line_m(const Vector3& point, const Vector3& a, const Vector3& b) {
  const Vector3 along = b - a;
  const double length2 = along.squaredNorm();
  const double fraction = length2 > 0.0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (a + fraction * along - point).norm();
}

double edge_error_m(const MeshedEdge& one, const std::vector<Vector3>& points, DisjointSets& unions) {
  if (BRep_Tool::Degenerated(one.edge) || one.parameters.size() != one.nodes.size()) return 0.0;
  const BRepAdaptor_Curve curve(one.edge);
  double largest = 0.0;
  for (std::size_t k = 0; k + 1 < one.nodes.size(); ++k) {
    const Vector3 &a = points[unions.find(one.nodes[k])], &b = points[unions.find(one.nodes[k + 1])];
    for (int i = 1; i < side_parts; ++i) {
      const double fraction = static_cast<double>(i) / side_parts;
      const Vector3 point =
          to_metres(curve.Value(one.parameters[k] + fraction * (one.parameters[k + 1] - one.parameters[k])));
      largest = std::max(largest, distance_to_line_m(point, a, b));
    }
  }
  return largest;
}

double measure_chord_error_m(const MeshNodes& nodes, DisjointSets& unions) {
  double largest = 0.0;
  visit_triangles(
      nodes, unions, [&](const MeshedFace& meshed, const std::array<int, 3>& local, const Corners& joined) {
        const auto& points = nodes.points();
        largest =
            std::max(largest, triangle_error_m(meshed, *BRep_Tool::Surface(meshed.face), local,
                                               {points[joined[0]], points[joined[1]], points[joined[2]]}));
      });
  for (const MeshedEdge& edge : nodes.edges()) {
    largest = std::max(largest, edge_error_m(edge, nodes.points(), unions));
  }
  return largest;
}

Result<std::optional<ShapeMesh>> mesh_with_deflection(const TopoDS_Shape& shape, double deflection_m,
                                                      std::size_t triangle_limit) {
  BRepTools::Clean(shape);
  const BRepMesh_IncrementalMesh mesher(shape, deflection_m * millimetres_per_metre, false, angle_limit);
  MeshNodes nodes;
  if (!nodes.collect(shape)) return std::optional<ShapeMesh>();
  if (nodes.triangle_count() > triangle_limit) {
    return Error{ErrorCode::too_many, "its mesh needs more than " + std::to_string(triangle_limit) +
                                          " triangles; choose a larger --chord"};
  }
  DisjointSets unions(nodes.points().size());
  if (!nodes.join(unions)) return std::optional<ShapeMesh>();
  ShapeMesh found{make_joined_mesh(nodes, unions), 0.0};
  if (!is_watertight(found.mesh)) return std::optional<ShapeMesh>();
  found.chord_error_m = measure_chord_error_m(nodes, unions);
  return std::optional(std::move(found));
}

// Meshes a closed shape so that faces share the points of their edges. Each try has a smaller deflection. The
// tries end when samples of faces and edges are within the requested chord error plus `gap_m`, the widest gap
// between two faces. The gap is added, because a shared point cannot be on both faces. Returns the most
// accurate mesh found, or nullopt if none is watertight. Refused: more triangles than the limit before a
// watertight mesh is found.
Result<std::optional<ShapeMesh>> mesh_shape(const TopoDS_Shape& shape, const SolidMeshing& meshing,
                                            double gap_m) {
  std::optional<ShapeMesh> best;
  double deflection_m = initial_fraction * meshing.chord_m;
  for (int k = 0; k < try_limit; ++k) {
    auto found = mesh_with_deflection(shape, deflection_m, meshing.triangle_limit);
    if (!found && best) break;
    if (!found) return found.error();
    double step = initial_fraction;
    if (found.value()) {
      const double error_m = found.value()->chord_error_m;
      step = std::clamp(initial_fraction * meshing.chord_m / error_m, smallest_step, initial_fraction);
      if (!best || error_m < best->chord_error_m) best = std::move(found).value();
      if (error_m <= meshing.chord_m + gap_m) break;
    }
    deflection_m *= step;
  }
  BRepTools::Clean(shape);
  return best;
}

// Relative tolerance to which OpenCASCADE integrates volume and area; its default has an error of about 1 %.
constexpr double integration_tolerance = 1e-6;
// The volumes of mesh and solid may differ by volume_slack x area x chord error, plus integral_slack x volume
// for the error of integration. volume_slack is above 1, because narrow bends add to the difference.
constexpr double volume_slack = 2.0, integral_slack = 1e-3;

CadSolid measure_solid(const std::string& name, const JoinedSolid& joined) {
  CadSolid solid;
  solid.name = name;
  solid.gap_m = joined.gap_m;
  GProp_GProps volume, area;
  BRepGProp::VolumeProperties(joined.shape, volume, integration_tolerance);
  BRepGProp::SurfaceProperties(joined.shape, area, integration_tolerance);
  solid.volume_m3 = volume.Mass() / std::pow(millimetres_per_metre, 3);
  solid.area_m2 = area.Mass() / std::pow(millimetres_per_metre, 2);
  const gp_Pnt centre = volume.CentreOfMass();
  solid.centre_m = Vector3(centre.X(), centre.Y(), centre.Z()) / millimetres_per_metre;
  return solid;
}

// Mesher of the solids of a model, in the order of their first faces.
class SolidMesher {
 public:
  SolidMesher(const CadModel& model, const SolidMeshing& meshing) : model_(model), remaining_(meshing) {}

  // Adds the solid to which the surface `index` belongs, unless another face of this solid has added it. A
  // surface without a solid is loose.
  Status add(std::size_t index) {
    const std::string& name = model_.surfaces[index].solid;
    if (name.empty()) {
      result_.loose.push_back(index);
      return {};
    }
    return added_.insert(name).second ? add_solid(name) : Status();
  }

  CadSolids release_solids() {
    // A surface with faces in several solids is not loose if one of these solids has a mesh.
    std::set<std::size_t> loose(result_.loose.begin(), result_.loose.end());
    for (const CadSolid& solid : result_.solids) {
      for (const std::size_t index : solid.surface_indices) loose.erase(index);
    }
    result_.loose.assign(loose.begin(), loose.end());
    return std::move(result_);
  }

 private:
  Status add_solid(const std::string& name) {
    std::vector<const CadSurface*> parts;
    std::vector<std::size_t> indices;
    for (std::size_t k = 0; k < model_.surfaces.size(); ++k) {
      if (model_.surfaces[k].solid != name) continue;
      parts.push_back(&model_.surfaces[k]);
      indices.push_back(k);
    }
    const auto joined = join_faces(parts);
    if (!joined) {
      result_.notes.push_back("'" + name + "': " + joined.error().message);
      result_.loose.insert(result_.loose.end(), indices.begin(), indices.end());
      return {};
    }
    for (std::string& note : describe_joining(joined.value(), name, parts, "")) {
      result_.notes.push_back(std::move(note));
    }
    for (const std::size_t loose : joined->loose) result_.loose.push_back(indices[loose]);
    for (const JoinedSolid& solid : joined->solids) {
      if (Status added = add_joined(name, solid, indices); !added) return added;
    }
    return {};
  }

  Status add_joined(const std::string& name, const JoinedSolid& joined,
                    const std::vector<std::size_t>& indices) {
    CadSolid solid = measure_solid(name, joined);
    for (const std::size_t part : joined.parts) solid.surface_indices.push_back(indices[part]);
    auto found = mesh_shape(joined.shape, remaining_, joined.gap_m);
    if (!found) return found.error().in("'" + name + "'");
    if (!found.value() || !has_same_volume(found.value().value(), solid)) {
      result_.notes.push_back("OpenCASCADE cannot make a watertight mesh of '" + name + "'");
      result_.loose.insert(result_.loose.end(), solid.surface_indices.begin(), solid.surface_indices.end());
      return {};
    }
    solid.mesh = std::move(found.value()->mesh);
    solid.chord_error_m = found.value()->chord_error_m;
    remaining_.triangle_limit -= solid.mesh.triangles.size();
    result_.solids.push_back(std::move(solid));
    return {};
  }

  // Returns true if mesh and solid have nearly the same volume. A mesh that folds over itself has a different
  // volume.
  static bool has_same_volume(const ShapeMesh& found, const CadSolid& solid) {
    const double difference_m3 = enclosed_volume_m3(found.mesh) - solid.volume_m3;
    return std::abs(difference_m3) <=
           volume_slack * solid.area_m2 * found.chord_error_m + integral_slack * solid.volume_m3;
  }

  const CadModel& model_;
  SolidMeshing remaining_;
  CadSolids result_;
  std::set<std::string> added_;
};

Result<CadSolids> mesh_all_solids(const CadModel& model, const SolidMeshing& meshing,
                                  const Progress& progress) {
  SolidMesher mesher(model, meshing);
  for (std::size_t k = 0; k < model.surfaces.size(); ++k) {
    if (Status added = mesher.add(k); !added) return added.error();
    const double fraction = static_cast<double>(k + 1) / static_cast<double>(model.surfaces.size());
    if (!progress.report(fraction)) return Progress::stopped();
  }
  return mesher.release_solids();
}

}  // namespace

Result<CadSolids> mesh_solids(const CadModel& model, const SolidMeshing& meshing, const Progress& progress) {
  try {
    return mesh_all_solids(model, meshing, progress);
  } catch (const Standard_Failure& failure) {
    return Error{ErrorCode::unsupported,
                 std::string("OpenCASCADE failed to mesh the model (") + failure.DynamicType()->Name() + ")"};
  }
}

}  // namespace spoonbill
