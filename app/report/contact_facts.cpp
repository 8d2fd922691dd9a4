#include "app/report/contact_facts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "app/report/quantity_text.h"

namespace spoonbill {
namespace {

Json vector_json(const Vector3& vector) {
  // Adding zero turns a negative zero into a positive one.
  return {vector.x() + 0.0, vector.y() + 0.0, vector.z() + 0.0};
}

std::string vector_text(const Vector3& vector, int decimals) {
  const double scale = std::pow(10.0, decimals);
  // Rounds first, so that no number prints as -0.0.
  const auto rounded = [&](double number) { return std::round(number * scale) / scale + 0.0; };
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "(%.*f, %.*f, %.*f)", decimals, rounded(vector.x()), decimals,
                rounded(vector.y()), decimals, rounded(vector.z()));
  return text.data();
}

std::string coordinates_text(const Vector3& point_m) {
  return vector_text(1e3 * point_m, 1) + " mm";
}

Json side_json(const ContactSide& side) {
  Json json = {{"point_m", vector_json(side.point_m)}};
  if (!side.body.empty()) json["body"] = side.body;
  if (!side.parameters) return json;
  json["u"] = side.parameters->u;
  json["v"] = side.parameters->v;
  if (const auto& range = side.parameters->range) {
    json["u_range"] = {range->u0, range->u1};
    json["v_range"] = {range->v0, range->v1};
  }
  return json;
}

Json contact_json(const ModelContact& contact) {
  return {{"point_m", vector_json(contact.a.point_m)},
          {"normal", vector_json(contact.normal)},
          {"tangent_u", vector_json(contact.tangent_u)},
          {"tangent_v", vector_json(contact.tangent_v)},
          {"depth_m", contact.depth_m},
          {"a", side_json(contact.a)},
          {"b", side_json(contact.b)}};
}

// Returns text that names the bodies in contact; empty if each model has only one body.
std::string bodies_text(const ModelContact& contact) {
  const std::string &a = contact.a.body, &b = contact.b.body;
  if (a.empty() && b.empty()) return "";
  if (a.empty() || b.empty()) return ", of " + a + b;
  return a == b ? ", of " + a + " with itself" : ", of " + a + " and " + b;
}

void add_contacts(FactSheet& facts, const std::vector<ModelContact>& contacts, Json& list) {
  double deepest = 0.0;
  for (const ModelContact& contact : contacts) deepest = std::max(deepest, contact.depth_m);
  facts.add("Depth", millimetres_text(deepest), "depth_m", deepest);
  for (const ModelContact& contact : contacts) {
    facts.add("Contact",
              millimetres_text(contact.depth_m) + " deep at " + coordinates_text(contact.a.point_m) +
                  ", separating direction " + vector_text(contact.normal, 3) + bodies_text(contact),
              "", {});
    list.push_back(contact_json(contact));
  }
}

std::vector<ModelContact> convert_contacts(const std::vector<PairContact>& found) {
  std::vector<ModelContact> contacts;
  for (const PairContact& contact : found) {
    const PairParameters& at = contact.pair.at;
    contacts.push_back({{contact.pair.first_m, SurfaceParameters{at.u, at.v, contact.first}, {}},
                        {contact.pair.second_m, SurfaceParameters{at.s, at.t, contact.second}, {}},
                        contact.normal,
                        contact.depth_m,
                        contact.tangent_u,
                        contact.tangent_v});
  }
  return contacts;
}

struct CleaningCount {
  std::size_t number;
  const char* field;
  const char* words;
};

// Lists what the cleaning changed, and the open and non-manifold edges.
std::array<CleaningCount, 9> list_cleaning(const MeshReport& report) {
  return {{{report.vertices_joined, "vertices_joined", "vertices joined"},
           {report.degenerate_dropped, "degenerate_dropped", "degenerate triangles dropped"},
           {report.duplicates_dropped, "duplicates_dropped", "duplicate triangles dropped"},
           {report.triangles_flipped, "triangles_turned", "triangles reoriented"},
           {report.holes_filled, "holes_filled", "holes filled"},
           {report.specks_dropped, "specks_dropped", "specks dropped"},
           {report.parts_flipped, "parts_turned", "parts inside out, reversed"},
           {report.open_edges, "open_edges", "open edges found"},
           {report.branching_edges, "non_manifold_edges", "edges found with more than two triangles"}}};
}

void append_part(std::string& text, const std::string& part) {
  text += (text.empty() ? "" : ", ") + part;
}

std::string parts_text(const MeshReport& report, double sheet_thickness_m) {
  std::string text;
  if (report.closed_parts > 0) {
    append_part(text, std::to_string(report.closed_parts) + " closed");
  }
  if (report.cavities > 0) append_part(text, std::to_string(report.cavities) + " cavities in them");
  if (report.sheets > 0) {
    append_part(text, std::to_string(report.sheets) + " open, treated as plates " +
                          millimetres_text(sheet_thickness_m) + " thick");
  }
  return text;
}

}  // namespace

CollisionAnswer make_answer(const SelfResult& result, const std::vector<PairContact>& contacts) {
  CollisionAnswer answer;
  answer.touching = result.touching;
  answer.complete = !result.overflow;
  answer.distance_m = std::numeric_limits<double>::infinity();
  answer.contacts = convert_contacts(contacts);
  return answer;
}

CollisionAnswer make_answer(const PairResult& result, const std::vector<PairContact>& contacts) {
  CollisionAnswer answer;
  answer.touching = result.touching;
  answer.contained = result.contained;
  answer.complete = !result.overflow;
  answer.distance_m = result.distance_m;
  const PairParameters& nearest = result.nearest.at;
  answer.nearest_a = {result.nearest.first_m, SurfaceParameters{nearest.u, nearest.v, {}}, {}};
  answer.nearest_b = {result.nearest.second_m, SurfaceParameters{nearest.s, nearest.t, {}}, {}};
  if (result.touching) answer.contacts = convert_contacts(contacts);
  return answer;
}

CollisionAnswer make_answer(const MeshPairResult& result) {
  CollisionAnswer answer;
  answer.touching = result.touching;
  answer.contained = result.contained;
  answer.complete = result.complete;
  answer.distance_m = result.distance_m;
  answer.nearest_a = {result.nearest_first_m, {}, {}};
  answer.nearest_b = {result.nearest_second_m, {}, {}};
  for (const MeshPairContact& contact : result.contacts) {
    const Vector3 tangent = contact.normal.unitOrthogonal();
    answer.contacts.push_back({{contact.first_m, {}, {}},
                               {contact.second_m, {}, {}},
                               contact.normal,
                               contact.depth_m,
                               tangent,
                               contact.normal.cross(tangent)});
  }
  return answer;
}

void add_contact_facts(FactSheet& facts, const CollisionAnswer& answer) {
  facts.add("Touching", answer.touching ? (answer.contained ? "yes, one inside the other" : "yes") : "no",
            "touching", answer.touching);
  facts.add("", "", "contained", answer.contained);
  facts.add(answer.complete ? "" : "Notice",
            "the models are close at more points than could be searched; some contacts may be missing",
            "complete", answer.complete);
  Json list = Json::array();
  if (answer.touching) {
    add_contacts(facts, answer.contacts, list);
  } else if (std::isfinite(answer.distance_m)) {
    facts.add("Distance", millimetres_text(answer.distance_m), "distance_m", answer.distance_m);
    facts.add("Nearest of A", coordinates_text(answer.nearest_a.point_m), "nearest",
              {{"a", side_json(answer.nearest_a)}, {"b", side_json(answer.nearest_b)}});
    facts.add("Nearest of B", coordinates_text(answer.nearest_b.point_m), "", {});
  }
  facts.add("", "", "contacts", std::move(list));
}

void add_mesh_facts(FactSheet& facts, const LengthUnit& unit, const CleanMesh& mesh, double sheet_thickness_m,
                    const std::string& field, const std::string& suffix) {
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
  for (const CleaningCount& count : list_cleaning(report)) {
    json["cleaning"][count.field] = count.number;
    if (count.number > 0)
      append_part(cleaning, std::string(count.words) + ": " + std::to_string(count.number));
  }
  facts.add("Unit" + suffix, std::string(unit.name) + " (of the mesh's numbers; --unit overrides it)", field,
            std::move(json));
  facts.add("Size" + suffix, size_text(report.size_m), "", {});
  facts.add(
      "Triangles" + suffix,
      std::to_string(mesh.mesh.triangles.size()) + " of " + std::to_string(report.triangles_read) + " read",
      "", {});
  facts.add("Cleaning" + suffix, cleaning.empty() ? "nothing to do" : cleaning, "", {});
  facts.add("Parts" + suffix, parts_text(report, sheet_thickness_m), "", {});
}

}  // namespace spoonbill
