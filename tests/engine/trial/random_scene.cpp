#include "tests/engine/trial/random_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "engine/scene/place_body.h"
#include "engine/simulation/body_hold.h"
#include "tests/engine/forces/samples.h"

namespace spoonbill {
namespace {

// Random numbers that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}

  double between(double low, double high) { return low + (high - low) * engine_() / 4294967296.0; }
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(count)); }
  bool chance(double probability) { return between(0.0, 1.0) < probability; }
  template <class Values>
  const auto& choose(const Values& values) {
    return values[static_cast<std::size_t>(below(static_cast<int>(values.size())))];
  }
  Vector3 direction() {
    Vector3 vector;
    do {
      vector = {between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0)};
    } while (!(vector.norm() > 0.1 && vector.norm() < 1.0));
    return vector.normalized();
  }

 private:
  std::mt19937 engine_;
};

StockShapeSize random_size(Dice& dice) {
  const auto mm = [&](double low, double high) { return 1e-3 * dice.between(low, high); };
  switch (dice.below(4)) {
    case 0:
      return SphereSize{mm(5.0, 12.0)};
    case 1: {
      const Vector3 sides(mm(10.0, 25.0), mm(10.0, 25.0), mm(10.0, 25.0));
      return BoxSize{sides, dice.between(0.05, 0.3) * sides.minCoeff()};
    }
    case 2: {
      CylinderSize size{mm(5.0, 10.0), mm(10.0, 22.0), 0.0};
      size.rounding_m = default_rounding_m(size);
      return size;
    }
    default: {
      ConeSize size{mm(6.0, 12.0), mm(10.0, 20.0), mm(2.0, 6.0), 0.0};
      size.rounding_m = default_rounding_m(size);
      return size;
    }
  }
}

Body make_dish(Dice& dice, const Material& material) {
  Body dish;
  if (dice.chance(0.5)) {
    BowlSize size{0.07, 0.055, dice.between(0.005, 0.02), dice.between(0.7e-3, 2e-3)};
    dish = stock_body("bowl", size, Vector3::Zero(), material, 300);
    dish.rim = bowl_shape(size)->rim;
  } else {
    PlateSize size{0.09, 0.07, dice.between(0.7e-3, 4e-3)};
    size.corner_m = default_corner_m(size);
    dish = stock_body("plate", size, Vector3::Zero(), material, 300);
  }
  dish.kind = BodyKind::fixed;
  return dish;
}

double highest_m(const Surface& surface) {
  return *std::max_element(surface.net.y.begin(), surface.net.y.end());
}

// Turns a body about its middle, then moves its lowest point to a height beside the y axis.
void drop_from(Dice& dice, double height_m, Body& body) {
  const BodyPlacement turn{Vector3::Zero(), dice.direction(), dice.between(0.0, 180.0)};
  move_body(turn.pose(), body);
  const double lowest_m = *std::min_element(body.surface.net.y.begin(), body.surface.net.y.end());
  const Vector3 move(dice.between(-8e-3, 8e-3), height_m - lowest_m, dice.between(-8e-3, 8e-3));
  move_body({move, Quaternion::Identity()}, body);
}

}  // namespace

RandomScene make_random_scene(std::uint32_t seed) {
  static const std::vector<std::string> materials = bundled_material_names();
  Dice dice(seed);
  RandomScene random;
  Scene& scene = random.scene;
  const auto material = [&] {
    Material chosen = bundled_material(dice.choose(materials));
    if (dice.chance(0.5)) chosen.friction = dice.between(0.0, 0.6);
    return chosen;
  };
  const int count = 1 + dice.below(6);
  const bool has_dish = count > 1 && dice.chance(0.75);
  if (has_dish) scene.bodies.push_back(make_dish(dice, material()));
  if (!has_dish || dice.chance(0.5)) {
    scene.ground =
        Ground{Vector3(0.0, has_dish ? -0.04 : 0.0, 0.0), Vector3::UnitY(), dice.between(0.0, 0.6)};
  }
  double height_m = has_dish ? highest_m(scene.bodies[0].surface) : 0.0;
  while (scene.bodies.size() < static_cast<std::size_t>(count)) {
    Body body = stock_body("body " + std::to_string(scene.bodies.size()), random_size(dice), Vector3::Zero(),
                           material(), 150 + dice.below(250));
    if (dice.chance(0.3)) body.kind = BodyKind::rigid;
    if (dice.chance(0.5)) body.lattice.cells = LatticeCells::box;
    height_m += dice.between(0.5e-3, scene.bodies.size() == 1 ? 50e-3 : 10e-3);
    drop_from(dice, height_m, body);
    height_m = highest_m(body.surface);
    scene.bodies.push_back(std::move(body));
  }
  if (has_dish && dice.chance(0.6)) {
    const double arm_m = dice.between(0.02, 0.15), speed_m_per_s = dice.between(0.1, 1.0);
    const double angle = dice.between(0.0, 2.0 * std::numbers::pi);
    TurnBody shake;
    shake.point_m = {0.0, dice.chance(0.5) ? arm_m : -arm_m, 0.0};
    shake.axis = {std::cos(angle), 0.0, std::sin(angle)};
    shake.angle_deg = dice.between(5.0, 30.0);
    shake.speed_deg_per_s = std::min(360.0, speed_m_per_s / arm_m * 180.0 / std::numbers::pi);
    random.shake = shake;
  }
  return random;
}

}  // namespace spoonbill
