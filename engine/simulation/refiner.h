// Prepares refinements of a simulation's surfaces on another thread while the simulation goes on.
#pragma once

#include <memory>

#include "engine/base/result.h"
#include "engine/scene/scene.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {

// A copy of what refinements depend on. Has one owner at a time, who may pass it to another thread. It serves
// until a build is exchanged, or a command other than one that the refiner has prepared replaces a mapping, a
// lattice or the model of the tool.
class Refiner {
 public:
  explicit Refiner(const Simulation& simulation);
  Refiner(Refiner&&) noexcept;
  Refiner& operator=(Refiner&&) noexcept;
  ~Refiner();

  // Prepares a refinement of the elements in given ranges; discards one that was prepared before and not
  // adopted. Takes up to 0.1 s, and allocates. An error leaves nothing prepared.
  Status prepare(const RefineKnots& command);
  bool is_prepared() const;

 private:
  friend class Simulation;
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace spoonbill
