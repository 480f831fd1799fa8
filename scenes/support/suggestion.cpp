#include "scenes/support/suggestion.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace taut {
namespace {

/// Longer names are not compared: the distance takes the product of both lengths.
constexpr std::size_t kLongestGuess = 64;
/// Of a folder: more files are not compared.
constexpr std::size_t kMostFilesCompared = 1000;

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

/// Least number of slips between the two (optimal string alignment: no letter takes part in two of them).
std::size_t slips(std::string_view from, std::string_view to) {
  std::vector<std::size_t> before, last, row(to.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= from.size(); ++i) {
    before = std::move(last);
    last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (from[i - 1] != to[j - 1])});
      if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row.back();
}

/// Index of the nearest candidate; that of none if none is near.
std::size_t nearest_index(std::string_view given, const std::vector<std::string>& candidates) {
  // One slip in a short word, two in a longer one.
  std::size_t best = given.size() < 3 ? 1 : given.size() == 3 ? 2 : 3, index = candidates.size();
  if (given.size() > kLongestGuess) return index;
  const std::string lower = lower_case(given);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].size() > given.size() + 3) continue;
    const std::size_t distance = slips(lower, lower_case(candidates[i]));
    if (distance < best) best = distance, index = i;
  }
  return index;
}

}  // namespace

std::string did_you_mean(std::string_view given, const std::vector<std::string>& candidates) {
  const std::size_t i = nearest_index(given, candidates);
  return i < candidates.size() ? "; did you mean \"" + candidates[i] + "\"?" : "";
}

std::string did_you_mean_file(const std::filesystem::path& missing) {
  const std::filesystem::path folder = missing.parent_path();
  std::vector<std::string> names;
  std::error_code error;
  if (std::filesystem::exists(missing, error)) return "";
  std::filesystem::directory_iterator entry(folder.empty() ? "." : folder, error);
  for (; !error && entry != std::filesystem::directory_iterator() && names.size() < kMostFilesCompared;
       entry.increment(error))
    if (!entry->is_directory(error)) names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());  // a folder has no order
  const std::size_t i = nearest_index(missing.filename().string(), names);
  return i < names.size() ? "; did you mean \"" + (folder / names[i]).string() + "\"?" : "";
}

std::string quoted_list(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list.append(list.empty() ? "\"" : ", \"").append(name).append("\"");
  return list;
}

}  // namespace taut
