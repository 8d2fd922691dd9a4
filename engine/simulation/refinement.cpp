#include "engine/simulation/refinement.h"

#include <optional>
#include <utility>

namespace spoonbill {
namespace {

// Returns a parameter in each element that overlaps the range; none without a range.
std::vector<double> elements_in(const KnotVector& knots, const std::optional<Range<double>>& range) {
  std::vector<double> found;
  if (!range) return found;
  const std::vector<double> breaks = knots.breakpoints();
  for (std::size_t e = 0; e + 1 < breaks.size(); ++e) {
    const bool overlaps = breaks[e] <= range->high && breaks[e + 1] >= range->low;
    if (overlaps) found.push_back(0.5 * (breaks[e] + breaks[e + 1]));
  }
  return found;
}

Result<BodyMapping> make_finer(const RefineKnots& command, const BodyState& body,
                               const std::vector<FixingPlane>& planes) {
  const BodyMapping& mapping = body.mapping();
  std::vector<double> u = elements_in(mapping.rest().u, command.u);
  std::vector<double> v = elements_in(mapping.rest().v, command.v);
  if (!command.u && !command.v) {
    u = {mapping.residual().u};
    v = {mapping.residual().v};
  }
  for (const auto& [knots, added] : {std::pair{&mapping.rest().u, &u}, std::pair{&mapping.rest().v, &v}}) {
    if (Status status = check_range("refine_knots: control points in one direction",
                                    knots->control_point_count() + static_cast<int>(added->size()),
                                    sculpted_control_point_count_range);
        !status.ok()) {
      return status.error();
    }
  }
  return mapping.refined(u, v, body.lattice, planes_through(body, planes));
}

// Exchanges two mappings until its end. Contacts are made from bodies, so a body gets its refined mapping for
// a moment.
class LentMapping {
 public:
  LentMapping(BodyMapping& one, BodyMapping& other) : one_(one), other_(other) { std::swap(one_, other_); }
  ~LentMapping() { std::swap(one_, other_); }
  LentMapping(const LentMapping&) = delete;
  LentMapping& operator=(const LentMapping&) = delete;

 private:
  BodyMapping& one_;
  BodyMapping& other_;
};

}  // namespace

Result<PreparedRefinement> prepare_refinement(const RefineKnots& command, std::vector<BodyState>& bodies,
                                              const RefinementScene& scene) {
  BodyState& body = bodies[static_cast<std::size_t>(command.body)];
  if (body.mesh()) {
    return Error{ErrorCode::unsupported, "refine_knots: the body has a mesh, not a surface", "body"};
  }
  if (!command.u && !command.v && !(body.mapping().residual().largest_m > 0.0)) {
    return Error{ErrorCode::inconsistent,
                 "refine_knots: nothing moved since the knots were last changed; shape the body first"};
  }
  Result<BodyMapping> finer = make_finer(command, body, scene.planes);
  if (!finer.ok()) return finer.error();
  std::vector<int> new_sample = finer->find_samples_of(body.mapping());
  SceneContacts contacts = [&] {
    const LentMapping lent(body.mapping(), finer.value());
    return make_scene_contacts(bodies, scene.contacts, scene.model);
  }();
  Surface surface = finer->current();
  return PreparedRefinement{command.body, std::move(finer).value(), std::move(contacts),
                            std::move(new_sample), std::move(surface)};
}

void adopt_refinement(Simulation::State& state, PreparedRefinement& prepared) {
  const auto index = static_cast<std::size_t>(prepared.body);
  BodyState& body = state.bodies[index];
  prepared.finer.adopt(body.mapping(), body.lattice);
  std::swap(body.mapping(), prepared.finer);
  Surface& surface = state.scene.bodies[index].surface;
  std::swap(surface, prepared.surface);
  surface = body.mapping().current();
  state.wanted_refinement.reset();
  exchange_contacts(state, prepared.contacts);
  for (std::size_t b = 0; b < state.self.size(); ++b) {
    if (state.bodies[b].mesh()) continue;
    const BodyMapping& now = state.bodies[b].mapping();
    state.self[b].carry_over(prepared.contacts.self[b], b == index ? prepared.finer : now, now);
  }
  state.tool.contact.carry_over(prepared.contacts.tool, prepared.body, prepared.new_sample);
  state.mirrored.contact.carry_over(prepared.contacts.mirrored, prepared.body, prepared.new_sample);
}

}  // namespace spoonbill
