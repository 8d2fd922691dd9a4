// How the feature maps of a document's lattices come along, as a bar for the person who waits, and what they
// made of the cells.
#pragma once

#include <vector>

#include "app/report/progress_bar.h"
#include "engine/material/lattice/feature_map.h"

namespace spoonbill {

// The console must outlive it, and it the watch().
class MapProgress {
 public:
  explicit MapProgress(Console& console, bool asked_for = false);

  FeatureMapWatch watch();
  // Of the maps that were done, in the order of the bodies that ask for one.
  const std::vector<FeatureMapReport>& reports() const { return reports_; }

 private:
  ProgressBar bar_;
  std::vector<FeatureMapReport> reports_;
};

}  // namespace spoonbill
