// Very many random friction problems in taut's solver: how many are solved, shown to have no solution or left
// inexact, and by how many factorisations.  Prints a page, and writes JSON if that is wanted.
#include "benchmarks/random_stages.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "benchmarks/one_blas_thread.h"
#include "benchmarks/timing.h"
#include "core/base/fnv1a.h"
#include "scenes/bench/bench_report.h"
#include "scenes/support/format.h"
#include "solvers/friction/friction_solver.h"

namespace {

using namespace taut;
using Json = nlohmann::ordered_json;

/// Of one family, or of all.
struct Tally {
  std::array<int, 3> ended{};  ///< by FrictionStatus
  std::array<int, 5> rungs{};  ///< of what is solved
  std::vector<int> factorisations, contacts;
  double seconds = 0;
  int sweeps = 0;
  double residual = 0;  ///< largest, of impulses and rates
  Fnv1a fingerprint;    ///< of all impulses

  void add(const FrictionProblem& problem, const FrictionResult& result, double taken) {
    ++ended[static_cast<std::size_t>(result.status)];
    contacts.push_back(problem.contacts());
    seconds += taken;
    sweeps += result.sweeps;
    residual = std::max({residual, result.errors.impulses, result.errors.rates});
    for (const double impulse : result.r) fingerprint.add(impulse);
    if (result.status != FrictionStatus::kSolved) return;
    factorisations.push_back(result.factorisations);
    ++rungs[static_cast<std::size_t>(result.rung)];
  }
  int of(FrictionStatus status) const { return ended[static_cast<std::size_t>(status)]; }
  double share_below(int most) const {
    const auto few =
        std::count_if(factorisations.begin(), factorisations.end(), [&](int f) { return f < most; });
    return factorisations.empty() ? 0 : static_cast<double>(few) / static_cast<double>(factorisations.size());
  }
};

int quantile(std::vector<int> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(part * static_cast<double>(values.size())))];
}

Json json_of(const std::string& name, const Tally& tally) {
  Json rungs;
  for (std::size_t i = 0; i < tally.rungs.size(); ++i) rungs[kFrictionRungNames[i]] = tally.rungs[i];
  Json factorisations;
  for (const auto& [label, part] :
       {std::pair{"50", 0.5}, {"75", 0.75}, {"90", 0.9}, {"99", 0.99}, {"100", 1.0}})
    factorisations[label] = quantile(tally.factorisations, part);
  factorisations["sum"] = std::accumulate(tally.factorisations.begin(), tally.factorisations.end(), 0);
  return {{"family", name},
          {"stages", tally.contacts.size()},
          {"contacts", {{"median", quantile(tally.contacts, 0.5)}, {"most", quantile(tally.contacts, 1)}}},
          {"solved", tally.of(FrictionStatus::kSolved)},
          {"no_solution", tally.of(FrictionStatus::kNoSolution)},
          {"inexact", tally.of(FrictionStatus::kInexact)},
          {"factorisations", factorisations},
          {"below_60", tally.share_below(60)},
          {"rungs", rungs},
          {"sweeps", tally.sweeps},
          {"largest_residual", tally.residual},
          {"fingerprint", format("%016llx", static_cast<unsigned long long>(tally.fingerprint.value()))},
          {"processor_seconds", tally.seconds}};
}

std::string page_row(const Json& j) {
  const Json &f = j.at("factorisations"), &c = j.at("contacts");
  return format("| %s | %d | %d, %d | %d | %d | %d | %d, %d, %d, %d, %d | %.2f %% | %.1f |\n",
                j.at("family").get<std::string>().c_str(), j.at("stages").get<int>(),
                c.at("median").get<int>(), c.at("most").get<int>(), j.at("solved").get<int>(),
                j.at("no_solution").get<int>(), j.at("inexact").get<int>(), f.at("50").get<int>(),
                f.at("75").get<int>(), f.at("90").get<int>(), f.at("99").get<int>(), f.at("100").get<int>(),
                100 * j.at("below_60").get<double>(),
                1e3 * j.at("processor_seconds").get<double>() / j.at("stages").get<int>());
}

std::string page_of(const Json& results) {
  std::string text = format("# %d random stages\n\n", results.at("families").back().at("stages").get<int>());
  for (const auto& [key, value] : results.at("machine").items())
    text += "- " + key + ": " + (value.is_string() ? value.get<std::string>() : value.dump()) + '\n';
  text +=
      "\n| family | stages | contacts: median, most | solved | no solution | inexact | factorisations: "
      "median, "
      "75 %, 90 %, 99 %, most | below 60 | ms |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const Json& family : results.at("families")) text += page_row(family);
  text += "\nSolved by\n\n";
  for (const auto& [rung, count] : results.at("families").back().at("rungs").items())
    text += "- " + rung + ": " + std::to_string(count.get<int>()) + '\n';
  text +=
      "\n## Inexact\n\n| stage | family | contacts | equalities | μ | impulses | rates | map | largest "
      "impulse [N·s] |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (const Json& j : results.at("inexact"))
    text += format("| %d | %s | %d | %d | %.2f | %.0e | %.0e | %.0e | %.2g |\n", j.at("stage").get<int>(),
                   j.at("family").get<std::string>().c_str(), j.at("contacts").get<int>(),
                   j.at("equalities").get<int>(), j.at("mu").get<double>(), j.at("impulses").get<double>(),
                   j.at("rates").get<double>(), j.at("map").get<double>(), j.at("largest").get<double>());
  return text;
}

Json inexact_of(int number, const char* family, const FrictionProblem& problem,
                const FrictionResult& result) {
  return {{"stage", number},
          {"family", family},
          {"contacts", problem.contacts()},
          {"equalities", problem.equalities},
          {"mu", problem.mu.maxCoeff()},
          {"impulses", result.errors.impulses},
          {"rates", result.errors.rates},
          {"map", result.errors.map},
          {"largest", result.r.cwiseAbs().maxCoeff()}};
}

Json run(int first, int count) {
  std::array<Tally, std::size(benchmarks::kStageFamilyNames)> families;
  Tally all;
  Json inexact = Json::array(), last_rung = Json::array();
  for (int i = first; i < first + count; ++i) {
    const benchmarks::RandomStage stage(i);
    const FrictionProblem problem = stage.problem();
    const double begin = benchmarks::cpu_seconds();
    const FrictionResult result = solve_friction(problem);
    const double seconds = benchmarks::cpu_seconds() - begin;
    for (Tally* tally : {&families[static_cast<std::size_t>(i) % families.size()], &all})
      tally->add(problem, result, seconds);
    if (result.tried.back() > 0) last_rung.push_back(i);
    if (result.status == FrictionStatus::kInexact)
      inexact.push_back(inexact_of(i, stage.family(), problem, result));
    if ((i + 1) % 500 == 0) std::cerr << i + 1 << " stages, " << inexact.size() << " inexact\n";
  }
  Json results{{"machine", machine_description()}, {"first", first}, {"families", Json::array()}};
  for (std::size_t f = 0; f < families.size(); ++f)
    results["families"].push_back(json_of(benchmarks::kStageFamilyNames[f], families[f]));
  results["families"].push_back(json_of("all", all));
  results["inexact"] = inexact;
  results["last_rung"] = last_rung;  // numbers of the stages that it was tried on
  return results;
}

}  // namespace

int main(int argc, char** argv) {
  benchmarks::use_one_blas_thread(argv);
  CLI::App app("random friction problems in taut's solver; prints a page");
  int first = 0, count = 10'000;
  std::string json;
  app.add_option("--first", first, "number of the first stage");
  app.add_option("--count", count, "how many")->check(CLI::PositiveNumber);
  app.add_option("--json", json, "write the numbers, too")->type_name("FILE");
  CLI11_PARSE(app, argc, argv);
  const Json results = run(first, count);
  std::cout << page_of(results);
  if (json.empty()) return 0;
  std::ofstream out(json);
  out << results.dump(1) << '\n';
  return out.good() ? 0 : 1;
}
