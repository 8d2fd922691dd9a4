#include "app/report/mesh_facts.h"

#include <array>
#include <string>
#include <utility>

#include "app/report/quantity_text.h"

namespace spoonbill {
namespace {

struct Count {
  std::size_t number;
  const char* field;
  const char* words;
};

// What the cleaning changed, and the edges that it found.
std::array<Count, 9> counts_of(const MeshReport& report) {
  return {{{report.vertices_joined, "vertices_joined", "vertices joined"},
           {report.degenerate_dropped, "degenerate_dropped", "degenerate triangles dropped"},
           {report.duplicates_dropped, "duplicates_dropped", "repeated triangles dropped"},
           {report.triangles_flipped, "triangles_turned", "triangles turned to agree"},
           {report.holes_filled, "holes_filled", "holes filled"},
           {report.specks_dropped, "specks_dropped", "specks dropped"},
           {report.parts_flipped, "parts_turned", "parts inside out, turned round"},
           {report.open_edges, "open_edges", "open edges found"},
           {report.branching_edges, "non_manifold_edges", "edges of more than two triangles found"}}};
}

void append(std::string& text, const std::string& part) {
  text += (text.empty() ? "" : ", ") + part;
}

std::string parts_text(const MeshReport& report, double sheet_thickness_m) {
  std::string text;
  if (report.closed_parts > 0) {
    append(text, std::to_string(report.closed_parts) + " closed");
  }
  if (report.cavities > 0) append(text, std::to_string(report.cavities) + " hollow in them");
  if (report.sheets > 0) {
    append(text, std::to_string(report.sheets) + " open, taken as plates " +
                     millimetres_text(sheet_thickness_m) + " thick");
  }
  return text;
}

}  // namespace

void add_mesh_facts(FactSheet& facts, const LengthUnit& unit, const CleanMesh& mesh, double sheet_thickness_m,
                    const std::string& field, const std::string& whose) {
  const MeshReport& report = mesh.report;
  Json json = {{"unit", unit.name},
               {"size_mm", {1e3 * report.size_m.x(), 1e3 * report.size_m.y(), 1e3 * report.size_m.z()}},
               {"vertices_read", report.vertices_read},
               {"triangles_read", report.triangles_read},
               {"vertices", mesh.mesh.vertices_m.size()},
               {"triangles", mesh.mesh.triangles.size()},
               {"closed_parts", report.closed_parts},
               {"cavities", report.cavities},
               {"sheets", report.sheets}};
  if (report.sheets > 0) json["sheet_thickness_m"] = sheet_thickness_m;
  std::string cleaning;
  for (const Count& count : counts_of(report)) {
    json["cleaning"][count.field] = count.number;
    if (count.number > 0) append(cleaning, std::string(count.words) + ": " + std::to_string(count.number));
  }
  facts.add("Unit" + whose, std::string(unit.name) + " (of the mesh's numbers; --unit names another)", field,
            std::move(json));
  facts.add("Size" + whose, size_text(report.size_m), "", {});
  facts.add(
      "Triangles" + whose,
      std::to_string(mesh.mesh.triangles.size()) + " of " + std::to_string(report.triangles_read) + " read",
      "", {});
  facts.add("Cleaning" + whose, cleaning.empty() ? "nothing to do" : cleaning, "", {});
  facts.add("Parts" + whose, parts_text(report, sheet_thickness_m), "", {});
}

}  // namespace spoonbill
