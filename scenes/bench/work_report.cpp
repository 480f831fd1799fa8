#include "scenes/bench/work_report.h"

#include <algorithm>
#include <cmath>

#include "scenes/support/format.h"

namespace taut {
namespace {

using OrderedJson = nlohmann::ordered_json;
using Points = std::vector<std::pair<double, double>>;

std::string with_of(const OrderedJson& profile, const char* before) {
  const std::string with = profile.value("with", "");
  return with.empty() ? with : before + with;
}
std::string family_of(const OrderedJson& profile) {
  return profile.at("scene").get<std::string>() + with_of(profile, " with ");
}
/// Not a number where JSON could not say it.
double number_in(const OrderedJson& profile, const char* key) {
  return profile.contains(key) && profile.at(key).is_number() ? profile.at(key).get<double>() : NAN;
}
bool is_whole(const OrderedJson& profile) {
  return !profile.contains("failed") && profile.contains("factor_flops");
}

std::string stage_shares(const OrderedJson& stages) {
  std::string shares;
  for (const char* stage : {"forces", "positions", "assembly", "factorization", "velocities"})
    shares += format("%s%.0f", shares.empty() ? "" : ", ",
                     100 * number_in(stages, stage) / number_in(stages, "total"));
  return shares;
}

std::string row_of(const OrderedJson& p) {
  const std::string name = "| " + p.at("scene").get<std::string>() +
                           format(" %d%s | ", p.at("n").get<int>(), with_of(p, " ").c_str());
  if (!is_whole(p)) return name + "| " + p.value("failed", "no result") + " | | | | | | | | | | | |\n";
  return name +
         format("%d | %.3g ms | %.2g | ", p.at("rows").get<int>(), 1e3 * number_in(p, "step_time_s"),
                number_in(p, "substeps_per_step")) +
         format("%.3g ms | %.3g ms | %.3g | %.3g | ", 1e3 * number_in(p, "factor_time_s"),
                1e3 * number_in(p, "bare_cholmod_time_s"), number_in(p, "factor_nonzeros"),
                number_in(p, "factor_flops")) +
         p.value("order", "") + format(" | %.0f %% | ", 100 * number_in(p, "share_of_dgemm")) +
         stage_shares(p.at("stage_times_per_substep_s")) +
         format(" | %.1e | %.1e | %.0f MB |\n",
                std::max(number_in(p, "max_joint_error_m"), number_in(p, "max_joint_angle_error_rad")),
                number_in(p, "energy_drift_rel"), number_in(p, "peak_memory_mb"));
}

/// What threads gain in the factor, of scenes where four would gain anything.
std::string thread_rows(const OrderedJson& profiles) {
  std::string rows;
  for (const OrderedJson& p : profiles) {
    if (!is_whole(p) || !p.contains("modelled_gain")) continue;
    const OrderedJson& gain = p.at("modelled_gain");
    if (!(number_in(gain, "4") > 1.05)) continue;
    const double measured = number_in(p, "gain_of_two_threads");
    rows += "| " + p.at("scene").get<std::string>() +
            format(" %d%s | ", p.at("n").get<int>(), with_of(p, " ").c_str()) +
            (std::isnan(measured) ? std::string("–") : format("%.2f", measured)) +
            format(" | %.2f | %.2f | %.2f | %.2f |\n", number_in(gain, "2"), number_in(gain, "4"),
                   number_in(gain, "16"), number_in(gain, "64"));
  }
  return rows;
}

constexpr const char* kChainMethods[] = {"rattle", "recursive", "recursive-midpoint", "lagrangian",
                                         "lagrangian-midpoint"};

/// "recursive is faster than lagrangian from 12 links on"
std::string crossing_text(const OrderedJson& methods, const std::string& slower, const std::string& faster) {
  Points first, second;
  for (const OrderedJson& p : methods) {
    if (p.contains("failed")) continue;
    const double n = number_in(p, "n"), a = number_in(p.at("method_step_times_s"), slower.c_str()),
                 b = number_in(p.at("method_step_times_s"), faster.c_str());
    if (!(a > 0 && b > 0)) continue;
    first.emplace_back(n, a);
    second.emplace_back(n, b);
  }
  const std::optional<double> at = crossing(first, second);
  return "* " + faster +
         (!at        ? " is not faster than " + slower + " at the last size"
          : *at == 0 ? " is faster than " + slower + " at all sizes"
                     : " is faster than " + slower + format(" from some %.0f links on", *at)) +
         '\n';
}

/// A step of a chain by each method, and from which size on which is faster.
std::string method_table(const OrderedJson& methods) {
  if (methods.empty()) return "";
  std::string text =
      "\n## Methods on a chain\n\nMedian processor time of a step of 1 ms of `chain`, n links on ball "
      "joints: "
      "in maximal coordinates (rattle,\norder 2), by the recursion of articulated bodies and by Lagrange's "
      "equations with a dense matrix (order 4, midpoint 2).\n\n| n |";
  for (const char* method : kChainMethods) text += std::string(" ") + method + " |";
  text += "\n|---|---|---|---|---|---|\n";
  for (const OrderedJson& p : methods) {
    text += format("| %d |", p.at("n").get<int>());
    for (const char* method : kChainMethods) {
      const double time = p.contains("failed") ? NAN : number_in(p.at("method_step_times_s"), method);
      text += std::isnan(time) ? std::string(" – |") : format(" %.3g ms |", 1e3 * time);
    }
    text += '\n';
  }
  return text + '\n' + crossing_text(methods, "lagrangian", "recursive") +
         crossing_text(methods, "lagrangian", "rattle") + crossing_text(methods, "recursive", "rattle") +
         crossing_text(methods, "recursive-midpoint", "rattle");
}

/// What grows, over the rows, of one family of scenes.
struct Growth {
  std::string family;
  Points time, fill, operations, memory;
};

std::vector<Growth> growth_of(const OrderedJson& profiles) {
  std::vector<Growth> all;
  for (const OrderedJson& p : profiles) {
    if (!is_whole(p)) continue;
    if (all.empty() || all.back().family != family_of(p)) all.push_back({family_of(p), {}, {}, {}, {}});
    Growth& growth = all.back();
    const double rows = number_in(p, "rows");
    growth.time.emplace_back(rows,
                             number_in(p, "step_time_s") / std::max(1.0, number_in(p, "substeps_per_step")));
    growth.fill.emplace_back(rows, number_in(p, "factor_nonzeros"));
    growth.operations.emplace_back(rows, number_in(p, "factor_flops"));
    growth.memory.emplace_back(rows, number_in(p, "peak_memory_mb"));
  }
  return all;
}

std::string cell(const Points& points) {
  const std::optional<double> exponent = growth_exponent(points);
  return exponent ? format(" %.2f |", *exponent) : std::string(" – |");
}

}  // namespace

std::optional<double> growth_exponent(const Points& points) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& [x, y] : points) {
    const double u = std::log(x), v = std::log(y);
    sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  const auto count = static_cast<double>(points.size());
  const double spread = count * sxx - sx * sx;
  if (points.size() < 2 || !(spread > 1e-12 * count * sxx)) return std::nullopt;
  return (count * sxy - sx * sy) / spread;
}

std::vector<int> method_sizes(bool quick) {
  return quick ? std::vector<int>{4, 32} : std::vector<int>{2, 4, 8, 16, 32, 64, 128, 256};
}

std::optional<double> crossing(const Points& first, const Points& second) {
  const auto over = [&](std::size_t i) { return std::log(first[i].second / second[i].second); };
  std::size_t above = std::min(first.size(), second.size());
  while (above > 0 && over(above - 1) > 0) --above;
  if (above == std::min(first.size(), second.size())) return std::nullopt;
  if (above == 0) return 0;
  const double before = over(above - 1), after = over(above), from = std::log(first[above - 1].first);
  return std::exp(from + (std::log(first[above].first) - from) * before / (before - after));
}

std::string work_tables(const BenchResults& results) {
  std::string text =
      "## Work of a step\n\nStep: median processor time of a step of 1 ms, from the start of the scene on; "
      "stages: "
      "shares of the sum of all.\nCHOLMOD: the faster of its two methods on the same matrix in the same "
      "order.  DGEMM "
      "is that of the BLAS as it takes this\nprocessor (see machine), so that a share may be above 100 %.\n\n"
      "| scene | rows | step | sub-steps | factorisation | bare CHOLMOD | L nonzeros | flops | order | share "
      "of "
      "DGEMM | forces, positions, assembly, factor, velocities [% of a sub-step] | joint error [m or rad] | "
      "drift | peak memory |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const OrderedJson& p : results.at("profiles")) text += row_of(p);
  text +=
      "\nExponents of growth over the rows:\n\n| scenes | time of a sub-step | L nonzeros | flops | peak "
      "memory |\n|---|---|---|---|---|\n";
  for (const Growth& growth : growth_of(results.at("profiles")))
    text += "| " + growth.family + " |" + cell(growth.time) + cell(growth.fill) + cell(growth.operations) +
            cell(growth.memory) + '\n';
  if (const std::string rows = thread_rows(results.at("profiles")); !rows.empty())
    text +=
        "\n## Threads\n\nTime of a factorisation by one thread over that by several: measured with two, "
        "where small ones are not\nshared, and modelled by the tree of fronts, each of them the work of one "
        "thread.\n\n"
        "| scene | two, measured | two | four | 16 | 64 |\n|---|---|---|---|---|---|\n" +
        rows;
  return text + method_table(results.value("methods", OrderedJson::array()));
}

}  // namespace taut
