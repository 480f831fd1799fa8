#include "scenes/program/run_summary.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <utility>

#include "scenes/recording/recorder.h"
#include "scenes/support/format.h"
#include "solvers/common/report_names.h"

namespace taut {
namespace {

/// Names in a list before "and n more".
constexpr std::size_t kNamed = 3;
/// Lines of events before "and n more".
constexpr std::size_t kEventLines = 20;
/// Works below this share of the scale are not worth a name.
constexpr double kWorthNaming = 1e-3;

std::string scene_text(const RunRecord& r) {
  std::string text = r.scene;
  for (const auto& [key, value] : r.parameters) text += " " + key + "=" + shortest(value);
  text += ": " + counted(r.bodies, "body", "bodies") + ", " + counted(r.joints, "joint") + " (" +
          counted(r.constraint_rows, "row") +
          format("), %.6g s in %lld", r.simulated_time, static_cast<long long>(r.steps));
  if (r.steps < r.steps_asked) text += format(" of %lld", static_cast<long long>(r.steps_asked));
  return text + format(" steps of %.4g s, ", r.dt) + r.integrator;
}

std::string speed_text(const RunRecord& r) {
  const double times = r.wall_time > 0 ? r.simulated_time / r.wall_time : 0;
  return format("%.3g s, %.3g times real time; median %.3g ms a step", r.wall_time, times,
                1e3 * r.median_step_time());
}

/// Axes that the predicate is true of, by label.
std::string axes_text(const std::vector<RunRecord::AxisEvents>& axes, auto is_one) {
  std::vector<std::string> names;
  for (const RunRecord::AxisEvents& axis : axes)
    if (is_one(axis)) names.push_back(axis.label);
  return first_of(names, kNamed, [](const std::string& name) { return name; });
}

void add_axes(std::vector<std::string>& parts, const std::string& what,
              const std::vector<RunRecord::AxisEvents>& axes, std::int64_t RunRecord::AxisEvents::*steps,
              bool RunRecord::AxisEvents::*now) {
  const std::string at_end = axes_text(axes, [&](const auto& axis) { return axis.*now; });
  const std::string before =
      axes_text(axes, [&](const auto& axis) { return axis.*steps > 0 && !(axis.*now); });
  if (!at_end.empty()) parts.push_back(what + " at the end: " + at_end);
  if (!before.empty()) parts.push_back(what + " before: " + before);
}

std::string inexact_text(const RunRecord& r) {
  std::string text =
      format("%lld of %lld steps inexact, at most %.1e", static_cast<long long>(r.inexact_steps),
             static_cast<long long>(r.steps), r.max_complementarity_residual);
  if (r.worst.culprits.empty()) return text + format(" at t = %.4g s", r.worst.time);
  return text + format(" at t = %.4g s: ", r.worst.time) +
         first_of(r.worst.culprits, kNamed, [](const std::string& name) { return name; });
}

std::string events_text(const RunRecord& r) {
  using Events = RunRecord::AxisEvents;
  std::vector<std::string> parts;
  add_axes(parts, "at limits", r.axes, &Events::limit_steps, &Events::at_limit);
  add_axes(parts, "motors saturated", r.axes, &Events::saturated_steps, &Events::saturated);
  if (!r.breaks.empty())
    parts.push_back("broken joints: " + first_of(r.breaks, kNamed, [](const RunRecord::Break& b) {
                      return b.joint + format(" at %.4g s", b.time);
                    }));
  if (r.inexact_steps > 0) parts.push_back(inexact_text(r));
  if (r.asleep > 0) parts.push_back(format("%d bodies asleep at the end", r.asleep));
  if (parts.empty()) return "no axis at a limit, no motor saturated, no joint broken, no step inexact";
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : "; ") + part;
  return text;
}

/// "; motors 12 J, friction -3 J": works that are worth a name, in the order of the ledger.
std::string works_text(const RunRecord& r) {
  std::string text;
  for (const LedgerTerm& term : kLedgerTerms)
    if (!term.stored && std::abs(r.ledger.*term.amount) > kWorthNaming * r.balance_scale())
      text +=
          (text.empty() ? "; " : ", ") + std::string(term.name) + format(" %.4g J", r.ledger.*term.amount);
  return text;
}

std::string energy_text(const RunRecord& r) {
  const std::string ends = format("%.6g J to %.6g J", r.initial_energy, r.final_energy);
  if (!r.has_works)
    return ends +
           format("; drift %.2e of %.6g J, works not known", r.relative_energy_drift(), r.energy_scale);
  return ends + works_text(r) +
         format("; not accounted for %.3g J (%.2e of %.6g J)", r.max_unexplained, r.relative_unexplained(),
                r.balance_scale());
}

std::string penetration_text(const RunRecord& r) {
  if (r.max_contacts == 0) return "no contacts";
  return format("at most %.2e m, at the end %.2e m, of at most %d contacts", r.max_penetration,
                r.final_penetration, r.max_contacts);
}

/// "hoist at 1.5 s: motor of winch length: target -0.5"
std::string event_text(const EventRecord& event) {
  return event.name + format(" at %.9g s", event.time) +
         (event.value ? format(" (%.6g)", *event.value) : "") + (event.what.empty() ? "" : ": " + event.what);
}

std::string page_beside(const std::string& file) {
  return std::filesystem::path(file).stem().string() + ".html";
}

/// The words of a command without what is written and printed, and without the live view.
std::vector<std::string> without_outputs(const RunOptions& options) {
  constexpr std::string_view kWithValue[] = {"--report", "--csv",  "--poses",       "--poses-interval",
                                             "--save",   "--gltf", "--plot",        "--vtk",
                                             "--record", "--html", "--dump-stages", "--live-address"};
  constexpr std::string_view kFlags[] = {"--quiet", "--verbose", "--live"};
  const std::vector<std::string>& words = options.words;
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    const std::string_view option = word.substr(0, word.find('='));
    if (std::find(std::begin(kFlags), std::end(kFlags), option) != std::end(kFlags)) {
      // The port may be left out.
      if (word == "--live" && i + 1 < words.size() && words[i + 1] == options.live.port) ++i;
      continue;
    }
    if (std::find(std::begin(kWithValue), std::end(kWithValue), option) == std::end(kWithValue))
      kept.push_back(words[i]);
    else if (option.size() == word.size())
      ++i;  // its value
  }
  return kept;
}

}  // namespace

std::string shell_word(const std::string& word) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_@%+=:,./-").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  std::string text = "'";
  for (char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

std::string run_summary(const RunRecord& r, const std::string& to_see) {
  std::vector<std::pair<std::string, std::string>> lines{
      {"scene", scene_text(r)},
      {"speed", speed_text(r)},
      {"joint error", format("at most %.2e m, %.2e rad", r.max_gap.metres, r.max_gap.radians)},
      {"what happened", events_text(r)},
      {"energy", energy_text(r)},
      {"penetration", penetration_text(r)},
      {"status", r.message.empty() ? r.status : r.status + ": " + r.message},
  };
  for (std::size_t i = 0; i < std::min(r.events.size(), kEventLines); ++i)
    lines.emplace_back("event", event_text(r.events[i]));
  if (r.events.size() > kEventLines)
    lines.emplace_back("event", format("… and %zu more, in --report", r.events.size() - kEventLines));
  if (!r.contradiction.empty())
    lines.emplace_back("cannot hold together",
                       list_of(r.contradiction) + format(" (%.3g is left)", r.contradiction_residual));
  for (const std::string& warning : r.warnings) lines.emplace_back("warning", warning);
  lines.emplace_back("to see it", to_see);
  std::string text;
  for (const auto& [name, value] : lines) text += format("%-13s  ", name.c_str()) + value + "\n";
  return text;
}

std::string how_to_see(const RunOptions& options) {
  if (!options.exports.html.empty()) return "open " + shell_word(options.exports.html) + " in a browser";
  if (!options.record_file.empty())
    return shell_word(options.program) + " replay " + shell_word(options.record_file) + " --html " +
           shell_word(page_beside(options.record_file));
  std::string command = shell_word(options.program) + " run";
  for (const std::string& word : without_outputs(options)) command += " " + shell_word(word);
  return command + " --html " + shell_word(page_beside(options.scene));
}

}  // namespace taut
