#include "engine/material/springs/lattice_kernels.h"

namespace spoonbill::SPOONBILL_KERNELS {
namespace {

constexpr int block = lattice_block;
constexpr float tiny = 1e-30f;

inline float min(float a, float b) {
  return a < b ? a : b;
}
inline float max(float a, float b) {
  return a > b ? a : b;
}

// Flow and creep rules of a block of springs. In CommonFlow and CommonCreep all springs share one rule; in
// OwnFlow and OwnCreep each spring has its own.
struct CommonFlow {
  FlowRule rule;
  float yield(int) const { return rule.yield; }
  float hardening(int) const { return rule.hardening; }
  float rate_step(int) const { return rule.rate_step; }
};

struct OwnFlow {
  const float *yields, *hardenings, *rates;
  float time;
  float yield(int l) const { return yields[l]; }
  float hardening(int l) const { return hardenings[l]; }
  float rate_step(int l) const { return min(rates[l] * time, static_cast<float>(largest_flow_step)); }
};

struct CommonCreep {
  CreepRule rule;
  float fraction(int) const { return rule.fraction; }
  float rate_step(int) const { return rule.rate_step; }
};

struct OwnCreep {
  const float *fractions, *times;
  float time;
  float fraction(int l) const { return fractions[l]; }
  float rate_step(int l) const { return 1.0f / (1.0f + times[l] / time); }
};

// Returns the cube root of the volume ratio J by two Newton steps from the tangent at 1. The error is below
// 1e-4 for J from 0.5 to 2, and 0 at 1. Returns 0 for J outside 0.3 to 3, which stops the flow of
// such a cell: flow would adopt the distortion of a crushed or torn cell as the new shape.
inline float cube_root(float j) {
  const float a = min(max(j, 0.3f), 3.0f);
  float y = 1.0f + (a - 1.0f) * (1.0f / 3.0f);
  y = y - (y * y * y - a) / (3.0f * y * y);
  y = y - (y * y * y - a) / (3.0f * y * y);
  return a == j ? y : 0.0f;
}

// Computes the squared present length of each spring of a block, m^2.
inline void square_block(const LatticeView& view, const SpringArrays& s, int start,
                         float* __restrict square) {
  const int o = s.offset;
  const float *dx = view.dx + start, *dy = view.dy + start, *dz = view.dz + start;
  const float *rx = s.rest_x + start, *ry = s.rest_y + start, *rz = s.rest_z + start;
  for (int l = 0; l < block; ++l) {
    const float ax = rx[l] + (dx[l + o] - dx[l]), ay = ry[l] + (dy[l + o] - dy[l]),
                az = rz[l] + (dz[l + o] - dz[l]);
    square[l] = ax * ax + ay * ay + az * az + tiny;
  }
}

template <class Rule>
inline void flow_block(const float* __restrict square, const float* __restrict root,
                       const float* __restrict root_far, const float* __restrict stiffness,
                       const float* __restrict first, float* __restrict rest_length,
                       float* __restrict square_difference, const Rule& rule) {
  for (int l = 0; l < block; ++l) {
    const float rest = rest_length[l];
    const float strain =
        __builtin_sqrtf(square[l]) / (rest * max(0.5f * (root[l] + root_far[l]), 0.1f)) - 1.0f;
    const float yielded = rest / first[l] - 1.0f;
    const float yield = rule.yield(l) + rule.hardening(l) * max(yielded, -yielded);
    const float beyond = max(strain - yield, 0.0f) + min(strain + yield, 0.0f);
    const float limited = min(max(beyond * rule.rate_step(l), -0.1f), 0.1f) * rest;
    const float next = min(max(rest + limited, 0.5f * first[l]), 2.0f * first[l]);
    const float change = stiffness[l] > 0.0f && root[l] > 0.0f && root_far[l] > 0.0f ? next - rest : 0.0f;
    square_difference[l] -= change * (2.0f * rest + change);
    rest_length[l] = rest + change;
  }
}

// Returns whether any spring of a block may be strained beyond yield. Uses no roots or quotients. The margin
// of 1e-5 far exceeds the rounding errors of this test and of the strain in flow_block().
template <class Rule>
inline bool may_flow(const float* __restrict square, const float* __restrict root,
                     const float* __restrict root_far, const float* __restrict stiffness,
                     const float* __restrict rest, const Rule& rule) {
  alignas(64) float beyond[16] = {}, always[16] = {};
  for (int start = 0; start < block; start += 16) {
    for (int l = 0; l < 16; ++l) {
      const int i = start + l;
      const float margin = rule.yield(i) - 1e-5f, over = 1.0f + margin, under = max(1.0f - margin, 0.0f);
      const float free = rest[i] * max(0.5f * (root[i] + root_far[i]), 0.1f), free_square = free * free;
      const float out = max(square[i] - over * over * free_square, under * under * free_square - square[i]);
      const float flows = rule.rate_step(i) > 0.0f ? stiffness[i] : 0.0f;
      beyond[l] = max(beyond[l], out * flows);
      always[l] = max(always[l], margin > 0.0f ? 0.0f : 1.0f);
    }
  }
  for (int l = 1; l < 16; ++l) beyond[0] = max(beyond[0], beyond[l]);
  for (int l = 1; l < 16; ++l) always[0] = max(always[0], always[l]);
  return beyond[0] > 0.0f || always[0] > 0.0f;
}

void compute_dilation_roots(const LatticeView& view, float* __restrict root) {
  average_dilations(view);
  const float* __restrict dilation = view.node_dilation;
  for (int i = 0; i < view.padded_count; ++i) root[i] = cube_root(dilation[i]);
}

// Applies plastic flow to the springs of one direction. `rule_at` receives the first node of a block and
// returns the block's rule.
template <class RuleAt>
inline void flow_springs(const LatticeView& view, const SpringArrays& s, const RuleAt& rule_at) {
  const float* const root = view.fx;
  alignas(64) float square[block];
  for (int start = 0; start < view.padded_count; start += block) {
    if (view.active_block[start / block] == 0) continue;
    const float *near = root + start, *far = near + s.offset, *stiffness = s.stiffness + start;
    const auto rule = rule_at(start);
    square_block(view, s, start, square);
    if (!may_flow(square, near, far, stiffness, s.rest_length + start, rule)) continue;
    flow_block(square, near, far, stiffness, s.first_rest_length + start, s.rest_length + start,
               s.square_difference + start, rule);
  }
}

template <class Rule>
inline void creep_block(const float* __restrict square, const float* __restrict root,
                        const float* __restrict root_far, const float* __restrict stiffness,
                        const float* __restrict first, float* __restrict crept, float* __restrict rest_length,
                        float* __restrict square_difference, const Rule& rule) {
  for (int l = 0; l < block; ++l) {
    const float rest = rest_length[l], own = rest / (1.0f + crept[l]);
    const float strain =
        __builtin_sqrtf(square[l]) / (own * max(0.5f * (root[l] + root_far[l]), 0.1f)) - 1.0f;
    const float moved = own * (1.0f + crept[l] + rule.rate_step(l) * (rule.fraction(l) * strain - crept[l]));
    const float bounded = min(max(moved, 0.5f * first[l]), 2.0f * first[l]);
    const bool creeps =
        rule.fraction(l) > 0.0f && stiffness[l] > 0.0f && root[l] > 0.0f && root_far[l] > 0.0f;
    const float next = creeps ? bounded : rest, change = next - rest;
    square_difference[l] -= change * (2.0f * rest + change);
    rest_length[l] = rest + change;
    crept[l] = next / own - 1.0f;
  }
}

template <class RuleAt>
inline void creep_springs(const LatticeView& view, const SpringArrays& s, const RuleAt& rule_at) {
  const float* const root = view.fx;
  alignas(64) float square[block];
  for (int start = 0; start < view.padded_count; start += block) {
    if (view.active_block[start / block] == 0) continue;
    square_block(view, s, start, square);
    creep_block(square, root + start, root + start + s.offset, s.stiffness + start,
                s.first_rest_length + start, s.crept + start, s.rest_length + start,
                s.square_difference + start, rule_at(start));
  }
}

}  // namespace

void flow(const LatticeView& view, const FlowRule& rule) {
  compute_dilation_roots(view, view.fx);
  for (const SpringArrays& s : view.springs) {
    if (s.flow_rate) {
      flow_springs(view, s, [&](int start) {
        return OwnFlow{s.yield + start, s.hardening + start, s.flow_rate + start, rule.time_s};
      });
    } else {
      flow_springs(view, s, [&](int) { return CommonFlow{rule}; });
    }
  }
}

void creep(const LatticeView& view, int direction, const CreepRule& rule) {
  compute_dilation_roots(view, view.fx);
  const SpringArrays& s = view.springs[direction];
  if (s.relaxing_fraction) {
    creep_springs(view, s, [&](int start) {
      return OwnCreep{s.relaxing_fraction + start, s.relaxation_time + start, rule.time_s};
    });
  } else {
    creep_springs(view, s, [&](int) { return CommonCreep{rule}; });
  }
}

}  // namespace spoonbill::SPOONBILL_KERNELS
