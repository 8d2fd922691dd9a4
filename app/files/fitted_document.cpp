#include "app/files/fitted_document.h"

#include <algorithm>
#include <optional>

#include "app/start/starting_document.h"

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
    if (lattice_of(body)) break;
  }
  return thickness;
}

// The largest number of nodes with which the body has a lattice: scans have places where cells of the usual
// size would fold.
Status choose_node_budget(Body& body) {
  const int usual = body.lattice.node_budget;
  Status first;
  for (const int share : {1, 2, 4, 8, 16}) {
    body.lattice.node_budget = std::max(node_budget_range.low, usual / share);
    const auto lattice = lattice_of(body);
    if (lattice) return {};
    if (first) first = lattice.error();
  }
  body.lattice.node_budget = usual;
  return first;
}

}  // namespace

Result<FittedDocument> fitted_document(const ScanFit& fit, const std::string& name, const Material& clay) {
  const auto most = static_cast<std::size_t>(sculpted_body_count_range.high);
  if (fit.bodies.size() > most) {
    return Error{"has " + std::to_string(fit.bodies.size()) + " islands, and at most " +
                 std::to_string(most) + " bodies are sculpted together; use --islands largest"};
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
    if (Status fits = choose_node_budget(body); !fits) {
      result.remarks.push_back("body \"" + body.name + "\" cannot be simulated yet: " + fits.error().message);
    }
    result.document.scene.bodies.push_back(std::move(body));
  }
  return result;
}

}  // namespace spoonbill
