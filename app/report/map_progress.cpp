#include "app/report/map_progress.h"

namespace spoonbill {

MapProgress::MapProgress(Console& console, bool asked_for)
    : bar_(console, "Spreading the lattice's nodes", asked_for) {}

FeatureMapWatch MapProgress::watch() {
  return {Progress([this](double fraction) {
            bar_.show(fraction);
            return true;
          }),
          [this](const FeatureMapReport& report) { reports_.push_back(report); }};
}

}  // namespace spoonbill
