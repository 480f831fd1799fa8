#include "core/world/rigid_body.h"

#include <functional>
#include <limits>
#include <numbers>

#include "tests/core/expect_invalid.h"
#include "tests/core/random_state.h"

namespace taut::rigid_body_test {
namespace {

using testing::expect_invalid;
using testing::Random;

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Volume, centre of volume and second moments of a solid of density 1.
struct Moments {
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();  // ∫ x xᵀ dV about the origin

  void add(const Vec3& x, double weight) {
    volume += weight;
    first += weight * x;
    second += weight * x * x.transpose();
  }
  /// Inertia about the centre of volume: ∫ (|x|² 1 − x xᵀ) dV, shifted.
  Mat3 inertia() const {
    const Vec3 c = first / volume;
    const Mat3 central = second - volume * c * c.transpose();
    return central.trace() * Mat3::Identity() - central;
  }
};

/// Nodes and weights of the five-point Gauss–Legendre rule on [0, 1]; exact to degree 9.
struct GaussRule {
  static constexpr int kPoints = 5;
  double x[kPoints], w[kPoints];
  GaussRule() {
    const double a = std::sqrt(5 - 2 * std::sqrt(10.0 / 7)) / 3,
                 b = std::sqrt(5 + 2 * std::sqrt(10.0 / 7)) / 3;
    const double wa = (322 + 13 * std::sqrt(70.0)) / 900, wb = (322 - 13 * std::sqrt(70.0)) / 900;
    const double nodes[] = {-b, -a, 0, a, b}, weights[] = {wb, wa, 128.0 / 225, wa, wb};
    for (int i = 0; i < kPoints; ++i) x[i] = 0.5 * (1 + nodes[i]), w[i] = 0.5 * weights[i];
  }
};

/// Adds the solid of revolution about z whose radius at z is profile(z), for z in [z0, z1].  The radius and
/// its powers up to the fourth must be polynomials in z of degree ≤ 9 after z = z0 + (z1 − z0) u, or smooth
/// enough. Azimuth: eight equal steps are exact for products of two coordinates.
void add_revolution(Moments& sum, double z0, double z1, const std::function<double(double)>& radius2) {
  const GaussRule gauss;
  for (int i = 0; i < GaussRule::kPoints; ++i) {
    const double z = z0 + (z1 - z0) * gauss.x[i], R2 = radius2(z);
    // r dr = ½ d(r²): Gauss in s = r²/R² keeps polynomials polynomial.
    for (int j = 0; j < GaussRule::kPoints; ++j) {
      const double r = std::sqrt(R2 * gauss.x[j]);
      for (int k = 0; k < 8; ++k) {
        const double angle = kPi / 4 * (k + 0.5);
        sum.add(Vec3(r * std::cos(angle), r * std::sin(angle), z),
                (z1 - z0) * gauss.w[i] * 0.5 * R2 * gauss.w[j] * 2 * kPi / 8);
      }
    }
  }
}

/// All integrands here are polynomials that the rule integrates exactly; what is left is rounding.
constexpr double kExact = 1e-13;

void expect_same_body(const MassProperties& body, const Moments& solid, double density) {
  EXPECT_NEAR(body.mass(), density * solid.volume, kExact * body.mass());
  const Mat3 expected = density * solid.inertia();
  EXPECT_LT((body.inertia_B() - expected).cwiseAbs().maxCoeff(), kExact * expected.norm())
      << body.inertia_B() << "\ninstead of\n"
      << expected;
}

constexpr double kDensityValue = 700;
constexpr Density kDensity{kDensityValue};

TEST(Inertia, OfABoxIsItsIntegral) {
  const Vec3 size(0.7, 1.1, 1.9);
  const GaussRule gauss;
  Moments solid;
  for (int i = 0; i < GaussRule::kPoints; ++i)
    for (int j = 0; j < GaussRule::kPoints; ++j)
      for (int k = 0; k < GaussRule::kPoints; ++k)
        solid.add(size.cwiseProduct(Vec3(gauss.x[i], gauss.x[j], gauss.x[k]) - Vec3::Constant(0.5)),
                  gauss.w[i] * gauss.w[j] * gauss.w[k] * size.prod());
  expect_same_body(MassProperties::box(size, kDensity), solid, kDensityValue);
}

TEST(Inertia, OfASphereIsItsIntegral) {
  const double r = 0.8;
  Moments solid;
  add_revolution(solid, -r, r, [&](double z) { return r * r - z * z; });
  expect_same_body(MassProperties::sphere(r, kDensity), solid, kDensityValue);
}

TEST(Inertia, OfAnEllipsoidIsItsIntegral) {
  const Vec3 radii(0.5, 0.9, 1.4);
  Moments ball, solid;
  add_revolution(ball, -1, 1, [](double z) { return 1 - z * z; });
  // The unit ball stretched along the axes.
  solid.volume = ball.volume * radii.prod();
  solid.second = radii.prod() * (radii.asDiagonal() * ball.second * radii.asDiagonal());
  expect_same_body(MassProperties::ellipsoid(radii, kDensity), solid, kDensityValue);
}

TEST(Inertia, OfACylinderAndARodIsItsIntegral) {
  const double r = 0.4, length = 1.7;
  Moments solid;
  add_revolution(solid, -length / 2, length / 2, [&](double) { return r * r; });
  expect_same_body(MassProperties::cylinder(r, length, kDensity), solid, kDensityValue);
  // The rod is the cylinder with z turned to x.
  const Mat3 z_to_x = (Mat3() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished();
  solid.second = z_to_x * solid.second * z_to_x.transpose();
  expect_same_body(MassProperties::rod(length, r, kDensity), solid, kDensityValue);
}

TEST(Inertia, OfACapsuleIsItsIntegral) {
  const double r = 0.4, half = 0.85;
  Moments solid;
  add_revolution(solid, -half, half, [&](double) { return r * r; });
  add_revolution(solid, half, half + r, [&](double z) { return r * r - (z - half) * (z - half); });
  add_revolution(solid, -half - r, -half, [&](double z) { return r * r - (z + half) * (z + half); });
  expect_same_body(MassProperties::capsule(r, 2 * half, kDensity), solid, kDensityValue);
}

TEST(Inertia, OfAConeIsItsIntegralAboutTheCentreOfMass) {
  const double r = 0.6, height = 1.3;
  Moments solid;
  add_revolution(solid, 0, height, [&](double z) { return r * r * (1 - z / height) * (1 - z / height); });
  EXPECT_NEAR(solid.first.z() / solid.volume, height / 4, kExact);
  expect_same_body(MassProperties::cone(r, height, kDensity), solid, kDensityValue);
}

TEST(Inertia, LimitsAgree) {
  const double mass = 3, r = 0.7;
  const Vec3 sphere = MassProperties::sphere(r, mass).principal_moments();
  const auto expect_sphere = [&](const MassProperties& body) {
    EXPECT_LT((body.principal_moments() - sphere).norm(), 1e-15 * 10);  // a few roundings
  };
  expect_sphere(MassProperties::capsule(r, 0, mass));
  expect_sphere(MassProperties::ellipsoid(Vec3(r, r, r), mass));
  // A thin rod: m L² / 12 across, nothing along.
  const Vec3 rod = MassProperties::rod(2, 1e-6, mass).principal_moments();
  EXPECT_NEAR(rod.x(), 0, 1e-11);
  EXPECT_NEAR(rod.y(), mass * 4 / 12, 1e-11);
  EXPECT_EQ(rod.y(), rod.z());
}

TEST(Inertia, DensityTimesVolumeIsTheMass) {
  EXPECT_DOUBLE_EQ(MassProperties::box(Vec3(1, 2, 3), Density{10}).mass(), 60);
  EXPECT_DOUBLE_EQ(MassProperties::sphere(1, Density{3}).mass(), 4 * kPi);
  expect_invalid([] { MassProperties::box(Vec3(1, 2, 3), Density{-4.5}); }, {"density", "positive", "-4.5"});
  expect_invalid([] { MassProperties::capsule(1, 2, Density{kNan}); }, {"density", "nan"});
}

TEST(Inertia, FullTensorIsDiagonalInThePrincipalFrame) {
  Random random(21);
  for (int i = 0; i < 100; ++i) {
    // Moments of a real body: sums of pairs of second moments.
    const Vec3 s(random.uniform(0.1, 2), random.uniform(0.1, 2), random.uniform(0.1, 2));
    const Vec3 moments(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
    const Mat3 R = random.rotation().toRotationMatrix();
    const MassProperties body(2, Mat3(R * moments.asDiagonal() * R.transpose()));
    const Mat3 R_BP = body.q_BP().toRotationMatrix();
    EXPECT_FALSE(body.body_axes_are_principal());
    EXPECT_NEAR(R_BP.determinant(), 1, 1e-14);
    const Mat3 again = R_BP * body.principal_moments().asDiagonal() * R_BP.transpose();
    EXPECT_LT((again - body.inertia_B()).norm(), 1e-14 * 10);  // an eigendecomposition of entries up to 4
    Vec3 found = body.principal_moments(), given = moments;
    std::sort(found.begin(), found.end());
    std::sort(given.begin(), given.end());
    EXPECT_LT((found - given).norm(), 1e-13);
  }
}

TEST(Inertia, DiagonalTensorKeepsItsAxes) {
  const Vec3 moments(3, 1, 2.5);
  const MassProperties body(2, Mat3(moments.asDiagonal()));
  EXPECT_TRUE(body.body_axes_are_principal());
  EXPECT_EQ(body.principal_moments(), moments);
  EXPECT_EQ(body.q_BP().coeffs(), Quat::Identity().coeffs());
}

TEST(Inertia, IsStoredExactlySymmetric) {
  Mat3 nearly = Vec3(3, 3, 3).asDiagonal();
  nearly(0, 1) = 0.5;
  nearly(1, 0) = 0.5 * (1 + 1e-12);
  const Mat3 inertia = MassProperties(1, nearly).inertia_B();
  EXPECT_EQ(inertia, inertia.transpose().eval());
}

TEST(Inertia, PlateIsAccepted) {
  // I₁ + I₂ = I₃ holds with equality, up to the rounding of the user's numbers.
  EXPECT_NO_THROW(MassProperties(1, Vec3(0.1, 0.2, 0.1 + 0.2)));
  EXPECT_NO_THROW(MassProperties(1, Vec3(0.1, 0.2, 0.3 * (1 + 1e-12))));
}

TEST(Inertia, ImpossibleBodiesAreRefused) {
  expect_invalid([] { MassProperties(1, Vec3(1, 1, 2.125)); }, {"inertia", "triangle", "2.125"});
  expect_invalid([] { MassProperties(1, Vec3(1, 1, -0.5)); }, {"inertia", "positive", "-0.5"});
  expect_invalid([] { MassProperties(1, Vec3(1, 1, 0)); }, {"inertia", "positive", "0"});
  expect_invalid([] { MassProperties(1, Vec3(1, kNan, 1)); }, {"inertia", "finite", "nan"});
  expect_invalid([] { MassProperties(0, Vec3(1, 1, 1)); }, {"mass", "positive", "0"});
  expect_invalid([] { MassProperties(-3.5, Vec3(1, 1, 1)); }, {"mass", "-3.5"});
  expect_invalid([] { MassProperties(kNan, Vec3(1, 1, 1)); }, {"mass", "nan"});
  expect_invalid([] { MassProperties(kInfinity, Vec3(1, 1, 1)); }, {"mass", "inf"});

  Mat3 tensor = Mat3::Identity();
  tensor(0, 1) = 0.125;
  expect_invalid([&] { MassProperties(1, tensor); }, {"inertia", "symmetric", "0.125"});
  tensor(1, 0) = kNan;
  expect_invalid([&] { MassProperties(1, tensor); }, {"inertia", "finite", "nan"});
  tensor(0, 1) = tensor(1, 0) = 1.5;  // an eigenvalue of −0.5
  expect_invalid([&] { MassProperties(1, tensor); }, {"inertia", "positive", "-0.5"});
  expect_invalid([&] { MassProperties(1, Mat3(Mat3::Zero())); }, {"inertia", "positive"});
}

TEST(Inertia, ImpossibleShapesAreRefused) {
  expect_invalid([] { MassProperties::box(Vec3(1, -2.5, 1), 1.0); }, {"box size", "-2.5"});
  expect_invalid([] { MassProperties::box(Vec3(1, -2.5, -1), kDensity); }, {"box size", "-2.5"});
  expect_invalid([] { MassProperties::box(Vec3(1, kNan, 1), kDensity); }, {"box size", "nan"});
  expect_invalid([] { MassProperties::sphere(0, 1.0); }, {"sphere radius", "0"});
  expect_invalid([] { MassProperties::ellipsoid(Vec3(1, 1, kInfinity), 1.0); }, {"ellipsoid radii", "inf"});
  expect_invalid([] { MassProperties::rod(-1.5, 0.1, 1.0); }, {"rod length", "-1.5"});
  expect_invalid([] { MassProperties::rod(1, -0.5, 1.0); }, {"rod radius", "-0.5"});
  expect_invalid([] { MassProperties::cylinder(-0.5, 1, 1.0); }, {"cylinder radius", "-0.5"});
  expect_invalid([] { MassProperties::cylinder(1, kNan, 1.0); }, {"cylinder length", "nan"});
  expect_invalid([] { MassProperties::capsule(kNan, 1, 1.0); }, {"capsule radius", "nan"});
  expect_invalid([] { MassProperties::capsule(1, -0.5, 1.0); }, {"capsule length", "-0.5"});
  expect_invalid([] { MassProperties::cone(-0.5, 1, 1.0); }, {"cone radius", "-0.5"});
  expect_invalid([] { MassProperties::cone(1, 0, 1.0); }, {"cone height", "0"});
  expect_invalid([] { MassProperties::sphere(1, -1.5); }, {"mass", "-1.5"});
}

}  // namespace
}  // namespace taut::rigid_body_test
