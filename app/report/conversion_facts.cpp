#include "app/report/conversion_facts.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "app/report/quantity_text.h"
#include "app/report/surface_extent.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

std::string short_millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g mm", 1e3 * metres);
  return text;
}

std::string net_text(const Surface& surface) {
  return "degrees " + std::to_string(surface.u.degree()) + " and " + std::to_string(surface.v.degree()) +
         ", " + std::to_string(surface.net.rows) + "x" + std::to_string(surface.net.columns) +
         " control points";
}

Json direction_json(const KnotVector& knots) {
  return {{"degree", knots.degree()},
          {"control_points", knots.control_point_count()},
          {"periodic", knots.is_periodic()}};
}

Json millimetres_of(const Vector3& size_m) {
  return {1e3 * size_m.x(), 1e3 * size_m.y(), 1e3 * size_m.z()};
}

}  // namespace

void add_surface_facts(FactSheet& facts, const std::vector<CadSurface>& surfaces) {
  Json bodies = Json::array();
  Box all = extent_of(surfaces.front().surface, surfaces.front().trims);
  double deviation_m = 0.0;
  for (const CadSurface& part : surfaces) {
    const Box extent = extent_of(part.surface, part.trims);
    const Vector3 size = extent.high - extent.low;
    all = joined(all, extent);
    std::string text = size_text(size) + ", " + net_text(part.surface);
    if (!part.trims.empty()) text += ", trimmed by " + std::to_string(part.trims.size());
    if (part.deviation_m > 0.0) text += ", approximated within " + short_millimetres(part.deviation_m);
    const std::string place = surfaces.size() > 1 ? " " + std::to_string(bodies.size() + 1) : "";
    facts.add("Body" + place, part.name + ": " + text, "", nullptr);
    bodies.push_back({{"name", part.name},
                      {"size_mm", millimetres_of(size)},
                      {"u", direction_json(part.surface.u)},
                      {"v", direction_json(part.surface.v)},
                      {"deviation_m", part.deviation_m},
                      {"trims", part.trims.size()},
                      {"trim_problem", part.trim_problem}});
    deviation_m = std::max(deviation_m, part.deviation_m);
  }
  const Vector3 size = all.high - all.low;
  facts.add("Size", size_text(size), "size_mm", millimetres_of(size));
  facts.add("", "", "bodies", std::move(bodies));
  facts.add("", "", "deviation_m", deviation_m);
}

void add_unit_facts(FactSheet& facts, const std::string& unit, bool declared) {
  facts.add("Unit read", declared ? unit : unit + " (not declared)", "unit_in", unit);
  facts.add("", "", "unit_declared", declared);
}

void add_conversion_facts(FactSheet& facts, const ConversionReport& report) {
  add_unit_facts(facts, report.unit_in, report.unit_declared);
  facts.add("Unit written", report.unit_out, "unit_out", report.unit_out);
  add_surface_facts(facts, report.surfaces);
  if (report.solids) {
    facts.add("Solids", std::to_string(*report.solids), "solids", *report.solids);
    facts.add("Not solid", std::to_string(*report.open_shells), "open_shells", *report.open_shells);
  }
  if (report.triangles) {
    facts.add("Triangles",
              std::to_string(*report.triangles) + ", within " + short_millimetres(report.chord_error_m) +
                  " of the surface",
              "triangles", *report.triangles);
    facts.add("Watertight",
              std::to_string(*report.closed_meshes) + " of " + std::to_string(report.meshes.value_or(0)),
              "closed_meshes", *report.closed_meshes);
    facts.add("", "", "meshes", report.meshes.value_or(0));
    facts.add("", "", "chord_error_m", report.chord_error_m);
  }
  for (const std::string& note : report.notes) facts.add("Note", note, "", nullptr);
  facts.add("", "", "notes", report.notes);
}

}  // namespace spoonbill
