#pragma once

#include <cstdint>
#include <vector>

#include "collision/narrow/contact.h"
#include "collision/narrow/separation.h"

namespace taut::detail {

/// A contact point in the frame of shape A.
struct ManifoldPoint {
  Vec3 p, q;   ///< on A and on B
  Vec3 n;      ///< from A to B
  double gap;  ///< n·(q − p)
  std::uint64_t id;
  LocalSurface surface_A{}, surface_B{};  ///< in the frame of A, too
};

/// What a contact point is the meeting of; with the ids of the two things it makes the id of the contact.
enum class Meeting : std::uint64_t { kVertexA = 1, kVertexB = 2, kEdges = 3, kDeepest = 4 };
/// 4 bits of meeting, 30 bits for each side.
std::uint64_t contact_id(Meeting meeting, std::uint64_t of_A, std::uint64_t of_B);
/// What an id is made of.  @{
Meeting meeting_of(std::uint64_t id);
std::uint64_t side_A(std::uint64_t id);
std::uint64_t side_B(std::uint64_t id);  /// @}
/// The id of an edge between two corners.
std::uint64_t edge_id(int corner, int other);

/// Work space of one thread.
struct ManifoldScratch {
  struct Corner {
    double x, y;  ///< in the contact plane
    std::uint64_t id;
    int edge_A, edge_B;
  };
  Feature feature_A, feature_B;
  std::vector<double> plane_A, plane_B;  ///< corners in the contact plane, x and y in turn
  std::vector<Corner> polygon, clipped;
  std::vector<ManifoldPoint> kept;
};

/// Whether a contact is made where the two features have nothing in common, at the deepest place.  Not so for
/// a triangle of a mesh: there another triangle has it.
enum class Overhang { kDeepest, kNone };

/// Contact points of two convex bodies that are `separation` apart: what the feature of A and that of B have
/// in common, seen along n.  Points with a gap above `cutoff` are left out; with Overhang::kDeepest there is
/// at least one.  Appended to `out`.
void make_manifold(const Convex& A, const Convex& B, const Relative& X_AB, const Separation& separation,
                   double cutoff, Overhang overhang, ManifoldScratch& scratch,
                   std::vector<ManifoldPoint>& out);

/// Keeps at most `most` of the points from `first` on: the deepest, then each time the one that is farthest
/// from those kept.  Order is kept.
void reduce(std::vector<ManifoldPoint>& points, std::size_t first, std::size_t most,
            ManifoldScratch& scratch);

}  // namespace taut::detail
