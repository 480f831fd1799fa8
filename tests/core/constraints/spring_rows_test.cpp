#include <gtest/gtest.h>

#include "core/constraints/rows.h"
#include "core/world/world.h"
#include "tests/core/random_state.h"

// Rows of springs between bodies.
namespace taut::spring_rows_test {
namespace {

using testing::Random;

struct Net {
  World world;
  BodyId a, b;
  Random random{7};
  Net() {
    world.set_gravity(Vec3::Zero());
    a = world.add_body({.pose = random.pose()});
    b = world.add_body({.pose = random.pose()});
  }
  Rows rows() const {
    return Rows(world, Rows::AxisRows::kIncluded, {}, Rows::Joints::kAll, Springs::kIncluded);
  }
};

TEST(SpringRows, AreThereOnlyIfAskedFor) {
  Net n;
  n.world.add_force(SpringDamper(n.a, n.b, Vec3::Zero(), Vec3::Zero(), 3, 0.5, 0));  // its length
  n.world.add_force(SpringDamper(n.a, n.b, Vec3::Zero(), Vec3::Zero(), 3, 0, 0));    // three displacements
  n.world.add_force(
      SpringDamper(n.a, kGround, Vec3::Zero(), Vec3::Zero(), 3, 0, 1));               // these, and its length
  n.world.add_force(SpringDamper(n.a, n.a, Vec3::Zero(), Vec3::UnitX(), 3, 0.5, 1));  // none: no spring
  EXPECT_EQ(Rows(n.world).row_count(), 0);
  const Rows rows = n.rows();
  EXPECT_EQ(rows.spring_count(), 3);
  EXPECT_EQ(rows.joint_count(), 0);
  EXPECT_EQ(rows.row_count(), 1 + 3 + 4);
  EXPECT_EQ(rows.axis_rows().size(), 8u);
  for (int r = 0; r < rows.row_count(); ++r) EXPECT_FALSE(rows.is_equality(r));
}

/// With the forces of their laws the rows put on the bodies what the laws do.
TEST(SpringRows, PullAsTheirLaws) {
  for (const double rest : {0.0, 0.7}) {
    for (const double damping : {0.0, 1.3}) {
      Net n;
      n.world.set_twist(n.a, n.random.twist());
      n.world.set_twist(n.b, n.random.twist());
      n.world.add_force(SpringDamper(n.a, n.b, n.random.vector(), n.random.vector(), 3, rest, damping));
      std::vector<Wrench> law(3), by_rows(3);
      n.world.forces(n.world.state(), law);
      const Rows rows = n.rows();
      std::vector<double> theta(rows.row_count()), rates(theta), lambda(theta), J(rows.jacobian_size());
      rows.residual(n.world.state(), theta);
      rows.jacobian(n.world.state(), J);
      rows.apply(J, n.world.state().twists, rates);
      for (const Rows::AxisRow& row : rows.axis_rows()) {
        const bool centred = row.spring()->centred;
        const double k = rest == 0 && !centred ? 0 : 3, own_rest = centred ? 0 : rest;
        lambda[row.row] = -k * (theta[row.row] - own_rest) - (centred ? 0 : damping) * rates[row.row];
      }
      rows.apply_transpose(J, lambda, by_rows);
      for (int body : {1, 2}) {
        EXPECT_LT((law[body].force - by_rows[body].force).norm(), 1e-13) << rest << ' ' << damping;
        EXPECT_LT((law[body].torque - by_rows[body].torque).norm(), 1e-13) << rest << ' ' << damping;
      }
    }
  }
}

TEST(SpringRows, AreAChangeOfTopologyOnlyWhereTheyChange) {
  Net n;
  const int before = n.world.topology_version();
  const ForceId id = n.world.add_force(SpringDamper(n.a, n.b, Vec3::Zero(), Vec3::Zero(), 3, 0.5, 1));
  const int added = n.world.topology_version(), axes = n.world.axis_version();
  EXPECT_NE(added, before);
  n.world.set_force(id, std::make_shared<SpringDamper>(n.a, n.b, Vec3::Zero(), Vec3::Zero(), 30, 0.1, 2));
  EXPECT_EQ(n.world.topology_version(), added);
  EXPECT_NE(n.world.axis_version(), axes);
  n.world.set_force(id, std::make_shared<SpringDamper>(n.a, kGround, Vec3::Zero(), Vec3::Zero(), 30, 0.1, 2));
  EXPECT_NE(n.world.topology_version(), added);
}

}  // namespace
}  // namespace taut::spring_rows_test
