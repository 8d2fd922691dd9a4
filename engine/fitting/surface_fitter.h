// How fit_surface() works: its state from round to round. The fitting's own; one owner, outside the tick.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "engine/fitting/fit_surface.h"
#include "engine/fitting/folds.h"
#include "engine/fitting/quantiles.h"
#include "engine/fitting/scattered_fit.h"

namespace spoonbill {

inline constexpr int projection_steps = 3;
inline constexpr double least_fairness = 3e-4;  // lets surfaces follow what is free of noise

// What is fitted: the nodes at first, then all points.
struct FittedData {
  std::span<const Vector3> points_m;
  std::span<const double> weights;
  std::span<const Vector3> normals;  // none, or of each point; zero where it is not known
  std::vector<Vector2> uv;
  std::vector<double> distance_m;
  std::vector<double> trust;
};

// The distance within which 95 % of them are.
inline double ninety_fifth(std::span<const double> distances) {
  return quantile_of({distances.begin(), distances.end()}, 0.95);
}

// A difference of parameters of a period of one, the short way around.
inline double wrapped(double difference) {
  return difference - std::round(difference);
}

// What folds nowhere is better than what does; else what is nearer, where each fold and cusp counts for a
// share of the distance.
struct FitQuality {
  std::size_t folds, cusps;
  double error_m;

  bool better_than(const FitQuality& other) const {
    return (folds > 0) != (other.folds > 0) ? folds == 0 : cost() < other.cost();
  }
  double cost() const {
    return error_m * (1.0 + 0.03 * static_cast<double>(folds) + 0.004 * static_cast<double>(cusps));
  }
};

class SurfaceFitter {
 public:
  // Points keep their parameters where the surface's normal at new ones has a smaller cosine than
  // `least_agreement` with theirs: on a thin wall the nearest place may be on the other face.
  SurfaceFitter(const FitPoints& points, const Parameterisation& start, const FitSettings& settings,
                double least_agreement, double fairness_factor);
  Result<FittedSurface> run();

 private:
  // What unfolding changes, to begin it again.
  struct Folding {
    Surface surface;
    FoldCheck folds;
    std::vector<Vector2> uv;
    std::vector<double> fairness;
  };

  bool closed() const { return kind_ == ShapeKind::closed; }
  bool periodic() const { return kind_ != ShapeKind::sheet; }
  Status solve(FittedData& data);
  void take_poles();
  void project(FittedData& data, bool smooth);
  bool may_go_to(const FittedData& data, std::size_t point, const Vector2& uv) const;
  void take_trust(FittedData& data) const;
  double distance_off(const FittedData& data, std::size_t point) const;
  void distrust_strays();
  void smooth_shifts(const std::vector<Vector2>& before, std::vector<Vector2>& uv) const;
  bool within_tolerance(const FittedData& data) const;
  bool grow();
  bool faces_inwards() const;
  Status face_outwards();
  Status node_rounds();
  Status point_rounds();
  const std::vector<bool>& faulty_spans() const;
  void stiffen_folds();
  void relax_folds(int rounds);
  bool in_folded_span(const Vector2& uv) const;
  Vector2 kept_inside(Vector2 uv) const;
  double usual_error() const;
  Status unfold();
  Status unfold(int relaxing);
  void take(const Folding& folding);
  void set_fairness(double fairness, const FittedData& data);
  Status choose_fairness(const FittedData& data);
  bool report(double fraction) const { return settings_->progress.report(fraction); }
  FittedSurface result();

  const FitPoints* points_;
  const FitSettings* settings_;
  ShapeKind kind_;
  double least_agreement_, fairness_factor_, chosen_fairness_;
  SurfaceStructure structure_;
  std::vector<double> fairness_;  // of each pair of spans
  std::vector<double> node_weights_, all_weights_;
  std::vector<Vector3> all_points_m_, all_normals_;
  FittedData nodes_, all_;
  std::vector<std::pair<Vector3, double>> poles_;  // and their v
  Surface surface_;
  FoldCheck folds_;
  std::vector<double> u_breaks_, v_breaks_;  // of the last knots
};

}  // namespace spoonbill
