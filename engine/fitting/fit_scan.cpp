#include "engine/fitting/fit_scan.h"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/fitting/bridging.h"
#include "engine/fitting/islands.h"
#include "engine/fitting/parameterisation.h"

namespace spoonbill {
namespace {

// Smallest number of points of a cloud: a component needs at least 30 nodes, and each node three points.
constexpr std::size_t least_cloud_points = 90;

IslandChoice island_choice(const FitRequest& request) {
  return request.islands.value_or(IslandChoice::largest);
}

Result<FittedBody> fit_body(FitPoints island, const Parameterisation& start, FitSettings settings,
                            const Progress& progress) {
  settings.progress = progress;
  auto fit = fit_surface(island, start, settings);
  if (!fit) return fit.error();
  FittedBody body;
  body.errors = measure_errors(fit.value(), island);
  body.surface = std::move(fit->surface);
  body.folds = std::move(fit->folds);
  body.kind = start.kind;
  body.size_m = box_about(island.given_m).extent();
  body.points_m = std::move(island.given_m);
  return body;
}

// Returns true if the points belong to a thin wall with two faces. The error of a fit to both faces is then
// at least 20 % smaller than the error of a single surface between the faces.
bool is_closer_as_wall(const FittedBody& wall, const FittedBody& face) {
  constexpr double fraction = 0.8;
  return wall.errors.data_to_surface.p95_m < fraction * face.errors.data_to_surface.p95_m;
}

Result<FittedBody> fit_from_profile(FitPoints island, Parameterisation start, const FitSettings& settings,
                                    const Progress& progress) {
  start.uv = use_points_as_nodes(island, start.uv);
  return fit_body(std::move(island), start, settings, progress);
}

Result<FittedBody> fit_from_kind(FitPoints island, const FitRequest& request, const Progress& progress) {
  if (island_choice(request) == IslandChoice::bridge && island.spanning_nodes > 0 &&
      request.kind.value_or(ShapeKind::closed) != ShapeKind::closed) {
    return Error(ErrorCode::inconsistent, "bridged islands make a closed body; leave --kind out", "kind");
  }
  const auto start = initial_parameterisation(island, request.kind.value_or(classify_shape(island)));
  if (!start) return start.error();
  return fit_body(std::move(island), start.value(), request.settings, progress);
}

Result<FittedBody> fit_island(FitPoints island, const FitRequest& request, const Progress& progress) {
  const bool may_be_closed = request.kind.value_or(ShapeKind::closed) == ShapeKind::closed;
  if (may_be_closed && !island.scan.has_normals()) {
    if (auto map = map_profile(island.scan.points_m)) {
      const bool is_doubtful = map->may_be_one_face && !request.kind;
      auto wall = fit_from_profile(island, std::move(map->start), request.settings, progress);
      if (!is_doubtful) return wall;
      auto face = fit_from_kind(std::move(island), request, progress);
      if (!wall) return face;
      return face && !is_closer_as_wall(wall.value(), face.value()) ? std::move(face) : std::move(wall);
    }
  }
  return fit_from_kind(std::move(island), request, progress);
}

Status choose_islands(std::vector<FitPoints>& islands, IslandChoice choice, ScanFit& result) {
  if (choice == IslandChoice::bridge && islands.size() > 1) {
    result.open_bridged = count_open_islands(islands);
    auto whole = bridge_islands(std::move(islands));
    if (!whole) return whole.error();
    islands.clear();
    islands.push_back(std::move(whole).value());
  }
  if (choice == IslandChoice::largest) {
    for (std::size_t k = 1; k < islands.size(); ++k) result.other_islands += islands[k].given_m.size();
    islands.resize(1);
  }
  return {};
}

UnfittedIsland unfitted_island(const FitPoints& island) {
  const Box box = box_about(island.given_m);
  return {island.given_m.size(), box.extent(), box.centre(), {}};
}

Status fit_islands(std::vector<FitPoints> islands, const FitRequest& request, ScanFit& result) {
  const auto count = static_cast<double>(islands.size());
  bool stopped = false;
  for (std::size_t k = 0; k < islands.size(); ++k) {
    const Progress progress([&](double fraction) {
      stopped = !request.settings.progress.report((static_cast<double>(k) + fraction) / count);
      return !stopped;
    });
    UnfittedIsland unfitted = unfitted_island(islands[k]);
    auto body = fit_island(std::move(islands[k]), request, progress);
    if (body) {
      result.bodies.push_back(std::move(body).value());
      continue;
    }
    if (stopped || count == 1.0) return body.error();
    unfitted.reason = body.error().message;
    result.other_islands += unfitted.points;
    result.unfitted.push_back(std::move(unfitted));
  }
  if (!result.bodies.empty()) return {};
  return Error(ErrorCode::not_converged,
               "none of its " + std::to_string(islands.size()) +
                   " islands can be fitted; the largest: " + result.unfitted.front().reason);
}

std::size_t count_distinct(std::vector<Vector3> points_m) {
  const auto is_before = [](const Vector3& a, const Vector3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::sort(points_m.begin(), points_m.end(), is_before);
  return static_cast<std::size_t>(std::unique(points_m.begin(), points_m.end()) - points_m.begin());
}

// Returns an error if the bodies use less than half of the distinct points.
Status check_points_used(const ScanFit& fit) {
  std::vector<Vector3> points_m;
  std::size_t strays = 0;
  for (const FittedBody& body : fit.bodies) {
    points_m.insert(points_m.end(), body.points_m.begin(), body.points_m.end());
    strays += body.errors.strays;
  }
  const std::size_t of_bodies = count_distinct(std::move(points_m));
  const std::size_t used = of_bodies - std::min(of_bodies, strays);
  if (2 * used >= fit.distinct) return {};
  return Error(ErrorCode::too_few,
               "only " + std::to_string(used) + " of its " + std::to_string(fit.distinct) +
                   " distinct points are used by the fit, which found " + std::to_string(fit.islands) +
                   " islands; choose among them with --islands, or repair the scan and join its vertices",
               "islands");
}

}  // namespace

Result<ScanFit> fit_scan(Scan scan, const FitRequest& request) {
  SPOONBILL_ASSERT_DEBUG(std::all_of(scan.points_m.begin(), scan.points_m.end(),
                                     [](const Vector3& at) { return at.allFinite(); }));
  SPOONBILL_ASSERT(!scan.has_normals() || scan.normals.size() == scan.points_m.size());
  if (scan.triangles.empty() && scan.points_m.size() < least_cloud_points) {
    return Error(ErrorCode::too_few, "has too few points for a fit: " + std::to_string(scan.points_m.size()) +
                                         ", needs at least " + std::to_string(least_cloud_points) +
                                         ", and about 200 for a closed shape");
  }
  auto points = make_fit_points(std::move(scan));
  if (!points) return points.error();
  const std::size_t distinct = count_distinct(points->given_m);
  Islands islands = split_islands(points.value());
  ScanFit result;
  result.islands = islands.islands.size();
  result.distinct = distinct;
  result.joined = points->joined;
  result.joining_distance_m = points->joining_distance_m;
  result.outliers = points->outliers;
  result.flipped_normals = points->flipped_normals;
  result.dust = islands.dust_points;
  if (islands.islands.empty()) {
    return Error(ErrorCode::degenerate,
                 "its points form no connected surface; they are too few or too noisy");
  }
  if (Status chosen = choose_islands(islands.islands, island_choice(request), result); !chosen) {
    return chosen.error();
  }
  if (Status fitted = fit_islands(std::move(islands.islands), request, result); !fitted) {
    return fitted.error();
  }
  if (request.islands) return result;
  if (Status used = check_points_used(result); !used) return used.error();
  return result;
}

}  // namespace spoonbill
