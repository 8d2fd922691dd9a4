#include "engine/exchange/cad/trim_reader.h"

#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Geom2d_Curve.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"

namespace spoonbill {
namespace {

using Point = Eigen::Vector2d;
// The control points of a cubic Bezier curve.
using Piece = std::array<Point, 4>;

// Shares of the domain: how near loops are to the file's curves, at most and where the tolerance asks for it.
constexpr double curve_share = 1e-6, nearest_curve_share = 1e-9;
// How far edges that meet may miss each other and are moved together.
constexpr double meeting_share = 1e-3;
constexpr int most_halvings = 12;

Point point_of(const gp_Pnt2d& p) {
  return {p.X(), p.Y()};
}

Point at(const Piece& piece, double t) {
  const double s = 1.0 - t;
  return s * s * s * piece[0] + 3.0 * s * s * t * piece[1] + 3.0 * s * t * t * piece[2] +
         t * t * t * piece[3];
}

// The domain of a surface, and how near curves over it must be.
struct Nearness {
  Point lengths;
  double share;
};

Nearness nearness_on(const Surface& surface, double tolerance_m) {
  const double share = tolerance_m / std::max(stretch_bound_m(surface), 1e-300);
  return {
      {surface.u.domain_end() - surface.u.domain_start(), surface.v.domain_end() - surface.v.domain_start()},
      std::clamp(share, nearest_curve_share, curve_share)};
}

// The curve from one end of the adaptor to the other as cubic pieces that share its tangents (Hermite).
class Fit {
 public:
  Fit(const Geom2dAdaptor_Curve& curve, const Nearness& near) : curve_(curve), near_(near) {
    add(curve.FirstParameter(), curve.LastParameter(), 0);
  }

  std::vector<Piece> pieces;

 private:
  void add(double from, double to, int halvings) {
    gp_Pnt2d start, end;
    gp_Vec2d start_tangent, end_tangent;
    curve_.D1(from, start, start_tangent);
    curve_.D1(to, end, end_tangent);
    const double third = (to - from) / 3.0;
    const Point p = point_of(start), q = point_of(end);
    const Piece piece{p, p + third * Point(start_tangent.X(), start_tangent.Y()),
                      q - third * Point(end_tangent.X(), end_tangent.Y()), q};
    if (halvings < most_halvings && misses(piece, from, to)) {
      const double middle = 0.5 * (from + to);
      add(from, middle, halvings + 1);
      add(middle, to, halvings + 1);
    } else {
      pieces.push_back(piece);
    }
  }

  bool misses(const Piece& piece, double from, double to) const {
    for (const double t : {0.2, 0.5, 0.8}) {
      const Point gap =
          (at(piece, t) - point_of(curve_.Value(from + t * (to - from)))).cwiseQuotient(near_.lengths);
      if (!(gap.norm() <= near_.share)) return true;
    }
    return false;
  }

  const Geom2dAdaptor_Curve& curve_;
  Nearness near_;
};

// Over the smooth pieces of the edge's curve, in the direction of its wire.
std::vector<Piece> pieces_of(const TopoDS_Edge& edge, const TopoDS_Face& face, const Nearness& near) {
  double first = 0.0, last = 0.0;
  const auto curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull() || !(last > first)) return {};
  const Geom2dAdaptor_Curve whole(curve, first, last);
  TColStd_Array1OfReal ends(1, whole.NbIntervals(GeomAbs_C2) + 1);
  whole.Intervals(ends, GeomAbs_C2);
  std::vector<Piece> pieces;
  for (int k = ends.Lower(); k < ends.Upper(); ++k) {
    if (!(ends(k + 1) > ends(k))) continue;
    const Geom2dAdaptor_Curve part(curve, ends(k), ends(k + 1));
    const Fit fit(part, near);
    pieces.insert(pieces.end(), fit.pieces.begin(), fit.pieces.end());
  }
  if (edge.Orientation() != TopAbs_REVERSED) return pieces;
  std::reverse(pieces.begin(), pieces.end());
  for (Piece& piece : pieces) std::reverse(piece.begin(), piece.end());
  return pieces;
}

Piece line(const Point& from, const Point& to) {
  return {from, (2.0 * from + to) / 3.0, (from + 2.0 * to) / 3.0, to};
}

// Lets `next` begin where `end` is: moved there where that is near, led there where it is not.
void join(const Point& end, const Point& lengths, std::vector<Piece>& next) {
  const Point gap = end - next.front()[0];
  if (gap.cwiseQuotient(lengths).norm() <= meeting_share) {
    next.front()[0] += gap;
    next.front()[1] += gap;
  } else {
    next.insert(next.begin(), line(end, next.front()[0]));
  }
}

Result<std::vector<Piece>> chain_of(const TopoDS_Wire& wire, const TopoDS_Face& face, const Nearness& near) {
  int edges = 0, visited = 0;
  for (TopExp_Explorer every(wire, TopAbs_EDGE); every.More(); every.Next()) ++edges;
  std::vector<Piece> chain;
  for (BRepTools_WireExplorer explorer(wire, face); explorer.More(); explorer.Next(), ++visited) {
    std::vector<Piece> pieces = pieces_of(explorer.Current(), face, near);
    if (pieces.empty()) return Error{"an edge has no curve over the surface's parameters"};
    if (!chain.empty()) join(chain.back()[3], near.lengths, pieces);
    chain.insert(chain.end(), pieces.begin(), pieces.end());
  }
  if (visited != edges) return Error{"its edges do not hang together"};
  if (chain.empty()) return chain;
  std::vector<Piece> start = {line(chain.front()[0], chain.front()[0])};
  join(chain.back()[3], near.lengths, start);
  if (start.size() > 1) chain.push_back(start.front());
  chain.back()[3] = chain.front()[0];
  return chain;
}

Result<TrimLoop> loop_of(const std::vector<Piece>& chain, const KnotVector& along_u,
                         const KnotVector& along_v) {
  std::vector<double> knots(4, 0.0), u, v;
  const auto add = [&](const Point& point) {
    // A curve may leave an open domain by rounding.
    u.push_back(along_u.is_periodic() ? point.x() : along_u.into_domain(point.x()));
    v.push_back(along_v.is_periodic() ? point.y() : along_v.into_domain(point.y()));
  };
  add(chain.front()[0]);
  for (std::size_t k = 0; k < chain.size(); ++k) {
    for (std::size_t i = 1; i < 4; ++i) add(chain[k][i]);
    const bool is_last = k + 1 == chain.size();
    knots.insert(knots.end(), is_last ? 4 : 3, static_cast<double>(k + 1));
  }
  auto along = KnotVector::open(3, std::move(knots));
  if (!along) return along.error();
  return make_trim_loop(along_u, along_v, std::move(along).value(), std::move(u), std::move(v));
}

double domain_area(const KnotVector& along_u, const KnotVector& along_v) {
  return (along_u.domain_end() - along_u.domain_start()) * (along_v.domain_end() - along_v.domain_start());
}

// Some systems turn the wires of a face against its normal: then the largest loop tells. The knots of a chain
// of pieces are the same backwards.
std::vector<TrimLoop> turned_right(std::vector<TrimLoop> loops, const KnotVector& along_u,
                                   const KnotVector& along_v) {
  std::vector<double> areas;
  areas.reserve(loops.size());
  for (const TrimLoop& loop : loops) areas.push_back(signed_area(to_polygon(loop, along_u, along_v)));
  const auto largest = std::max_element(areas.begin(), areas.end(),
                                        [](double a, double b) { return std::abs(a) < std::abs(b); });
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const bool outer = areas.begin() + static_cast<std::ptrdiff_t>(k) == largest;
    if ((areas[k] > 0.0) == outer) continue;
    std::reverse(loops[k].u.begin(), loops[k].u.end());
    std::reverse(loops[k].v.begin(), loops[k].v.end());
  }
  return loops;
}

}  // namespace

Result<std::vector<TrimLoop>> trims_of(const TopoDS_Face& face, const Surface& surface, double tolerance_m) {
  const TopoDS_Face forward = TopoDS::Face(face.Oriented(TopAbs_FORWARD));
  const KnotVector &along_u = surface.u, &along_v = surface.v;
  const Nearness near = nearness_on(surface, tolerance_m);
  std::vector<TrimLoop> loops;
  for (TopExp_Explorer wires(forward, TopAbs_WIRE); wires.More(); wires.Next()) {
    const auto chain = chain_of(TopoDS::Wire(wires.Current()), forward, near);
    if (!chain) return chain.error();
    if (chain->empty()) continue;
    auto loop = loop_of(chain.value(), along_u, along_v);
    if (!loop) return loop.error();
    const double area = std::abs(signed_area(to_polygon(loop.value(), along_u, along_v)));
    if (area > (1.0 - curve_share) * domain_area(along_u, along_v)) continue;
    loops.push_back(std::move(loop).value());
  }
  if (TrimmedArea::make(along_u, along_v, loops)) return loops;
  loops = turned_right(std::move(loops), along_u, along_v);
  if (const auto area = TrimmedArea::make(along_u, along_v, loops); !area) return area.error();
  return loops;
}

}  // namespace spoonbill
