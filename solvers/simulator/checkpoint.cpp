#include "solvers/simulator/checkpoint.h"

#include <cmath>
#include <istream>
#include <ostream>

#include "core/axes/axis.h"
#include "core/base/check.h"
#include "core/base/flush_to_zero.h"
#include "core/base/fnv1a.h"
#include "core/state/same_state.h"
#include "solvers/simulator/checkpoint_memory.h"
#include "solvers/simulator/simulator_impl.h"

namespace taut {
namespace {

/// What a checkpoint begins with: its format, and the properties of axes whose parts its reports have.
const std::string& mark() {
  static const std::string kMark = [] {
    std::string text = "taut-checkpoint/11";
    for_axis_types([&]<typename Property>() {
      if constexpr (PlainAxisProperty<Property>) text += std::string("+") + Property::kFacts.key;
    });
    return text + "\n";
  }();
  return kMark;
}
constexpr std::size_t kSumBytes = 8;

std::uint64_t checksum(std::string_view bytes) {
  Fnv1a sum;
  sum.add(bytes);
  return sum.value();
}

std::string number(std::uint64_t value) {
  std::string bytes(kSumBytes, '\0');
  for (std::size_t i = 0; i < kSumBytes; ++i) bytes[i] = static_cast<char>(value >> (8 * i));
  return bytes;
}

/// What a world consists of, but for values that may be changed while it is simulated.
std::uint64_t model_of(const World& world) {
  Archive archive;
  const auto text = [&](std::string_view part) {
    std::string copy(part);
    archive(copy);
  };
  for (int b = 0; b < world.body_count(); ++b) {
    text(world.name(BodyId{b}));
    bool fixed = world.is_fixed({b});
    archive(fixed);
  }
  for (int j = 0; j < world.joint_count(); ++j) {
    text(world.name(JointId{j})), text(world.joint({j}).type());
    for (BodyId body : world.joint({j}).bodies()) archive(body);
  }
  for (int s = 0; s < world.shape_count(); ++s) {
    BodyId body = world.shape({s}).body;
    std::size_t kind = world.shape({s}).shape->index();
    archive(body, kind);
  }
  int forces = world.force_count();
  archive(forces);
  return checksum(archive.bytes());
}

/// Settings that decide what is remembered.
struct Method {
  Integrator integrator;
  Solver solver;
  bool contacts, sleep, merge;

  explicit Method(const Settings& s)
      : integrator(s.integrator),
        solver(s.solver),
        contacts(s.contacts),
        sleep(s.sleep),
        merge(s.merge_fixed_joints) {}
  void transfer(Archive& archive) { archive(integrator, solver, contacts, sleep, merge); }
};

void require_same(const char* setting, bool same) {
  if (!same)
    throw std::invalid_argument(std::string("checkpoint: was made with another setting: ") + setting);
}

}  // namespace

Checkpoint Checkpoint::of_payload(const std::string& payload) {
  Checkpoint checkpoint;
  checkpoint.bytes_ = mark() + payload + number(checksum(payload));
  return checkpoint;
}

std::string Checkpoint::payload() const {
  if (empty()) fail("checkpoint", "is empty", 0);
  return bytes_.substr(mark().size(), bytes_.size() - mark().size() - kSumBytes);
}

Checkpoint Checkpoint::from_bytes(std::string bytes) {
  if (!bytes.starts_with(mark())) fail("checkpoint", "does not begin as one of this version", bytes.size());
  Checkpoint checkpoint;
  checkpoint.bytes_ = std::move(bytes);
  const bool whole = checkpoint.bytes_.size() >= mark().size() + kSumBytes &&
                     checkpoint.bytes_.ends_with(number(checksum(checkpoint.payload())));
  if (!whole) fail("checkpoint", "is damaged or cut short, after bytes", checkpoint.bytes_.size());
  return checkpoint;
}

std::ostream& operator<<(std::ostream& out, const Checkpoint& checkpoint) {
  return out << checkpoint.bytes().size() << '\n' << checkpoint.bytes();
}

std::istream& operator>>(std::istream& in, Checkpoint& checkpoint) {
  constexpr std::size_t kBlock = 1 << 16;  // no count is believed before the bytes are there
  std::uint64_t left = 0;
  if (!(in >> left) || in.get() != '\n') fail("checkpoint", "has no size in front", left);
  std::string bytes;
  while (left > 0 && in) {
    const std::size_t block = static_cast<std::size_t>(std::min<std::uint64_t>(left, kBlock)),
                      before = bytes.size();
    bytes.resize(before + block);
    in.read(bytes.data() + before, static_cast<std::streamsize>(block));
    bytes.resize(before + static_cast<std::size_t>(in.gcount()));
    left -= static_cast<std::uint64_t>(in.gcount());
  }
  checkpoint = Checkpoint::from_bytes(std::move(bytes));
  return in;
}

Checkpoint Simulator::checkpoint() {
  Impl& own = impl();
  if (own.since_events_ && PassingLoads::next(own.source_).empty() &&
      own.since_events_->versions == own.versions())
    return own.since_events_->checkpoint;
  return checkpoint_before({});
}

/// Of now, before these events happen: whoever restores it lets them happen.
Checkpoint Simulator::checkpoint_before(std::vector<DueEvent> due) {
  const detail::FlushToZero mode;
  Impl& own = impl();
  const World& world = own.source_;
  std::uint64_t model = model_of(world);
  Method method(own.settings_);
  bool has_events = own.events_.any();
  own.events_.note_settings(world);
  bool remembers = own.settle();
  State state = world.state();
  std::vector<BodyLoad> loads = PassingLoads::next(world);
  std::vector<char> attached, gone;  // gone with the last step, which the integrator has not seen yet
  for (int j = 0; j < world.joint_count(); ++j) attached.push_back(world.is_attached({j}));
  gone.assign(attached.size(), 0);
  if (remembers)
    for (const BreakEvent& event : own.stepper_.scheme().breaking().events()) gone[event.joint.index] = 1;
  const auto write = [&](Archive& archive) {
    archive(model, method, state, attached, gone, remembers);
    transfer_loads(archive, loads, world);
    archive(has_events);
    if (has_events) own.events_.transfer(archive, world), own.events_.transfer(archive, due);
    if (remembers) own.transfer(archive, {});
  };
  Archive archive;
  write(archive);
  if (archive.is_sound()) return Checkpoint::of_payload(archive.bytes());
  Archive bare;  // without memory, as after a step that failed
  remembers = false;
  write(bare);
  return Checkpoint::of_payload(bare.bytes());
}

void Simulator::restore(const Checkpoint& checkpoint) {
  const detail::FlushToZero mode;
  const std::string payload = checkpoint.payload();
  Archive archive(payload);
  World& world = impl().source_;
  const Settings settings = impl_->settings_;
  std::uint64_t model = 0;
  Method method(settings);
  State state;
  std::vector<char> attached, gone;
  bool remembers = false;
  std::vector<BodyLoad> loads;
  archive(model, method, state, attached, gone, remembers);
  const Method own(settings);
  require_same("integrator", method.integrator == own.integrator);
  require_same("solver", method.solver == own.solver);
  require_same("contacts", method.contacts == own.contacts);
  require_same("sleep", method.sleep == own.sleep);
  require_same("merge_fixed_joints", method.merge == own.merge);
  Archive::require(model == model_of(world), "it is of another world");
  Archive::require(std::ssize(attached) == world.joint_count() && gone.size() == attached.size(),
                   "it has other joints");
  transfer_loads(archive, loads, world);
  bool has_events = false;
  archive(has_events);
  Archive::require(has_events == impl_->events_.any(), "it is of a run with other events");
  EventSchedule events = impl_->events_, events_before = impl_->events_;
  events_before.note_settings(world);
  std::vector<DueEvent> due;
  if (has_events) events.transfer(archive, world), events.transfer(archive, due);

  const State before = world.state();
  std::vector<char> attached_before;
  for (int j = 0; j < world.joint_count(); ++j) attached_before.push_back(world.is_attached({j}));
  const auto attach = [&](std::span<const char> wanted) {
    for (int j = world.joint_count() - 1; j >= 0; --j)
      if (!wanted[j]) world.detach({j});
    for (int j = 0; j < world.joint_count(); ++j)
      if (wanted[j]) world.attach({j});
  };
  std::vector<char> with_gone = attached;
  for (std::size_t j = 0; j < gone.size(); ++j) with_gone[j] = attached[j] || gone[j];
  try {
    world.set_state(state);
    attach(with_gone);
    events.apply(world);
    auto fresh = std::make_unique<Impl>(world, settings);
    fresh->hooks_ = impl_->hooks_;
    fresh->events_ = std::move(events);
    if (remembers) {
      fresh->transfer(archive, gone);
      Archive::require(archive.at_end());
    }
    impl_ = std::move(fresh);
    PassingLoads::set_next(world, std::move(loads));
    if (!due.empty()) {
      (void)impl_->events_.let_happen(impl_->source_, due);
      impl_->since_events_ = {checkpoint, impl_->versions()};
    }
  } catch (...) {
    events_before.apply(world);
    attach(attached_before);
    world.set_state(before);
    world.wake_all();
    throw;
  }
}

/// Brings what the integrator knows to the present world, as the next step would.  False if it knows nothing
/// that is worth keeping: before the first step, and after one that failed.
bool Simulator::Impl::settle() {
  welds_.solve_means_of_old_source(stepper_, report_.dt);
  if (!stepper_.has_state() || !stepper_.is_started() || !report_.ok() || report_.dt == 0) return false;
  const bool unchanged = recalled_.empty() && end_versions_ == versions();
  if (unchanged) return true;
  StepReport kept = report_;
  bring_up_to_date(horizon_);
  bodies_.publish();
  const bool good = report_.ok();
  report_ = std::move(kept);
  end_versions_ = versions();
  return good;
}

/// `gone`, when reading: joints that left with the last step, by joint.
void Simulator::Impl::transfer(Archive& archive, std::span<const char> gone) {
  substepping_.division().transfer(archive, settings_.max_substeps);
  archive(horizon_, report_.dt, report_.time);
  Archive::require(horizon_ >= 0 && std::isfinite(horizon_) && report_.dt > 0 &&
                   std::isfinite(report_.dt + report_.time));
  State state = world_.state();
  archive(state);
  if (archive.reads()) world_.set_state(state);
  sleep_.transfer(archive, world_);
  sleeping_.transfer(archive);
  if (archive.reads()) {
    bodies_.give_sleep();
    stepper_.renew();
    note_renewed();
  }
  stepper_.transfer(archive);
  welds_.transfer(archive);
  if (archive.reads()) {
    bodies_.note_restored();
    for (int j = 0; j < std::ssize(gone); ++j)
      if (gone[j]) world_.detach({j}), source_.detach({j});
    stepper_.note_state();
    if (same(world_.state(), stepper_.state())) stepper_.note_left();
    bodies_.note_published();
    end_versions_ = versions();
  }
  accounting_.transfer(archive, world_);
}

Simulator::Impl::Versions Simulator::Impl::versions() const {
  return {source_.topology_version(), source_.state_version(),   source_.geometry_version(),
          source_.sleep_version(),    world_.topology_version(), world_.state_version()};
}

}  // namespace taut
