#include "app/report/contact_facts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

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

Json place_json(double u, double v, const Vector3& point_m) {
  return {{"u", u}, {"v", v}, {"point_m", vector_json(point_m)}};
}

Json place_json(double u, double v, const Vector3& point_m, const ParameterRange& range) {
  Json place = place_json(u, v, point_m);
  place["u_range"] = {range.u0, range.u1};
  place["v_range"] = {range.v0, range.v1};
  return place;
}

Json contact_json(const PairContact& contact) {
  const PairParameters& at = contact.pair.at;
  return {{"point_m", vector_json(contact.pair.first_m)},
          {"normal", vector_json(contact.normal)},
          {"depth_m", contact.depth_m},
          {"a", place_json(at.u, at.v, contact.pair.first_m, contact.first)},
          {"b", place_json(at.s, at.t, contact.pair.second_m, contact.second)}};
}

}  // namespace

void add_contact_facts(FactSheet& facts, const PairResult& result, const std::vector<PairContact>& contacts) {
  facts.add("Touching", result.touching ? (result.contained ? "yes, one inside the other" : "yes") : "no",
            "touching", result.touching);
  facts.add("", "", "contained", result.contained);
  facts.add(result.overflow ? "Notice" : "",
            "they meet in more places than are listed; give them fewer control points", "complete",
            !result.overflow);
  Json list = Json::array();
  if (result.touching) {
    double deepest = 0.0;
    for (const PairContact& contact : contacts) deepest = std::max(deepest, contact.depth_m);
    facts.add("Depth", millimetres_text(deepest), "depth_m", deepest);
    for (const PairContact& contact : contacts) {
      facts.add("Contact",
                millimetres_text(contact.depth_m) + " deep at " + point_text(contact.pair.first_m) +
                    ", way out " + vector_text(contact.normal, 3),
                "", {});
      list.push_back(contact_json(contact));
    }
  } else {
    const PairParameters& at = result.nearest.at;
    facts.add("Distance", millimetres_text(result.distance_m), "distance_m", result.distance_m);
    facts.add("Nearest of A", point_text(result.nearest.first_m), "nearest",
              {{"a", place_json(at.u, at.v, result.nearest.first_m)},
               {"b", place_json(at.s, at.t, result.nearest.second_m)}});
    facts.add("Nearest of B", point_text(result.nearest.second_m), "", {});
  }
  facts.add("", "", "contacts", std::move(list));
}

}  // namespace spoonbill
