// Summary of the cases of a study: for each series the tilts at which the food holds, the best tilt, and how
// far the repeats confirm it. A pure function of plan and results.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/study/next_cases.h"
#include "app/study/sobol_indices.h"

namespace spoonbill {

// A result at a tilt, after its repeats were compared with it.
struct JudgedTilt {
  double tilt_deg = 0.0;
  // Result with the usual steps, on the usual lattice or, where this and the finer one differ and the finest
  // one confirms the finer one, on the finer lattice.
  const CaseResult* result = nullptr;
  Verdict verdict = Verdict::undecided;  // undecided if repeats disagree
  bool is_repeated = false;
};

struct SeriesSummary {
  StudySeries series;
  std::vector<JudgedTilt> tilts;  // ascending
  // The longest range of tilts between which the food holds at each tilt tried; empty if it holds nowhere. It
  // ends halfway between the last tilt that holds and the next that is decided.
  std::optional<Range<double>> holds_deg;
  // True if no tilt beyond that end of the range is decided. The range then ends at the last tilt that holds.
  bool is_open_low = false, is_open_high = false;
  // The centre of the range, farthest from both ends; and the half width of the interval around it that the
  // spacing of the tilts and disagreeing repeats leave open.
  double best_deg = 0.0, uncertainty_deg = 0.0;
  std::vector<VerdictChange> changes;
};

// A repeat whose verdict differs from that of the case, or that of the finest lattice from that of the finer
// one.
struct Disagreement {
  StudyCase repeat;
  Verdict usual = Verdict::undecided, repeated = Verdict::undecided;
};

// How far half the step and a finer lattice change results.
struct TrustSummary {
  int repeats = 0;
  std::vector<Disagreement> disagreements;
  // Largest CaseDifference::time and mass.
  double largest_time_change = 0.0, largest_mass_change = 0.0;
};

// Sobol indices of the margin of the centre of mass to the rim.
struct SensitivitySummary {
  std::vector<FactorRange> ranges;
  SensitivityValues margins_m;      // of the rows in which every case was judged
  std::vector<SobolIndex> indices;  // of each range; empty if fewer than two rows were judged
  std::size_t dropped = 0;          // rows with a case that was not judged
};

struct StudySummary {
  std::vector<SeriesSummary> series;
  TrustSummary trust;
  std::optional<SensitivitySummary> sensitivity;
  std::vector<const DoneCase*> failures;  // cases that could not be judged, in the order of their keys
};

// `results` must outlive the summary.
StudySummary summarise(const StudyPlan& plan, const CaseResults& results);

}  // namespace spoonbill
