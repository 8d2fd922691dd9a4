#include "tests/engine/exchange/sample_document.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

namespace spoonbill {

namespace {

constexpr int around = 6;
constexpr int along = 8;

ControlNet tube() {
  constexpr std::array<double, around> ring_y_mm = {6, 3, -3, -6, -3, 3};
  constexpr std::array<double, around> ring_z_mm = {0, 5.196, 5.196, 0, -5.196, -5.196};
  ControlNet net(around, along);
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      const bool pole = j == 0 || j == along - 1;
      const auto k = static_cast<std::size_t>(i);
      net.set_point(i, j,
                    Vector3(j * 40.0 / 7.0, pole ? 0.0 : ring_y_mm[k], pole ? 0.0 : ring_z_mm[k]) / 1000.0);
    }
  }
  return net;
}

void append(std::vector<double>& values, const Vector3& vector) {
  values.insert(values.end(), {vector.x(), vector.y(), vector.z()});
}

std::vector<double> numbers_of(const Document& document) {
  const Scene& scene = document.scene;
  const Material& material = scene.bodies[0].material;
  std::vector<double> numbers = {
      material.youngs_modulus_pa, material.poissons_ratio,    material.density_kg_per_m3,
      material.damping_time_s,    material.yield_strain,      material.flow_rate_per_s,
      material.hardening,         material.stiffening,        material.relaxing_fraction,
      material.relaxation_time_s, material.friction,          material.yield_strength_pa,
      scene.tool.radius_m,        scene.sculpting.drag_per_s, scene.sculpting.force_scale};
  append(numbers, scene.sculpting.gravity_m_per_s2);
  for (const FixingPlane& plane : scene.planes) {
    append(numbers, plane.point_m);
    append(numbers, plane.normal);
  }
  const Surface& surface = scene.bodies[0].surface;
  for (const auto* values :
       {&surface.u.knots(), &surface.v.knots(), &surface.net.x, &surface.net.y, &surface.net.z}) {
    numbers.insert(numbers.end(), values->begin(), values->end());
  }
  return numbers;
}

}  // namespace

Document sample_document() {
  Surface surface = make_surface(KnotVector::periodic_uniform(3, around).value(),
                                 KnotVector::clamped_uniform(3, along).value(), tube())
                        .value();
  const Material clay{"modelling-clay",
                      "for tests",
                      2e5,
                      0.45,
                      1700.0,
                      2.5e-5,
                      true,
                      0.02,
                      40.0,
                      0.125,
                      -2.5,
                      0.0,
                      1.0,
                      0.375,
                      1e6,
                      "for tests"};
  Scene scene{{Body{"stub", std::move(surface), clay, {}}}, {}, {}, {}};
  scene.planes.push_back({Vector3(0.01, 0.0, 0.0), Vector3::UnitX()});
  return {"stub", std::move(scene), Json{{"camera", {{"distance_mm", 250}}}}};
}

Document deformed_document(unsigned seed) {
  Document document = sample_document();
  std::mt19937_64 random(seed);
  const auto length_m = [&random] {
    const double mantissa = 1.0 + static_cast<double>(random() >> 11) / 9007199254740992.0;
    const double magnitude = std::ldexp(mantissa, static_cast<int>(random() % 20) - 18);
    return random() % 2 == 0 ? magnitude : -magnitude;
  };
  ControlNet& net = document.scene.bodies[0].surface.net;
  for (auto* values : {&net.x, &net.y, &net.z}) {
    for (double& value : *values) value = length_m();
  }
  FixingPlane& plane = document.scene.planes.front();
  plane.point_m = {length_m(), length_m(), -0.0};
  plane.normal = Vector3(length_m(), length_m(), length_m()).normalized();
  document.scene.tool.radius_m = std::abs(length_m()) / 8.0;
  document.scene.bodies[0].lattice.counts = {4, 8, 60};
  document.scene.bodies[0].lattice.feature_map = FeatureMapSettings{7, 0.25, 0.0625, 3.0, 0.75, 12};
  return document;
}

bool same_bits(const Document& a, const Document& b) {
  const std::vector<double> left = numbers_of(a), right = numbers_of(b);
  if (left.size() != right.size()) return false;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (std::bit_cast<std::uint64_t>(left[i]) != std::bit_cast<std::uint64_t>(right[i])) return false;
  }
  const Body &body = a.scene.bodies[0], &other = b.scene.bodies[0];
  const Tool &tool = a.scene.tool, &other_tool = b.scene.tool;
  return a.name == b.name && a.view == b.view && body.name == other.name &&
         body.surface.u == other.surface.u && body.surface.v == other.surface.v &&
         body.material.name == other.material.name && body.material.source == other.material.source &&
         body.material.plastic == other.material.plastic && body.lattice.counts == other.lattice.counts &&
         body.lattice.feature_map == other.lattice.feature_map &&
         body.lattice.node_budget == other.lattice.node_budget && tool.kind == other_tool.kind &&
         tool.action == other_tool.action && tool.substeps == other_tool.substeps;
}

Surface wavy_sheet(int rows, int columns) {
  const auto knots = [](int count) {
    std::vector<double> all(4, 0.0);
    for (int k = 1; k < count - 3; ++k) all.push_back(static_cast<double>(k) / (count - 3));
    all.insert(all.end(), 4, 1.0);
    return KnotVector::open(3, std::move(all)).value();
  };
  ControlNet net(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) net.set_point(i, j, {1e-3 * j, 0.01 * std::sin(0.01 * j), 1e-3 * i});
  }
  return make_surface(knots(rows), knots(columns), std::move(net)).value();
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "spoonbill-test-XXXXXX").string();
  path_ = mkdtemp(pattern.data());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryFolder::write(const std::string& name, const std::string& content) const {
  std::ofstream(path_ / name, std::ios::binary) << content;
  return path_ / name;
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace spoonbill
