// A crane's jib: a triangle of rods that bears 1000 N at its tip.  What each rod carries, beside statics.
//   truss [FOLDER]   writes truss.html
#include <taut/io.h>

#include <cstdio>

int main(int argc, char** argv) {
  using namespace taut;
  const std::string folder = argc > 1 ? argv[1] : ".";
  const double load = 1000;
  World world;
  world.set_gravity(Vec3::Zero());  // so that the load is all that acts
  const Vec3 foot(0, 0, 0), top(0, 0, 3), at(4, 0, 0);
  const BodyId tip =
      world.add_body({.name = "tip", .mass = MassProperties::sphere(0.1, 5), .pose = {Quat::Identity(), at}});
  const auto rod_from = [&](const Vec3& p) {
    return Distance(kGround, tip, p, Vec3::Zero(), (p - at).norm());
  };
  const JointId strut = world.add("strut", rod_from(foot));
  const JointId tie = world.add("tie", rod_from(top));
  // The third rod keeps the tip in the plane of the others and carries nothing.
  const JointId guy = world.add("guy", rod_from(at + Vec3(0, 5, 0)));
  world.add_force(PointForce(tip, Vec3::Zero(), Vec3(0, 0, -load)));
  Simulator simulator(world);
  Film film(world);
  for (int i = 0; i < 60; ++i) {
    film.sample(simulator);
    if (!simulator.step(1.0 / 60).ok())
      return std::fprintf(stderr, "%s\n", simulator.report().message.c_str()), 1;
  }
  // Force of the joint on its body B, here the tip: towards the other end where the rod pulls.
  const auto pull = [&](JointId rod, const Vec3& from) {
    return simulator.reaction(rod).force.dot((from - at).normalized());
  };
  const double truths[] = {-load * 4 / 3, load * 5 / 3, 0};
  const double pulls[] = {pull(strut, foot), pull(tie, top), pull(guy, at + Vec3(0, 5, 0))};
  bool right = true;
  for (int i = 0; i < 3; ++i) {
    std::printf("%-5s pulls with %12.6f N, statics say %12.6f N\n", world.name(JointId{i}).c_str(), pulls[i],
                truths[i]);
    right = right && std::abs(pulls[i] - truths[i]) < 1e-6 * load;
  }
  RecordingReader recording = film.reader();
  const ExportOutcome made = export_recording(recording, {.html = folder + "/truss.html"});
  for (const std::string& error : made.errors) std::fprintf(stderr, "%s\n", error.c_str());
  return right && made.errors.empty() ? 0 : 1;
}
