#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "engine/collision/levels/cell_pairs.h"
#include "tests/engine/collision/surfaces/random_pairs.h"

namespace spoonbill {
namespace {

Surface random_of(Random& random) {
  return random_pair(random, 0.0).first;
}

// The samples of an element, which is a pair of knot spans, must have the same bits whether they are
// evaluated one by one or all at once. A contact must not depend on the order in which cells are evaluated.
TEST(CellSlabs, SamplesHaveTheSameBitsHoweverTheyAreEvaluated) {
  Random random(94);
  for (int trial = 0; trial < 60; ++trial) {
    const Surface surface = random_of(random);
    const NestedGrid nested = make_nested_grid(surface.u, surface.v, random.integer(0, 3)).value();
    SurfaceLevels one_by_one(nested);
    one_by_one.begin(surface);
    const int columns = nested.grid.columns(), cells = 1 << nested.levels;
    for (const InstructionSet set : available_instruction_sets()) {
      SurfaceLevels whole(nested, set);
      whole.begin(surface);
      for (int e = 0; e < whole.bounds().elements_u(); ++e) {
        for (int f = 0; f < whole.bounds().elements_v(); ++f) {
          whole.sample_element(e, f);
          for (int k = 0; k < (cells + 1) * (cells + 1); ++k) {
            const int index = (e * cells + k / (cells + 1)) * columns + f * cells + k % (cells + 1);
            ASSERT_EQ(whole.sample(index), one_by_one.sample(index)) << trial << ' ' << name_of(set);
          }
        }
      }
    }
  }
}

TEST(CellSlabs, SlabsHoldTheirPatches) {
  Random random(95);
  for (int trial = 0; trial < 300; ++trial) {
    const Surface surface = random_of(random);
    const NestedGrid nested = make_nested_grid(surface.u, surface.v, 2).value();
    SurfaceLevels levels(nested);
    levels.begin(surface);
    CellSlabs slabs(levels);
    const CellSlabs::QuadtreeCell element =
        slabs.element(random.integer(0, levels.bounds().elements_u() - 1),
                      random.integer(0, levels.bounds().elements_v() - 1));
    const int lane = random.integer(0, 3);
    const SlabGroup& group = slabs.children(element);
    const LevelCell cell = slabs.child(element, lane).cell;
    const auto vector = [&](const float(&values)[3][slab_lanes]) {
      return Vector3(values[0][lane], values[1][lane], values[2][lane]);
    };
    const Vector3 centre = vector(group.centre), normal = vector(group.normal);
    const Vector3 any =
        Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1)).normalized();
    const double extent = std::abs(any.dot(vector(group.along_u))) +
                          std::abs(any.dot(vector(group.along_v))) + group.slack[lane];
    const int step = levels.step(cell.level);
    const std::vector<double>& in_u = nested.grid.u.parameters;
    const std::vector<double>& in_v = nested.grid.v.parameters;
    for (int k = 0; k < 20; ++k) {
      const Vector3 point = position(surface, random.uniform(in_u[cell.i], in_u[cell.i + step]),
                                     random.uniform(in_v[cell.j], in_v[cell.j + step]));
      EXPECT_LE(std::abs(normal.dot(point - centre)), group.thickness[lane]) << trial;
      EXPECT_LE(std::abs(any.dot(point - centre)), extent) << trial;
    }
  }
}

TEST(CellSlabs, EveryInstructionSetFindsTheSameCells) {
  Random random(96);
  int met = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const RandomPair pair = random_pair(random, 0.5);
    const NestedGrid a = make_nested_grid(pair.first.u, pair.first.v, 2).value();
    const NestedGrid b = make_nested_grid(pair.second.u, pair.second.v, 2).value();
    SlabGroup reference[2];
    unsigned expected = 0;
    for (const InstructionSet set : available_instruction_sets()) {
      SurfaceLevels first(a, set), second(b, set);
      first.begin(pair.first);
      second.begin(pair.second);
      CellSlabs of_first(first), of_second(second);
      const SlabGroup groups[2] = {of_first.children(of_first.element(0, 0)),
                                   of_second.children(of_second.element(0, 0))};
      const unsigned bits = first.kernels().find_meeting(groups[0], slab_lanes, groups[1], 0.1F);
      if (set == InstructionSet::baseline) {
        std::memcpy(static_cast<void*>(reference), groups, sizeof groups);
        expected = bits;
        met += bits != 0U ? 1 : 0;
      }
      EXPECT_EQ(bits, expected) << trial << ' ' << name_of(set);
      EXPECT_EQ(std::memcmp(groups, reference, sizeof groups), 0) << trial << ' ' << name_of(set);
    }
  }
  EXPECT_GT(met, 10);
  EXPECT_LT(met, 190);
}

}  // namespace
}  // namespace spoonbill
