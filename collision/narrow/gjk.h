#pragma once

#include "collision/narrow/convex.h"

namespace taut::detail {

/// Builds FCL's geometry for the core of a body and puts it in body.gjk.
void attach_gjk(Convex& body);
/// Brings FCL's triangle up to date with body.hull.
void update_gjk_triangle(Convex& body);

/// The direction n (unit, in frame A) from core A to core B along the shortest line between them, after B was
/// moved by `shift` (in frame A), by FCL's GJK.  `guess` is a direction from A to B.  The duality certificate
///     distance = min_B n·x − max_A n·x
/// is checked to 1e-8 of the size of the pair (1e-5 for curved cores, which are polished afterwards); if it
/// fails, FCL's other solver (libccd) is asked, and the n with the larger right-hand side is returned.
/// Returns false if that is not positive: the cores overlap, or both solvers failed.  Without
/// `second_opinion` libccd is not asked.
bool shortest_direction(const Convex& A, const Convex& B, const Relative& X_AB, const Vec3& shift,
                        const Vec3& guess, Vec3& n, bool second_opinion = true);

}  // namespace taut::detail
