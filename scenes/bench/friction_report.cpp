#include "scenes/bench/friction_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "scenes/support/format.h"
#include "scenes/support/printable.h"

namespace taut {
namespace {

using OrderedJson = nlohmann::ordered_json;
constexpr const char *kTaut = "taut cold", *kTautWarm = "taut warm", *kProx = "siconos prox";
/// Contacts of a large problem, factorisations that are enough, rows of the table of losses.
constexpr int kLargeProblem = 225, kEnoughFactorisations = 60;
constexpr std::size_t kShownLosses = 25;

/// One problem: what each solver made of it.
struct Solved {
  std::string problem;
  int contacts = 0;
  std::map<std::string, const OrderedJson*> by_solver;

  const OrderedJson* of(const std::string& solver) const {
    const auto found = by_solver.find(solver);
    return found == by_solver.end() ? nullptr : found->second;
  }
  bool ended(const std::string& solver, const char* status) const {
    const OrderedJson* run = of(solver);
    return run && run->value("status", "") == status;
  }
  /// None if it did not solve it [s].
  std::optional<double> seconds(const std::string& solver) const {
    if (!ended(solver, "solved")) return std::nullopt;
    return of(solver)->at("seconds").get<double>();
  }
  bool is_large() const { return contacts >= kLargeProblem; }
  /// Shown to have no solution, which no solver can be asked for.
  bool excluded() const { return ended(kTaut, "no solution"); }
};

std::string solver_label(const OrderedJson& run) {
  return FrictionRun{run.value("solver", ""), run.value("method", ""), run.value("start", "cold")}.label();
}

std::vector<Solved> by_problem(const BenchResults& results) {
  std::vector<Solved> problems;
  std::map<std::string, std::size_t> place;
  for (const OrderedJson& run : results.at("runs")) {
    const std::string name = std::filesystem::path(run.at("problem").get<std::string>()).filename().string();
    const auto [at, fresh] = place.emplace(name, problems.size());
    if (fresh) problems.push_back({.problem = name, .contacts = 0, .by_solver = {}});
    Solved& problem = problems[at->second];
    problem.contacts = std::max(problem.contacts, run.value("contacts", 0));
    problem.by_solver[solver_label(run)] = &run;
  }
  return problems;
}

std::vector<std::string> cold_solvers() {
  std::vector<std::string> labels;
  for (const FrictionRun& run : friction_plan())
    if (run.start == "cold") labels.push_back(run.label());
  return labels;
}

/// Of the solver that was fastest among those that start cold; none if nobody solved it [s].
std::optional<double> least_seconds(const Solved& problem) {
  std::optional<double> least;
  for (const std::string& solver : cold_solvers())
    if (const auto seconds = problem.seconds(solver); seconds && !(least && *least <= *seconds))
      least = seconds;
  return least;
}

/// What is said of a solver in the table of all.
struct SolverSummary {
  int asked = 0, solved = 0, large = 0, large_solved = 0;
  std::vector<int> factorisations;  ///< ascending; taut's
  double log_large_seconds = 0;

  SolverSummary(const std::vector<Solved>& problems, const std::string& solver) {
    for (const Solved& problem : problems) {
      if (problem.excluded() || !problem.of(solver)) continue;
      ++asked;
      large += problem.is_large();
      const auto seconds = problem.seconds(solver);
      if (!seconds) continue;
      ++solved;
      if (const OrderedJson& run = *problem.of(solver); run.contains("factorisations"))
        factorisations.push_back(run.at("factorisations"));
      if (!problem.is_large()) continue;
      ++large_solved;
      log_large_seconds += std::log(*seconds);
    }
    std::sort(factorisations.begin(), factorisations.end());
  }
  /// Of those that it solved [s]; NaN if there are none.
  double mean_large_seconds() const { return std::exp(log_large_seconds / large_solved); }
  int quantile(double part) const {
    if (factorisations.empty()) return 0;
    const auto last = std::ssize(factorisations) - 1;
    return factorisations[std::min(last, static_cast<std::ptrdiff_t>(part * std::ssize(factorisations)))];
  }
  double share_of_few() const {
    const auto few = std::lower_bound(factorisations.begin(), factorisations.end(), kEnoughFactorisations);
    return asked > 0 ? static_cast<double>(few - factorisations.begin()) / asked : 0;
  }
};

std::string solver_table(const std::vector<Solved>& problems) {
  std::string text =
      "| solver | solved to 1e-8 | factorisations: median, 90 %, 99 %, most | below 60 | large: solved, "
      "geometric mean of those [ms] |\n|---|---|---|---|---|\n";
  for (const FrictionRun& run : friction_plan()) {
    const SolverSummary s(problems, run.label());
    if (s.asked == 0) continue;
    const std::string counts =
        s.factorisations.empty() ? " | "
                                 : format("%d, %d, %d, %d | %.1f %%", s.quantile(0.5), s.quantile(0.9),
                                          s.quantile(0.99), s.factorisations.back(), 100 * s.share_of_few());
    text += format("| %s | %d of %d | %s | %d of %d%s |\n", run.label().c_str(), s.solved, s.asked,
                   counts.c_str(), s.large_solved, s.large,
                   s.large_solved > 0 ? format(", %.1f", 1e3 * s.mean_large_seconds()).c_str() : "");
  }
  return text;
}

/// Large problems that both have solved: the ratio of their geometric means, and how many they are.
std::pair<double, int> ratio_where_both_solve(const std::vector<Solved>& problems, const std::string& solver,
                                              const std::string& peer) {
  double sum = 0;
  int count = 0;
  for (const Solved& problem : problems) {
    const auto own = problem.seconds(solver), other = problem.seconds(peer);
    if (!problem.is_large() || !own || !other) continue;
    sum += std::log(*own / *other);
    ++count;
  }
  return {count > 0 ? std::exp(sum / count) : NAN, count};
}

std::string goal_table(const std::vector<Solved>& problems) {
  const SolverSummary cold(problems, kTaut), warm(problems, kTautWarm);
  const auto [ratio, both] = ratio_where_both_solve(problems, kTaut, kProx);
  const auto line = [](const char* goal, const std::string& is, bool met) {
    return format("| %s | %s | %s |\n", goal, is.c_str(), met ? "yes" : "no");
  };
  return "| goal of taut | is | met |\n|---|---|---|\n" +
         line("all solved, cold", format("%d of %d", cold.solved, cold.asked), cold.solved == cold.asked) +
         line("all solved, warm", format("%d of %d", warm.solved, warm.asked), warm.solved == warm.asked) +
         line("median of 8 factorisations cold", format("%d", cold.quantile(0.5)), cold.quantile(0.5) <= 8) +
         line("median of 4 factorisations warm", format("%d", warm.quantile(0.5)), warm.quantile(0.5) <= 4) +
         line("99 % below 60, cold", format("%.1f %%", 100 * cold.share_of_few()),
              cold.share_of_few() >= 0.99) +
         line("99 % below 60, warm", format("%.1f %%", 100 * warm.share_of_few()),
              warm.share_of_few() >= 0.99) +
         line("faster than PROX on large problems",
              format("%.2f of its time on the %d that both solve", ratio, both), ratio < 1);
}

std::string cell_of(const Solved& problem, const std::string& solver) {
  const OrderedJson* run = problem.of(solver);
  if (!run) return "";
  if (const auto seconds = problem.seconds(solver)) {
    std::string text = format("%.3g", 1e3 * *seconds);
    if (run->contains("factorisations")) text += format(" (%d)", run->at("factorisations").get<int>());
    return text;
  }
  std::string text = run->value("status", "");
  if (run->contains("residual") && text != "no solution") {
    const OrderedJson& residual = run->at("residual");
    double worst = 0;
    for (const auto& [name, value] : residual.items())
      worst = value.is_number() ? std::max(worst, value.get<double>()) : INFINITY;
    text += format(" %.0e", worst);
  }
  return text;
}

std::string friction_run_table(const std::vector<Solved>& problems) {
  std::string text = "| problem | contacts |", rule = "|---|---|";
  for (const FrictionRun& run : friction_plan()) text += ' ' + run.label() + " |", rule += "---|";
  text += '\n' + rule + '\n';
  for (const Solved& problem : problems) {
    text += format("| %s | %d |", problem.problem.c_str(), problem.contacts);
    for (const FrictionRun& run : friction_plan()) text += ' ' + cell_of(problem, run.label()) + " |";
    text += '\n';
  }
  return text;
}

/// Where a peer solves what taut does not, or sooner: taut's time over the least; infinite if it has none.
std::vector<std::pair<double, const Solved*>> losses_of(const std::vector<Solved>& problems) {
  std::vector<std::pair<double, const Solved*>> losses;
  for (const Solved& problem : problems) {
    const auto least = least_seconds(problem), own = problem.seconds(kTaut);
    if (least && !(own && *own <= *least)) losses.emplace_back(own ? *own / *least : INFINITY, &problem);
  }
  std::stable_sort(losses.begin(), losses.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  return losses;
}

std::string fastest_of(const Solved& problem) {
  const auto least = least_seconds(problem);
  for (const std::string& solver : cold_solvers())
    if (least && problem.seconds(solver) == least) return solver;
  return "";
}

/// Points (log2 τ, share) of a solver's profile.
std::string profile_points(const std::vector<const Solved*>& problems, const std::string& solver) {
  std::vector<double> factors;
  for (const Solved* problem : problems)
    if (const auto seconds = problem->seconds(solver))
      factors.push_back(std::log2(*seconds / *least_seconds(*problem)));
  std::sort(factors.begin(), factors.end());
  std::string points = "0 0\n";
  for (std::size_t i = 0; i < factors.size(); ++i)
    points += format("%.6g %.6g\n", factors[i], (i + 1.0) / static_cast<double>(problems.size()));
  if (!factors.empty())
    points += format("20 %.6g\n", static_cast<double>(factors.size()) / static_cast<double>(problems.size()));
  return points;
}

std::string profile_plot(const std::vector<const Solved*>& problems, const std::string& title,
                         const std::string& file) {
  std::string blocks, plot;
  int index = 0;
  for (const std::string& solver : cold_solvers()) {
    blocks += format("$P%d << EOD\n", index) + profile_points(problems, solver) + "EOD\n";
    plot += (plot.empty() ? "plot " : ", ") +
            format("$P%d with steps lw %d title '%s'", index, index == 0 ? 3 : 1, solver.c_str());
    ++index;
  }
  return blocks + "set output " + gnuplot_quoted(file) + "\nset title " + gnuplot_quoted(title) + "\n" +
         plot + '\n';
}

}  // namespace

std::string FrictionRun::label() const {
  return peer + (method.empty() ? "" : ' ' + method) + (method.empty() || start != "cold" ? ' ' + start : "");
}

std::vector<FrictionRun> friction_plan() {
  std::vector<FrictionRun> plan{{"taut", "", "cold"}, {"taut", "", "warm"}};
  for (const char* method : {"vi", "prox", "nsn", "nsgs", "admm"})
    plan.push_back({"siconos", method, "cold"});
  return plan;
}

std::string friction_losses(const BenchResults& results) {
  const std::vector<Solved> problems = by_problem(results);
  const auto losses = losses_of(problems);
  std::string text = format("A peer is ahead on %zu of %zu problems.", losses.size(), problems.size());
  if (losses.empty()) return text + '\n';
  text += format(" Most of all (at most %zu are listed):\n\n", kShownLosses) +
          "| problem | contacts | taut cold [ms] | best peer | its time [ms] | ratio "
          "|\n|---|---|---|---|---|---|\n";
  for (std::size_t i = 0; i < std::min(losses.size(), kShownLosses); ++i) {
    const Solved& problem = *losses[i].second;
    text += format("| %s | %d | %s | %s | %.3g | %.3g |\n", problem.problem.c_str(), problem.contacts,
                   cell_of(problem, kTaut).c_str(), fastest_of(problem).c_str(),
                   1e3 * *least_seconds(problem), losses[i].first);
  }
  return text;
}

std::string friction_page(const BenchResults& results, const std::string& command) {
  const std::vector<Solved> problems = by_problem(results);
  std::string text = "# Results of `" + command + "`\n\n";
  for (const auto& [key, value] : results.at("machine").items())
    text += "- " + key + ": " + (value.is_string() ? value.get<std::string>() : value.dump()) + '\n';
  const auto excluded =
      std::count_if(problems.begin(), problems.end(), [](const Solved& p) { return p.excluded(); });
  text += format("- problems: %zu, of which %td are shown to have no solution and do not count\n\n",
                 problems.size(), excluded);
  text +=
      "Each run is a process of its own with " + format("%g", results.value("limit_s", 0.0)) +
      " s of processor time, on one thread; what is over sooner than 0.5 s is made up to five times, and "
      "the fastest counts. Whoever solves, all are judged by the three residuals of solvers/friction, none "
      "above 1e-8 or what round-off makes of it. Siconos' tolerance is of an error that depends on units: "
      "it is 1e-8, 1e-10, 1e-12 and 1e-14 in turn until the residuals are met, and only the last run is "
      "timed. *Warm*: q is moved by 1 % of its norm along a motion of the bodies, from the impulses of "
      "before. *Large*: from 225 contacts on. `stage:N` is a random stage (benchmarks/random_stages.h), "
      "`stage:N:2` one of twice the size along each direction.\n\n";
  return text + solver_table(problems) + '\n' + goal_table(problems) + "\n## Where taut loses first\n\n" +
         friction_losses(results) +
         "\n## Performance profiles\n\n![All problems](friction/profile-all.svg)\n\n![Large "
         "problems](friction/profile-large.svg)\n\n## All runs\n\nMilliseconds, and factorisations of taut; "
         "of "
         "what is not solved the largest residual.\n\n" +
         friction_run_table(problems);
}

std::string friction_plots(const BenchResults& results, const std::string& folder) {
  const std::vector<Solved> problems = by_problem(results);
  std::vector<const Solved*> all, large;
  for (const Solved& problem : problems) {
    if (problem.excluded()) continue;
    all.push_back(&problem);
    if (problem.is_large()) large.push_back(&problem);
  }
  std::string script =
      "set terminal svg size 720,480 dynamic background rgb 'white'\nset grid\nset key bottom right\nset "
      "xrange "
      "[0:12]\nset yrange [0:1]\nset xlabel 'log2 of the time over that of whoever was fastest'\nset ylabel "
      "'share of problems solved'\n";
  if (!all.empty()) script += profile_plot(all, "all problems", folder + "/profile-all.svg");
  if (!large.empty()) script += profile_plot(large, "from 225 contacts on", folder + "/profile-large.svg");
  return script;
}

}  // namespace taut
