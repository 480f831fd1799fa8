#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/math/so3.h"
#include "solvers/friction/friction_problem.h"

// Friction problems as contact stages have them, in any number: bodies, joints and contacts put where they
// belong, with masses, friction and velocities drawn at random.
namespace taut::benchmarks {

/// Bodies at one moment, whose rows become a friction problem.  The ground is body −1.
class RandomBodies {
 public:
  explicit RandomBodies(int seed) : random_(static_cast<std::uint32_t>(seed)) {}

  double uniform(double low, double high) { return low + (high - low) * unit(); }
  int integer(int low, int high) { return low + static_cast<int>(unit() * (high - low + 1)); }
  /// Between 1 and 10 to the power `decades`, in logarithms.
  double ratio(double decades) { return std::pow(10, decades * unit()); }
  Vec3 vector(double size) {
    const double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return {x, y, z};
  }

  /// A box of these edges [m], with a velocity after a free step.  @returns its index.
  int add_box(const Vec3& centre, const Vec3& edges, double mass, const Vec3& v, const Vec3& w) {
    const Vec3 squares = edges.cwiseProduct(edges);
    const Vec3 inertia = mass / 12 * (Vec3::Constant(squares.sum()) - squares);
    bodies_.push_back({centre, 1 / mass, inertia.cwiseInverse(), v, w});
    return static_cast<int>(bodies_.size()) - 1;
  }
  /// B presses on A at a point, against the normal, which leads from A to B.
  void add_contact(int A, int B, const Vec3& point, const Vec3& normal, double mu) {
    const Vec3 n = normal.normalized(), t = n.unitOrthogonal();
    contacts_.push_back({A, B, point, {n, t, n.cross(t)}});
    mu_.push_back(mu);
  }
  /// A point of A stays on one of B.
  void add_ball(int A, int B, const Vec3& point) {
    joints_.push_back({A, B, point, {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}});
  }

  /// W = J M⁻¹ Jᵀ and q = J v of all rows, joints first.
  FrictionProblem problem() const {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd v(6 * std::ssize(bodies_));
    for (int b = 0; b < std::ssize(bodies_); ++b) v.segment<6>(6 * b) << bodies_[b].v, bodies_[b].w;
    FrictionProblem problem;
    problem.equalities = 3 * static_cast<int>(joints_.size());
    problem.mu = Eigen::Map<const Eigen::VectorXd>(mu_.data(), std::ssize(mu_));
    problem.q.resize(problem.rows());
    int row = 0;
    for (const auto* pairs : {&joints_, &contacts_})
      for (const Pair& pair : *pairs)
        for (const Vec3& axis : pair.axes) add_row(pair, axis, v, row++, problem.q, entries);
    FrictionProblem::Matrix J(problem.rows(), v.size());
    J.setFromTriplets(entries.begin(), entries.end());
    problem.W = J * J.transpose();
    return problem;
  }

 private:
  struct Body {
    Vec3 centre;
    double inverse_mass;
    Vec3 inverse_inertia, v, w;
  };
  struct Pair {
    int A, B;
    Vec3 point;
    std::array<Vec3, 3> axes;
  };

  /// In [0, 1), the same on all machines.
  double unit() { return random_() * 0x1p-32; }

  /// A row of J M^−½ and J v.
  void add_row(const Pair& pair, const Vec3& axis, const Eigen::VectorXd& v, int row, Eigen::VectorXd& q,
               std::vector<Eigen::Triplet<double>>& entries) const {
    q[row] = 0;
    for (const auto& [body, sign] : {std::pair{pair.A, -1.0}, std::pair{pair.B, 1.0}}) {
      if (body < 0) continue;
      const Body& b = bodies_[body];
      const Vec3 turn = sign * (pair.point - b.centre).cross(axis), move = sign * axis;
      q[row] += move.dot(v.segment<3>(6 * body)) + turn.dot(v.segment<3>(6 * body + 3));
      for (int i = 0; i < 3; ++i) {
        entries.emplace_back(row, 6 * body + i, move[i] * std::sqrt(b.inverse_mass));
        entries.emplace_back(row, 6 * body + 3 + i, turn[i] * std::sqrt(b.inverse_inertia[i]));
      }
    }
  }

  std::mt19937 random_;
  std::vector<Body> bodies_;
  std::vector<Pair> joints_, contacts_;
  std::vector<double> mu_;
};

/// What a stage is of, in the order in which they take turns.
enum class StageFamily { kTower, kWall, kHeap, kArch, kWedges, kNet, kPlate, kLinkage };
inline constexpr std::array<const char*, 8> kStageFamilyNames{"tower",  "wall", "heap",  "arch",
                                                              "wedges", "net",  "plate", "linkage"};

/// A random stage of the family, by its number: the same problem each time.  Masses differ by up to 10⁶,
/// friction is up to 1.5 and missing in one of eight; contacts are redundant but in heaps.
class RandomStage {
 public:
  /// `size` times as many bodies along each direction in which there are many.
  explicit RandomStage(int number, int size = 1)
      : size_(size),
        family_(static_cast<StageFamily>(number % std::ssize(kStageFamilyNames))),
        bodies_(number) {
    decades_ = bodies_.uniform(0, 6);
    mu_ = bodies_.integer(0, 7) == 0 ? 0 : bodies_.uniform(0.05, 1.5);
    make();
  }

  const char* family() const { return kStageFamilyNames[static_cast<std::size_t>(family_)]; }
  FrictionProblem problem() const { return bodies_.problem(); }

 private:
  static constexpr double kStep = 1.0 / 240;  ///< of free fall before the stage [s]

  void make() {
    switch (family_) {
      case StageFamily::kTower:
        return tower();
      case StageFamily::kWall:
        return wall();
      case StageFamily::kHeap:
        return heap();
      case StageFamily::kArch:
        return arch();
      case StageFamily::kWedges:
        return wedges();
      case StageFamily::kNet:
        return net();
      case StageFamily::kPlate:
        return plate();
      case StageFamily::kLinkage:
        return linkage();
    }
  }

  int box(const Vec3& centre, const Vec3& edges) {
    const Vec3 v = bodies_.vector(drift_) - Vec3(0, 0, 9.81 * kStep), w = bodies_.vector(drift_);
    return bodies_.add_box(centre, edges, bodies_.ratio(decades_), v, w);
  }
  void contact(int A, int B, const Vec3& point, const Vec3& normal) {
    bodies_.add_contact(A, B, point, normal, mu_ * bodies_.uniform(0.8, 1.25) * (mu_ < 1.2 ? 1 : 0.8));
  }
  /// At the four corners of a rectangle in the plane at `centre`, the edges of which are along x and
  /// `across`.
  void face(int A, int B, const Vec3& centre, double x, const Vec3& across, const Vec3& normal) {
    for (const double i : {-0.5, 0.5})
      for (const double j : {-0.5, 0.5}) contact(A, B, centre + i * x * Vec3::UnitX() + j * across, normal);
  }

  /// Boxes on each other; some lean or are pushed.
  void tower() {
    drift_ = bodies_.uniform(0, 0.3);
    const int count = many(1, 10);
    int below = -1;
    for (int i = 0; i < count; ++i) {
      const int above = box({bodies_.uniform(-0.1, 0.1), 0, i + 0.5}, Vec3::Ones());
      face(below, above, Vec3(0, 0, i), bodies_.uniform(0.4, 0.9), Vec3(0, 0.8, 0), Vec3::UnitZ());
      below = above;
    }
  }

  /// Bricks in bond, on the ground.
  void wall() {
    drift_ = bodies_.uniform(0, 0.2);
    const int rows = many(2, 4), columns = many(2, 4);
    std::vector<int> below(columns + 1, -1);
    for (int i = 0; i < rows; ++i) {
      std::vector<int> row;
      for (int k = 0; k < columns; ++k) {
        const double x = k + (i % 2) * 0.5;
        row.push_back(box({x, 0, 0.5 * i + 0.25}, {1, 0.5, 0.5}));
        for (const int side : {0, 1})
          if (const int under = i == 0 ? -1 : k + side + i % 2 - 1; i == 0 || (under >= 0 && under < columns))
            face(i == 0 ? -1 : below[under], row.back(), {x + 0.5 * side - 0.25, 0, 0.5 * i}, 0.4,
                 Vec3(0, 0.4, 0), Vec3::UnitZ());
        if (k > 0)
          face(row[k - 1], row[k], {x - 0.5, 0, 0.5 * i + 0.25}, 0, Vec3(0, 0.4, 0.4), Vec3::UnitX());
      }
      below = row;
    }
  }

  /// Lumps that touch their neighbours at one point each, in all directions.
  void heap() {
    drift_ = bodies_.uniform(0, 2);
    const int count = many(2, 24);
    std::vector<Vec3> centres;
    for (int i = 0; i < count; ++i) {
      centres.push_back({bodies_.uniform(0, 2.5), bodies_.uniform(0, 2.5), bodies_.uniform(0.4, 3)});
      box(centres[i], {0.9, 0.8, 0.7});
      if (centres[i].z() < 1) contact(-1, i, {centres[i].x() + 0.1, centres[i].y(), 0}, Vec3::UnitZ());
      for (int k = 0; k < i; ++k)
        if (const Vec3 apart = centres[i] - centres[k]; apart.norm() < 1.3)
          contact(k, i, centres[k] + 0.5 * apart + bodies_.vector(0.1), apart + bodies_.vector(0.2));
    }
  }

  /// Voussoirs between two footings.
  void arch() {
    drift_ = bodies_.uniform(0, 0.1);
    const int count = many(3, 15);
    const double span = std::numbers::pi * bodies_.uniform(0.6, 1);
    int before = -1;
    for (int i = 0; i <= count; ++i) {
      const double joint = 0.5 * std::numbers::pi - 0.5 * span + span * i / count,
                   middle = joint + 0.5 * span / count;
      const Vec3 radius(std::cos(joint), 0, std::sin(joint)), along(-radius.z(), 0, radius.x());
      const int next =
          i == count ? -1 : box(5 * Vec3(std::cos(middle), 0, std::sin(middle)), {0.8, 0.8, 0.8});
      for (const double r : {4.7, 5.3})
        for (const double y : {-0.4, 0.4}) contact(before, next, r * radius + Vec3(0, y, 0), along);
      before = next;
    }
  }

  /// Bodies pressed between inclined walls, which jam where friction exceeds the slope.
  void wedges() {
    drift_ = bodies_.uniform(0, 1);
    const int count = many(1, 8);
    const double slope = bodies_.uniform(0.05, 1.2);
    const Vec3 left(std::cos(slope), 0, std::sin(slope)), right(-left.x(), 0, left.z());
    int below = -1;
    for (int i = 0; i < count; ++i) {
      const int body = box({0, 0, 1.0 + i}, Vec3::Ones());
      for (const double y : {-0.3, 0.3})
        for (const double z : {-0.2, 0.2}) {
          contact(-1, body, {-0.5, y, 1 + i + z}, left);
          contact(-1, body, {0.5, y, 1 + i + z}, right);
        }
      if (below >= 0) face(below, body, {0, 0, i + 0.5}, 0.5, Vec3(0, 0.5, 0), Vec3::UnitZ());
      below = body;
    }
  }

  /// A net of bodies with ball joints, whose loops are redundant, on the ground.
  void net() {
    drift_ = bodies_.uniform(0, 1);
    const int n = many(2, 5);
    std::vector<int> knots;
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k) {
        knots.push_back(box({1.0 * k, 1.0 * i, 0.1}, {0.9, 0.9, 0.2}));
        if (k > 0) bodies_.add_ball(knots[n * i + k - 1], knots[n * i + k], {k - 0.5, 1.0 * i, 0.1});
        if (i > 0) bodies_.add_ball(knots[n * (i - 1) + k], knots[n * i + k], {1.0 * k, i - 0.5, 0.1});
        if (bodies_.integer(0, 3) > 0)
          face(-1, knots.back(), {1.0 * k, 1.0 * i, 0}, 0.6, Vec3(0, 0.6, 0), Vec3::UnitZ());
      }
  }

  /// One plate on very many points, some of them twice.
  void plate() {
    drift_ = bodies_.uniform(0, 2);
    const int body = box({0, 0, 0.1}, {2, 2, 0.2}), count = many(1, 40);
    for (int i = 0; i < count; ++i) {
      const Vec3 point(bodies_.uniform(-1, 1), bodies_.uniform(-1, 1), 0);
      const Vec3 normal = Vec3::UnitZ() + bodies_.vector(0.3 * (i % 2));
      for (int twice = bodies_.integer(0, 3) == 0 ? 0 : 1; twice < 2; ++twice)
        contact(-1, body, point, normal);
    }
  }

  /// A chain of bars that lies on the ground and on itself, perhaps held at its end.
  void linkage() {
    drift_ = bodies_.uniform(0, 1);
    const int count = many(2, 12);
    for (int i = 0; i < count; ++i) {
      const double z = 0.1 + 0.2 * (i % 3);
      box({i + 0.5, 0, z}, {1, 0.2, 0.2});
      if (i > 0 || bodies_.integer(0, 1) == 0) bodies_.add_ball(i - 1, i, {1.0 * i, 0, z});
      for (const double x : {0.1, 0.9})
        for (const double y : {-0.1, 0.1}) contact(-1, i, {i + x, y, z - 0.1}, Vec3::UnitZ());
      if (i > 2) contact(i - 3, i, {i - 1.0, 0, z}, bodies_.vector(1) + Vec3::UnitZ() * 1.5);
    }
  }

  /// How many bodies there are along a direction.
  int many(int least, int most) { return bodies_.integer(least, most * size_); }

  int size_;
  StageFamily family_;
  RandomBodies bodies_;
  double decades_ = 0, mu_ = 0;
  double drift_ = 0;  ///< velocities beside free fall [m/s, rad/s]
};

}  // namespace taut::benchmarks
