#include "core/state/relocation.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace taut {

Relocation Relocation::after(const Relocation& first) const {
  Relocation all{shifted(first.ground),
                 bodies + first.bodies,
                 joints + first.joints,
                 axes + first.axes,
                 shapes + first.shapes,
                 forces + first.forces,
                 carriers,
                 sides};
  if (first.carriers) all.carry(*this, first);
  return all;
}

void Relocation::carry(const Relocation& second, const Relocation& first) {
  assert(first.bodies == 0 && first.ground == kGround && first.sides.empty());
  auto all = std::make_shared<Carriers>();
  int last = ground.index;
  for (int b = 0; b < static_cast<int>(first.carriers->bodies.size()); ++b)
    last = std::max(last, shifted({b}).index);
  // Of an id as the second has shifted it.
  for (int b = 0; b <= last; ++b) {
    all->bodies.push_back(second.carriers ? second.carriers->bodies[b] : BodyId{b});
    all->frames.push_back(second.carriers ? second.carriers->frames[b] : Pose{});
  }
  for (int b = 0; b < static_cast<int>(first.carriers->bodies.size()); ++b)
    all->frames[second.shifted({b}).index] = second.frame({b}) * first.carriers->frames[b];
  carriers = std::move(all);
}

}  // namespace taut
