#include "app/files/fitted_document.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "app/start/starting_document.h"
#include "engine/material/lattice/body_lattice.h"

namespace spoonbill {
namespace {

constexpr double thickest_m = 2e-3;
constexpr double thickness_share = 0.01;
constexpr int thinnings = 6;

// Of a shell that its curvature allows; the thinnest tried where none does.
double thickness_for(Body body, double size_m) {
  double thickness = shell_thickness_range_m.low;
  for (int thinning = 0; thinning <= thinnings; ++thinning) {
    thickness = std::max(shell_thickness_range_m.low,
                         std::min(thickest_m, thickness_share * size_m) / static_cast<double>(1 << thinning));
    body.shell_thickness_m = thickness;
    if (make_body_lattice(body)) break;
  }
  return thickness;
}

bool has_lattice_along(const Body& body) {
  return body.shell_thickness_m ? make_body_lattice(body).ok() : tube_lattice(body.surface, body.lattice).ok();
}

// The largest number of nodes with which a lattice runs along the body: scans have places where cells of the
// usual size would fold. The usual number where none does: a solid then lies in a box of that many, which is
// worth more than a lattice of few along it.
void choose_node_budget(Body& body) {
  const int usual = body.lattice.node_budget;
  const int most = body.shell_thickness_m ? 16 : 4;
  for (int share = 1; share <= most; share *= 2) {
    body.lattice.node_budget = std::max(node_budget_range.low, usual / share);
    if (has_lattice_along(body)) return;
  }
  body.lattice.node_budget = usual;
}

std::optional<std::string> remark_on_lattice(const Body& body) {
  const auto lattice = make_body_lattice(body);
  const std::string name = "body \"" + body.name + "\" ";
  if (!lattice) return name + "cannot be simulated yet: " + lattice.error().message;
  if (lattice->along.empty()) return std::nullopt;
  return name + "is sculpted in a box of cells: a lattice along it would fold";
}

}  // namespace

Result<FittedDocument> fitted_document(const ScanFit& fit, const std::string& name, const Material& clay) {
  const auto most = static_cast<std::size_t>(body_count_range.high);
  if (fit.bodies.size() > most) {
    return Error{"has " + std::to_string(fit.bodies.size()) + " islands, and a document holds at most " +
                 std::to_string(most) + " bodies; use --islands largest"};
  }
  FittedDocument result;
  result.document = starting_document(name, fit.bodies.front().surface, clay);
  result.document.scene.bodies.clear();
  for (std::size_t b = 0; b < fit.bodies.size(); ++b) {
    const FittedBody& fitted = fit.bodies[b];
    Body body;
    body.name = fit.bodies.size() == 1 ? name : name + " " + std::to_string(b + 1);
    body.surface = fitted.surface;
    body.material = clay;
    if (fitted.kind != ShapeKind::closed) body.shell_thickness_m = thickness_for(body, fitted.size_m.norm());
    choose_node_budget(body);
    if (auto remark = remark_on_lattice(body)) result.remarks.push_back(std::move(*remark));
    result.document.scene.bodies.push_back(std::move(body));
  }
  if (Status few = check_body_count(result.document.scene); !few) {
    result.remarks.push_back(few.error().message);
  }
  return result;
}

}  // namespace spoonbill
