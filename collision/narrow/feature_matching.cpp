#include "collision/narrow/feature_matching.h"

#include <algorithm>

namespace taut::detail {
namespace {

bool same_pair(const Contact& x, const Contact& y) { return x.a == y.a && x.b == y.b; }
bool pair_before(const Contact& x, const Contact& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; }

/// One pair.  `taken` and `settled` are work space.
void match_pair(std::span<const Contact> before, std::span<Contact> now, double near,
                std::vector<char>& taken, std::vector<char>& settled) {
  taken.assign(before.size(), 0);
  settled.assign(now.size(), 0);
  for (std::size_t i = 0; i < now.size(); ++i)
    for (std::size_t k = 0; k < before.size() && !settled[i]; ++k)
      if (!taken[k] && before[k].feature == now[i].feature) taken[k] = settled[i] = 1;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (settled[i]) continue;
    double best = near * near;
    std::size_t choice = before.size();
    for (std::size_t k = 0; k < before.size(); ++k) {
      const double distance = std::max((before[k].p_AP - now[i].p_AP).squaredNorm(),
                                       (before[k].p_BQ - now[i].p_BQ).squaredNorm());
      if (!taken[k] && distance < best) best = distance, choice = k;
    }
    if (choice == before.size()) continue;
    now[i].feature = before[choice].feature;
    taken[choice] = settled[i] = 1;
  }
  // New ones must not use what others have.
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (settled[i]) continue;
    const auto used = [&](std::uint64_t feature) {
      for (std::size_t k = 0; k < now.size(); ++k)
        if (settled[k] && now[k].feature == feature) return true;
      return false;
    };
    while (used(now[i].feature)) ++now[i].feature;
    settled[i] = 1;
  }
  std::sort(now.begin(), now.end(), [](const Contact& x, const Contact& y) { return x.feature < y.feature; });
}

}  // namespace

void match_features(std::span<const Contact> before, std::span<Contact> now,
                    const std::function<double(const Contact&)>& near) {
  thread_local std::vector<char> taken, settled;
  std::size_t old = 0;
  for (std::size_t begin = 0; begin < now.size();) {
    std::size_t end = begin + 1;
    while (end < now.size() && same_pair(now[begin], now[end])) ++end;
    while (old < before.size() && pair_before(before[old], now[begin])) ++old;
    std::size_t old_end = old;
    while (old_end < before.size() && same_pair(before[old_end], now[begin])) ++old_end;
    match_pair(before.subspan(old, old_end - old), now.subspan(begin, end - begin), near(now[begin]), taken,
               settled);
    begin = end;
  }
}

}  // namespace taut::detail
