#include "app/report/fit_report.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "app/report/fact_sheet.h"
#include "app/report/quantity_text.h"
#include "engine/base/file.h"
#include "engine/base/geometry.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

Json deviation_json(const Deviation& deviation) {
  return {{"max_m", deviation.max_m}, {"p95_m", deviation.p95_m}, {"mean_m", deviation.mean_m}};
}

std::string distances_text(const Deviation& deviation) {
  return "95 % within " + short_length_text(deviation.p95_m) + ", mean " +
         short_length_text(deviation.mean_m) + ", at most " + short_length_text(deviation.max_m);
}

std::string control_text(const Surface& surface) {
  return std::to_string(surface.net.rows) + " x " + std::to_string(surface.net.columns);
}

Vector3 size_of_all(const ScanFit& fit) {
  Box box;
  for (const FittedBody& body : fit.bodies) box.join(box_about(body.points_m));
  return box.extent();
}

std::size_t count_strays(const ScanFit& fit) {
  std::size_t strays = 0;
  for (const FittedBody& body : fit.bodies) strays += body.errors.strays;
  return strays;
}

// Returns the number of points that were given to the fit: all points of the file except points with a
// coordinate that is not a number and points that were joined to another point.
std::size_t count_given(const ScanFit& fit) {
  std::size_t count = fit.outliers + fit.dust + fit.other_islands;
  for (const FittedBody& body : fit.bodies) count += body.points_m.size();
  return count;
}

// Returns the fraction of the given points (see count_given()) that belong to no body.
double left_out_share(const ScanFit& fit) {
  const double given = static_cast<double>(std::max<std::size_t>(1, count_given(fit)));
  return static_cast<double>(fit.outliers + fit.dust + fit.other_islands) / given;
}

void add_body(FactSheet& facts, const FittedBody& body, Json& list) {
  const std::string kind(name_of(body.kind));
  facts.add("Body",
            kind + ", " + size_text(body.size_m) + ", " + control_text(body.surface) + " control points", "",
            nullptr);
  facts.add("  Scan to surface", distances_text(body.errors.data_to_surface), "", nullptr);
  if (body.errors.strays > 0) {
    facts.add("  With stray points", distances_text(body.errors.all_to_surface), "", nullptr);
  }
  facts.add("  Surface to scan",
            distances_text(body.errors.surface_to_data) + "; " + percent_text(body.errors.unseen_fraction) +
                " of the surface was not scanned",
            "", nullptr);
  facts.add("  Folds",
            body.folds.folds == 0
                ? "none"
                : std::to_string(body.folds.folds) + " of " + std::to_string(body.folds.samples) + " samples",
            "", nullptr);
  if (body.folds.cusps > 0) {
    facts.add("  Cusps",
              std::to_string(body.folds.cusps) +
                  ": creases sharper than the knots can follow; fewer control points are smoother",
              "", nullptr);
  }
  list.push_back({{"kind", kind},
                  {"control", {body.surface.net.rows, body.surface.net.columns}},
                  {"size_mm", millimetres_json(body.size_m)},
                  {"points", body.points_m.size()},
                  {"data_to_surface", deviation_json(body.errors.data_to_surface)},
                  {"strays_too_to_surface", deviation_json(body.errors.all_to_surface)},
                  {"surface_to_data", deviation_json(body.errors.surface_to_data)},
                  {"unseen_share", body.errors.unseen_fraction},
                  {"folds", body.folds.folds},
                  {"fold_samples", body.folds.samples},
                  {"cusps", body.folds.cusps}});
}

std::string unfitted_island_text(const UnfittedIsland& island) {
  const auto along = [&](int axis) { return millimetres_text(island.centre_m[axis]); };
  return "the island of " + size_text(island.size_m) + " about " + along(0) + ", " + along(1) + ", " +
         along(2) + " was skipped, with " + count_text(island.points, "point", "points") + ": " +
         island.reason;
}

void append_float(std::string& bytes, double number) {
  const auto value = static_cast<float>(number);
  const char* const data = reinterpret_cast<const char*>(&value);
  bytes.append(data, sizeof value);
}

std::string cloud_header(std::size_t points, double full_m) {
  return std::string("ply\nformat ") +
         (std::endian::native == std::endian::little ? "binary_little_endian" : "binary_big_endian") +
         " 1.0\ncomment lengths in metres; colours from 0 (dark violet) to " + number_text(full_m * 1e3) +
         " mm (yellow)\nelement vertex " + std::to_string(points) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty float distance_mm\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
}

// Returns red, green and blue for a fraction, clamped to 0 to 1. The scale runs from dark violet through blue
// and green to yellow with evenly rising lightness, so that it is legible in grey and without distinguishing
// red from green (viridis; Smith and van der Walt 2015).
std::array<std::uint8_t, 3> scale_colour(double fraction) {
  static constexpr std::array<std::array<double, 3>, 9> steps{{{68, 1, 84},
                                                               {71, 45, 123},
                                                               {59, 82, 139},
                                                               {44, 114, 142},
                                                               {33, 145, 140},
                                                               {40, 174, 128},
                                                               {94, 201, 98},
                                                               {173, 220, 48},
                                                               {253, 231, 37}}};
  const double position = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(steps.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(position), steps.size() - 2);
  const double rest = position - static_cast<double>(below);
  std::array<std::uint8_t, 3> colour;
  for (std::size_t k = 0; k < 3; ++k) {
    const double value = steps[below][k] + rest * (steps[below + 1][k] - steps[below][k]);
    colour[k] = static_cast<std::uint8_t>(std::lround(value));
  }
  return colour;
}

}  // namespace

Deviation deviation_of_all(const ScanFit& fit) {
  std::vector<double> distances;
  for (const FittedBody& body : fit.bodies) {
    for (std::size_t p = 0; p < body.errors.distance_m.size(); ++p) {
      if (!body.errors.is_stray[p]) distances.push_back(body.errors.distance_m[p]);
    }
  }
  return compute_deviation(std::move(distances));
}

void add_left_out_facts(FactSheet& facts, const ScanFile& file, const ScanFit& fit) {
  const double share = left_out_share(fit);
  std::string text;
  const auto add_part = [&](std::size_t count, const char* what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  };
  add_part(fit.outliers, "outliers");
  add_part(fit.dust, "in specks");
  add_part(fit.other_islands, "on other islands");
  if (!text.empty()) text = percent_text(share) + " of the scan's points: " + text;
  facts.add(text.empty() ? "" : "Left out", text, "left_out_share", share);
  facts.add("", "", "points_left_out",
            {{"not_a_number", file.points_skipped},
             {"joined", fit.joined},
             {"outliers", fit.outliers},
             {"strays", count_strays(fit)},
             {"specks", fit.dust},
             {"other_islands", fit.other_islands}});
}

void add_scan_facts(FactSheet& facts, const ScanFile& file, const ScanFit& fit) {
  facts.add("Unit", std::string(file.unit.name) + " (of the scan's numbers; --unit overrides it)", "unit",
            std::string(file.unit.name));
  const Vector3 size = size_of_all(fit);
  facts.add("Size", size_text(size), "size_mm", millimetres_json(size));
  const std::size_t strays = count_strays(fit);
  std::size_t used = 0;
  for (const FittedBody& body : fit.bodies) used += body.points_m.size();
  used -= std::min(used, strays);
  std::string text = std::to_string(used) + " used of " + std::to_string(file.points_read) + " read";
  const auto add_skipped = [&](std::size_t count, const std::string& why) {
    if (count > 0) text += ", " + std::to_string(count) + " " + why;
  };
  add_skipped(file.points_skipped, "not a number");
  add_skipped(fit.joined, "joined to another within " + short_length_text(fit.joining_distance_m));
  add_skipped(fit.outliers, "outliers");
  add_skipped(strays, "stray points off the surface");
  add_skipped(fit.dust, "in specks");
  add_skipped(fit.other_islands, "on other islands");
  facts.add("Points", text, "points_read", file.points_read);
  facts.add("", "", "points_distinct", fit.distinct);
  facts.add("", "", "points_used", used);
  const bool has_triangles = fit.joining_distance_m > 0.0;
  facts.add("", "", "joined_within_m", has_triangles ? Json(fit.joining_distance_m) : Json(nullptr));
  facts.add("Islands", std::to_string(fit.islands), "islands", fit.islands);
}

std::optional<std::string> find_size_note(const ScanFile& file, const ScanFit& fit) {
  constexpr Range<double> usual_m{1e-3, 10.0};
  const double longest_m = size_of_all(fit).maxCoeff();
  if (usual_m.contains(longest_m)) return std::nullopt;
  return "the scan is " + short_length_text(longest_m) + " long; if its numbers are not in " +
         std::string(file.unit.name) + ", give their unit with --unit";
}

std::optional<std::string> find_detail_note(const ScanFit& fit) {
  constexpr double close_fraction = 0.01;
  const auto is_loose = [&](const FittedBody& body) {
    return body.errors.data_to_surface.p95_m > close_fraction * body.size_m.maxCoeff();
  };
  if (std::none_of(fit.bodies.begin(), fit.bodies.end(), is_loose)) return std::nullopt;
  return "5 % of the scan or more is farther from the surface than a hundredth of its size; one surface "
         "cannot have a handle or a hole, so fit the parts of such a scan separately; fine detail needs more "
         "control points";
}

namespace {

// Returns the fraction of the given points (see count_given()) that is within the tolerance. Points that
// belong to no body count as outside.
double share_within(const ScanFit& fit, double tolerance_m) {
  double within = 0.0;
  for (const FittedBody& body : fit.bodies) {
    const std::vector<double>& distances = body.errors.distance_m;
    const auto near = std::count_if(distances.begin(), distances.end(),
                                    [&](double distance) { return distance <= tolerance_m; });
    // If the scan is a coarse mesh, the distances are those of samples all over the mesh, not those of its
    // points. The number of distances then differs from the number of points.
    if (!distances.empty()) {
      within += static_cast<double>(body.points_m.size()) * static_cast<double>(near) /
                static_cast<double>(distances.size());
    }
  }
  return within / static_cast<double>(std::max<std::size_t>(1, count_given(fit)));
}

bool is_body_within(const FittedBody& body, double tolerance_m) {
  return body.errors.data_to_surface.p95_m <= tolerance_m;
}

// Returns true if at least 95 % of the whole scan and at least 95 % of the points of each body are within the
// tolerance. Stray points do not count as points of a body. Returns nullopt for a tolerance of 0.
std::optional<bool> is_within_tolerance(const ScanFit& fit, double tolerance_m) {
  if (tolerance_m <= 0.0) return std::nullopt;
  const bool are_bodies = std::all_of(fit.bodies.begin(), fit.bodies.end(),
                                      [&](const auto& body) { return is_body_within(body, tolerance_m); });
  return are_bodies && share_within(fit, tolerance_m) >= 0.95;
}

std::string tolerance_text(const ScanFit& fit, double tolerance_m) {
  const double omitted = left_out_share(fit);
  std::string text = percent_text(share_within(fit, tolerance_m)) + " of the whole scan is within " +
                     short_length_text(tolerance_m) + " of the surface";
  if (omitted > 0.0) text += "; left out: " + percent_text(omitted);
  return text;
}

}  // namespace

std::vector<std::string> find_fit_shortcomings(const ScanFit& fit, double tolerance_m) {
  std::vector<std::string> notes;
  bool are_bodies_within = true;
  for (std::size_t k = 0; k < fit.bodies.size(); ++k) {
    const FittedBody& body = fit.bodies[k];
    const std::string which =
        fit.bodies.size() == 1 ? "the surface" : "the surface of body " + std::to_string(k + 1);
    const double p95_m = body.errors.data_to_surface.p95_m;
    if (tolerance_m > 0.0 && !is_body_within(body, tolerance_m)) {
      are_bodies_within = false;
      notes.push_back(which + " is not within the tolerance: 95 % of the points fitted to it are within " +
                      short_length_text(p95_m) + " of it, not " + short_length_text(tolerance_m) +
                      "; allow more control points with --control, unless the scan is that noisy");
    }
    if (body.folds.folds > 0) {
      notes.push_back(which + " folds at " + std::to_string(body.folds.folds) + " of " +
                      std::to_string(body.folds.samples) +
                      " samples; try fewer control points or another --kind");
    }
  }
  if (are_bodies_within && is_within_tolerance(fit, tolerance_m) == false) {
    notes.push_back("the scan as a whole is not within the tolerance: " + tolerance_text(fit, tolerance_m) +
                    "; --islands all fits every part");
  }
  if (fit.flipped_normals > 0) {
    notes.push_back("the normals of " + count_text(fit.flipped_normals, "point", "points") +
                    " were opposite to those of their neighbours and were flipped");
  }
  for (const UnfittedIsland& island : fit.unfitted) notes.push_back(unfitted_island_text(island));
  if (fit.open_bridged > 0) {
    notes.push_back(
        count_text(fit.open_bridged, "island was", "islands were") +
        " open at places other than the gaps; these openings were capped, because a bridged body is closed; "
        "--islands all leaves sheets and tubes open");
  }
  return notes;
}

void add_fit_facts(FactSheet& facts, const ScanFit& fit, double tolerance_m) {
  Json list = Json::array();
  std::size_t folds = 0;
  for (const FittedBody& body : fit.bodies) {
    add_body(facts, body, list);
    folds += body.folds.folds;
  }
  const Deviation all = deviation_of_all(fit);
  const FittedBody& first = fit.bodies.front();
  facts.add("", "", "bodies", list);
  facts.add("", "", "kind", std::string(name_of(first.kind)));
  facts.add("", "", "control", {first.surface.net.rows, first.surface.net.columns});
  facts.add("", "", "folds", folds);
  const std::optional<bool> within = is_within_tolerance(fit, tolerance_m);
  facts.add(within ? "Within tolerance" : "",
            within ? (*within ? "yes: " : "no: ") + tolerance_text(fit, tolerance_m) : "", "within_tolerance",
            within ? Json(*within) : Json(nullptr));
  facts.add("", "", "within_tolerance_share", within ? Json(share_within(fit, tolerance_m)) : Json(nullptr));
  facts.add("", "", "max_m", all.max_m);
  facts.add("", "", "p95_m", all.p95_m);
  facts.add("", "", "mean_m", all.mean_m);
}

Status write_error_cloud(const ScanFit& fit, double full_m, const std::filesystem::path& file,
                         const OutputOptions& options) {
  std::size_t count = 0;
  for (const FittedBody& body : fit.bodies) count += body.errors.positions_m.size();
  auto out = OutputFile::create(file, options);
  if (!out) return out.error();
  if (Status written = out->write(cloud_header(count, full_m)); !written) return written;
  std::string bytes;
  for (const FittedBody& body : fit.bodies) {
    bytes.clear();
    for (std::size_t p = 0; p < body.errors.positions_m.size(); ++p) {
      for (int axis = 0; axis < 3; ++axis) append_float(bytes, body.errors.positions_m[p][axis]);
      append_float(bytes, 1e3 * body.errors.distance_m[p]);
      for (const std::uint8_t value : scale_colour(body.errors.distance_m[p] / full_m)) {
        bytes.push_back(static_cast<char>(value));
      }
    }
    if (Status written = out->write(bytes); !written) return written;
  }
  return out->commit();
}

}  // namespace spoonbill
