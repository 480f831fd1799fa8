#include "collision/narrow/contact.h"

namespace taut {

LocalSurface LocalSurface::flat(const Vec3& n) { return {0, kFlat * (Mat3::Identity() - n * n.transpose())}; }

bool LocalSurface::is_flat() const { return radii.trace() > 1.5 * kFlat; }

LocalSurface LocalSurface::turned(const Mat3& R) const {
  return {ball, R * radii * R.transpose(), R * squares * R.transpose()};
}

}  // namespace taut
