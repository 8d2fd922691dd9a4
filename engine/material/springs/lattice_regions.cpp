// What springs of a lattice of several materials have of their own.
#include <algorithm>
#include <cmath>

#include "engine/material/springs/lattice_assembly.h"

namespace spoonbill {
namespace {

// Damping times that differ by less count as one.
constexpr double same_time = 1e-6;

template <class Of>
bool differ(const LatticeMaterials& materials, const Of& of) {
  return std::any_of(materials.materials.begin(), materials.materials.end(),
                     [&](const Material& material) { return of(material) != of(materials.own()); });
}

// Of its pressure waves, squared: E (1 - nu) / ((1 + nu) (1 - 2 nu)) over the density.
double wave_speed_square(const Material& material) {
  const double poisson = std::max(material.poissons_ratio, min_spring_poissons_ratio);
  return material.youngs_modulus_pa * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson)) /
         material.density_kg_per_m3;
}

std::vector<double> damping_times_s(const LatticeMaterials& materials, double fastest_frequency) {
  double fastest_square = 0.0;
  for (const Material& material : materials.materials) {
    fastest_square = std::max(fastest_square, wave_speed_square(material));
  }
  std::vector<double> times;
  for (const Material& material : materials.materials) {
    const double own = fastest_frequency * std::sqrt(wave_speed_square(material) / fastest_square);
    times.push_back(2.0 * material.damping_ratio / own);
  }
  return times;
}

}  // namespace

void SpringLattice::store_stiffening(const Assembly& sum) {
  if (!differ(materials_, [](const Material& of) { return of.stiffening; })) return;
  for (std::size_t d = 0; d < lattice_direction_count; ++d) {
    stiffening_[d].assign(stiffness_[d].size(), 0.0f);
    for (std::size_t n = 0; n < sum.mass.size(); ++n) {
      if (!(sum.stiffness[d][n] > 0.0)) continue;
      double mean = 0.0;
      for (std::size_t m = 0; m < sum.by_material.size(); ++m) {
        mean += sum.by_material[m][d][n] / sum.stiffness[d][n] * materials_.materials[m].stiffening;
      }
      stiffening_[d][n] = static_cast<float>(mean);
    }
  }
}

void SpringLattice::store_flow_and_creep(const Assembly& sum) {
  for (const Material& material : materials_.materials) {
    flows_ = flows_ || material.plastic;
    creeps_ = creeps_ || material.relaxing_fraction > 0.0;
  }
  const bool own_flow = flows_ && differ(materials_, [](const Material& of) {
                          return std::array<double, 4>{of.plastic ? 1.0 : 0.0, of.yield_strain,
                                                       of.flow_rate_per_s, of.hardening};
                        });
  const bool own_creep = creeps_ && differ(materials_, [](const Material& of) {
                           return std::array<double, 2>{of.relaxing_fraction, of.relaxation_time_s};
                         });
  if (!own_flow && !own_creep) return;
  for (std::size_t d = 0; d < lattice_direction_count; ++d) {
    const std::size_t size = stiffness_[d].size();
    if (own_flow) {
      for (Floats* of : {&yield_[d], &hardening_[d], &flow_rate_[d]}) of->assign(size, 0.0f);
      std::fill(yield_[d].begin(), yield_[d].end(), 1.0f);  // what does not flow asks for nothing
    }
    if (own_creep) {
      relaxing_share_[d].assign(size, 0.0f);
      relaxation_time_[d].assign(size, 1.0f);
    }
    for (std::size_t n = 0; n < sum.mass.size(); ++n) {
      const Material& of = materials_.materials[sum.leading_material(static_cast<int>(d), n)];
      if (own_flow && of.plastic) {
        yield_[d][n] = static_cast<float>(of.yield_strain);
        hardening_[d][n] = static_cast<float>(of.hardening);
        flow_rate_[d][n] = static_cast<float>(of.flow_rate_per_s);
      }
      if (own_creep) {
        relaxing_share_[d][n] = static_cast<float>(of.relaxing_fraction);
        relaxation_time_[d][n] = static_cast<float>(of.relaxation_time_s);
      }
    }
  }
}

void SpringLattice::take_damping(const Assembly& sum) {
  if (!materials_.are_several()) {
    damping_time_ = step_damping_time_ =
        static_cast<float>(2.0 * material().damping_ratio / fastest_frequency_);
    return;
  }
  const std::vector<double> times_s = damping_times_s(materials_, fastest_frequency());
  const auto [least, most] = std::minmax_element(times_s.begin(), times_s.end());
  damping_time_ = step_damping_time_ = static_cast<float>(*least);
  if (*most - *least > same_time * *most) take_further_damping(sum, times_s);
}

void SpringLattice::take_further_damping(const Assembly& sum, const std::vector<double>& times_s) {
  const double least = *std::min_element(times_s.begin(), times_s.end());
  for (std::size_t d = 0; d < lattice_direction_count; ++d) {
    further_damping_[d].assign(stiffness_[d].size(), 0.0f);
    for (std::size_t n = 0; n < sum.mass.size(); ++n) {
      double damping = 0.0;
      for (std::size_t m = 0; m < times_s.size(); ++m) {
        damping += sum.by_material[m][d][n] * (times_s[m] - least);
      }
      further_damping_[d][n] = static_cast<float>(damping);
    }
  }
  further_bulk_damping_.assign(bulk_.size(), 0.0f);
  slowest_damping_.assign(node_mass_.size(), 0.0f);
  for (int i = 0; i + 1 < mesh_.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh_.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh_.count[2]; ++k) {
        const auto further =
            static_cast<float>(times_s[materials_.index_of(mesh_.cell_index(i, j, k))] - least);
        const int first = mesh_.index(i, j, k);
        // One that gives way would drive, and not damp.
        further_bulk_damping_[first] = further * std::max(bulk_[first], 0.0f);
        for (int c = 0; c < 8; ++c) {
          float& slowest = slowest_damping_[mesh_.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1))];
          slowest = std::max(slowest, further);
        }
      }
    }
  }
  for (std::size_t s = 0; s < seam_.size(); s += 2) {
    float &first = slowest_damping_[seam_[s]], &second = slowest_damping_[seam_[s + 1]];
    first = second = std::max(first, second);
  }
  step_damping_time_ = static_cast<float>(damped_square() / (fastest_frequency() * fastest_frequency()));
}

// The largest eigenvalue of the damping over the mass, 1/s: a step h is stable where h^2 w^2 + 2 h of it
// stays below 4. Measured as the frequency is, with every spring and cell as stiff as it is damped.
double SpringLattice::damped_square() {
  const Floats vector[3] = {power_x_, power_y_, power_z_}, bulk = bulk_;
  Floats stiffness[lattice_direction_count];
  for (std::size_t d = 0; d < lattice_direction_count; ++d) {
    stiffness[d] = stiffness_[d];
    for (std::size_t n = 0; n < stiffness[d].size(); ++n) {
      stiffness_[d][n] = damping_time_ * stiffness[d][n] + further_damping_[d][n];
    }
  }
  for (std::size_t n = 0; n < bulk.size(); ++n) bulk_[n] = damping_time_ * bulk[n] + further_bulk_damping_[n];
  const double root = measured_frequency();
  bulk_ = bulk;
  for (std::size_t d = 0; d < lattice_direction_count; ++d) stiffness_[d] = stiffness[d];
  power_x_ = vector[0];
  power_y_ = vector[1];
  power_z_ = vector[2];
  return root * root;
}

}  // namespace spoonbill
