// Tests of the contacts between bodies on blocks of which each moves as one.
#include "engine/material/contact/body_contacts.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "tests/engine/material/block.h"

namespace spoonbill {
namespace {

constexpr double h_s = 1e-4;
constexpr double infinitely_deep = std::numeric_limits<double>::infinity();
constexpr std::array<float, 3> no_caps = {1e30f, 1e30f, 1e30f};

// Blocks of 10 mm in a row along x. A point of a block is the mean of all its nodes, so that a push moves the
// whole block.
class Row {
 public:
  explicit Row(int count) {
    for (int b = 0; b < count; ++b) {
      blocks_.push_back(block(Vector3::Constant(0.01), {2, 2, 2}, elastic_material(1e4, 0.3, 1000.0)));
    }
  }

  BodyPoint point(int body) const {
    BodyPoint point{body, &blocks_[static_cast<std::size_t>(body)], {}};
    point.point.count = 8;
    for (int n = 0; n < 8; ++n) {
      point.point.node[n] = n;
      point.point.weight[n] = 0.125f;
    }
    return point;
  }
  void set_velocity(int body, double m_per_s) {
    for (int n = 0; n < 8; ++n) lattice(body).set_velocity(n, Vector3(m_per_s, 0.0, 0.0));
  }
  double velocity(int body) const { return blocks_[static_cast<std::size_t>(body)].velocity(0).x(); }
  double moved_m(int body) const { return blocks_[static_cast<std::size_t>(body)].displacement(0).x(); }
  void move(int body, double by_m) {
    for (int n = 0; n < 8; ++n) lattice(body).set_displacement(n, Vector3(moved_m(body) + by_m, 0.0, 0.0));
  }

  std::vector<LatticeView> views() {
    std::vector<LatticeView> views;
    for (SpringLattice& each : blocks_) views.push_back(each.view());
    return views;
  }
  std::array<const SpringLattice*, 3> lattices() const {
    std::array<const SpringLattice*, 3> all{};
    for (std::size_t b = 0; b < blocks_.size(); ++b) all[b] = &blocks_[b];
    return all;
  }

 private:
  SpringLattice& lattice(int body) { return blocks_[static_cast<std::size_t>(body)]; }

  std::vector<SpringLattice> blocks_;
};

// Adds the contact that keeps body `first` at larger x than body `second`.
bool add(BodyContacts& contacts, const Row& row, int first, int second, double gap_m, int sample = 0,
         double deepest_new_m = infinitely_deep) {
  return contacts.add(row.point(first), row.point(second), Vector3::UnitX(), gap_m, deepest_new_m, sample);
}

void substep(BodyContacts& contacts, Row& row) {
  const std::vector<LatticeView> views = row.views();
  contacts.start(views, h_s);
  for (const bool is_reversed : {false, true}) {
    contacts.pass(views, {h_s, MovedBy::springs, is_reversed, no_caps});
  }
}

// Lets a body approach another one, 0.01 mm away, for a substep.
void approach(double speed_m_per_s, Row& row, BodyContacts& contacts) {
  row.set_velocity(1, speed_m_per_s);
  ASSERT_TRUE(add(contacts, row, 0, 1, 1e-5));
  contacts.begin(1e-3);
  substep(contacts, row);
}

TEST(BodyContacts, AFastBodyClosesAtMostHalfOfAGap) {
  Row row(2);
  BodyContacts contacts(4);
  approach(1.0, row, contacts);
  // Positions are in single precision, and so are velocities.
  EXPECT_NEAR(row.velocity(1) - row.velocity(0), 0.5 * 1e-5 / h_s, 1e-6);
  EXPECT_NEAR(row.velocity(1) + row.velocity(0), 1.0, 1e-6);
  EXPECT_TRUE(contacts.acted(0, 1));
}

TEST(BodyContacts, ASlowBodyIsNotPushed) {
  Row row(2);
  BodyContacts contacts(4);
  approach(0.04, row, contacts);
  EXPECT_EQ(row.velocity(0), 0.0);
  EXPECT_FALSE(contacts.acted(0, 1));
}

// The contact with the last body has no reason to act before the first body pushes the one between them. Each
// order of the contacts must find this out within the substep.
TEST(BodyContacts, APushIsPassedOnWithinASubstep) {
  for (const bool last_first : {false, true}) {
    Row row(3);
    row.set_velocity(0, 1.0);
    BodyContacts contacts(4);
    if (last_first) {
      ASSERT_TRUE(add(contacts, row, 2, 1, 1e-6, 1));
    }
    ASSERT_TRUE(add(contacts, row, 1, 0, 1e-6, 0));
    if (!last_first) {
      ASSERT_TRUE(add(contacts, row, 2, 1, 1e-6, 1));
    }
    contacts.begin(1e-3);
    substep(contacts, row);
    EXPECT_GT(row.velocity(2), 0.1) << "last first: " << last_first;
    EXPECT_TRUE(contacts.acted(1, 2));
  }
}

// A point beyond its cell has negative weights, and moves farther than any node when a node is pushed.
TEST(BodyContacts, APushIsPassedOnToAPointBeyondItsCell) {
  Row row(3);
  row.set_velocity(0, 1.0);
  BodyPoint beyond = row.point(1);
  beyond.point.count = 2;
  beyond.point.weight[0] = 3.0f;
  beyond.point.weight[1] = -2.0f;
  BodyPoint pushed = row.point(1);
  pushed.point.count = 1;
  pushed.point.weight[0] = 1.0f;
  BodyContacts contacts(4);
  ASSERT_TRUE(contacts.add(pushed, row.point(0), Vector3::UnitX(), 1e-6, infinitely_deep, 0));
  // The pushed node gets 0.11 m/s, and the point beyond it three times as much.
  ASSERT_TRUE(contacts.add(row.point(2), beyond, Vector3::UnitX(), 4e-5, infinitely_deep, 1));
  contacts.begin(1e-3);
  substep(contacts, row);
  EXPECT_TRUE(contacts.acted(1, 2));
}

// A search finds bodies overlapping by 1 um that had a gap of 10 um and have not moved. Returns the number of
// ticks after which they are moved apart.
int ticks_until_separated(bool is_real_time) {
  Row row(2);
  BodyContacts contacts(4);
  contacts.set_real_time(is_real_time);
  EXPECT_TRUE(add(contacts, row, 0, 1, 1e-5));
  contacts.begin(1e-3);
  contacts.clear(row.lattices());
  EXPECT_TRUE(add(contacts, row, 0, 1, -1e-6));
  contacts.begin(1e-3);
  for (int tick = 0; tick < 200; ++tick) {
    const double before_m = row.moved_m(0);
    substep(contacts, row);
    contacts.separate(row.views(), h_s, no_caps);
    if (row.moved_m(0) > before_m) return tick;
    contacts.keep();
  }
  return 200;
}

// The gap becomes negative when the part f that is taken over in a tick satisfies (1 - f)^n < 1 / 11, after n
// = 13 or 47 times. add() takes over for the first time, so that this is one tick earlier.
TEST(BodyContacts, AGapIsTakenOverLittleByLittle) {
  EXPECT_EQ(ticks_until_separated(false), 12);
  EXPECT_EQ(ticks_until_separated(true), 46);
}

TEST(BodyContacts, AnOverlapIsCorrectedWithoutMotion) {
  Row row(2);
  BodyContacts contacts(4);
  ASSERT_TRUE(add(contacts, row, 0, 1, -1e-4));
  contacts.begin(1e-3);
  for (int s = 0; s < 2000; ++s) {
    substep(contacts, row);
    contacts.separate(row.views(), h_s, no_caps);
  }
  EXPECT_NEAR(row.moved_m(0) - row.moved_m(1), 1e-4, 1e-6);
  EXPECT_EQ(row.velocity(0), 0.0);
  EXPECT_EQ(row.velocity(1), 0.0);
}

TEST(BodyContacts, ANewDeepPointIsLeftOutUnlessBodiesBeginInEachOther) {
  Row row(2);
  BodyContacts contacts(4);
  ASSERT_TRUE(add(contacts, row, 0, 1, -2e-3, 0, 1e-3));
  EXPECT_EQ(contacts.count(), 1);
  contacts.begin(1e-3);
  contacts.clear(row.lattices());
  ASSERT_TRUE(add(contacts, row, 0, 1, -2e-3, 0, 1e-3)) << "it had a contact in the last tick";
  ASSERT_TRUE(add(contacts, row, 0, 1, -2e-3, 1, 1e-3));
  EXPECT_EQ(contacts.count(), 1);
  contacts.forget();
  ASSERT_TRUE(add(contacts, row, 0, 1, -2e-3, 1, 1e-3));
  EXPECT_EQ(contacts.count(), 1);
}

TEST(BodyContacts, AContactWhoseNormalTurnsRoundKeepsItsOwn) {
  Row row(2);
  row.set_velocity(1, 1.0);
  BodyContacts contacts(4);
  ASSERT_TRUE(add(contacts, row, 0, 1, 1e-5));
  contacts.begin(1e-3);
  contacts.clear(row.lattices());
  ASSERT_TRUE(contacts.add(row.point(0), row.point(1), -Vector3::UnitX(), -1e-5, infinitely_deep, 0));
  contacts.begin(1e-3);
  substep(contacts, row);
  EXPECT_NEAR(row.velocity(1) - row.velocity(0), 0.5 * 1e-5 / h_s, 1e-6);
}

// Body 1 moves towards body 0 and away from body 2.
TEST(BodyContacts, FindsHowFastBodiesMeet) {
  Row row(3);
  BodyContacts contacts(4);
  row.set_velocity(1, 1.5);
  ASSERT_TRUE(add(contacts, row, 0, 1, 1e-3));
  ASSERT_TRUE(add(contacts, row, 1, 2, 1e-3));
  const auto find = [&](double time_s) { return contacts.find_impacts_m_per_s(row.views(), time_s); };
  EXPECT_DOUBLE_EQ(find(1e-3)[0], 1.5);
  EXPECT_DOUBLE_EQ(find(1e-3)[1], 1.5);
  EXPECT_EQ(find(1e-3)[2], 0.0);
  EXPECT_EQ(find(0.5e-3)[0], 0.0);
  row.set_velocity(1, -1.5);
  EXPECT_EQ(find(1e-3)[0], 0.0);
}

TEST(BodyContacts, RefusesMoreThanItsCapacity) {
  Row row(2);
  BodyContacts contacts(1);
  EXPECT_TRUE(add(contacts, row, 0, 1, 0.0, 0));
  EXPECT_FALSE(add(contacts, row, 0, 1, 0.0, 1));
  EXPECT_EQ(contacts.count(), 1);
}

}  // namespace
}  // namespace spoonbill
