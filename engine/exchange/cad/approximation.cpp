#include "engine/exchange/cad/approximation.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/exchange/cad/closing.h"
#include "engine/scene/scene.h"

namespace spoonbill {
namespace {

using Points = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int checks_per_piece = 8;
// Of the tolerance, so that what lies between two checks is within it too.
constexpr double allowed_share = 0.8;

// Into how many equal pieces each smooth piece of a direction is cut.
using Pieces = std::vector<int>;

Pieces first_pieces(const PatchDirection& direction, int degree) {
  const std::size_t count = direction.breaks.size() - 1;
  // A period of fewer pieces than the degree interpolates badly.
  const int least = direction.closed ? (2 * degree + static_cast<int>(count)) / static_cast<int>(count) : 1;
  return Pieces(count, least);
}

std::vector<double> ends_of_pieces(const PatchDirection& direction, const Pieces& pieces) {
  std::vector<double> ends;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const double from = direction.breaks[k].parameter, to = direction.breaks[k + 1].parameter;
    for (int i = 0; i < pieces[k]; ++i) ends.push_back(from + (to - from) * i / pieces[k]);
  }
  ends.push_back(direction.breaks.back().parameter);
  return ends;
}

Result<KnotVector> knots_of(const PatchDirection& direction, const Pieces& pieces, int degree) {
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

// Points of the patch, those of one u in a row.
Points sampled(const Patch& patch, const std::vector<double>& u, const std::vector<double>& v) {
  Points points(static_cast<Eigen::Index>(u.size()), static_cast<Eigen::Index>(3 * v.size()));
  for (std::size_t i = 0; i < u.size(); ++i) {
    for (std::size_t j = 0; j < v.size(); ++j) {
      points.block<1, 3>(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(3 * j)) =
          patch.at(u[i], v[j]).transpose();
    }
  }
  return points;
}

// The same points, those of one v in a row.
Points turned(const Points& points) {
  const Eigen::Index rows = points.rows(), columns = points.cols() / 3;
  Points result(columns, 3 * rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) result.block<1, 3>(j, 3 * i) = points.block<1, 3>(i, 3 * j);
  }
  return result;
}

Points solved(const KnotVector& knots, const std::vector<double>& parameters, const Points& points) {
  return Eigen::PartialPivLU<Eigen::MatrixXd>(blending_matrix(knots, parameters, 0).dense()).solve(points);
}

Result<Surface> interpolated(const Patch& patch, const KnotVector& u, const KnotVector& v) {
  const std::vector<double> at_u = greville_parameters(u), at_v = greville_parameters(v);
  const Points along_u = solved(u, at_u, sampled(patch, at_u, at_v));
  const Points controls = turned(solved(v, at_v, turned(along_u)));
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

// Distances at equal parameters; NaN counts as infinite.
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

// What one direction alone leaves: errors[k] of the piece k.
std::vector<double> errors_of(const Eigen::MatrixXd& distances, std::size_t pieces) {
  std::vector<double> errors(pieces, 0.0);
  for (std::size_t k = 0; k < pieces; ++k) {
    const auto first = static_cast<Eigen::Index>(checks_per_piece * k);
    errors[k] = distances.middleRows(first, checks_per_piece + 1).maxCoeff();
  }
  return errors;
}

// Whether any smooth piece was cut further.
bool refine(const std::vector<double>& errors, double allowed_m, int degree, Pieces& pieces) {
  bool refined = false;
  std::size_t piece = 0;
  for (int& count : pieces) {
    double largest = 0.0;
    for (int i = 0; i < count; ++i) largest = std::max(largest, errors[piece++]);
    if (largest <= allowed_m) continue;
    // The error falls with the power degree + 1 of a piece's length where the patch is smooth.
    const double factor = std::pow(largest / allowed_m, 1.0 / (degree + 1));
    count = std::max(count + 1, static_cast<int>(std::ceil(count * std::clamp(factor, 1.1, 2.0))));
    refined = true;
  }
  return refined;
}

int control_points_of(const PatchDirection& direction, const Pieces& pieces, int degree) {
  const auto knots = knots_of(direction, pieces, degree);
  return knots ? knots->control_point_count() : control_point_count_range.high + 1;
}

// Nothing where it would take too many control points; the Error only of a patch that is none.
Result<std::optional<PatchFit>> approximate_of_degree(const Patch& patch, double tolerance_m, int degree) {
  Pieces u_pieces = first_pieces(patch.u, degree), v_pieces = first_pieces(patch.v, degree);
  const double allowed_m = allowed_share * tolerance_m;
  for (;;) {
    if (control_points_of(patch.u, u_pieces, degree) > control_point_count_range.high ||
        control_points_of(patch.v, v_pieces, degree) > control_point_count_range.high) {
      return std::optional<PatchFit>();
    }
    const auto u = knots_of(patch.u, u_pieces, degree), v = knots_of(patch.v, v_pieces, degree);
    if (!u) return u.error();
    if (!v) return v.error();
    auto surface = interpolated(patch, u.value(), v.value());
    if (!surface) return surface.error();
    const std::vector<double> u_ends = ends_of_pieces(patch.u, u_pieces);
    const std::vector<double> v_ends = ends_of_pieces(patch.v, v_pieces);
    const std::vector<double> u_checks = check_parameters(u_ends), v_checks = check_parameters(v_ends);
    // Where the other direction interpolates, what is left is this direction's own.
    const Eigen::MatrixXd along_u =
        distances(patch, surface.value(), u_checks, greville_parameters(v.value()));
    const Eigen::MatrixXd along_v =
        distances(patch, surface.value(), greville_parameters(u.value()), v_checks);
    const bool refined_u = refine(errors_of(along_u, u_ends.size() - 1), 0.5 * allowed_m, degree, u_pieces);
    const bool refined_v =
        refine(errors_of(along_v.transpose(), v_ends.size() - 1), 0.5 * allowed_m, degree, v_pieces);
    if (refined_u || refined_v) continue;
    const Eigen::MatrixXd all = distances(patch, surface.value(), u_checks, v_checks);
    if (const double largest = all.maxCoeff(); largest <= allowed_m) {
      return std::optional(PatchFit{std::move(surface).value(), largest});
    }
    refine(errors_of(all, u_ends.size() - 1), allowed_m, degree, u_pieces);
    refine(errors_of(all.transpose(), v_ends.size() - 1), allowed_m, degree, v_pieces);
  }
}

}  // namespace

Result<PatchFit> approximate(const Patch& patch, double tolerance_m) {
  SPOONBILL_ASSERT(patch.u.breaks.size() >= 2 && patch.v.breaks.size() >= 2);
  SPOONBILL_ASSERT(static_cast<bool>(patch.at));
  for (const int degree : {3, 5, 7}) {
    auto found = approximate_of_degree(patch, tolerance_m, degree);
    if (!found) return found.error();
    if (found.value()) return *std::move(found).value();
  }
  return Error{"a tolerance of " + number_text(1e3 * tolerance_m) + " mm would take more than the " +
               std::to_string(control_point_count_range.high) +
               " control points that a surface has in one direction; choose a larger one"};
}

}  // namespace spoonbill
