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
  // Without a negative zero, which tells a reader nothing.
  return {vector.x() + 0.0, vector.y() + 0.0, vector.z() + 0.0};
}

std::string vector_text(const Vector3& vector, int decimals) {
  const double places = std::pow(10.0, decimals);
  // Rounded first, so that nothing reads -0.0.
  const auto rounded = [&](double number) { return std::round(number * places) / places + 0.0; };
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "(%.*f, %.*f, %.*f)", decimals, rounded(vector.x()), decimals,
                rounded(vector.y()), decimals, rounded(vector.z()));
  return text.data();
}

std::string point_text(const Vector3& point_m) {
  return vector_text(1e3 * point_m, 1) + " mm";
}

Json side_json(const ContactSide& side) {
  Json json = {{"point_m", vector_json(side.point_m)}};
  if (!side.body.empty()) json["body"] = side.body;
  if (!side.place) return json;
  json["u"] = side.place->u;
  json["v"] = side.place->v;
  if (const auto& range = side.place->range) {
    json["u_range"] = {range->u0, range->u1};
    json["v_range"] = {range->v0, range->v1};
  }
  return json;
}

Json contact_json(const ContactOfTwo& contact) {
  return {{"point_m", vector_json(contact.a.point_m)},
          {"normal", vector_json(contact.normal)},
          {"tangent_u", vector_json(contact.tangent_u)},
          {"tangent_v", vector_json(contact.tangent_v)},
          {"depth_m", contact.depth_m},
          {"a", side_json(contact.a)},
          {"b", side_json(contact.b)}};
}

// Whose contact it is, where there are several bodies.
std::string bodies_text(const ContactOfTwo& contact) {
  const std::string &a = contact.a.body, &b = contact.b.body;
  if (a.empty() && b.empty()) return "";
  if (a.empty() || b.empty()) return ", of " + a + b;
  return a == b ? ", of " + a + " with itself" : ", of " + a + " and " + b;
}

void add_contacts(FactSheet& facts, const std::vector<ContactOfTwo>& contacts, Json& list) {
  double deepest = 0.0;
  for (const ContactOfTwo& contact : contacts) deepest = std::max(deepest, contact.depth_m);
  facts.add("Depth", millimetres_text(deepest), "depth_m", deepest);
  for (const ContactOfTwo& contact : contacts) {
    facts.add("Contact",
              millimetres_text(contact.depth_m) + " deep at " + point_text(contact.a.point_m) + ", way out " +
                  vector_text(contact.normal, 3) + bodies_text(contact),
              "", {});
    list.push_back(contact_json(contact));
  }
}

std::vector<ContactOfTwo> contacts_of(const std::vector<PairContact>& found) {
  std::vector<ContactOfTwo> contacts;
  for (const PairContact& contact : found) {
    const PairParameters& at = contact.pair.at;
    contacts.push_back({{contact.pair.first_m, SurfacePlace{at.u, at.v, contact.first}, {}},
                        {contact.pair.second_m, SurfacePlace{at.s, at.t, contact.second}, {}},
                        contact.normal,
                        contact.depth_m,
                        contact.tangent_u,
                        contact.tangent_v});
  }
  return contacts;
}

}  // namespace

CollisionAnswer answer_of(const SelfResult& result, const std::vector<PairContact>& contacts) {
  CollisionAnswer answer;
  answer.touching = result.touching;
  answer.complete = !result.overflow;
  answer.distance_m = std::numeric_limits<double>::infinity();
  answer.contacts = contacts_of(contacts);
  return answer;
}

CollisionAnswer answer_of(const PairResult& result, const std::vector<PairContact>& contacts) {
  CollisionAnswer answer;
  answer.touching = result.touching;
  answer.contained = result.contained;
  answer.complete = !result.overflow;
  answer.distance_m = result.distance_m;
  const PairParameters& nearest = result.nearest.at;
  answer.nearest_a = {result.nearest.first_m, SurfacePlace{nearest.u, nearest.v, {}}, {}};
  answer.nearest_b = {result.nearest.second_m, SurfacePlace{nearest.s, nearest.t, {}}, {}};
  if (result.touching) answer.contacts = contacts_of(contacts);
  return answer;
}

CollisionAnswer answer_of(const MeshPairResult& result) {
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
            "they come near each other in more places than could be searched; there may be more to tell",
            "complete", answer.complete);
  Json list = Json::array();
  if (answer.touching) {
    add_contacts(facts, answer.contacts, list);
  } else if (std::isfinite(answer.distance_m)) {
    facts.add("Distance", millimetres_text(answer.distance_m), "distance_m", answer.distance_m);
    facts.add("Nearest of A", point_text(answer.nearest_a.point_m), "nearest",
              {{"a", side_json(answer.nearest_a)}, {"b", side_json(answer.nearest_b)}});
    facts.add("Nearest of B", point_text(answer.nearest_b.point_m), "", {});
  }
  facts.add("", "", "contacts", std::move(list));
}

}  // namespace spoonbill
