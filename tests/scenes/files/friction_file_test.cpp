#include "scenes/files/friction_file.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "solvers/friction/friction_solver.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

// Files of friction problems, and all that are in tests/friction solved: made by Siconos' users, not by taut.
namespace taut::testing::friction_file_test {
namespace {

namespace fs = std::filesystem;
using Vector = Eigen::VectorXd;

const fs::path kFolder = fs::path(source_dir()) / "tests/friction";

std::vector<std::string> problems() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(kFolder)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".dat") || (name.ends_with(".hdf5") && reads_hdf5())) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// |r − P(r − ρ û)| / (ρ |q|), ρ = 1/|W|, as it is written in papers; dense.
double natural_map(const FrictionProblem& problem, const Vector& r) {
  const Eigen::MatrixXd W(problem.W);
  const double rho = 1 / Eigen::BDCSVD<Eigen::MatrixXd>(W).singularValues()[0];
  const Vector u = W * r + problem.q;
  double sum = 0;
  for (int k = 0; k < problem.contacts(); ++k) {
    const double mu = problem.mu[k];
    const Eigen::Vector3d v = u.segment<3>(3 * k), at = r.segment<3>(3 * k);
    const Eigen::Vector3d x = at - rho * (v + mu * v.tail<2>().norm() * Eigen::Vector3d::UnitX());
    const double t = x.tail<2>().norm();
    Eigen::Vector3d y = x;
    if (mu * t <= -x[0])
      y.setZero();
    else if (t > mu * x[0]) {
      y[0] = (x[0] + mu * t) / (1 + mu * mu);
      y.tail<2>() *= mu * y[0] / t;
    }
    sum += (at - y).squaredNorm();
  }
  return std::sqrt(sum) / (rho * problem.q.norm());
}

class FrictionCorpus : public ::testing::TestWithParam<std::string> {};

TEST_P(FrictionCorpus, IsSolved) {
  const FrictionFile file = read_friction_file(kFolder / GetParam());
  const FrictionResult result = solve_friction(file.problem);
  EXPECT_EQ(result.status, FrictionStatus::kSolved);
  EXPECT_LE(result.errors.impulses, 1e-8);
  EXPECT_LE(natural_map(file.problem, result.r), 1e-8);
}

std::string test_name(const ::testing::TestParamInfo<std::string>& file) {
  std::string name = file.param;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Files, FrictionCorpus, ::testing::ValuesIn(problems()), test_name);

/// The same problem dense, in blocks and global with M = 1.
TEST(FrictionFile, FormsOfOneProblemAreTheSame) {
  // Column by column.
  const std::string dense = "3\n1\n0 3 3\n3 3\n 2 0.5 0  0.25 1 0  0 0 1\n-1 3 4\n0.5\n";
  const std::string blocks =
      "3 1  1 3 3  1 1 1  3 3  2 1  0 1  0  0   2 0.5 0  0.25 1 0  0 0 1   -1 3 4   0.5   1";
  const FrictionFile a = parse_friction_text(dense, "dense"), b = parse_friction_text(blocks, "blocks");
  EXPECT_EQ(a.form, "local");
  EXPECT_EQ(a.problem.W.coeff(1, 0), 0.5);  // ∂u_1/∂r_0
  EXPECT_EQ(a.problem.W.coeff(0, 1), 0.25);
  EXPECT_EQ((a.problem.W - b.problem.W).norm(), 0);
  EXPECT_EQ((a.problem.q - b.problem.q).norm(), 0);
  const std::string global =
      "3 1 0 3 3 3 3 2 0 0 0 2 0 0 0 2 0 3 3 3 3 1 0 0 0 1 0 0 0 1  2 0 0  -2 3 4  0.5";
  const FrictionFile c = parse_friction_text(global, "global");
  EXPECT_EQ(c.form, "global");
  EXPECT_LE((Eigen::Matrix3d(c.problem.W) - 0.5 * Eigen::Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_LE((c.problem.q - Eigen::Vector3d(-1, 3, 4)).norm(), 1e-15);
}

/// What is written is read as it was, to the last bit, W with blocks that are not there and not symmetric.
TEST(FrictionFile, IsReadAsItWasWritten) {
  FrictionProblem problem{.W = {}, .q = Eigen::VectorXd(9), .mu = Eigen::VectorXd(3)};
  problem.q << -1.0 / 3, 2, 1e-300, 4, -5e17, 6, 7, 0.1, -0.0;
  problem.mu << 0, 0.3, 1.5;
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(9, 9);
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 9; ++j)
      if (i / 3 != 1 || j / 3 == 1) W(i, j) = (i == j ? 9 : 0) + 1.0 / (1 + i + 10 * j);
  W(0, 8) = 0;
  problem.W = W.sparseView(0, 0);
  const FrictionFile read = parse_friction_text(friction_text(problem), "written");
  EXPECT_EQ(read.form, "local");
  EXPECT_EQ(Eigen::MatrixXd(read.problem.W), W);
  EXPECT_EQ(read.problem.q, problem.q);
  EXPECT_EQ(read.problem.mu, problem.mu);
  problem.equalities = 3;
  problem.mu.conservativeResize(2);
  EXPECT_THROW(friction_text(problem), std::invalid_argument);
}

/// In the plane friction has one direction.
TEST(FrictionFile, AProblemOfThePlaneStaysInIt) {
  const FrictionFile file = parse_friction_text("2 1 0 2 2 2 2 1 0 0 2 -1 -3 0.5", "plane");
  EXPECT_EQ(file.dimension, 2);
  const FrictionResult result = solve_friction(file.problem);
  ASSERT_EQ(result.status, FrictionStatus::kSolved);
  EXPECT_LE((result.r - Eigen::Vector3d(1, 0.5, 0)).norm(), 1e-9);
}

TEST(FrictionFile, SaysWhatIsWrongAndBelievesNoCount) {
  const auto message = [](const std::string& text) {
    try {
      parse_friction_text(text, "p.dat");
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  const std::string good = "3 1 0 3 3 3 3 1 0 0 0 1 0 0 0 1 -1 0 0 0.5";
  EXPECT_EQ(message(good), "none");
  for (std::size_t size = 0; size + 4 < good.size(); ++size)
    EXPECT_TRUE(message(good.substr(0, size)).starts_with("p.dat: ")) << size;
  EXPECT_TRUE(message("3 2000000000").starts_with("p.dat: "));
  EXPECT_TRUE(message("3 1 1 3 3 2000000000 1 1 3").starts_with("p.dat: "));
  EXPECT_TRUE(message("3 1 2 3 3 0 0 0 0 0 0").find("storage") != std::string::npos);
  EXPECT_TRUE(message("4 1 0 3 3 3 3 1").find("dimension") != std::string::npos);
  EXPECT_TRUE(message("3 1 0 3 3 3 3 1 0 x").find("(value: x)") != std::string::npos);
  EXPECT_TRUE(message(good + " 1 1 1").starts_with("p.dat: "));
  EXPECT_TRUE(message("3 1 0 3 3 3 3 1 0 0 0 1 0 0 0 1 -1 0 0 -0.5").find("mu") != std::string::npos);
  // Indices of blocks that lead elsewhere.
  EXPECT_TRUE(message("3 1  1 3 3  1 1 1  3 3  2 1  0 1  7  0   1 0 0 0 1 0 0 0 1   -1 3 4   0.5")
                  .starts_with("p.dat: "));
  EXPECT_TRUE(message("3 1  1 3 3  1 1 1  3 3  2 1  0 5  0  0   1 0 0 0 1 0 0 0 1   -1 3 4   0.5")
                  .starts_with("p.dat: "));
}

/// Damaged HDF5 is refused, wherever it is cut.
TEST(FrictionFile, DamagedHdf5IsRefused) {
  if (!reads_hdf5()) GTEST_SKIP() << "this build reads no HDF5";
  const std::string whole = read_text((kFolder / "Box_Stacks-i0122-82-5.hdf5").string());
  ASSERT_GT(whole.size(), 10'000u);
  const fs::path damaged = temporary("damaged.hdf5");
  for (std::size_t size = 8; size < whole.size(); size += whole.size() / 25) {
    write_text(damaged.string(), whole.substr(0, size));
    EXPECT_THROW(read_friction_file(damaged), std::invalid_argument) << size;
  }
}

}  // namespace
}  // namespace taut::testing::friction_file_test
