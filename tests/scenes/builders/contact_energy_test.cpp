#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"

/// Contacts of no scene of the catalogue give energy: the ledger's work of their normal impulses is never
/// positive beyond round-off, in any step.
namespace taut::contact_energy_test {
namespace {

/// Small ones; the others as they are.
std::map<std::string, double> sizes(const SceneInfo& info) {
  for (const ParameterInfo& parameter : info.parameters)
    if (parameter.name == "n") return {{"n", std::clamp(5.0, parameter.minimum, parameter.maximum)}};
  return {};
}

/// The springs of compliant contacts give back what they took.
void make_rigid(World& world) {
  for (int a = 0; a < world.shape_count(); ++a) {
    Material material = world.contact_material(ShapeId{a}, ShapeId{a});
    material.compliance = 0;
    world.set_material(ShapeId{a}, material);
  }
}

/// [J] of a fall through one step: what is worked between the two kicks of a contact that holds.
double kick_energy(const World& world, double dt) {
  double mass = 0;
  for (int b = 1; b < world.body_count(); ++b)
    if (!world.is_fixed(BodyId{b})) mass += world.mass_properties(BodyId{b}).mass();
  return 0.5 * mass * world.gravity().squaredNorm() * dt * dt;
}

class ContactEnergy : public ::testing::TestWithParam<std::string> {};

TEST_P(ContactEnergy, is_never_given_by_contacts) {
  const auto& all = scene_catalogue();
  const auto info = std::find_if(all.begin(), all.end(), [](const auto& i) { return i.name == GetParam(); });
  Scene scene = build_scene(info->name, sizes(*info));
  make_rigid(scene.world);
  Simulator simulator(scene.world, scene.settings);
  double most_kinetic = kick_energy(scene.world, scene.dt);
  const double most_time = 0.5;
  bool touched = false;
  while (scene.world.time() < std::min(scene.duration, most_time)) {
    const StepReport& report = simulator.step(scene.dt);
    ASSERT_TRUE(report.ok()) << report.message;
    most_kinetic = std::max(most_kinetic, report.kinetic_energy);
    touched = touched || report.contacts > 0;
    // Laws are met to 1e-8 of the largest impulse.
    ASSERT_LE(report.ledger.contacts, 1e-8 * most_kinetic) << "at " << report.time << " s";
  }
  EXPECT_TRUE(touched);
}

/// All whose bodies touch; a list, since every process of the tests would spend its time to find them.
const std::vector<std::string> kTouching{"chain-over-cylinder",
                                         "vehicle-bridge",
                                         "net-catch",
                                         "net-drag",
                                         "ragdoll-stairs",
                                         "stack",
                                         "wall",
                                         "heap",
                                         "pile",
                                         "card-house",
                                         "tank"};

TEST(ContactEnergyList, is_watched_in_each_scene_that_touches) {
  std::vector<std::string> names;
  for (const SceneInfo& info : scene_catalogue()) {
    const Scene scene = build_scene(info.name, sizes(info));
    if (scene.world.shape_count() > 0 && scene.settings.contacts) names.push_back(info.name);
  }
  EXPECT_EQ(names, kTouching);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, ContactEnergy, ::testing::ValuesIn(kTouching), [](const auto& name) {
  std::string plain = name.param;
  std::replace(plain.begin(), plain.end(), '-', '_');
  return plain;
});

}  // namespace
}  // namespace taut::contact_energy_test
