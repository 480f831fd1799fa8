#pragma once

#include "solvers/friction/scaled_friction.h"

namespace taut {

/// Nonsmooth Gauss–Seidel: block after block meets its law with all others held, forwards and backwards in
/// turn.  Convergence is not assured, and slow; it finds which contacts carry, stick and slide.
///                                                                          (solvers/friction, "Rungs")
Eigen::VectorXd sweep(const ScaledFriction& problem, Eigen::VectorXd r, int times);

}  // namespace taut
