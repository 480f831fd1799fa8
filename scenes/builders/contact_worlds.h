#pragma once

#include <random>

#include "core/world/world.h"

/// Worlds with contact whose motion obeys a closed form or a law: what `taut accuracy --contacts` and the
/// tests of contacts measure.
namespace taut::contact_worlds {

/// One friction, static and dynamic.
Material rubbing(double friction, double restitution = 0);
/// A body of one shape, named by its number.
BodyId add_solid(World& world, const Shape& shape, MassProperties mass, const Pose& pose, const Twist& twist,
                 const Material& material);
/// Of 1 kg.
BodyId add_ball(World& world, double radius, const Vec3& p, const Twist& twist, const Material& material);
BodyId add_box(World& world, const Vec3& size, const Pose& pose, const Twist& twist,
               const Material& material);
Quat random_turn(std::mt19937& random);
/// Each component within ±most.
Vec3 random_vector(std::mt19937& random, double most);

/// A smooth elastic box that falls on a smooth floor, turning.
World tumbling_box();
/// 27 smooth elastic balls or boxes in a cube of 1 m, without weight.
World gas(bool boxes);
/// Two smooth elastic balls; the first flies at 3 m/s along x at the second, 0.19 m off its centre at a
/// distance of centres of 0.2 m.
World two_balls();
/// A ball at 5 m/s strikes fifteen that touch each other, smooth and elastic.
World ball_break();
/// Five smooth elastic balls of 1 kg and 0.1 m in a line along x, `gap` [m] between each two, without weight;
/// the first flies at the others at 2 m/s from 0.1 m.
World cradle(double gap);

/// A ball of 1 kg without weight that strikes a floor obliquely.
struct Oblique {
  double speed_x = 1.5, speed_z = -2;  ///< [m/s]
  double spin = 4;                     ///< about y [rad/s]
  double radius = 0.1;                 ///< [m]
  double height = 3e-4;                ///< above the floor at the start [m]
};
World oblique_ball(const Oblique& ball, double restitution, double friction);
/// A rod or a box, thrown at a floor with random turn, speed and spin.
World thrown_box(std::mt19937& random, bool slender, double restitution, double friction);

inline constexpr double kDomeReach = 1.1;  ///< [m] from the centre of the dome to that of the ball
/// A smooth ball of 0.1 m on a fixed sphere of 1 m about the origin, `angle` [rad] from its top towards x,
/// moving on at `rate` [rad/s].
World ball_on_dome(double angle, double rate = 0);
/// A bowl of `planes` fixed planes that touch a circle of 1.1 m in the plane xz, `turn` [rad] between each
/// two, the first below its centre, the origin; a smooth ball of 0.1 m slides on the first at 1 m/s along x,
/// without weight.
World ball_in_bowl(int planes, double turn);

inline constexpr double kDiscRadius = 0.2, kDiscHalf = 0.02;  ///< [m] of the rolling disc
/// On its rim, leaning and turning, without slip.
World rolling_disc();
/// A ball of 0.1 m whose centre of mass is 0.04 m below its own, leaning by half a radian and turning: it
/// rocks as in a bowl, and rolls without slip.
World roly_poly();
inline constexpr double kRolyRadius = 0.1, kRolyRise = 0.04;  ///< [m]
/// A celt [Kane1982]: half axes 0.2, 0.03 and 0.02 m, its centre of mass 0.01 m below that of the ellipsoid,
/// its principal axes of inertia turned against those of the shape.  It spins about the vertical without slip
/// at −5 rad/s, leaning by half a degree.
World rattleback();
inline Vec3 rattleback_radii() { return {0.2, 0.03, 0.02}; }
inline constexpr double kRattlebackRise = 0.01;  ///< [m] of the ellipsoid's centre above that of mass
/// Euler's disc, of 0.1 m and 2 mm: it leans by `lean` [rad] from the floor and runs round on its rim about a
/// centre at rest, with rolling friction of that length [m].
World euler_disc(double lean, double rolling_length);
inline constexpr double kEulerRadius = 0.1, kEulerHalf = 0.001;  ///< [m]

/// A rod of 1 m and 1 kg as a capsule of 5 mm that slides at −2 m/s along x on a floor with its left end, at
/// `angle` [rad] from the horizontal, `height` [m] above it.  [Painleve1895]
struct Rod {
  double angle = 0, height = 0;
  double speed_z = 0;  ///< [m/s]
  double spin = 0;     ///< about y [rad/s]
  double speed_x = -2;
};
World sliding_rod(const Rod& rod, double restitution, double friction);
/// A box on a belt, held back by a spring: friction has to bear 80 N/s more until it slips.
struct Belt {
  World world;
  BodyId belt, box;
  double limit = 0;  ///< of static friction, μ_s m g [N]
  double rate = 0;   ///< [N/s] of the spring's force before it
};
Belt box_on_belt();
/// n dominoes in a line along x; the first falls.
World dominoes(int n);
inline constexpr double kDominoPitch = 0.04;  ///< [m] from one to the next

}  // namespace taut::contact_worlds
