#include "scenes/export/page_contacts.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace taut {
namespace {

using Pair = std::pair<int, int>;

/// The contacts of each pair of bodies among those from `first` on.
std::map<Pair, std::vector<std::int64_t>> by_pair(const Words& bodies, std::size_t first) {
  std::map<Pair, std::vector<std::int64_t>> found;
  for (std::size_t c = first; 4 * c < bodies.size(); ++c) {
    const auto body = [&](std::size_t i) { return bodies[4 * c + i] | bodies[4 * c + i + 1] << 16; };
    found[{body(0), body(2)}].push_back(static_cast<std::int64_t>(c));
  }
  return found;
}

}  // namespace

void ContactColumns::add(const Frame& frame) {
  const auto before = by_pair(bodies_, previous_);
  previous_ = places_.size();
  counts_.push_back(static_cast<std::uint32_t>(frame.contacts.size()));
  std::map<Pair, std::size_t> used;
  for (const ContactSample& contact : frame.contacts) {
    const Pair pair{contact.a.index, contact.b.index};
    const auto found = before.find(pair);
    const std::size_t number = used[pair]++;
    const bool has_one = found != before.end() && number < found->second.size();
    predecessors_.push_back(has_one ? found->second[number] : -1);
    for (const int body : {pair.first, pair.second})
      for (const int shift : {0, 16}) bodies_.push_back(static_cast<std::uint16_t>(body >> shift));
    places_.push_back(contact.position);
    forces_.add(contact.force);
  }
}

Words ContactColumns::place_words(const Vec3& low, const Vec3& step) const {
  Words words;
  words.reserve(3 * places_.size());
  for (const Vec3& place : places_)
    for (int i = 0; i < 3; ++i) {
      const double steps = step[i] > 0 ? (place[i] - low[i]) / step[i] : 0;
      words.push_back(static_cast<std::uint16_t>(std::lround(std::clamp(steps, 0.0, 65535.0))));
    }
  return words;
}

Words ContactColumns::rest(const Words& words) const {
  Words rest(words);
  for (std::size_t c = 0; c < predecessors_.size(); ++c)
    for (std::size_t i = 0; i < 3 && predecessors_[c] >= 0; ++i)
      rest[3 * c + i] = static_cast<std::uint16_t>(words[3 * c + i] -
                                                   words[3 * static_cast<std::size_t>(predecessors_[c]) + i]);
  return rest;
}

void ContactColumns::write(ColumnWriter& columns) const {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  for (std::size_t c = 0; c < places_.size(); ++c) {
    low = c == 0 ? places_[c] : Vec3(low.cwiseMin(places_[c]));
    high = c == 0 ? places_[c] : Vec3(high.cwiseMax(places_[c]));
  }
  const Vec3 step = (high - low) / 65535;
  columns.plain("contact_count", counts_);
  columns.plain("contact_low", std::vector<double>(low.begin(), low.end()));
  columns.plain("contact_step", std::vector<double>(step.begin(), step.end()));
  columns.predicted("contact_bodies", bodies_, 4, 1);
  columns.predicted("contact_place", rest(place_words(low, step)), 3, 0);
  columns.predicted("contact_force", rest(forces_.words()), 3, 0);
  columns.scale("contact_force", forces_.largest());
}

}  // namespace taut
