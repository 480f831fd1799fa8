#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "collision/contact_finder.h"
#include "scenes/files/scene_file.h"
#include "solvers/simulator/simulator.h"
#include "tests/fuzz/mechanism.h"
#include "tests/fuzz/seed_guard.h"
#include "tests/fuzz/world.h"
#include "tests/solvers/chain_on_floor.h"

// Random worlds that touch, by seed, a second of each:
//   worlds --from 0 --count 1000 [--csv FILE] [--keep FOLDER]
//       [--limit S] [--patience S] [--seconds S] [--kind K]
//   worlds --sum FILE...     the table of what --csv has written
//   worlds --write SEED      its scene file
//   worlds --check FILE...   scene files that were written so
//   worlds --chain           the chain on the floor, by links, friction and step
// Seeds run in processes of their own; a step of more than --limit seconds is a hang, a world that has taken
// more than --patience seconds of processor time is cut short.  The exit status is 1 if a step failed without
// a contradiction that is named, if contacts gave energy, or if an oracle of mechanisms found something.

namespace taut::fuzz {
namespace {

using Json = nlohmann::json;

struct Options {
  SeedRange seeds;
  int limit = 60;
  double patience = 30;
  int kind = -1;  ///< only seeds of this one
  std::string csv, keep;
};

double processor_time() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Smallest radius of gyration of a moving body [m].
double smallest_size(const World& world) {
  double size = std::numeric_limits<double>::infinity();
  for (int b = 1; b < world.body_count(); ++b) {
    if (world.is_fixed(BodyId{b})) continue;
    const MassProperties& mass = world.mass_properties(BodyId{b});
    size = std::min(size, std::sqrt(mass.principal_moments().maxCoeff() / mass.mass()));
  }
  return size;
}

bool is_compliant(const World& world) {
  for (int s = 0; s < world.shape_count(); ++s)
    if (world.contact_material(ShapeId{s}, ShapeId{s}).compliance > 0) return true;
  return false;
}

/// Of bodies that are in each other before the first step [m].
double overlap(const World& world) {
  ContactFinder finder({.margin = 0, .threads = 1});
  double depth = 0;
  for (const Contact& contact : finder.find(world)) depth = std::max(depth, -contact.gap);
  return depth;
}

/// Steps a scene and fills in what it comes to.
class Course {
 public:
  Course(Scene& scene, const Options& options, WorldRecord& record)
      : scene_(scene),
        options_(options),
        r_(record),
        size_(smallest_size(scene.world)),
        compliant_(is_compliant(scene.world)) {}

  void run(Judge* judge) {
    const double start = processor_time();
    Simulator simulator(scene_.world, scene_.settings);
    if (judge) judge->start(scene_.world);
    r_.planned = static_cast<int>(std::lround(scene_.duration / scene_.dt));
    for (int i = 0; i < r_.planned && r_.end == "done"; ++i) {
      alarm(static_cast<unsigned>(options_.limit));
      const StepReport& report = simulator.step(scene_.dt);
      alarm(0);
      take(report);
      if (judge && report.ok())
        if (const auto bad = judge->judge(scene_.world, report, scene_.dt))
          r_.end = "oracle", r_.remark = bad->oracle + ": " + bad->figures;
      if (r_.end == "done" && processor_time() - start > options_.patience && i + 1 < r_.planned)
        r_.end = "cut";
    }
    r_.seconds = processor_time() - start;
  }

 private:
  void take(const StepReport& report) {
    r_.newton += report.counts.contact_iterations;
    r_.most_newton = std::max<long>(r_.most_newton, report.counts.contact_iterations);
    if (!report.ok()) {
      r_.end = to_string(report.status);
      r_.named = !report.contradiction.empty();
      r_.remark = report.message;
      return;
    }
    ++r_.steps;
    if (report.exact()) {
      r_.natural_residual = std::max(r_.natural_residual, report.natural_residual);
    } else {
      ++r_.inexact;
      if (report.complementarity_residual > r_.residual && !report.culprits.empty())
        r_.remark = "inexact: " + name_of(report.culprits.front(), scene_.world);
      r_.residual = std::max(r_.residual, report.complementarity_residual);
    }
    r_.gap = std::max({r_.gap, report.gap.metres, report.gap.radians});
    if (compliant_) return;  // their springs give back what they took, and sink
    r_.penetration = std::max(r_.penetration, report.penetration / size_);
    most_kinetic_ = std::max(most_kinetic_, report.kinetic_energy);
    if (!(most_kinetic_ > 0)) return;
    const double normal = report.works.contacts.normal / most_kinetic_,
                 all = report.works.contacts.total() / most_kinetic_;
    r_.normal_gain = std::max(r_.normal_gain, normal);
    if (all > r_.gain) r_.gain = all, r_.gain_time = report.time;
  }

  Scene& scene_;
  const Options& options_;
  WorldRecord& r_;
  double size_;
  bool compliant_;
  double most_kinetic_ = 0;
};

WorldRecord examine(const Json& json, const std::string& name, WorldRecord record, const Options& options) {
  try {
    Scene scene = parse_scene(json.dump(), name);
    scene.settings.threads = 1;
    if (const double depth = overlap(scene.world); depth > 1e-9) {
      record.end = "refused", record.remark = "bodies are in each other at the start";
      return record;
    }
    Judge judge(json);
    Course(scene, options, record).run(&judge);
  } catch (const SceneFileError& error) {
    alarm(0);
    record.end = "refused", record.remark = error.what();
  } catch (const std::exception& error) {
    alarm(0);
    record.end = "exception", record.remark = error.what();
  }
  return record;
}

void keep(const Json& json, std::uint64_t seed, const Options& options) {
  if (options.keep.empty()) return;
  std::filesystem::create_directories(options.keep);
  std::ofstream(options.keep + "/world_" + std::to_string(seed) + ".json") << json.dump(1) << '\n';
}

/// One line in the file, whatever process writes it.
void write(const std::string& file, const WorldRecord& record) {
  std::ofstream(file, std::ios::app) << csv_line(record) + "\n";
}

std::vector<WorldRecord> read(const std::string& file) {
  std::ifstream in(file);
  std::vector<WorldRecord> records;
  for (std::string line; std::getline(in, line);)
    if (line != csv_header()) records.push_back(parse_csv_line(line));
  return records;
}

int print_sums(const std::vector<WorldRecord>& records) {
  const std::string finds = campaign_finds(records);
  std::printf("%s\n%s", campaign_table(records).c_str(), finds.c_str());
  return !finds.empty();
}

WorldRecord started(std::uint64_t seed) {
  WorldRecord record;
  record.seed = seed, record.kind = static_cast<int>(seed % std::size(kWorldKinds));
  return record;
}

int run_seeds(Options& options) {
  const bool scratch = options.csv.empty();
  if (scratch)
    options.csv = std::filesystem::temp_directory_path() / ("worlds-" + std::to_string(getpid()) + ".csv");
  if (!std::filesystem::exists(options.csv)) std::ofstream(options.csv) << csv_header() << '\n';
  run_guarded(options.seeds, {[&](std::uint64_t seed) {
                                if (options.kind >= 0 && started(seed).kind != options.kind) return;
                                const Json json = make_world(seed);
                                const WorldRecord record =
                                    examine(json, "seed " + std::to_string(seed), started(seed), options);
                                write(options.csv, record);
                                if (!campaign_finds({record}).empty()) keep(json, seed, options);
                              },
                              [&](std::uint64_t seed, const std::string& how) {
                                WorldRecord record = started(seed);
                                record.end = "crash", record.remark = how;
                                write(options.csv, record);
                                keep(make_world(seed), seed, options);
                              }});
  const std::vector<WorldRecord> records = read(options.csv);
  if (scratch) std::filesystem::remove(options.csv);
  return print_sums(records);
}

int check_files(const std::vector<std::string>& files, const Options& options) {
  std::vector<WorldRecord> records;
  for (const std::string& file : files) {
    std::ifstream in(file);
    records.push_back(examine(Json::parse(in), file, {}, options));
    std::printf("%s: %s\n", file.c_str(), csv_line(records.back()).c_str());
  }
  return !campaign_finds(records).empty();
}

/// The chain that swings down on a floor, by links, friction and step: rows that say what became of it.
int run_chains(const Options& options) {
  constexpr int kLinks[] = {3, 10, 30, 100};
  constexpr double kFrictions[] = {0, 0.3, 1}, kSteps[] = {0.25e-3, 1e-3, 4e-3, 8e-3};
  std::vector<WorldRecord> records;
  std::printf(
      "| links | friction | step [ms] | end | time [s] | inexact | residual | Newton a step, most | largest "
      "gain | at [s] | "
      "penetration | s |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const int links : kLinks)
    for (const double friction : kFrictions)
      for (const double dt : kSteps) {
        Scene scene;
        scene.world = testing::chain_on_floor(links, friction);
        scene.dt = dt, scene.duration = 2, scene.settings.threads = 1;
        WorldRecord r;
        Course(scene, options, r).run(nullptr);
        records.push_back(r);
        std::printf("| %d | %g | %g | %s | %.3g | %d | %.1e | %.1f, %ld | %.1e | %.4g | %.1e | %.1f |\n",
                    links, friction, 1e3 * dt, r.end.c_str(), r.steps * dt, r.inexact, r.residual,
                    static_cast<double>(r.newton) / std::max(1, r.steps), r.most_newton, r.gain, r.gain_time,
                    r.penetration, r.seconds);
        std::fflush(stdout);
      }
  return !campaign_finds(records).empty();
}

}  // namespace
}  // namespace taut::fuzz

int main(int argc, char** argv) {
  using namespace taut::fuzz;
  Options options;
  std::vector<std::string> files;
  std::string mode;
  for (int i = 1; i < argc; ++i) {
    const std::string key = argv[i];
    const auto value = [&]() -> std::string { return i + 1 < argc ? argv[++i] : ""; };
    if (options.seeds.takes(key, value)) continue;
    if (key == "--limit")
      options.limit = std::atoi(value().c_str());
    else if (key == "--patience")
      options.patience = std::atof(value().c_str());
    else if (key == "--kind")
      options.kind = std::atoi(value().c_str());
    else if (key == "--csv")
      options.csv = value();
    else if (key == "--keep")
      options.keep = value();
    else if (key == "--write")
      return std::printf("%s\n", make_world(std::strtoull(value().c_str(), nullptr, 10)).dump(1).c_str()), 0;
    else if (key == "--sum" || key == "--check" || key == "--chain")
      mode = key;
    else if (!mode.empty() && !key.starts_with("-"))
      files.push_back(key);
    else
      return std::fprintf(stderr, "unknown option %s\n", argv[i]), 2;
  }
  if (mode == "--check") return check_files(files, options);
  if (mode == "--chain") return run_chains(options);
  if (mode == "--sum") {
    std::vector<WorldRecord> records;
    for (const std::string& file : files)
      for (const WorldRecord& record : read(file)) records.push_back(record);
    return print_sums(records);
  }
  return run_seeds(options);
}
