// What a run is judged by, from reports of single steps.
#include "scenes/program/run_record.h"

#include <gtest/gtest.h>

#include "scenes/program/run_report.h"
#include "scenes/program/run_summary.h"
#include "scenes/recording/recorder.h"

namespace taut::run_record_test {
namespace {

StepReport step_of(Status status, double time, double residual) {
  StepReport report;
  report.status = status;
  report.time = time;
  report.substeps = 2;
  report.contacts = 3;
  report.complementarity_residual = residual;
  return report;
}

/// Steps that were done count, exactly met or not; one that failed costs time and leaves no other trace.
TEST(RunRecord, CountsWhatWasDone) {
  RunRecord record;
  record.add(step_of(Status::kSuccess, 0.1, 1e-10), 0.01, {}, 5);
  record.add(step_of(Status::kInexact, 0.2, 3e-5), 0.01, {.metres = 1e-10}, 4);
  record.add(step_of(Status::kNotConverged, 0.2, 0.7), 0.01, {.metres = 1}, 3);
  EXPECT_EQ(record.steps, 2);
  EXPECT_EQ(record.inexact_steps, 1);
  EXPECT_EQ(record.substeps, 6);
  EXPECT_EQ(record.simulated_time, 0.2);
  EXPECT_EQ(record.max_complementarity_residual, 3e-5);
  EXPECT_EQ(record.max_gap.metres, 1e-10);
  EXPECT_EQ(record.final_energy, 4);
  const auto report = run_report(record, Recorder(std::vector<Probe>{}), {}, World{});
  EXPECT_EQ(report.at("inexact_steps"), 1);
  EXPECT_EQ(report.at("steps"), 2);
}

/// The lines about contacts are there for worlds that have some.
TEST(RunRecord, ItsTableSpeaksOfContactsWhereThereAreSome) {
  RunRecord record;
  record.add(StepReport{}, 0.01, {}, 0);
  EXPECT_EQ(run_details(record).find("complementarity"), std::string::npos);
  EXPECT_NE(run_summary(record, "").find("no contacts"), std::string::npos);
  record.add(step_of(Status::kSuccess, 0.1, 1e-10), 0.01, {}, 5);
  EXPECT_NE(run_details(record).find("complementarity"), std::string::npos);
  EXPECT_NE(run_summary(record, "").find("at most 3 contacts"), std::string::npos);
}

/// Where nothing moves but for round-off, that is no error of 100 %.
TEST(RunRecord, RoundOffOfNothingIsNoError) {
  Scene scene;
  scene.dt = 0.01;
  scene.world.add_body({.mass = MassProperties(2, Vec3(1, 1, 1))});
  RunRecord record;
  record.start(scene, 0, 0);
  StepReport report = step_of(Status::kSuccess, 0.01, 0);
  report.kinetic_energy = 6.5e-54;
  record.add(report, 0.01, {}, 6.5e-54);
  record.max_unexplained = 6.5e-54;
  EXPECT_NEAR(record.balance_scale(), 2 * scene.world.gravity().squaredNorm() * 1e-4 / 2, 1e-15);
  EXPECT_LT(record.relative_unexplained(), 1e-40);
}

}  // namespace
}  // namespace taut::run_record_test
