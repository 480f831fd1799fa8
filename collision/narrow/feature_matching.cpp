#include "collision/narrow/feature_matching.h"

#include <algorithm>

namespace taut::detail {
namespace {

bool same_pair(const Contact& x, const Contact& y) { return x.a == y.a && x.b == y.b; }
bool pair_before(const Contact& x, const Contact& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; }

/// Contacts of one pair, before and now, and which of them have found their counterpart.
struct PairMatch {
  std::span<const Contact> before;
  std::span<Contact> now;
  std::vector<char>& taken;    // of `before`
  std::vector<char>& settled;  // of `now`
};

void settle_same_features(PairMatch& pair) {
  for (std::size_t i = 0; i < pair.now.size(); ++i)
    for (std::size_t k = 0; k < pair.before.size() && !pair.settled[i]; ++k)
      if (!pair.taken[k] && pair.before[k].feature == pair.now[i].feature)
        pair.taken[k] = pair.settled[i] = 1;
}

/// The nearest contact before, at most `near` away, that is not taken; before.size() if there is none.
std::size_t nearest_free(const PairMatch& pair, const Contact& contact, double near) {
  double best = near * near;
  std::size_t choice = pair.before.size();
  for (std::size_t k = 0; k < pair.before.size(); ++k) {
    const double distance = std::max((pair.before[k].p_AP - contact.p_AP).squaredNorm(),
                                     (pair.before[k].p_BQ - contact.p_BQ).squaredNorm());
    if (!pair.taken[k] && distance < best) best = distance, choice = k;
  }
  return choice;
}

void settle_near_ones(PairMatch& pair, double near) {
  for (std::size_t i = 0; i < pair.now.size(); ++i) {
    if (pair.settled[i]) continue;
    const std::size_t choice = nearest_free(pair, pair.now[i], near);
    if (choice == pair.before.size()) continue;
    pair.now[i].feature = pair.before[choice].feature;
    pair.taken[choice] = pair.settled[i] = 1;
  }
}

/// New ones must not use what others have.
void settle_new_ones(PairMatch& pair) {
  const auto used = [&](std::uint64_t feature) {
    for (std::size_t k = 0; k < pair.now.size(); ++k)
      if (pair.settled[k] && pair.now[k].feature == feature) return true;
    return false;
  };
  for (std::size_t i = 0; i < pair.now.size(); ++i) {
    if (pair.settled[i]) continue;
    while (used(pair.now[i].feature)) ++pair.now[i].feature;
    pair.settled[i] = 1;
  }
}

/// `taken` and `settled` are work space.
void match_pair(std::span<const Contact> before, std::span<Contact> now, double near,
                std::vector<char>& taken, std::vector<char>& settled) {
  taken.assign(before.size(), 0);
  settled.assign(now.size(), 0);
  PairMatch pair{before, now, taken, settled};
  settle_same_features(pair);
  settle_near_ones(pair, near);
  settle_new_ones(pair);
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
