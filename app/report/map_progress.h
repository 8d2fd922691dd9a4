// How the feature maps of a document's lattices come along, as a bar for the person who waits, and what they
// made of the cells.
#pragma once

#include <optional>

#include "app/report/progress_bar.h"
#include "engine/material/lattice/feature_map.h"

namespace spoonbill {

// The console must outlive it, and it the watch().
class MapProgress {
 public:
  explicit MapProgress(Console& console, bool asked_for = false);

  FeatureMapWatch watch();
  // Of the first map that was done; none where no body asks for one.
  const std::optional<FeatureMapReport>& report() const { return report_; }

 private:
  ProgressBar bar_;
  std::optional<FeatureMapReport> report_;
};

}  // namespace spoonbill
