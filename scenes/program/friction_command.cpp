#include "scenes/program/friction_command.h"

#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/check.h"
#include "scenes/files/friction_file.h"
#include "scenes/program/run_command.h"
#include "scenes/support/file_ending.h"
#include "scenes/support/format.h"
#include "scenes/support/output_file.h"
#include "scenes/support/printable.h"
#include "solvers/common/setting_names.h"
#include "solvers/friction/friction_solver.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

constexpr std::pair<const char*, FrictionStatus> kStatusNames[] = {
    {"solved", FrictionStatus::kSolved},
    {"no solution", FrictionStatus::kNoSolution},
    {"inexact", FrictionStatus::kInexact},
};

/// Of the row with the largest residual.
std::string row_name(const FrictionProblem& problem, int row) {
  if (row < 0) return "";
  if (row < problem.equalities) return "equality " + std::to_string(row);
  return "contact " + std::to_string((row - problem.equalities) / 3);
}

OrderedJson json_of(const std::string& name, const FrictionFile& file, const FrictionResult& result) {
  OrderedJson tried;
  for (std::size_t i = 0; i < result.tried.size(); ++i) tried[kFrictionRungNames[i]] = result.tried[i];
  return {{"file", printable(name)},
          {"form", file.form},
          {"dimension", file.dimension},
          {"contacts", file.problem.contacts()},
          {"equalities", file.problem.equalities},
          {"status", name_of(result.status, kStatusNames)},
          {"residual",
           {{"impulses", result.errors.impulses},
            {"rates", result.errors.rates},
            {"map", result.errors.map},
            {"round_off", result.errors.round_off},
            {"largest_at", row_name(file.problem, result.errors.worst_row)}}},
          {"largest_impulse", result.r.size() > 0 ? result.r.cwiseAbs().maxCoeff() : 0},
          {"rung", kFrictionRungNames[static_cast<int>(result.rung)]},
          {"tried", tried},
          {"factorisations", result.factorisations},
          {"sweeps", result.sweeps},
          {"seconds", result.seconds}};
}

/// A contact a line: normal, two tangents.
std::string impulses_text(const FrictionProblem& problem, const Eigen::VectorXd& r) {
  std::string text;
  for (int k = 0; k < problem.contacts(); ++k) {
    const auto at = r.segment<3>(problem.equalities + 3 * k);
    text += format("%.17g %.17g %.17g\n", at[0], at[1], at[2]);
  }
  return text;
}

std::string equalities_text(const FrictionProblem& problem, const Eigen::VectorXd& r) {
  std::string text;
  for (int i = 0; i < problem.equalities; ++i) text += format("%.17g\n", r[i]);
  return text;
}

std::string line_of(const std::string& name, const FrictionFile& file, const FrictionResult& result) {
  return format("%-44s %8d  %-11s  %9.1e  %9.1e  %-14s  %6d  %9.2f\n", printable(name).c_str(),
                file.problem.contacts(), name_of(result.status, kStatusNames), result.errors.impulses,
                std::max(result.errors.rates, result.errors.map),
                kFrictionRungNames[static_cast<int>(result.rung)], result.factorisations,
                1e3 * result.seconds);
}

std::string advice_for(const std::string& name, const FrictionFile& file, const FrictionResult& result) {
  const std::string at = row_name(file.problem, result.errors.worst_row);
  if (result.status == FrictionStatus::kNoSolution)
    return name +
           ": no impulses meet the laws: contacts close by their normals alone, whatever the impulses\n";
  if (result.status == FrictionStatus::kInexact)
    return name + ": the largest residual is that of " + at +
           "; if impulses are far above what q needs, bodies are jammed: a compliance (a larger diagonal of "
           "W) has "
           "a solution\n";
  return "";
}

/// Files of the same name in different folders would write one solution over the other.
void require_different_names(const std::vector<std::string>& files) {
  std::map<std::string, std::string> by_name;
  for (const std::string& file : files)
    if (const auto [at, added] = by_name.emplace(fs::path(file).filename().string(), file);
        !added && at->second != file)
      fail("--solution", "two files have the same name, so that one solution would replace the other", file);
}

bool write_friction_output(const std::string& file, const std::string& text) {
  const std::string error = write_output(file, text);
  if (!error.empty()) std::cerr << "taut friction: could not write " << error << '\n';
  return error.empty();
}

bool write_impulses(const fs::path& folder, const std::string& name, const FrictionProblem& problem,
                    const Eigen::VectorXd& r) {
  const fs::path stem = folder / fs::path(name).filename();
  bool good = write_friction_output(stem.string() + ".txt", impulses_text(problem, r));
  if (problem.equalities > 0)
    good = write_friction_output(stem.string() + ".equalities.txt", equalities_text(problem, r)) && good;
  return good;
}

/// A problem, or why there is none; alone that is the last word, of main().
std::optional<FrictionFile> readable_file(const std::string& name, bool alone, std::string& unread) {
  try {
    return read_friction_file(name);
  } catch (const std::exception& error) {
    unread = error.what();
    if (!alone) std::cerr << "taut: " << unread << '\n';
    return std::nullopt;
  }
}

/// Adds the result to the others, shows it as a line of a table if told to, and writes the impulses.
/// @returns whether it is solved, and written
bool solve_file(const FrictionOptions& options, const std::string& name, const FrictionFile& file, bool shown,
                OrderedJson& results) {
  const FrictionResult result = solve_friction(file.problem, {.accuracy = options.accuracy});
  if (results.empty() && shown)
    std::cout << format("%-44s %8s  %-11s  %9s  %9s  %-14s  %6s  %9s\n", "file", "contacts", "status",
                        "residual", "in rates", "rung", "factors", "ms");
  results.push_back(json_of(name, file, result));
  if (shown) std::cout << line_of(name, file, result) << std::flush;
  std::cerr << advice_for(printable(name), file, result);
  const bool solved = result.status == FrictionStatus::kSolved;
  if (options.solution_folder.empty()) return solved;
  fs::create_directories(options.solution_folder);
  return write_impulses(options.solution_folder, name, file.problem, result.r) && solved;
}

}  // namespace

int friction_command(const FrictionOptions& options) {
  require_positive("--accuracy", options.accuracy);
  const bool to_output = options.json && *options.json == "-";
  if (options.json && !to_output) {
    require_ending("--json", *options.json, FileKind::kJson);
    require_writable("--json", *options.json);
  }
  if (!options.solution_folder.empty()) {
    require_different_names(options.files);
    require_folder_name("--solution", options.solution_folder);
    require_writable_folder("--solution", options.solution_folder);
  }
  bool good = true;
  OrderedJson results = OrderedJson::array();
  std::string unread;
  for (const std::string& name : options.files) {
    const std::optional<FrictionFile> file = readable_file(name, options.files.size() == 1, unread);
    good = file && solve_file(options, name, *file, !to_output, results) && good;
  }
  if (results.empty())
    throw std::invalid_argument(options.files.size() > 1 ? "no file could be read" : unread);
  if (to_output) std::cout << results.dump(2) << '\n';
  if (options.json && !to_output) good = write_friction_output(*options.json, results.dump(2) + "\n") && good;
  return good ? kExitSuccess : kExitFailure;
}

}  // namespace taut
