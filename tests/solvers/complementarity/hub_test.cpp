#include <gtest/gtest.h>

#include "collision/contact_finder.h"
#include "core/constraints/rows.h"
#include "solvers/simulator/simulator.h"
#include "solvers/system/constraint_system.h"

// A hub: one body that touches hundreds of others.  In S the rows of all its contacts are coupled; in the
// system of the bodies it is one node with many neighbours. (solvers/system, "Primal matrix")
namespace taut::hub_test {
namespace {

/// n × n boxes of 1 kg on a loose tray.
World tray_of(int n) {
  constexpr double kPitch = 0.25, kBox = 0.1;
  World world;
  world.add_shape(kGround, HalfSpace{});
  const Vec3 size(n * kPitch, n * kPitch, kBox), box = Vec3::Constant(kBox);
  const BodyId tray = world.add_body(
      {.name = "tray", .mass = MassProperties::box(size, 50), .pose = {.p = Vec3(0, 0, kBox / 2)}});
  world.add_shape(tray, Box{size});
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = (i - 0.5 * (n - 1)) * kPitch, y = (j - 0.5 * (n - 1)) * kPitch;
      const BodyId body =
          world.add_body({.mass = MassProperties::box(box, 1), .pose = {.p = Vec3(x, y, 1.5 * kBox)}});
      world.add_shape(body, Box{box});
    }
  return world;
}

/// Of the factor with all contacts of the world.
double factor_entries(const World& world) {
  ContactFinder finder;
  const std::vector<Contact>& contacts = finder.find(world);
  std::vector<Rows::ContactSlot> places;
  for (const Contact& contact : contacts) places.push_back({contact.A.index, contact.B.index, false});
  ConstraintSystem system(world, FactorChoice::kAuto);
  system.set_contact_slots(world, places);
  for (std::size_t k = 0; k < contacts.size(); ++k)
    system.set_contact(static_cast<int>(k),
                       {contacts[k].p_AP, contacts[k].p_BQ, {Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY()}});
  system.linearize(world.state().poses);
  system.set_mass(world.state().poses);
  StageTimes times;
  system.factorize(times);
  return static_cast<double>(system.factor().nonzeros());
}

TEST(Hub, FillGrowsWithItsContactsAndNotWithTheirSquare) {
  const double few = factor_entries(tray_of(8)), many = factor_entries(tray_of(32));
  EXPECT_LT(many, 1.1 * 16 * few);  // 16 times as many boxes
}

TEST(Hub, BearsWhatLiesOnIt) {
  constexpr int kSide = 16;
  World world = tray_of(kSide);
  Simulator simulator(world);
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(simulator.step(1.0 / 240).exact()) << simulator.report().message;
    ASSERT_LE(simulator.report().natural_residual, 1e-8);
  }
  EXPECT_EQ(simulator.report().contacts, 4 * (kSide * kSide + 1));
  double carried = 0;
  for (const ContactReport& contact : simulator.contacts())
    if (contact.contact.A == kGround) carried += contact.normal_force;
  EXPECT_NEAR(carried, (50 + kSide * kSide) * world.gravity().norm(), 1e-6 * carried);
}

}  // namespace
}  // namespace taut::hub_test
