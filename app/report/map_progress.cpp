#include "app/report/map_progress.h"

namespace spoonbill {

MapProgress::MapProgress(Console& console, bool asked_for)
    : bar_(console, "Spreading the lattice's nodes", asked_for) {}

FeatureMapWatch MapProgress::watch() {
  constexpr double steps = 1000.0;
  return {[this](double share) {
            bar_.show(static_cast<std::uint64_t>(steps * share), static_cast<std::uint64_t>(steps));
            return true;
          },
          [this](const FeatureMapReport& report) { reports_.push_back(report); }};
}

}  // namespace spoonbill
