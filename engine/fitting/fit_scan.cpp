#include "engine/fitting/fit_scan.h"

#include <algorithm>
#include <utility>

#include "engine/fitting/bridging.h"
#include "engine/fitting/islands.h"
#include "engine/fitting/profile_map.h"
#include "engine/fitting/shape_start.h"

namespace spoonbill {
namespace {

Vector3 extent_of(const std::vector<Vector3>& points_m) {
  Vector3 low = points_m.front(), high = low;
  for (const Vector3& point : points_m) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  return high - low;
}

Result<FittedBody> fit_from(FitPoints island, const Parameterisation& start, FitSettings settings,
                            const FitWatch& watch) {
  settings.watch = watch;
  auto fit = fit_surface(island, start, settings);
  if (!fit) return fit.error();
  FittedBody body;
  body.errors = measure_errors(fit.value(), island);
  body.surface = std::move(fit->surface);
  body.folds = std::move(fit->folds);
  body.kind = start.kind;
  body.size_m = extent_of(island.given_m);
  body.points_m = std::move(island.given_m);
  return body;
}

// A wall that is truly there brings its two faces much nearer than a surface in their middle.
bool nearer_as_wall(const FittedBody& wall, const FittedBody& face) {
  constexpr double share = 0.8;
  return wall.errors.data_to_surface.p95_m < share * face.errors.data_to_surface.p95_m;
}

Result<FittedBody> fit_from_profile(FitPoints island, Parameterisation start, const FitSettings& settings,
                                    const FitWatch& watch) {
  start.uv = take_points_as_nodes(island, start.uv);
  return fit_from(std::move(island), start, settings, watch);
}

Result<FittedBody> fit_from_kind(FitPoints island, const FitRequest& request, const FitWatch& watch) {
  if (request.islands == IslandChoice::bridge && island.spanning_nodes > 0 &&
      request.kind.value_or(ShapeKind::closed) != ShapeKind::closed) {
    return Error{"bridged islands make a closed body; leave --kind out"};
  }
  const auto start = first_parameters(island, request.kind.value_or(kind_of_shape(island)));
  if (!start) return start.error();
  return fit_from(std::move(island), start.value(), request.settings, watch);
}

Result<FittedBody> fit_island(FitPoints island, const FitRequest& request, const FitWatch& watch) {
  const bool may_be_closed = request.kind.value_or(ShapeKind::closed) == ShapeKind::closed;
  if (may_be_closed && !island.scan.has_normals()) {
    if (auto map = profile_map(island.scan.points_m)) {
      const bool is_doubtful = map->may_be_one_face && !request.kind;
      auto wall = fit_from_profile(island, std::move(map->start), request.settings, watch);
      if (!is_doubtful) return wall;
      auto face = fit_from_kind(std::move(island), request, watch);
      if (!wall) return face;
      return face && !nearer_as_wall(wall.value(), face.value()) ? std::move(face) : std::move(wall);
    }
  }
  return fit_from_kind(std::move(island), request, watch);
}

}  // namespace

Result<ScanFit> fit_scan(Scan scan, const FitRequest& request) {
  auto points = make_fit_points(std::move(scan));
  if (!points) return points.error();
  Islands islands = split_islands(points.value());
  ScanFit result;
  result.islands = islands.islands.size();
  result.joined = points->joined;
  result.outliers = points->outliers;
  result.turned_normals = points->turned_normals;
  result.dust = islands.dust_points;
  if (islands.islands.empty()) {
    return Error{"its points hang together nowhere; they are too few or too noisy"};
  }
  if (request.islands == IslandChoice::bridge && islands.islands.size() > 1) {
    auto whole = bridged(std::move(islands.islands));
    if (!whole) return whole.error();
    islands.islands.clear();
    islands.islands.push_back(std::move(whole).value());
  }
  if (request.islands == IslandChoice::largest) {
    for (std::size_t k = 1; k < islands.islands.size(); ++k) {
      result.other_islands += islands.islands[k].given_m.size();
    }
    islands.islands.resize(1);
  }
  const auto count = static_cast<double>(islands.islands.size());
  for (FitPoints& island : islands.islands) {
    const double done = static_cast<double>(result.bodies.size());
    const auto watch = [&](double share) {
      return !request.settings.watch || request.settings.watch((done + share) / count);
    };
    auto body = fit_island(std::move(island), request, watch);
    if (!body) return body.error();
    result.bodies.push_back(std::move(body).value());
  }
  return result;
}

}  // namespace spoonbill
