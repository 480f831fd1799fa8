#pragma once

#include <Eigen/Cholesky>
#include <optional>
#include <span>
#include <vector>

#include "core/base/union_find.h"
#include "solvers/system/mass_matrix.h"

namespace taut {

/// The parts of a system that nothing ties to what is fixed, and their motions as rigid bodies V = R c with
/// c = (ω, v) a twist at the part's centre of mass: A = RᵀMR is the part's inertia as one body, Rᵀp are its
/// momenta (angular about that centre, and linear), and of the rows within it J R = 0.
///
/// A filter p ← F p body by body, symmetric in the sense that F M is, changes these sums.  Between take_out()
/// and put_back() it becomes
///     Π F Π + (1 − Π),    Π = 1 − M R A⁻¹ Rᵀ,
/// which keeps them, is symmetric likewise, takes energy where F does, and has the J M⁻¹F Jᵀ of F.
/// (solvers/system, "Free parts")
class FreeParts {
 public:
  /// Forgets all parts: from now on each body is one by itself, until join().
  void begin(const MassMatrix& mass);
  /// Bodies a and b, which a joint or contact has rows between, are of one part.
  void join(int a, int b) { sets_.join(a, b); }
  /// The parts at these poses, of those with a body that `filtered` marks.
  void find(const MassMatrix& mass, std::span<const Pose> poses, std::span<const char> filtered);
  bool empty() const { return parts_.empty(); }

  /// p ← Π p of the parts' bodies, momenta in world axes.
  void take_out(const MassMatrix& mass, std::span<const Pose> poses, std::span<Wrench> p);
  /// p ← Π p + (1 − Π) p′ with the p′ that take_out() found.
  void put_back(const MassMatrix& mass, std::span<const Pose> poses, std::span<Wrench> p);

 private:
  struct Part {
    double mass = 0;
    Vec3 centre = Vec3::Zero();
    Mat3 inertia = Mat3::Zero();
    Eigen::LLT<Mat3> factor;
    Wrench sum;    // Rᵀp
    Twist motion;  // A⁻¹Rᵀp
  };

  void measure(std::span<const Pose> poses, std::span<const Wrench> p);
  void add(const MassMatrix& mass, std::span<const Pose> poses, double factor, std::span<Wrench> p) const;

  UnionFind sets_;
  std::vector<char> is_sought_;                                         // sets, by their least body
  std::vector<std::optional<std::size_t>> part_of_set_, part_of_body_;  // by the least body, and by body
  std::vector<Part> parts_;
  std::vector<Twist> taken_;  // of the parts
};

}  // namespace taut
