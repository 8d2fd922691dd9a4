#include "engine/exchange/cad/approximation.h"

#include <Eigen/LU>
#include <GeomAdaptor_Surface.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/exchange/cad/occt_surface.h"
#include "engine/scene/scene.h"

namespace spoonbill {
namespace {

// Parameter at which two smooth parts of a patch meet, or at which the patch begins or ends. Derivatives up
// to order `continuity` agree across it.
struct PatchBreak {
  double parameter;
  int continuity;
};

struct PatchDirection {
  std::vector<PatchBreak> breaks;  // increasing, both ends of the domain included
  // True if the end of the patch meets its start, with the continuity of the first break. The approximation
  // is then periodic.
  bool closed = false;
};

struct Patch {
  PatchDirection u, v;
  std::function<Vector3(double u, double v)> at;  // position in metres
};

using PointRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int checks_per_piece = 8;
// Largest deviation at a checked point, as a fraction of the tolerance. It is below 1, so that points between
// two checks are within the tolerance too.
constexpr double allowed_fraction = 0.8;

// Number of equal knot spans between each two successive breaks of a direction.
using Pieces = std::vector<int>;

Pieces initial_pieces(const PatchDirection& direction, int degree) {
  const std::size_t count = direction.breaks.size() - 1;
  // Interpolation over a period with few knot spans is badly conditioned. A period therefore gets more than
  // twice as many spans as the degree.
  const int smallest =
      direction.closed ? (2 * degree + static_cast<int>(count)) / static_cast<int>(count) : 1;
  return Pieces(count, smallest);
}

std::vector<double> piece_ends(const PatchDirection& direction, const Pieces& pieces) {
  std::vector<double> ends;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const double from = direction.breaks[k].parameter, to = direction.breaks[k + 1].parameter;
    for (int i = 0; i < pieces[k]; ++i) ends.push_back(from + (to - from) * i / pieces[k]);
  }
  ends.push_back(direction.breaks.back().parameter);
  return ends;
}

Result<KnotVector> make_knots(const PatchDirection& direction, const Pieces& pieces, int degree) {
  std::vector<double> knots;
  const auto add = [&](double knot, int multiplicity) {
    knots.insert(knots.end(), static_cast<std::size_t>(multiplicity), knot);
  };
  const auto multiplicity = [&](int continuity) { return std::clamp(degree - continuity, 1, degree); };
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const double from = direction.breaks[k].parameter, to = direction.breaks[k + 1].parameter;
    add(from, k == 0 && !direction.closed ? degree + 1 : multiplicity(direction.breaks[k].continuity));
    for (int i = 1; i < pieces[k]; ++i) add(from + (to - from) * i / pieces[k], 1);
  }
  add(direction.breaks.back().parameter, direction.closed ? 1 : degree + 1);
  return direction.closed ? KnotVector::periodic(degree, std::move(knots))
                          : KnotVector::open(degree, std::move(knots));
}

// Returns points of the patch; each row holds the points at one u.
PointRows sample_patch(const Patch& patch, const std::vector<double>& u, const std::vector<double>& v) {
  PointRows points(static_cast<Eigen::Index>(u.size()), static_cast<Eigen::Index>(3 * v.size()));
  for (std::size_t i = 0; i < u.size(); ++i) {
    for (std::size_t j = 0; j < v.size(); ++j) {
      points.block<1, 3>(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(3 * j)) =
          patch.at(u[i], v[j]).transpose();
    }
  }
  return points;
}

// Returns the points transposed: each row holds the points at one v.
PointRows transpose_points(const PointRows& points) {
  const Eigen::Index rows = points.rows(), columns = points.cols() / 3;
  PointRows result(columns, 3 * rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) result.block<1, 3>(j, 3 * i) = points.block<1, 3>(i, 3 * j);
  }
  return result;
}

PointRows interpolate_rows(const KnotVector& knots, const std::vector<double>& parameters,
                           const PointRows& points) {
  return Eigen::PartialPivLU<Eigen::MatrixXd>(blending_matrix(knots, parameters, 0).dense()).solve(points);
}

Result<Surface> interpolate_patch(const Patch& patch, const KnotVector& u, const KnotVector& v) {
  const std::vector<double> at_u = greville_parameters(u), at_v = greville_parameters(v);
  const PointRows along_u = interpolate_rows(u, at_u, sample_patch(patch, at_u, at_v));
  const PointRows controls = transpose_points(interpolate_rows(v, at_v, transpose_points(along_u)));
  ControlNet net(u.control_point_count(), v.control_point_count());
  for (int i = 0; i < net.rows; ++i) {
    for (int j = 0; j < net.columns; ++j) net.set_point(i, j, controls.block<1, 3>(i, 3 * j).transpose());
  }
  return make_surface(u, v, std::move(net));
}

std::vector<double> check_parameters(const std::vector<double>& ends) {
  std::vector<double> parameters;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    for (int i = 0; i < checks_per_piece; ++i) {
      parameters.push_back(ends[k] + (ends[k + 1] - ends[k]) * i / checks_per_piece);
    }
  }
  parameters.push_back(ends.back());
  return parameters;
}

// Returns the distances in metres between patch and surface at equal parameters; NaN counts as infinite.
Eigen::MatrixXd distances(const Patch& patch, const Surface& surface, const std::vector<double>& u,
                          const std::vector<double>& v) {
  Eigen::MatrixXd result(static_cast<Eigen::Index>(u.size()), static_cast<Eigen::Index>(v.size()));
  for (std::size_t i = 0; i < u.size(); ++i) {
    for (std::size_t j = 0; j < v.size(); ++j) {
      const double distance = (patch.at(u[i], v[j]) - position(surface, u[i], v[j])).norm();
      result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          std::isfinite(distance) ? distance : std::numeric_limits<double>::infinity();
    }
  }
  return result;
}

// Returns the largest distance within each knot span. The rows of `distances` belong to increasing
// parameters; each span has checks_per_piece rows.
std::vector<double> piece_errors(const Eigen::MatrixXd& distances, std::size_t pieces) {
  std::vector<double> errors(pieces, 0.0);
  for (std::size_t k = 0; k < pieces; ++k) {
    const auto first = static_cast<Eigen::Index>(checks_per_piece * k);
    errors[k] = distances.middleRows(first, checks_per_piece + 1).maxCoeff();
  }
  return errors;
}

// Adds knot spans between two breaks where the error is too large. Returns true if any were added.
bool refine(const std::vector<double>& errors, double allowed_m, int degree, Pieces& pieces) {
  bool refined = false;
  std::size_t piece = 0;
  for (int& count : pieces) {
    double largest = 0.0;
    for (int i = 0; i < count; ++i) largest = std::max(largest, errors[piece++]);
    if (largest <= allowed_m) continue;
    // On a smooth patch, the error is proportional to the length of a knot span to the power of degree + 1.
    const double factor = std::pow(largest / allowed_m, 1.0 / (degree + 1));
    count = std::max(count + 1, static_cast<int>(std::ceil(count * std::clamp(factor, 1.1, 2.0))));
    refined = true;
  }
  return refined;
}

// Largest number of control points of an approximated surface in each direction, and altogether.
constexpr int direction_limit = 1000, point_limit = 200'000;

int count_control_points(const PatchDirection& direction, const Pieces& pieces, int degree) {
  const auto knots = make_knots(direction, pieces, degree);
  return knots ? knots->control_point_count() : direction_limit + 1;
}

// Approximates the patch by a surface of the given degree. Returns nullopt if too many control points would
// be needed, and an error if the patch is not finite.
Result<std::optional<PatchFit>> approximate_with_degree(const Patch& patch, double tolerance_m, int degree) {
  Pieces u_pieces = initial_pieces(patch.u, degree), v_pieces = initial_pieces(patch.v, degree);
  const double allowed_m = allowed_fraction * tolerance_m;
  for (;;) {
    const int rows = count_control_points(patch.u, u_pieces, degree);
    const int columns = count_control_points(patch.v, v_pieces, degree);
    if (std::max(rows, columns) > direction_limit || rows * columns > point_limit) {
      return std::optional<PatchFit>();
    }
    const auto u = make_knots(patch.u, u_pieces, degree), v = make_knots(patch.v, v_pieces, degree);
    if (!u) return u.error();
    if (!v) return v.error();
    auto surface = interpolate_patch(patch, u.value(), v.value());
    if (!surface) return surface.error();
    const std::vector<double> u_ends = piece_ends(patch.u, u_pieces);
    const std::vector<double> v_ends = piece_ends(patch.v, v_pieces);
    const std::vector<double> u_checks = check_parameters(u_ends), v_checks = check_parameters(v_ends);
    // At the Greville parameters of one direction, the error is due to the other direction alone.
    const Eigen::MatrixXd along_u =
        distances(patch, surface.value(), u_checks, greville_parameters(v.value()));
    const Eigen::MatrixXd along_v =
        distances(patch, surface.value(), greville_parameters(u.value()), v_checks);
    const bool refined_u =
        refine(piece_errors(along_u, u_ends.size() - 1), 0.5 * allowed_m, degree, u_pieces);
    const bool refined_v =
        refine(piece_errors(along_v.transpose(), v_ends.size() - 1), 0.5 * allowed_m, degree, v_pieces);
    if (refined_u || refined_v) continue;
    const Eigen::MatrixXd all = distances(patch, surface.value(), u_checks, v_checks);
    if (const double largest = all.maxCoeff(); largest <= allowed_m) {
      return std::optional(PatchFit{std::move(surface).value(), largest});
    }
    refine(piece_errors(all, u_ends.size() - 1), allowed_m, degree, u_pieces);
    refine(piece_errors(all.transpose(), v_ends.size() - 1), allowed_m, degree, v_pieces);
  }
}

Result<PatchFit> approximate(const Patch& patch, double tolerance_m) {
  SPOONBILL_ASSERT(patch.u.breaks.size() >= 2 && patch.v.breaks.size() >= 2);
  SPOONBILL_ASSERT(static_cast<bool>(patch.at));
  for (const int degree : {3, 5, 7}) {
    auto found = approximate_with_degree(patch, tolerance_m, degree);
    if (!found) return found.error();
    if (found.value()) return *std::move(found).value();
  }
  return Error{ErrorCode::too_many,
               "a tolerance of " + number_text(1e3 * tolerance_m) + " mm needs more than the " +
                   std::to_string(direction_limit) + " control points in one direction, or the " +
                   std::to_string(point_limit) +
                   " altogether, that an approximated surface may have; choose a larger tolerance"};
}

constexpr int lines_compared = 7;
constexpr double patch_coincidence_m = 1e-9;

struct Derivatives {
  Vector3 position, first, second;
};

// Direction u or v of a surface within a box of parameters. Derivatives are compared on a few lines of the
// surface that run in this direction.
class ParameterLine {
 public:
  ParameterLine(const GeomAdaptor_Surface& surface, const ParameterBox& box, bool along_u)
      : surface_(&surface), box_(box), along_u_(along_u) {}

  double start() const { return along_u_ ? box_.u_start : box_.v_start; }
  double end() const { return along_u_ ? box_.u_end : box_.v_end; }

  // Returns position and derivatives of the k-th line at a parameter.
  Derivatives at(double parameter, int k) const {
    const double fraction = (k + 0.5) / lines_compared;
    const double u = along_u_ ? parameter : box_.u_start + fraction * (box_.u_end - box_.u_start);
    const double v = along_u_ ? box_.v_start + fraction * (box_.v_end - box_.v_start) : parameter;
    gp_Pnt p;
    gp_Vec du, dv, duu, dvv, duv;
    surface_->D2(u, v, p, du, dv, duu, dvv, duv);
    const gp_Vec& first = along_u_ ? du : dv;
    const gp_Vec& second = along_u_ ? duu : dvv;
    return {{p.X(), p.Y(), p.Z()}, {first.X(), first.Y(), first.Z()}, {second.X(), second.Y(), second.Z()}};
  }

  std::vector<double> interval_ends() const {
    const int count = along_u_ ? surface_->NbUIntervals(GeomAbs_C3) : surface_->NbVIntervals(GeomAbs_C3);
    TColStd_Array1OfReal ends(1, count + 1);
    if (along_u_) {
      surface_->UIntervals(ends, GeomAbs_C3);
    } else {
      surface_->VIntervals(ends, GeomAbs_C3);
    }
    std::vector<double> inside{start()};
    const double smallest_length = 1e-7 * (end() - start());
    for (const double parameter : ends) {
      if (parameter > inside.back() + smallest_length && parameter < end() - smallest_length) {
        inside.push_back(parameter);
      }
    }
    inside.push_back(end());
    return inside;
  }

 private:
  const GeomAdaptor_Surface* surface_;
  ParameterBox box_;
  bool along_u_;
};

// Returns the highest order from 0 to 2 up to which derivatives just before `left` and just after `right`
// agree; -1 if the points differ.
int continuity_across(const ParameterLine& line, double left, double right, double scale) {
  const double step = 1e-9 * (line.end() - line.start());
  const double length = line.end() - line.start();
  int continuity = 2;
  for (int k = 0; k < lines_compared; ++k) {
    const Derivatives a = line.at(left - step, k), b = line.at(right + step, k);
    const double first = std::max(a.first.norm(), b.first.norm());
    const double second = std::max({a.second.norm(), b.second.norm(), first / length});
    if (scale * ((a.position - b.position).norm() - 2.0 * step * first) > patch_coincidence_m) return -1;
    if ((a.first - b.first).norm() > 1e-6 * first + 2.0 * step * second) continuity = 0;
    if ((a.second - b.second).norm() > 1e-4 * second) continuity = std::min(continuity, 1);
  }
  return continuity;
}

PatchDirection make_direction(const ParameterLine& line, double scale) {
  PatchDirection direction;
  const std::vector<double> ends = line.interval_ends();
  for (const double parameter : ends) direction.breaks.push_back({parameter, 2});
  for (std::size_t k = 1; k + 1 < ends.size(); ++k) {
    direction.breaks[k].continuity = std::max(0, continuity_across(line, ends[k], ends[k], scale));
  }
  // A direction along which every line is a single point is not closed.
  double largest_span = 0.0;
  for (int k = 0; k < lines_compared; ++k) {
    const Vector3 centre = line.at(0.5 * (line.start() + line.end()), k).position;
    largest_span = std::max(largest_span, scale * (centre - line.at(line.start(), k).position).norm());
  }
  const int seam = continuity_across(line, line.end(), line.start(), scale);
  direction.closed = seam >= 0 && largest_span > patch_coincidence_m;
  direction.breaks.front().continuity = std::max(0, seam);
  return direction;
}

}  // namespace

Result<PatchFit> approximate_patch(const opencascade::handle<Geom_Surface>& surface, const ParameterBox& box,
                                   double scale, double tolerance_m) {
  const GeomAdaptor_Surface adaptor(surface, box.u_start, box.u_end, box.v_start, box.v_end);
  Patch patch;
  patch.u = make_direction(ParameterLine(adaptor, box, true), scale);
  patch.v = make_direction(ParameterLine(adaptor, box, false), scale);
  patch.at = [&](double u, double v) -> Vector3 {
    const gp_Pnt point = surface->Value(u, v);
    return scale * Vector3(point.X(), point.Y(), point.Z());
  };
  return approximate(patch, tolerance_m);
}

}  // namespace spoonbill
