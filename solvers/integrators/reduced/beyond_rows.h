#pragma once

#include <span>

#include "core/math/dense.h"
#include "solvers/laws/row_law.h"

namespace taut {

/// The rows beyond a tree by themselves: rates w = A λ + b, of velocities in an impact or of rates at an
/// instant.  Dense, and few; the solvers of (solvers/complementarity) are for sparse S of bodies, by which
/// they are told what rows depend on.
struct BeyondRows {
  dense::Matrix A;
  dense::Vector b;
  dense::Vector alone;  ///< diagonal of A if bodies were free, by which rows of all units are alike
};

/// How many rows depend on the others, as is found where all are closed.
struct RankDeficit {
  int rows = -1;  ///< −1: not known
};
/// λ of least norm in that scale with w = 0 as far as may be.  Where a deficit is known it is kept: off
/// closed positions the rows that depend on the others there say what others do not, but nothing that is
/// true.
dense::Vector solve_equalities(const BeyondRows& rows, const RankDeficit& known = {});
/// The same λ, where the deficit is not known yet: it is found.
dense::Vector solve_closed(const BeyondRows& rows, RankDeficit& found);

/// λ and w with λ_r ∈ L_r(w_r) for each row, and the segments of laws that they are on, by block principal
/// pivoting as ActiveSet's [JudicePires1994]; from the segments that are given.  False if none is found.
[[nodiscard]] bool solve_laws(const BeyondRows& rows, std::span<const RowLaw> laws, std::span<int> segments,
                              dense::Vector& lambda, dense::Vector& w);

}  // namespace taut
