#include "solvers/simulator/stepper.h"

#include "core/state/same_state.h"
#include "solvers/common/setting_checks.h"
#include "solvers/integrators/force_level.h"
#include "solvers/integrators/moreau_jean.h"
#include "solvers/integrators/rattle.h"
#include "solvers/integrators/reduced/reduced_coordinates.h"

namespace taut {

Stepper::Stepper(const World& world, const World& named, const Settings& settings)
    : world_(world),
      named_(named),
      settings_(settings),
      springs_(settings.integrator == Integrator::kRattle || settings.integrator == Integrator::kMoreauJean
                   ? Springs::kIncluded
                   : Springs::kLeftOut),
      threads_(settings.threads) {}

bool Stepper::knows_topology() const {
  return made() && topology_version_ == world_.topology_version() &&
         geometry_version_ == world_.geometry_version();
}

bool Stepper::knows_pattern() const { return knows_topology() && sleep_version_ == world_.sleep_version(); }

void Stepper::renew() {
  auto system = std::make_unique<ConstraintSystem>(
      world_, settings_.factor, RankTuning::kStepping, Rows::AxisRows::kIncluded, springs_,
      FactorMeans{
          .orders = settings_.solver == Solver::kDirect ? &orders_ : nullptr,  // others factor nothing
          .threads = &threads_});
  scheme_.reset();
  system_ = std::move(system);
  scheme_ = make_scheme();
  topology_version_ = world_.topology_version();
  geometry_version_ = world_.geometry_version();
  sleep_version_ = world_.sleep_version();
  state_version_ = -1;
}

/// The only place that knows which one it is.
std::unique_ptr<Scheme> Stepper::make_scheme() {
  if (is_force_level(settings_.integrator)) return std::make_unique<ForceLevel>(world_, *system_, settings_);
  if (is_reduced(settings_.integrator))
    return std::make_unique<ReducedCoordinates>(world_, *system_, settings_);
  std::unique_ptr<ImpulseScheme> scheme;
  if (settings_.integrator == Integrator::kMoreauJean)
    scheme = std::make_unique<MoreauJean>(world_, *system_, settings_);
  else
    scheme = std::make_unique<Rattle>(world_, *system_, settings_);
  scheme->stages().culprits().name_by(named_);
  return scheme;
}

Stepper::Predecessor Stepper::renew_from_known() {
  Predecessor old;
  if (remembers()) {
    scheme_->forget(moved_bodies());
    old = {std::move(system_), std::move(scheme_)};
  }
  renew();
  return old;
}

bool Stepper::goes_on_with_new_forces() {
  if (retaken_ || !same(world_.state(), scheme_->state()) || !scheme_->renew_forces()) return false;
  note_state();
  return true;
}

void Stepper::forget_step() {
  state_version_ = -1;
  if (made() && scheme_->breaking().any()) topology_version_ = -1;
}

void Stepper::retake(bool done) {
  retaken_ = done;
  forget_step();
}

void Stepper::forget_all() {
  state_version_ = topology_version_ = -1;
  retaken_ = false;
}

bool Stepper::is_moved(int body) const {
  const State &now = world_.state(), &then = state();
  return !same(now.poses[body], then.poses[body]) || !same(now.twists[body], then.twists[body]);
}

std::vector<char> Stepper::moved_bodies() const {
  std::vector<char> moved(world_.body_count(), false);
  if (retaken_) return moved;
  for (int b = 0; b < std::ssize(scheme_->state().poses); ++b)
    moved[b] = !world_.is_asleep({b}) && is_moved(b);
  return moved;
}

std::span<const ContactCache::Slot> Stepper::slots() const {
  if (!made() || scheme_->contacts().empty()) return {};
  return scheme_->contacts().cache().slots();
}

std::vector<ContactReport> Stepper::mean_contacts(double dt) const {
  std::vector<ContactReport> reports = scheme_->contacts().reports();
  for (ContactReport& report : reports) {
    report.force /= dt;
    report.torque /= dt;
    report.normal_force /= dt;
  }
  return reports;
}

}  // namespace taut
