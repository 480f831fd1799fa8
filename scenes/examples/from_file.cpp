// Loads a scene file, a model (URDF, SDF, MJCF) or a scene of the catalogue, runs it, and makes what can be
// looked at.
//   from_file SCENE [FOLDER [SECONDS]]   writes from_file.html, .glb, .svg and .xml (MJCF)
#include <taut/io.h>

#include <cstdio>
#include <fstream>

int main(int argc, char** argv) try {
  using namespace taut;
  if (argc < 2) return std::fprintf(stderr, "from_file SCENE [FOLDER [SECONDS]]\n"), 2;
  const std::string folder = argc > 2 ? argv[2] : ".";
  std::vector<ImportNotice> notices;
  Scene scene = open_scene_or_model(argv[1], {}, &notices);
  if (argc > 3) scene.duration = std::stod(argv[3]);
  for (const ImportNotice& notice : notices) std::printf("%s\n", notice.text().c_str());
  for (const std::string& warning : scene.warnings) std::printf("%s\n", warning.c_str());

  Simulator simulator(scene.world, scene.settings);
  if (scene.assemble) (void)simulator.assemble();
  Film film(scene);
  double gap = 0;
  while (scene.world.time() < scene.duration - scene.dt / 2) {
    film.sample(simulator);
    const StepReport& report = simulator.step(scene.dt);
    if (!report.ok()) return std::fprintf(stderr, "%s\n", report.message.c_str()), 1;
    gap = std::max(gap, report.gap.metres);
  }
  film.sample_now(simulator);
  std::printf("%s: %d bodies, %d joints, %.3f s, joints open by at most %.1e m\n", scene.name.c_str(),
              scene.world.moving_body_count(), scene.world.joint_count(), scene.world.time(), gap);
  RecordingReader recording = film.reader();
  const std::string stem = folder + "/from_file";
  const ExportOutcome made =
      export_recording(recording, {.html = stem + ".html", .gltf = stem + ".glb", .plot = stem + ".svg"});
  for (const std::string& error : made.errors) std::fprintf(stderr, "%s\n", error.c_str());
  std::vector<std::string> left_out;  // what MJCF cannot say
  std::ofstream(stem + ".xml") << mjcf_of(scene, left_out);
  return made.errors.empty() ? 0 : 1;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 2;
}
