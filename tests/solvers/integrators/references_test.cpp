#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>

#include "scenes/accuracy/reference_contacts.h"
#include "scenes/accuracy/reference_run.h"
#include "tests/source_dir.h"

/// Every file of tests/references is one test.
namespace taut::reference::references_test {
namespace {

namespace fs = std::filesystem;

/// Cases that are run to an earlier time only, with the quantities up to it, to keep the tests short.
/// `taut accuracy` runs all of them.
const std::map<std::string, double> kCutAt = {{"n_four_bar_40", 1.0}, {"n_four_bar_5", 3.0}};

/// Quantities with tolerances that the truncation of second order exceeds at the step of the case, and the
/// multiple of the tolerance within which RATTLE's deviation must stay.  All of them fall by four when the
/// step is halved; the integrator of order 4 meets them.
const std::map<std::string, std::map<std::string, double>> kBeyondOrder2 = {
    {"chain_20_release", {{"energy", 2.8}, {"rod10.position", 2.1}, {"rod15.position", 2.6}}},
    {"chain_5_drop", {{"energy", 2.9}}},
    {"double_pendulum_chaotic", {{"j1.force_on_rod1", 1.7}}},
    {"heavy_top_cusp", {{"cos_theta_min", 3.8}, {"nutation_period", 48}}},
    {"heavy_top_geradin_cardona", {{"nutation_period", 11}}},
    {"n_four_bar_5", {{"B0.position", 2}, {"B0.velocity", 1.6}}},
    {"pendulum_compound_box", {{"period", 2.1}}},
    {"pendulum_simple_90", {{"period", 1.6}}},
    {"pendulum_viscous", {{"bar.position", 1.2}, {"bar.angular_velocity", 1.6}}},
    {"pendulum_whirling", {{"revolution_time", 12}, {"angular_speed_top", 4.9}}},
    {"pendulum_whirling_slow", {{"revolution_time", 90}, {"angular_speed_top", 23}}},
    {"rigid_pendulum_3d", {{"energy", 2.2}}},
    {"spatial_slider_crank", {{"crank.angle at the last time", 1.8}}},
    {"top_steady_fast", {{"precession_rate", 5.3}}},
    {"top_steady_slow", {{"precession_rate", 2.3}}},
    {"triple_pendulum", {{"energy", 1.4}}},
};

/// Cases that RATTLE needs a shorter step for, as a fraction of the one that their tolerances are for.
const std::map<std::string, double> kStepFraction = {
    // Dampers of 40 kN·s/m on 3 kg: the iteration of velocity-dependent forces contracts below 2e-4 s only.
    {"flyball_a05", 0.1},
};

fs::path folder() { return fs::path(testing::source_dir()) / "tests" / "references"; }
std::string test_name(const ::testing::TestParamInfo<fs::path>& info) { return info.param.stem().string(); }

RunPlan plan_for(const fs::path& file) {
  RunPlan plan;
  const auto cut = kCutAt.find(file.stem().string());
  if (cut != kCutAt.end()) plan.end = cut->second;
  return plan;
}

/// @param beyond multiples of what is allowed, by quantity; 1 for all others
void expect_met(const CaseRun& run, const std::map<std::string, double>& beyond = {}) {
  EXPECT_EQ(run.failed, "");
  EXPECT_LE(run.max_gap, 1e-9);
  double worst = 0;
  int measured = 0;
  for (const Measurement& m : run.quantities) {
    if (m.verdict != Verdict::kPass && m.verdict != Verdict::kFail) continue;
    const auto found = beyond.find(m.name);
    const double times = found == beyond.end() ? 1 : found->second;
    EXPECT_TRUE(!m.measured.empty() && m.error <= times * m.allowed)
        << run.id << ": " << m.name << (m.time ? " at " + std::to_string(*m.time) + " s" : "") << ", error "
        << m.error << ", allowed " << m.allowed << " " << m.reason;
    worst = std::max(worst, m.error / m.allowed);
    ++measured;
  }
  std::cout << run.id << ": " << measured << " measured, " << run.count(Verdict::kNotMeasured)
            << " not, worst " << worst << " of what is allowed\n";
}

class ReferenceCase : public ::testing::TestWithParam<fs::path> {};

TEST_P(ReferenceCase, IsMetAtTheStepOfItsTolerances) {
  const Case built = load_case(GetParam());
  const CaseRun run = run_case(GetParam(), plan_for(GetParam()));
  expect_met(run);
  // What cannot be run must say why; of what can and says how, something must be measured.
  const bool runs = built.missing.empty();
  const bool says_how = std::any_of(run.quantities.begin(), run.quantities.end(),
                                    [](const Measurement& m) { return m.reason != kNoProbe; });
  EXPECT_EQ(run.count(Verdict::kPass) > 0, runs && says_how);
  for (const Measurement& m : run.quantities)
    if (m.verdict == Verdict::kNotMeasured) {
      EXPECT_NE(m.reason, "") << m.name;
    }
}

INSTANTIATE_TEST_SUITE_P(References, ReferenceCase, ::testing::ValuesIn(case_files(folder())), test_name);

/// RATTLE itself, which has order 2, at the step of the tolerances.
class ReferenceCaseAtOrder2 : public ::testing::TestWithParam<fs::path> {};

TEST_P(ReferenceCaseAtOrder2, IsMetButForWhatTruncationExceeds) {
  RunPlan plan = plan_for(GetParam());
  plan.choose_integrator = false;
  const std::string id = GetParam().stem().string();
  const auto beyond = kBeyondOrder2.find(id);
  const auto fraction = kStepFraction.find(id);
  if (fraction != kStepFraction.end()) plan.step = fraction->second;
  const CaseRun run = run_case(GetParam(), plan);
  expect_met(run, beyond == kBeyondOrder2.end() ? std::map<std::string, double>{} : beyond->second);
  EXPECT_GT(run.count(Verdict::kPass) + run.count(Verdict::kFail), 0);
}

/// By the head of the file alone: each process of these tests makes the list, whichever test it is to run.
bool is_smooth(const fs::path& file) {
  std::string head(2000, ' ');
  std::ifstream(file).read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.find("\"level\": \"smooth\"") != std::string::npos;
}

std::vector<fs::path> smooth_files() {
  std::vector<fs::path> files;
  for (const fs::path& file : case_files(folder()))
    if (is_smooth(file)) files.push_back(file);
  return files;
}

TEST(ReferenceCaseFiles, SayInTheirHeadsWhetherTheyAreSmooth) {
  for (const fs::path& file : case_files(folder()))
    EXPECT_EQ(is_smooth(file), load_case(file).level == "smooth") << file;
}

INSTANTIATE_TEST_SUITE_P(References, ReferenceCaseAtOrder2, ::testing::ValuesIn(smooth_files()), test_name);

/// Cases that are short and regular enough to be met to their limit tolerance, near 1e-9, by the integrator
/// of order 8 at the same step.
class ReferenceCaseAtHighOrder : public ::testing::TestWithParam<fs::path> {};

TEST_P(ReferenceCaseAtHighOrder, IsMetToItsLimit) {
  RunPlan plan{.settings = {.integrator = Integrator::kRattle8,
                            .position_tolerance = 1e-13,
                            .velocity_tolerance = 1e-12},
               .choose_integrator = false,
               .limit = true};
  const CaseRun run = run_case(GetParam(), plan);
  expect_met(run);
  EXPECT_GT(run.count(Verdict::kPass), 0);
}

std::vector<fs::path> files_of(std::initializer_list<const char*> ids) {
  std::vector<fs::path> files;
  for (const char* id : ids) files.push_back(folder() / (std::string(id) + ".json"));
  return files;
}

INSTANTIATE_TEST_SUITE_P(
    References, ReferenceCaseAtHighOrder,
    ::testing::ValuesIn(files_of({"bennett_b", "cart_pendulum_b", "double_pendulum_regular", "euler_top",
                                  "floating_two_rods", "four_bar_free", "governor_rigid",
                                  "pendulum_compound_box", "pendulum_products_of_inertia",
                                  "pendulum_simple_90", "pendulum_spherical", "rigid_pendulum_3d",
                                  "slider_crank_free_b", "thrown_cylinder", "top_steady_slow"})),
    test_name);

/// A loop, a redundant loop, a net and a chain with every factor.
class ReferenceCaseByFactor : public ::testing::TestWithParam<std::tuple<fs::path, FactorChoice>> {};

TEST_P(ReferenceCaseByFactor, IsMet) {
  RunPlan plan = plan_for(std::get<0>(GetParam()));
  plan.settings.factor = std::get<1>(GetParam());
  expect_met(run_case(std::get<0>(GetParam()), plan));
}

INSTANTIATE_TEST_SUITE_P(
    References, ReferenceCaseByFactor,
    ::testing::Combine(::testing::ValuesIn(files_of({"four_bar_free", "bricard_a04", "net_points_9",
                                                     "bridge_release_8"})),
                       ::testing::Values(FactorChoice::kSimplicial, FactorChoice::kSupernodal,
                                         FactorChoice::kMultifrontal)));

/// A ball that rolls on a turning disc: the place where it sticks changes with its way.
TEST(ReferenceOrder, of_rolling_without_slip_is_two) {
  const fs::path file = folder() / "turntable.json";
  const auto largest_error = [&](double fraction) {
    const CaseRun run = run_case(file, RunPlan{.settings = {}, .choose_integrator = false, .step = fraction});
    double error = 0;
    for (const Measurement& m : run.quantities)
      if (m.name == "ball.position") error = std::max(error, m.error);
    return error;
  };
  const double coarse = largest_error(8), fine = largest_error(4);
  EXPECT_GT(coarse, 3.5 * fine);
  EXPECT_LT(fine, 1e-4);  // over 7.3 s at 4 ms
}

}  // namespace
}  // namespace taut::reference::references_test
