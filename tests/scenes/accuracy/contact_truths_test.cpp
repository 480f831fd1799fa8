#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scenes/accuracy/contact_report.h"
#include "scenes/accuracy/rolling_body.h"
#include "scenes/builders/contact_worlds.h"
#include "tests/run_program.h"
#include "tests/temporary.h"

/// `taut accuracy --contacts`: its judgements, the motion that it compares with, and rows that have a closed
/// form.
namespace taut::reference::contact_truths_test {
namespace {

using Json = nlohmann::json;
using testing::run_program;

const std::vector<double> kSteps = {4e-3, 2e-3, 1e-3};

Verdict verdict_of(const Truth& truth, const std::vector<double>& measured) {
  return judge(truth, kSteps, measured).verdict;
}

TEST(ContactTruths, JudgesByTheDistanceAndItsOrder) {
  const Truth truth{.what = "x", .source = "1", .value = 1, .allowed = 1.1e-3, .power = 2, .order = 1.9};
  const TruthResult met = judge(truth, kSteps, {1.016, 1.004, 0.999});
  EXPECT_EQ(met.verdict, Verdict::kPass);
  EXPECT_NEAR(met.order, 2, 1e-9);
  EXPECT_NEAR(met.allowed[0], 0.0176, 1e-12);
  EXPECT_EQ(verdict_of(truth, {1.018, 1.004, 1.001}), Verdict::kFail);   // too far at the longest step
  EXPECT_EQ(verdict_of(truth, {1.003, 1.0018, 1.001}), Verdict::kFail);  // of order 1
  EXPECT_EQ(verdict_of(truth, {1.01, 1.001, std::nan("")}), Verdict::kFail);
  EXPECT_EQ(verdict_of(truth, {1.01, 1, 1 + 1e-12}), Verdict::kPass);  // round-off has no order
}

TEST(ContactTruths, JudgesWhatMustNotGrowByOneSideAlone) {
  const Truth truth{.what = "x", .source = "law", .comparison = Comparison::kAtMost, .allowed = 1e-6};
  EXPECT_EQ(verdict_of(truth, {-5, -1e-3, 9e-7}), Verdict::kPass);
  EXPECT_EQ(verdict_of(truth, {-5, 2e-6, 0}), Verdict::kFail);
  EXPECT_EQ(verdict_of(truth, {-5, 0, std::nan("")}), Verdict::kFail);
}

TEST(ContactTruths, JudgesConvergenceByTheChanges) {
  const Truth truth{
      .what = "x", .source = "converges", .comparison = Comparison::kConverges, .allowed = 0.11, .power = 1};
  const TruthResult met = judge(truth, kSteps, {7.3, 7.1, 7.0});
  EXPECT_EQ(met.verdict, Verdict::kPass);
  EXPECT_NEAR(met.order, 1, 1e-9);
  EXPECT_EQ(verdict_of(truth, {7.3, 7.1, 6.9}), Verdict::kFail);
}

ContactCase named(const std::string& name) {
  for (ContactCase& one : contact_cases())
    if (one.name == name) return one;
  throw std::runtime_error("no case " + name);
}

void expect_all_rows(const ContactResult& result) {
  for (const LawRecord& law : result.laws) EXPECT_EQ(law.failed, "");
  for (const TruthResult& row : result.truths)
    EXPECT_EQ(row.verdict, Verdict::kPass) << row.truth.what << ": " << row.measured.back() << ", allowed "
                                           << row.allowed.back() << ", order " << row.order;
  EXPECT_TRUE(result.good());
}

/// Rows with a closed form or an independent motion, to the tolerances and orders of the cases.
class ContactTruth : public ::testing::TestWithParam<const char*> {};

TEST_P(ContactTruth, is_met_with_its_order) { expect_all_rows(run_contact_case(named(GetParam()))); }

INSTANTIATE_TEST_SUITE_P(Cases, ContactTruth,
                         ::testing::Values("tumbling-box", "gas-of-balls", "break", "cradle",
                                           "cradle-touching", "two-balls", "oblique", "dome", "bowl",
                                           "roly-poly", "rattleback", "painleve", "dominoes", "belt"),
                         [](const auto& one) {
                           std::string name = one.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

/// A step that fails leaves rows that are not numbers, and no case is good with those.
TEST(ContactTruths, OfARunThatFailsAreMissed) {
  ContactCase broken;
  broken.name = "broken";
  broken.what = "fails";
  broken.steps = {1e-3};
  broken.truths = {{.what = "x", .source = "0", .allowed = 1}};
  broken.measure = [](double, LawRecord& laws) {
    laws.failed = "step to t = 0 s: no";
    return std::vector{std::nan("")};
  };
  const ContactResult result = run_contact_case(broken);
  EXPECT_FALSE(result.good());
  const std::string table = contact_table({result}, false);
  EXPECT_EQ(table.rfind("Rows that miss their truth", 0), 0u) << table;
  EXPECT_NE(table.find("at 1 ms: step to t = 0 s: no"), std::string::npos) << table;
  EXPECT_NE(table.find("not measured"), std::string::npos) << table;
  EXPECT_EQ(contact_json({result}).at("cases").at(0).at("rows").at(0).at("verdict"), "FAIL");
  const Json read = Json::parse(contact_json({result}).dump());
  EXPECT_TRUE(read.at("cases").at(0).at("rows").at(0).at("results").at(0).at("measured").is_null());
}

/// Contacts that give energy are found, and so is the step: a body is thrown into a run as by an impact.
TEST(ContactTruths, WatchEveryStepOfTheLedger) {
  LawRecord laws;
  ContactCourse course(contact_worlds::oblique_ball({}, 0.5, 0.3), 1e-3, laws);
  double least = 0;
  ASSERT_TRUE(course.run(0.01, [&] {
    least = std::min(least, course.simulator().report().ledger.contacts);
    return true;
  }));
  EXPECT_EQ(laws.steps, 10);
  EXPECT_LT(least, 0);               // the impact takes energy …
  EXPECT_EQ(laws.contacts.work, 0);  // … and no other step gives or takes any
  EXPECT_LT(course.drift(), -0.1);
}

/// p of an ellipsoid moves with n as its slope says, and lies on the surface.
TEST(RollingBody, KnowsPointsOfSurfaces) {
  const Vec3 radii(0.3, 0.2, 0.1), centre(0.01, 0, 0.02);
  const Vec3 n = Vec3(0.3, -0.4, 0.8).normalized(), dn = n.cross(Vec3(1e-6, 2e-6, -1e-6));
  const auto check = [&](const std::function<SurfacePoint(const Vec3&)>& at) {
    const Vec3 difference = (at(n + dn).p - at(n - dn).p) / 2;
    EXPECT_LT((difference - at(n).slope * dn).norm(), 1e-14);  // third order in 2e-6
  };
  check([&](const Vec3& m) { return on_ellipsoid(radii, centre, m); });
  check([&](const Vec3& m) { return on_rim(0.2, 0.02, m); });
  EXPECT_NEAR((on_ellipsoid(radii, centre, n).p - centre).cwiseQuotient(radii).norm(), 1, 1e-14);
  EXPECT_NEAR(on_rim(0.2, 0.02, n).p.head<2>().norm(), 0.2, 1e-15);
}

/// A ball rolls straight on at one speed; with rolling friction of arm δ it slows by 5/7 g δ/r.
TEST(RollingBody, OfABallIsStraight) {
  const double r = 0.1, speed = 0.5, arm = 1e-3;
  RollingBody ball;
  ball.mass = 2;
  ball.inertia = 0.4 * 2 * r * r * Mat3::Identity();
  ball.surface = [r](const Vec3& n) { return on_ellipsoid(Vec3::Constant(r), Vec3::Zero(), n); };
  const RollingState start{.pose = {.q = Quat::Identity(), .p = {0, 0, r}},
                           .twist = {.w = {0, speed / r, 0}, .v = {speed, 0, 0}}};
  const RollingState free = roll(ball, start, 2, 2000);
  EXPECT_NEAR(free.pose.p.x(), 1, 1e-12);
  EXPECT_NEAR(free.pose.p.z(), r, 1e-14);
  ball.rolling_arm = arm;
  const RollingState slowed = roll(ball, start, 2, 2000);
  // m v̇ = −F and 2/5 m r² ω̇ = F r − δ m g: v̇ = −5/7 g δ/r.
  EXPECT_NEAR(slowed.twist.v.x(), speed - 5.0 / 7 * 9.81 * arm / r * 2, 1e-9);
}

TEST(ContactTruths, AreRunByTheProgram) {
  const auto outcome = run_program({"accuracy", "--contacts", "--only", "cradle", "--json"});
  EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
  const Json report = Json::parse(outcome.out);
  EXPECT_EQ(report.at("schema"), "taut-accuracy-contacts/1");
  ASSERT_EQ(report.at("cases").size(), 2u);
  EXPECT_EQ(report.at("summary").at("fail"), 0);
  const Json& row = report.at("cases").at(1).at("rows").at(1);
  EXPECT_EQ(row.at("truth"), 0.4);
  ASSERT_EQ(row.at("results").size(), 3u);
  EXPECT_NEAR(row.at("results").at(2).at("measured"), 0.4, 1e-8);
  EXPECT_EQ(report.at("cases").at(1).at("runs").at(0).at("inexact"), 0);

  const auto table = run_program({"accuracy", "--contacts", "--only", "two-balls", "--summary"});
  EXPECT_EQ(table.exit_status, 0);
  EXPECT_NE(table.out.find("No row misses its truth."), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("1 cases: 5 rows pass, 0 fail"), std::string::npos) << table.out;
  const auto csv = run_program({"accuracy", "--contacts", "--only", "two-balls", "--csv"});
  EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'), 1 + 5 * 3);
}

TEST(ContactTruths, RefuseOptionsOfCases) {
  for (const std::vector<std::string>& option : {std::vector<std::string>{"--references", "."},
                                                 {"--integrator", "rattle"},
                                                 {"--factor", "cholmod"},
                                                 {"--study", "nowhere"},
                                                 {"--only", "nosuch"}}) {
    std::vector<std::string> words{"accuracy", "--contacts"};
    words.insert(words.end(), option.begin(), option.end());
    const auto outcome = run_program(words);
    EXPECT_EQ(outcome.exit_status, 2) << option.front();
    EXPECT_NE(outcome.err.find(option.front()), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace taut::reference::contact_truths_test
