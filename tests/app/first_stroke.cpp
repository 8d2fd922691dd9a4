#include "tests/app/first_stroke.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "engine/bspline/evaluate.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

constexpr int stations = 300;

}  // namespace

std::span<const FirstShape> first_shapes() {
  static const std::array<FirstShape, 9> shapes = {{
      {"sphere", {"--radius", "30mm"}, Vector3(0.03, 0, 0), Vector3::UnitX(), 0.06},
      {"box", {"--size", "60x40x20mm"}, Vector3(0, 0.02, 0), Vector3::UnitY(), 0.04},
      {"cylinder", {"--radius", "20mm", "--height", "60mm"}, Vector3(0, 0.03, 0), Vector3::UnitY(), 0.06},
      {"cone", {"--radius", "30mm", "--height", "60mm"}, Vector3(0.015, 0, 0), Vector3(0.9, 0.45, 0), 0.03},
      {"torus", {"--ring", "40mm", "--tube", "10mm"}, Vector3(0.04, 0.01, 0), Vector3::UnitY(), 0.02},
      {"plate", {"--size", "100x60mm", "--thickness", "3mm"}, Vector3(0, 0.0015, 0), Vector3::UnitY(), 0.003},
      {"plate",
       {"--sheet", "--size", "100x60mm", "--thickness", "2mm"},
       Vector3::Zero(),
       Vector3::UnitY(),
       0.002},
      {"bowl",
       {"--length", "60mm", "--width", "42mm", "--rim", "3mm"},
       Vector3::Zero(),
       Vector3::UnitY(),
       0.003},
      {"tube",
       {"--path", "0,0,0;30,10,0;60,0,0mm", "--radius", "5mm"},
       Vector3(0, 0.01, 0),
       Vector3::UnitY(),
       0.01},
  }};
  return shapes;
}

std::string first_shape_name(std::size_t shape) {
  const FirstShape& made = first_shapes()[shape];
  return made.options.front() == "--sheet" ? "sheet" : made.name;
}

Document make_first_document(const FirstShape& shape, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "first.json";
  std::vector<std::string> arguments = {"new", shape.name};
  arguments.insert(arguments.end(), shape.options.begin(), shape.options.end());
  arguments.insert(arguments.end(), {"--force", "--out", file.string()});
  const Outcome made = run(arguments);
  EXPECT_EQ(made.code, 0) << made.err;
  Document document = read_document(file).value();
  document.scene.planes.clear();
  return document;
}

PressedPoint::PressedPoint(const Surface& rest, const Vector3& near_m) : rest_(rest) {
  double least = std::numeric_limits<double>::infinity();
  const auto offer = [&](double u, double v) {
    const double distance = (position(rest_, u, v) - near_m).norm();
    if (!(distance < least)) return false;
    least = distance;
    u_ = u;
    v_ = v;
    return true;
  };
  for (int a = 0; a <= stations; ++a) {
    for (int b = 0; b <= stations; ++b) {
      offer(rest_.u.parameter_at(a / static_cast<double>(stations)),
            rest_.v.parameter_at(b / static_cast<double>(stations)));
    }
  }
  double step = 0.5 / stations;
  for (int halvings = 0; halvings < 30;) {
    const double du = step * rest_.u.domain_length(), dv = step * rest_.v.domain_length();
    const double u = u_, v = v_;
    bool is_nearer = false;
    for (const double along_u : {-du, 0.0, du}) {
      for (const double along_v : {-dv, 0.0, dv}) {
        is_nearer |= offer(rest_.u.into_domain(u + along_u), rest_.v.into_domain(v + along_v));
      }
    }
    if (is_nearer) continue;
    step *= 0.5;
    ++halvings;
  }
  start_m_ = position(rest_, u_, v_);
  normal_ = unit_normal(rest_, u_, v_);
}

Vector3 PressedPoint::position_m(const Surface& shaped) const {
  return position(shaped, u_, v_);
}

double PressedPoint::find_depth_m(const Surface& shaped, double region_m) const {
  constexpr int along = 60;
  std::vector<Vector3> rest, moved;
  Vector3 rest_centre = Vector3::Zero(), moved_centre = Vector3::Zero();
  for (int a = 0; a < along; ++a) {
    for (int b = 0; b < along; ++b) {
      const double u = rest_.u.parameter_at((a + 0.5) / along), v = rest_.v.parameter_at((b + 0.5) / along);
      const Vector3 at_rest = position(rest_, u, v);
      if ((at_rest - start_m_).norm() < region_m) continue;
      rest.push_back(at_rest);
      moved.push_back(position(shaped, u, v));
      rest_centre += rest.back();
      moved_centre += moved.back();
    }
  }
  EXPECT_GT(rest.size(), 20U);
  rest_centre /= static_cast<double>(rest.size());
  moved_centre /= static_cast<double>(rest.size());
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    sum += (rest[i] - rest_centre) * (moved[i] - moved_centre).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d flip = Eigen::Matrix3d::Identity();
  flip(2, 2) = (svd.matrixV() * svd.matrixU().transpose()).determinant();
  const Eigen::Matrix3d turn = svd.matrixV() * flip * svd.matrixU().transpose();
  const Vector3 back = turn.transpose() * (position(shaped, u_, v_) - moved_centre) + rest_centre;
  return (start_m_ - back).dot(normal_);
}

double find_gap_m(const Surface& surface, const Vector3& centre_m, double radius_m) {
  double least = std::numeric_limits<double>::infinity();
  for (int a = 0; a <= stations; ++a) {
    for (int b = 0; b <= stations; ++b) {
      const Vector3 point = position(surface, surface.u.parameter_at(a / static_cast<double>(stations)),
                                     surface.v.parameter_at(b / static_cast<double>(stations)));
      least = std::min(least, (point - centre_m).norm());
    }
  }
  return least - radius_m;
}

}  // namespace spoonbill
