#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "tests/fuzz/world.h"

namespace taut::fuzz {
namespace {

std::string text(const char* format, auto... values) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

/// What is told of a set of worlds.
struct Sums {
  long worlds = 0, done = 0, refused = 0, cut = 0, not_converged = 0, contradictions = 0, other = 0;
  long steps = 0, inexact = 0, inexact_worlds = 0, newton = 0, most_newton = 0, gains = 0;
  double residual = 0, gain = -1, normal_gain = -1, penetration = 0, gap = 0, seconds = 0;

  void add(const WorldRecord& r) {
    ++worlds;
    if (r.end == "refused") {
      ++refused;
      return;
    }
    if (r.end == "done")
      ++done;
    else if (r.end == "cut")
      ++cut;
    else if (r.end == "contradiction" && r.named)
      ++contradictions;
    else if (r.end == "not converged" || r.end == "contradiction")
      ++not_converged;
    else
      ++other;
    steps += r.steps, inexact += r.inexact, inexact_worlds += r.inexact > 0;
    newton += r.newton, most_newton = std::max(most_newton, r.most_newton);
    gains += r.gain > kGain;
    residual = std::max(residual, r.residual);
    gain = std::max(gain, r.gain), normal_gain = std::max(normal_gain, r.normal_gain);
    penetration = std::max(penetration, r.penetration), gap = std::max(gap, r.gap);
    seconds += r.seconds;
  }
  static constexpr double kGain = 1e-8;  ///< as laws are met

  std::string row(const std::string& kind) const {
    const double all = static_cast<double>(std::max(1L, steps));
    return text(
        "| %s | %ld | %ld | %ld | %ld | %ld | %ld | %ld | %ld | %.1e | %.1e | %.1f, %ld | %ld | %.1e | %.1e "
        "| %.1e | %.1e | %.0f |\n",
        kind.c_str(), worlds, refused, done, cut, contradictions, not_converged, other, steps,
        static_cast<double>(inexact) / all, residual, static_cast<double>(newton) / all, most_newton, gains,
        gain, normal_gain, penetration, gap, seconds);
  }
};

/// How far a record is from what is asked of all; 0 if it is not.
double badness(const WorldRecord& r) {
  if (r.end == "refused") return 0;
  if (r.end != "done" && r.end != "cut" && !(r.end == "contradiction" && r.named)) return 1e6;
  double bad = 0;
  if (r.gain > Sums::kGain) bad = 1e3 * std::max(r.gain, 1e-6);
  if (r.inexact > 0) bad = std::max(bad, 1e-3 * r.inexact);
  if (r.end == "cut") bad = std::max(bad, 1e-4);
  return bad;
}

}  // namespace

std::string csv_header() {
  return "seed,kind,planned,steps,end,named,inexact,residual,natural_residual,newton,most_newton,gain,gain_"
         "time,"
         "normal_gain,penetration,gap,seconds,remark";
}

std::string csv_line(const WorldRecord& r) {
  std::string remark = r.remark;
  std::replace(remark.begin(), remark.end(), ',', ';');
  std::replace(remark.begin(), remark.end(), '\n', ' ');
  return text("%llu,%d,%d,%d,%s,%d,%d,%.3e,%.3e,%ld,%ld,%.3e,%.6g,%.3e,%.3e,%.3e,%.3f,",
              static_cast<unsigned long long>(r.seed), r.kind, r.planned, r.steps, r.end.c_str(),
              int(r.named), r.inexact, r.residual, r.natural_residual, r.newton, r.most_newton, r.gain,
              r.gain_time, r.normal_gain, r.penetration, r.gap, r.seconds) +
         remark;
}

WorldRecord parse_csv_line(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> fields;
  constexpr std::size_t kFields = 18;
  for (std::string field; fields.size() + 1 < kFields && std::getline(in, field, ',');)
    fields.push_back(field);
  std::string remark;
  std::getline(in, remark);
  if (fields.size() + 1 != kFields) throw std::runtime_error("no record of a world: " + line);
  WorldRecord r;
  std::size_t at = 0;
  const auto number = [&] { return std::stod(fields[at++]); };
  r.seed = std::stoull(fields[at++]);
  r.kind = std::stoi(fields[at++]), r.planned = std::stoi(fields[at++]), r.steps = std::stoi(fields[at++]);
  r.end = fields[at++];
  r.named = fields[at++] == "1";
  r.inexact = std::stoi(fields[at++]);
  r.residual = number(), r.natural_residual = number();
  r.newton = std::stol(fields[at++]), r.most_newton = std::stol(fields[at++]);
  r.gain = number(), r.gain_time = number(), r.normal_gain = number();
  r.penetration = number(), r.gap = number(), r.seconds = number();
  r.remark = remark;
  return r;
}

std::string campaign_table(const std::vector<WorldRecord>& records) {
  Sums all, by_kind[std::size(kWorldKinds)];
  for (const WorldRecord& r : records) all.add(r), by_kind[r.kind].add(r);
  std::string table =
      "| kind | worlds | refused | a second | cut | contradictions | not converged | other | steps | "
      "inexact, of all | residual | "
      "Newton a step, most | worlds with gain | largest gain | of normal impulses | penetration | joint "
      "error | s |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (std::size_t k = 0; k < std::size(kWorldKinds); ++k) table += by_kind[k].row(kWorldKinds[k]);
  return table + all.row("all");
}

std::string campaign_finds(const std::vector<WorldRecord>& records) {
  std::vector<WorldRecord> bad;
  for (const WorldRecord& r : records)
    if (badness(r) > 0) bad.push_back(r);
  std::stable_sort(bad.begin(), bad.end(),
                   [](const WorldRecord& a, const WorldRecord& b) { return badness(a) > badness(b); });
  std::string list;
  for (const WorldRecord& r : bad)
    list += text("seed %llu (%s): %s after %d of %d steps; inexact %d, %.1e; gain %.1e at %.4g s; Newton %ld",
                 static_cast<unsigned long long>(r.seed), kWorldKinds[r.kind], r.end.c_str(), r.steps,
                 r.planned, r.inexact, r.residual, r.gain, r.gain_time, r.most_newton) +
            (r.remark.empty() ? "" : "; " + r.remark) + "\n";
  return list;
}

}  // namespace taut::fuzz
