#include "core/world/force_laws.h"

#include <utility>

#include "core/world/id_check.h"

namespace taut::detail {

bool has_rows(const Force& law) {
  const LineSpring* spring = law.spring();
  return spring && spring->a != spring->b;
}

bool has_same_rows(const Force& one, const Force& other) {
  if (!has_rows(one) || !has_rows(other)) return false;
  const LineSpring &a = *one.spring(), &b = *other.spring();
  return a.a == b.a && a.b == b.b && a.p_AP == b.p_AP && a.p_BQ == b.p_BQ &&
         a.is_centred() == b.is_centred() && a.is_damped() == b.is_damped();
}

int ForceLaws::checked(ForceId id) const { return index_of(id, laws_.size(), "force"); }

void ForceLaws::classify(int index) {
  const Force& law = *laws_[index];
  const bool spring = has_rows(law);
  const Traits its{law.depends_on_velocity(), !law.conservative()};
  if (spring) springs_.push_back({index});
  for (Traits* traits : {&all_, &without_springs_}) {
    if (traits == &without_springs_ && spring) continue;
    traits->velocity = traits->velocity || its.velocity;
    traits->dissipative = traits->dissipative || its.dissipative;
  }
}

void ForceLaws::add(Law law) {
  laws_.push_back(std::move(law));
  classify(count() - 1);
}

void ForceLaws::set(int index, Law law) {
  laws_[index] = std::move(law);
  springs_.clear();
  all_ = without_springs_ = {};
  for (int f = 0; f < count(); ++f) classify(f);
}

void ForceLaws::replace(std::vector<Law> laws, const ForceLaws& like) {
  laws_ = std::move(laws);
  springs_.clear();
  for (int f = 0; f < count(); ++f)
    if (has_rows(*laws_[f])) springs_.push_back({f});
  all_ = like.all_, without_springs_ = like.without_springs_;
  if (like.passing_) all_.dissipative = without_springs_.dissipative = true;
  passing_ = nullptr;
}

std::vector<ForceLaws::Law> ForceLaws::acting() const {
  std::vector<Law> laws = laws_;
  if (passing_) laws.push_back(passing_);
  return laws;
}

void ForceLaws::accumulate(const State& state, std::span<Wrench> wrenches, Springs springs) const {
  for (const Law& law : laws_)
    if (springs == Springs::kIncluded || !has_rows(*law)) law->accumulate(state, wrenches);
  if (passing_) passing_->accumulate(state, wrenches);
}

double ForceLaws::accumulate_dissipative(const State& state, std::span<Wrench> wrenches,
                                         Springs springs) const {
  double energy = 0;
  for (const Law& law : laws_) {
    if (law->conservative() || (springs == Springs::kLeftOut && has_rows(*law))) continue;
    law->accumulate(state, wrenches);
    energy += law->potential_energy(state);
  }
  if (passing_) passing_->accumulate(state, wrenches);
  return energy;
}

double ForceLaws::spring_energy(const State& state) const {
  double energy = 0;
  for (const Law& law : laws_)
    if (law->spring()) energy += law->potential_energy(state);
  return energy;
}

}  // namespace taut::detail
