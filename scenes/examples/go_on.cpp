// A chain that is saved in the middle of its swing, in a file, and goes on from there in another simulator:
// to the same bits.
//   go_on [FOLDER]   writes go_on.json and go_on.html
#include <taut/io.h>

#include <cstdio>

int main(int argc, char** argv) {
  using namespace taut;
  const std::string folder = argc > 1 ? argv[1] : ".", file = folder + "/go_on.json";
  const auto run = [](Simulator& simulator, World& world, double until, Film* film) {
    while (world.time() < until - 1e-9) {
      if (film) film->sample(simulator);
      if (!simulator.step(1.0 / 240).ok()) throw std::runtime_error(simulator.report().message);
    }
  };
  Scene whole = build_scene("chain", {{"n", 30}});
  Simulator first(whole.world, whole.settings);
  Film film(whole);
  run(first, whole.world, 0.5, &film);
  const std::string error = save_state_file(first, file);
  if (!error.empty()) return std::fprintf(stderr, "%s\n", error.c_str()), 1;
  run(first, whole.world, 1, &film);

  Scene again = build_scene("chain", {{"n", 30}});
  const SavedMemory memory = load_state_file(again.world, file);
  Simulator second(again.world, again.settings);
  const std::string note = go_on_from(second, again.world, memory);
  if (!note.empty()) std::printf("%s\n", note.c_str());
  run(second, again.world, 1, nullptr);

  bool same = true;
  for (int b = 0; b < whole.world.body_count(); ++b)
    same = same && whole.world.pose({b}).p == again.world.pose({b}).p;
  std::printf("after 1 s both chains are %s\n", same ? "the same, to the last bit" : "different");
  RecordingReader recording = film.reader();
  const ExportOutcome made = export_recording(recording, {.html = folder + "/go_on.html"});
  for (const std::string& e : made.errors) std::fprintf(stderr, "%s\n", e.c_str());
  return same && made.errors.empty() ? 0 : 1;
}
