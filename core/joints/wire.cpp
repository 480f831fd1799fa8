#include "core/joints/wire.h"

#include <algorithm>
#include <memory>

#include "core/base/check.h"

namespace taut::detail {

row_parts::Coupling wire_length(const std::string& name, const std::vector<WirePoint>& points,
                                const std::vector<double>& weights, std::span<const BodyId> bodies) {
  row_parts::Coupling length;
  const auto side = [&](BodyId body) {
    return static_cast<int>(std::find(bodies.begin(), bodies.end(), body) - bodies.begin());
  };
  for (std::size_t i = 0; i < points.size(); ++i)
    require_all_finite(name + " point " + std::to_string(i + 1), points[i].p_BP);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    auto section = std::make_shared<PartStore<row_parts::Length>>();
    const WirePoint &P = points[i], &Q = points[i + 1];
    section->items.push_back({{P.body.index, Q.body.index, 0, 0, 6}, {P.p_BP, Q.p_BP}});
    if (P.body == Q.body) {
      length.offset -= weights[i] * (Q.p_BP - P.p_BP).norm();
      continue;
    }
    length.terms.push_back({weights[i], std::move(section), {side(P.body), side(Q.body)}});
  }
  return length;
}

std::vector<BodyId> wire_bodies(const std::string& name, const std::vector<WirePoint>& points) {
  if (points.size() < 2) fail(name, "must have two points or more", points.size());
  std::vector<BodyId> bodies{points.front().body};
  const auto add = [&](BodyId body) {
    if (std::find(bodies.begin(), bodies.end(), body) == bodies.end()) bodies.push_back(body);
  };
  add(points.back().body);
  for (const WirePoint& p : points) add(p.body);
  if (bodies.size() < 2) fail(name, "must join two bodies", bodies.size());
  return bodies;
}

}  // namespace taut::detail
