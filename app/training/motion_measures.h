// Measures of how a person moved.
#pragma once

#include <vector>

#include "engine/base/geometry.h"

namespace spoonbill {

// Returns the length of the path through positions, m.
double find_path_length_m(const std::vector<Vector3>& positions_m);

// Returns the spectral arc length of a speed, which is sampled at `rate_hz`: the negative length of its
// amplitude spectrum, scaled to a square of one, up to 10 Hz or the last frequency with a twentieth of the
// mean speed's amplitude (Balasubramanian et al. 2015, J. NeuroEng. Rehabil. 12:112). About -1.4 for one
// smooth reach; less if the motion is less smooth. 0 if nothing moved.
double find_spectral_arc_length(const std::vector<double>& speeds_m_per_s, double rate_hz);

// Returns the root mean square of the motion of more than about 3 Hz, such as tremor, m: what is left of
// positions when their mean over the quarter second around is subtracted, and that of what is left once more.
double find_tremor_m(const std::vector<Vector3>& positions_m, double rate_hz);

}  // namespace spoonbill
