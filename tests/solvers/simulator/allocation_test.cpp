#include <gtest/gtest.h>

#include "scenes/builders/scene.h"
#include "solvers/simulator/simulator.h"
#include "tests/allocation_counter.h"
#include "tests/sanitized.h"
#include "tests/solvers/simulator/joint_scenes.h"

namespace taut::allocation_test {
namespace {

/// Allocations of each step after the first few, until `steps` of them.
void expect_none(const std::string& name, const std::map<std::string, double>& parameters, double dt,
                 int steps) {
  Scene scene = build_scene(name, parameters);
  Simulator simulator(scene.world, scene.settings);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulator.step(dt).exact());
  for (int i = 5; i < steps; ++i) {
    const long before = allocation_count();
    const StepReport& report = simulator.step(dt);
    const long count = allocation_count() - before;
    ASSERT_TRUE(report.exact()) << report.message;
    ASSERT_EQ(count, 0) << name << ", step " << i << " of " << report.substeps << " sub-steps, "
                        << report.counts.refactorizations << " factorisations at an iterate";
  }
}

TEST(Allocation, IsCounted) {
  if (testing::sanitized()) GTEST_SKIP() << "a sanitizer has a malloc of its own";
  void* volatile kept = nullptr;  // else the compiler leaves out what is freed at once
  const auto count = [&](auto allocate) {
    const long before = allocation_count();
    kept = allocate();
    return allocation_count() - before;
  };
  EXPECT_EQ(count([] { return nullptr; }), 0);
  EXPECT_EQ(count([] { return std::malloc(64); }), 1);
  EXPECT_EQ(count([&] { return std::realloc(kept, 1000); }), 1);
  std::free(kept);
  EXPECT_EQ(count([] { return std::calloc(8, 8); }), 1);
  std::free(kept);
  EXPECT_EQ(count([] { return std::aligned_alloc(64, 64); }), 1);
  std::free(kept);
  EXPECT_EQ(count([] { return ::operator new(64); }), 1);
  ::operator delete(kept);
}

/// Sub-steps, whips that need factorisations at an iterate, and redundant rows whose number changes among
/// them.
TEST(Allocation, AStepAllocatesNothingAfterTheFirst) {
  for (const auto& [name, parameters] : kJointScenes) expect_none(name, parameters, 1.0 / 240, 480);
}

TEST(Allocation, AStepOfALargerSceneAllocatesNothing) {
  for (const char* name : {"chain", "bridge-balls", "net-corners"}) expect_none(name, {{"n", 20}}, 1e-3, 55);
  expect_none("joint-grid", {{"n", 20}, {"swing", 1}}, 1.0 / 240, 245);
}

}  // namespace
}  // namespace taut::allocation_test
