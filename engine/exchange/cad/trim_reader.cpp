#include "engine/exchange/cad/trim_reader.h"

#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/bspline/trimmed_area.h"
#include "engine/exchange/cad/occt_surface.h"

namespace spoonbill {
namespace {

using Point = Eigen::Vector2d;
// Control points of a cubic Bezier curve, and the part of an edge that it follows.
struct CubicPiece : std::array<Point, 4> {
  int edge = -1;                // index of the edge in its wire; -1 for a line across a gap
  double from = 0.0, to = 0.0;  // parameters of the edge at the ends of the piece
};

// Largest distance between loops and the file's curves, as a fraction of the domain. The first value is the
// default; a tight tolerance may require values down to the second.
constexpr double curve_fraction = 1e-6, smallest_curve_fraction = 1e-9;
// Largest gap between edges that is closed by moving their ends, as a fraction of the domain.
constexpr double meeting_fraction = 1e-3;
constexpr int halving_limit = 12;

Point to_point(const gp_Pnt2d& p) {
  return {p.X(), p.Y()};
}

Point evaluate(const CubicPiece& piece, double t) {
  const double s = 1.0 - t;
  return s * s * s * piece[0] + 3.0 * s * s * t * piece[1] + 3.0 * s * t * t * piece[2] +
         t * t * t * piece[3];
}

// Side lengths of a surface's domain, and the tolerance of curves over it as a fraction of these lengths.
struct CurveTolerance {
  Point lengths;
  double fraction;
};

CurveTolerance find_curve_tolerance(const Surface& surface, double tolerance_m) {
  const double fraction = tolerance_m / std::max(stretch_bound_m(surface), 1e-300);
  return {{surface.u.domain_length(), surface.v.domain_length()},
          std::clamp(fraction, smallest_curve_fraction, curve_fraction)};
}

// Fit of a curve by cubic pieces with the tangents of the curve (Hermite). Pieces are halved until they are
// within the tolerance.
class CurveFit {
 public:
  CurveFit(const Geom2dAdaptor_Curve& curve, const CurveTolerance& tolerance)
      : curve_(curve), tolerance_(tolerance) {
    add(curve.FirstParameter(), curve.LastParameter(), 0);
  }

  std::vector<CubicPiece> pieces;

 private:
  void add(double from, double to, int halvings) {
    gp_Pnt2d start, end;
    gp_Vec2d start_tangent, end_tangent;
    curve_.D1(from, start, start_tangent);
    curve_.D1(to, end, end_tangent);
    const double third = (to - from) / 3.0;
    const Point p = to_point(start), q = to_point(end);
    const CubicPiece piece{{p, p + third * Point(start_tangent.X(), start_tangent.Y()),
                            q - third * Point(end_tangent.X(), end_tangent.Y()), q},
                           -1,
                           from,
                           to};
    if (halvings < halving_limit && is_outside_tolerance(piece, from, to)) {
      const double midpoint = 0.5 * (from + to);
      add(from, midpoint, halvings + 1);
      add(midpoint, to, halvings + 1);
    } else {
      pieces.push_back(piece);
    }
  }

  bool is_outside_tolerance(const CubicPiece& piece, double from, double to) const {
    for (const double t : {0.2, 0.5, 0.8}) {
      const Point gap = (evaluate(piece, t) - to_point(curve_.Value(from + t * (to - from))))
                            .cwiseQuotient(tolerance_.lengths);
      if (!(gap.norm() <= tolerance_.fraction)) return true;
    }
    return false;
  }

  const Geom2dAdaptor_Curve& curve_;
  CurveTolerance tolerance_;
};

// Returns the cubic pieces of an edge in the direction of its wire. Empty if the edge has no curve over the
// surface.
std::vector<CubicPiece> fit_edge(const TopoDS_Edge& edge, const TopoDS_Face& face,
                                 const CurveTolerance& tolerance) {
  double first = 0.0, last = 0.0;
  const auto curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull() || !(last > first)) return {};
  const Geom2dAdaptor_Curve whole(curve, first, last);
  TColStd_Array1OfReal ends(1, whole.NbIntervals(GeomAbs_C2) + 1);
  whole.Intervals(ends, GeomAbs_C2);
  std::vector<CubicPiece> pieces;
  for (int k = ends.Lower(); k < ends.Upper(); ++k) {
    if (!(ends(k + 1) > ends(k))) continue;
    const Geom2dAdaptor_Curve part(curve, ends(k), ends(k + 1));
    const CurveFit fit(part, tolerance);
    pieces.insert(pieces.end(), fit.pieces.begin(), fit.pieces.end());
  }
  if (edge.Orientation() != TopAbs_REVERSED) return pieces;
  std::reverse(pieces.begin(), pieces.end());
  for (CubicPiece& piece : pieces) {
    std::reverse(piece.begin(), piece.end());
    std::swap(piece.from, piece.to);
  }
  return pieces;
}

CubicPiece line(const Point& from, const Point& to) {
  return {{from, (2.0 * from + to) / 3.0, (from + 2.0 * to) / 3.0, to}};
}

// Makes `next` begin at `end`. A small gap is closed by moving the start of `next`, a large gap by adding a
// line.
void join(const Point& end, const Point& lengths, std::vector<CubicPiece>& next) {
  const Point gap = end - next.front()[0];
  if (gap.cwiseQuotient(lengths).norm() <= meeting_fraction) {
    next.front()[0] += gap;
    next.front()[1] += gap;
  } else {
    next.insert(next.begin(), line(end, next.front()[0]));
  }
}

// Closed chain of cubic curves along the edges of a wire.
struct EdgeChain {
  std::vector<CubicPiece> pieces;
  std::vector<TopoDS_Edge> edges;
};

Result<EdgeChain> join_edges(const TopoDS_Wire& wire, const TopoDS_Face& face,
                             const CurveTolerance& tolerance) {
  int edges = 0, visited = 0;
  for (TopExp_Explorer every(wire, TopAbs_EDGE); every.More(); every.Next()) ++edges;
  EdgeChain result;
  std::vector<CubicPiece>& chain = result.pieces;
  for (BRepTools_WireExplorer explorer(wire, face); explorer.More(); explorer.Next(), ++visited) {
    std::vector<CubicPiece> pieces = fit_edge(explorer.Current(), face, tolerance);
    if (pieces.empty()) {
      return Error{ErrorCode::malformed, "an edge has no curve over the surface's parameters"};
    }
    for (CubicPiece& piece : pieces) piece.edge = visited;
    result.edges.push_back(explorer.Current());
    if (!chain.empty()) join(chain.back()[3], tolerance.lengths, pieces);
    chain.insert(chain.end(), pieces.begin(), pieces.end());
  }
  if (visited != edges) return Error{ErrorCode::mismatch, "its edges are not connected"};
  if (chain.empty()) return result;
  std::vector<CubicPiece> start = {line(chain.front()[0], chain.front()[0])};
  join(chain.back()[3], tolerance.lengths, start);
  if (start.size() > 1) chain.push_back(start.front());
  chain.back()[3] = chain.front()[0];
  return result;
}

// Distance beyond the domain that counts as rounding, as a fraction of the domain.
constexpr double rounding_fraction = 1e-10;
constexpr int bisections = 60;

double coordinate_at(const CubicPiece& piece, int axis, double t) {
  return evaluate(piece, t)[axis];
}

// Adds the parameters in (0, 1) at which a coordinate of the piece passes a level. Searches between the
// turning points of the coordinate.
void add_passages(const CubicPiece& piece, int axis, double level, std::vector<double>& at) {
  // Coefficients of the derivative, without the factor 3.
  const double d0 = piece[1][axis] - piece[0][axis], d1 = piece[2][axis] - piece[1][axis],
               d2 = piece[3][axis] - piece[2][axis];
  const double a = d0 - 2.0 * d1 + d2, b = d1 - d0, c = d0;
  std::vector<double> turns{0.0, 1.0};
  const double root = std::sqrt(std::max(b * b - a * c, 0.0));
  // This form of the quadratic formula avoids the cancellation of nearly equal numbers.
  const double q = -(b + std::copysign(root, b));
  for (const double turn : {q / a, c / q}) {
    if (turn > 0.0 && turn < 1.0) turns.push_back(turn);
  }
  std::sort(turns.begin(), turns.end());
  for (std::size_t k = 0; k + 1 < turns.size(); ++k) {
    double low = turns[k], high = turns[k + 1];
    const bool rises = coordinate_at(piece, axis, high) > level;
    if ((coordinate_at(piece, axis, low) > level) == rises) continue;
    for (int step = 0; step < bisections; ++step) {
      const double halfway = 0.5 * (low + high);
      ((coordinate_at(piece, axis, halfway) > level) == rises ? high : low) = halfway;
    }
    at.push_back(0.5 * (low + high));
  }
}

// Returns the part of a piece between two of its parameters.
CubicPiece part_of(const CubicPiece& piece, double from, double to) {
  const auto blossom = [&](double r, double s, double t) -> Point {
    std::array<Point, 4> points = piece;
    int count = 3;
    for (const double at : {r, s, t}) {
      for (int k = 0; k < count; ++k) points[k] = (1.0 - at) * points[k] + at * points[k + 1];
      --count;
    }
    return points[0];
  };
  CubicPiece part = piece;
  part[0] = blossom(from, from, from);
  part[1] = blossom(from, from, to);
  part[2] = blossom(from, to, to);
  part[3] = blossom(to, to, to);
  part.from = piece.from + from * (piece.to - piece.from);
  part.to = piece.from + to * (piece.to - piece.from);
  return part;
}

// Moves the parts of a curve that are beyond an end of an open direction to that end. A curve is first cut
// where it passes the end, because its control points may be outside while the curve is not.
std::vector<CubicPiece> clip(const std::vector<CubicPiece>& pieces, int axis, const KnotVector& knots) {
  if (knots.is_periodic()) return pieces;
  const double start = knots.domain_start(), end = knots.domain_end();
  const double slack = rounding_fraction * (end - start);
  std::vector<CubicPiece> clipped;
  for (const CubicPiece& piece : pieces) {
    std::vector<double> cuts{0.0, 1.0};
    const auto leaves = [&](const Point& p) { return p[axis] < start - slack || p[axis] > end + slack; };
    if (std::any_of(piece.begin(), piece.end(), leaves)) {
      add_passages(piece, axis, start, cuts);
      add_passages(piece, axis, end, cuts);
      std::sort(cuts.begin(), cuts.end());
    }
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      if (!(cuts[k + 1] - cuts[k] > 1e-12)) continue;
      CubicPiece part = part_of(piece, cuts[k], cuts[k + 1]);
      const double halfway = coordinate_at(part, axis, 0.5);
      if (halfway < start || halfway > end) {
        for (Point& point : part) point[axis] = std::clamp(halfway, start, end);
      }
      for (const std::size_t tip : {0, 3}) part[tip][axis] = std::clamp(part[tip][axis], start, end);
      clipped.push_back(part);
    }
  }
  return clipped;
}

Result<TrimLoop> make_loop(const std::vector<CubicPiece>& chain, const KnotVector& along_u,
                           const KnotVector& along_v) {
  std::vector<double> knots(4, 0.0), u, v;
  const auto add = [&](const Point& point) {
    u.push_back(point.x());
    v.push_back(point.y());
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

constexpr int samples_per_piece = 8, nearest_steps = 8;
// A sample counts as the end of an edge if its parameter is nearer to the end than this fraction of the
// edge's range.
constexpr double end_fraction = 1e-9;

// Returns the distance of a point from an edge's curve, in the unit of the face. Gauss-Newton steps search
// for the nearest point of the curve, starting from the parameter `at`.
double distance_to_edge(const gp_Pnt& point, const Geom_Curve& curve, double first, double last, double at) {
  double nearest = 1e300;
  for (int step = 0; step < nearest_steps; ++step) {
    gp_Pnt there;
    gp_Vec tangent;
    curve.D1(at, there, tangent);
    nearest = std::min(nearest, point.Distance(there));
    const double length2 = tangent.SquareMagnitude();
    if (!(length2 > 0.0)) break;
    const double next = std::clamp(at + gp_Vec(there, point).Dot(tangent) / length2, first, last);
    if (std::abs(next - at) <= 1e-12 * (last - first)) break;
    at = next;
  }
  return nearest;
}

// Returns the largest distance between the pieces of a chain and the 3D curves of their edges, in the unit of
// the face. The pieces are sampled. A sample at an end of an edge is compared with that end; any other sample
// is compared with the nearest point of the curve. `place` returns the point of the surface at a parameter.
template <class Place>
double measure_chain(const EdgeChain& chain, const Place& place) {
  double largest = 0.0;
  for (std::size_t e = 0; e < chain.edges.size(); ++e) {
    double first = 0.0, last = 0.0;
    const auto curve = BRep_Tool::Curve(chain.edges[e], first, last);
    if (curve.IsNull()) continue;  // the edge is a pole
    for (const CubicPiece& piece : chain.pieces) {
      if (piece.edge != static_cast<int>(e)) continue;
      for (int k = 0; k <= samples_per_piece; ++k) {
        const double t = static_cast<double>(k) / samples_per_piece;
        const double at = std::clamp(piece.from + t * (piece.to - piece.from), first, last);
        const gp_Pnt point = place(evaluate(piece, t));
        const bool is_end = std::min(at - first, last - at) <= end_fraction * (last - first);
        const double apart =
            is_end ? point.Distance(curve->Value(at)) : distance_to_edge(point, *curve, first, last, at);
        if (std::isfinite(apart)) largest = std::max(largest, apart);
      }
    }
  }
  return largest;
}

double domain_area(const KnotVector& along_u, const KnotVector& along_v) {
  return along_u.domain_length() * along_v.domain_length();
}

// Orients the largest loop counter-clockwise and the others clockwise, because some systems orient wires
// against the normal of their face. The knots of a loop are symmetric, so it is enough to reverse the control
// points.
std::vector<TrimLoop> orient_loops(std::vector<TrimLoop> loops, const KnotVector& along_u,
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

gp_Pnt place_on(const Surface& surface, const Point& at, double scale) {
  const Vector3 point = position(surface, at.x(), at.y()) / scale;
  return {point.x(), point.y(), point.z()};
}

}  // namespace

Result<FaceTrims> read_trim_loops(const TopoDS_Face& face, const Surface& surface, double scale,
                                  double tolerance_m) {
  const TopoDS_Face forward = TopoDS::Face(face.Oriented(TopAbs_FORWARD));
  const KnotVector &along_u = surface.u, &along_v = surface.v;
  const CurveTolerance tolerance = find_curve_tolerance(surface, tolerance_m);
  FaceTrims trims;
  std::vector<TrimLoop>& loops = trims.loops;
  for (TopExp_Explorer wires(forward, TopAbs_WIRE); wires.More(); wires.Next()) {
    auto chain = join_edges(TopoDS::Wire(wires.Current()), forward, tolerance);
    if (!chain) return chain.error();
    if (chain->pieces.empty()) continue;
    chain->pieces = clip(clip(chain->pieces, 0, along_u), 1, along_v);
    const double apart =
        measure_chain(chain.value(), [&](const Point& at) { return place_on(surface, at, scale); });
    trims.deviation_m = std::max(trims.deviation_m, apart * scale);
    auto loop = make_loop(chain->pieces, along_u, along_v);
    if (!loop) return loop.error();
    const double area = std::abs(signed_area(to_polygon(loop.value(), along_u, along_v)));
    if (area > (1.0 - curve_fraction) * domain_area(along_u, along_v)) continue;
    loops.push_back(std::move(loop).value());
  }
  if (TrimmedArea::make(along_u, along_v, loops)) return trims;
  loops = orient_loops(std::move(loops), along_u, along_v);
  if (const auto area = TrimmedArea::make(along_u, along_v, loops); !area) return area.error();
  return trims;
}

double measure_sides(const TopoDS_Face& face, const Surface& surface, double scale, double tolerance_m) {
  const TopoDS_Face forward = TopoDS::Face(face.Oriented(TopAbs_FORWARD));
  const CurveTolerance tolerance = find_curve_tolerance(surface, tolerance_m);
  const double u_start = surface.u.domain_start(), u_end = surface.u.domain_end();
  const double v_start = surface.v.domain_start(), v_end = surface.v.domain_end();
  // Projects the parameters onto each of the four sides of the domain and returns the nearest of the four
  // points. Each sample of an edge is near one of the sides.
  const auto place = [&](const Point& at) {
    const gp_Pnt point = place_on(surface, at, scale);
    gp_Pnt nearest = point;
    double shortest = 1e300;
    for (const Point& side :
         {Point(u_start, at.y()), Point(u_end, at.y()), Point(at.x(), v_start), Point(at.x(), v_end)}) {
      const gp_Pnt there = place_on(surface, side, scale);
      if (!(there.Distance(point) < shortest)) continue;
      shortest = there.Distance(point);
      nearest = there;
    }
    return nearest;
  };
  double largest_m = 0.0;
  for (TopExp_Explorer wires(forward, TopAbs_WIRE); wires.More(); wires.Next()) {
    const auto chain = join_edges(TopoDS::Wire(wires.Current()), forward, tolerance);
    if (chain) largest_m = std::max(largest_m, scale * measure_chain(chain.value(), place));
  }
  return largest_m;
}

}  // namespace spoonbill
