#include "benchmarks/peers/friction_peer.h"

#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>

#include "benchmarks/one_blas_thread.h"
#include "benchmarks/random_stages.h"
#include "benchmarks/timing.h"
#include "scenes/files/friction_file.h"

namespace taut::peers {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Vector = Eigen::VectorXd;

constexpr double kAccuracy = 1e-8;
/// q is moved by this part of it.
constexpr double kMove = 0.01;
/// Solves that are over sooner [s] are made again, so many times at most, and the fastest counts.
constexpr double kShort = 0.5;
constexpr int kMaxTurns = 5;
const std::string kStage = "stage:";

struct Options {
  std::string problem, method, start = "cold";
  double limit = 20;  ///< processor time of the process [s]
  int list = -1;      ///< random stages among the names to be printed; −1: none are
};

FrictionProblem problem_of(const std::string& name) {
  if (!name.starts_with(kStage)) return read_friction_file(name).problem.without_equalities();
  const std::size_t size = name.find(':', kStage.size());
  return benchmarks::RandomStage(std::stoi(name.substr(kStage.size())),
                                 size == std::string::npos ? 1 : std::stoi(name.substr(size + 1)))
      .problem()
      .without_equalities();
}

/// q as bodies would have it that move a little otherwise: by W x, so that what depended on each other does.
Vector moved(const FrictionProblem& problem) {
  benchmarks::RandomBodies random(1);
  Vector x(problem.rows());
  for (double& value : x) value = random.uniform(-1, 1);
  const Vector move = problem.W * x;
  const double size = move.norm();
  return size > 0 ? Vector(problem.q + kMove * problem.q.norm() / size * move) : problem.q;
}

/// One tolerance: the fastest of some turns.
Json solve(const FrictionProblem& problem, const FrictionSolve& solve, const Vector& start, double tolerance,
           FrictionTry& found) {
  double seconds = 0, total = 0;
  for (int turn = 0; turn == 0 || (turn < kMaxTurns && total < kShort); ++turn) {
    const double taken = benchmarks::cpu_seconds_of([&] { found = solve(start, tolerance); });
    seconds = turn == 0 ? taken : std::min(seconds, taken);
    total += taken;
  }
  Json out{{"tolerance", tolerance}, {"seconds", seconds}};
  out.update(found.counts);
  if (!found.r.allFinite()) return out.update({{"status", "not finite"}}), out;
  const FrictionErrors errors = friction_errors(problem, found.r);
  out["residual"] = {{"impulses", errors.impulses}, {"rates", errors.rates}, {"map", errors.map}};
  out["status"] = errors.met(kAccuracy) ? "solved" : found.excluded ? "no solution" : "inexact";
  return out;
}

/// Tolerances in turn, each with its line.  @returns the last impulses.
Vector solve_in_turn(const FrictionProblem& problem, const FrictionPeer& peer, const Options& options,
                     const Vector& start, bool print) {
  const FrictionSolve take = peer.take(problem, options.method);
  FrictionTry found;
  for (const double tolerance : peer.tolerances) {
    Json out{{"problem", options.problem},
             {"contacts", problem.contacts()},
             {"solver", peer.solver},
             {"method", options.method},
             {"start", options.start}};
    out.update(solve(problem, take, start, tolerance, found));
    if (print) std::cout << out.dump() << std::endl;
    if (out.at("status") != "inexact") break;
  }
  return found.r;
}

void run(const FrictionPeer& peer, const Options& options) {
  FrictionProblem problem = problem_of(options.problem);
  Vector start = Vector::Zero(problem.rows());
  if (options.start == "warm") {
    start = solve_in_turn(problem, peer, options, start, false);
    problem.q = moved(problem);
  }
  solve_in_turn(problem, peer, options, start, true);
}

/// Processor time is limited by the system, since no solver asks a clock of ours.
void set_limit(double seconds) {
  const rlim_t limit = static_cast<rlim_t>(std::ceil(seconds));
  const rlimit most{limit, limit + 1};
  setrlimit(RLIMIT_CPU, &most);
}

void list(int stages) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(fs::path(TAUT_SOURCE_DIR) / "tests/friction"))
    if (const std::string name = entry.path().string();
        name.ends_with(".dat") || (name.ends_with(".hdf5") && reads_hdf5()))
      files.push_back(name);
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) std::cout << file << '\n';
  for (int i = 0; i < stages; ++i) std::cout << kStage << i << '\n';
  // Those that are large at twice the size, walls and nets.
  for (int i = 0; 8 * i < stages; ++i) std::cout << kStage << 8 * i + (i % 2 == 0 ? 1 : 5) << ":2\n";
}

}  // namespace

int friction_peer_main(int argc, char** argv, const FrictionPeer& peer) {
  benchmarks::use_one_blas_thread(argv);
  CLI::App app("a friction problem in " + peer.solver + "; prints JSON");
  Options options;
  app.add_option("--problem", options.problem, "a file, or stage:NUMBER");
  app.add_option("--method", options.method, "which of its solvers");
  app.add_option("--start", options.start, "cold or warm")->check(CLI::IsMember({"cold", "warm"}));
  app.add_option("--limit", options.limit, "processor time [s]")->check(CLI::PositiveNumber);
  app.add_option("--list", options.list, "names of problems, so many random ones among them");
  CLI11_PARSE(app, argc, argv);
  try {
    if (options.list >= 0) return list(options.list), 0;
    set_limit(options.limit);
    run(peer, options);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
  return 0;
}

}  // namespace taut::peers
