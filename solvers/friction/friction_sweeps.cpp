#include "solvers/friction/friction_sweeps.h"

#include <algorithm>
#include <cmath>

#include "solvers/laws/contact_cone.h"

namespace taut {
namespace {

struct FrictionSweepsTuning {
  /// One contact by itself: fixed points of r ← P_K(r − γ û), for so many steps (60 take twice the time of
  /// all, and lead to the same), or until one changes less than this part of r, a little above round-off.
  static constexpr int kLocalSteps = 10;
  static constexpr double kLocalAccuracy = 1e-13;
};

/// Its impulses, from r and u on; B is W of the contact.
Vec3 one_contact(const Mat3& B, double step, double mu, Vec3 r, Vec3 u) {
  for (int i = 0; i < FrictionSweepsTuning::kLocalSteps; ++i) {
    const double slip = std::sqrt(u[1] * u[1] + u[2] * u[2]);
    const Vec3 next = into_cone(r - step * Vec3(u[0] + mu * slip, u[1], u[2]), mu), change = next - r;
    r = next;
    u += B * change;
    if (change.cwiseAbs().sum() <= FrictionSweepsTuning::kLocalAccuracy * r.cwiseAbs().sum()) break;
  }
  return r;
}

}  // namespace

Eigen::VectorXd sweep(const ScaledFriction& problem, Eigen::VectorXd r, int times) {
  using Law = ScaledFriction::Law;
  const auto& blocks = problem.blocks();
  const int count = static_cast<int>(blocks.size());
  std::vector<Mat3> diagonal(count);
  std::vector<double> step(count);
  for (int b = 0; b < count; ++b) {
    if (blocks[b].law != Law::kCone) {
      const double w = problem.values(blocks[b].first)[problem.diagonal(blocks[b])];
      step[b] = w > 0 ? 1 / w : 0;
      continue;
    }
    diagonal[b] = problem.diagonal_block(blocks[b]);
    // Two bounds of its largest eigenvalue.
    const double rows = diagonal[b].cwiseAbs().rowwise().sum().maxCoeff(),
                 bound = std::min(diagonal[b].trace(), rows);
    step[b] = bound > 0 ? 1 / bound : 0;
  }
  const auto rate = [&](int row) {
    const auto columns = problem.columns(row);
    const auto values = problem.values(row);
    double u = problem.q()[row];
    for (std::size_t k = 0; k < columns.size(); ++k) u += values[k] * r[columns[k]];
    return u;
  };
  for (int s = 0; s < times; ++s)
    for (int k = 0; k < count; ++k) {
      const int b = s % 2 == 0 ? k : count - 1 - k;
      const auto& [law, first, size, mu] = blocks[b];
      if (law == Law::kCone) {
        const Vec3 u(rate(first), rate(first + 1), rate(first + 2));
        r.segment<3>(first) = one_contact(diagonal[b], step[b], mu, r.segment<3>(first), u);
      } else {
        const double x = r[first] - step[b] * rate(first);
        r[first] = law == Law::kEquality ? x : std::max(0.0, x);
      }
    }
  return r;
}

}  // namespace taut
