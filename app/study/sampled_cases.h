// The cases of sampled designs, which are drawn from ranges of factors: those of a Latin hypercube or a Sobol
// sequence, and those of a sensitivity analysis. Pure functions of the plan.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "app/study/sobol_indices.h"
#include "app/study/study_case.h"
#include "app/study/study_plan.h"

namespace spoonbill {

// Coordinates from 0 to 1.
using SamplePoint = std::vector<double>;

// Returns points of which each `count`-th part of each coordinate has one (McKay et al. 1979). The same seed
// gives the same points.
std::vector<SamplePoint> draw_latin_hypercube(int count, int dimensions, std::uint32_t seed);
// Returns the first points of the Sobol sequence (Joe and Kuo 2008) after the origin.
std::vector<SamplePoint> list_sobol_points(int count, int dimensions);

// Returns the cases of the plan's design; empty if it has none.
std::vector<StudyCase> list_design_cases(const StudyPlan& plan);

// The matrices of a sensitivity analysis (Saltelli et al. 2010). A and B are independent samples of all
// factors. Row j of mixed[i] is row j of A with the value of factor i from row j of B.
struct SensitivityCases {
  std::vector<StudyCase> a, b;
  std::vector<std::vector<StudyCase>> mixed;
};
SensitivityCases list_sensitivity_cases(const StudyPlan& plan);

// Returns all cases of both, in a fixed order. Some may be equal.
std::vector<StudyCase> list_sampled_cases(const StudyPlan& plan);

}  // namespace spoonbill
