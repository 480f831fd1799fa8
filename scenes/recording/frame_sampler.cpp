#include "scenes/recording/frame_sampler.h"

#include "core/constraints/axis_parts.h"
#include "core/constraints/part_store.h"
#include "scenes/recording/drawn_shapes.h"

namespace taut {

std::vector<ForceId> line_forces(const World& world) {
  std::vector<ForceId> found;
  for (int f = 0; f < world.force_count(); ++f)
    if (world.force(ForceId{f}).line_force(world.state())) found.push_back({f});
  return found;
}

ContactSample contact_sample(const World& world, const Contact& contact, const Vec3& force) {
  const Vec3 p_WP = world.pose(contact.A).point(contact.p_AP),
             p_WQ = world.pose(contact.B).point(contact.p_BQ);
  return {contact.A, contact.B, (p_WP + p_WQ) / 2, contact.normal, force};
}

namespace {

void append_contacts(const Simulator& simulator, std::vector<ContactSample>& samples) {
  for (const ContactReport& report : simulator.contacts())
    if (!report.force.isZero(0))
      samples.push_back(contact_sample(simulator.world(), report.contact, report.force));
}

/// The axes of a joint that are fixed in a body; swings and turns of balls have no such direction.
std::vector<RecordedAxis> recorded_axes(const World& world, JointId joint) {
  std::vector<RecordedAxis> axes;
  for (int k = 0; k < world.axis_count(joint); ++k) {
    const AxisInfo& info = world.axis_info({joint, k});
    const auto add = [&](const auto* store, const auto& direction) {
      if (store == nullptr) return;
      const auto& [place, part] = store->items[0];
      axes.push_back({info.name, info.angular, {place.body_a}, direction(part)});
    };
    using row_parts::Angle, row_parts::Displacement;
    add(dynamic_cast<const detail::PartStore<Angle>*>(info.coordinate.get()),
        [](const Angle& part) { return part.a_A; });
    add(dynamic_cast<const detail::PartStore<Displacement>*>(info.coordinate.get()),
        [](const Displacement& part) { return part.a_A; });
  }
  return axes;
}

}  // namespace

FrameSampler::FrameSampler(const Scene& scene)
    : scene_(scene),
      springs_(line_forces(scene.world)),
      gaps_(scene.world),
      probes_(scene.probes),
      contacts_(append_contacts) {}

RecordingHeader FrameSampler::header(double frames_per_second) const {
  const World& world = scene_.world;
  RecordingHeader header;
  header.scene = scene_.name;
  header.parameters = scene_.parameters;
  header.parameter_units = scene_.parameter_units;
  header.dt = scene_.dt;
  header.frames_per_second = frames_per_second;
  header.gravity = world.gravity();
  for (int b = 0; b < world.body_count(); ++b) {
    const BodyId id{b};
    const double mass = id == kGround ? 0 : world.mass_properties(id).mass();
    header.bodies.push_back({world.name(id), mass, world.is_fixed(id)});
  }
  for (int j = 0; j < world.joint_count(); ++j) {
    const JointId id{j};
    const Joint& joint = world.joint(id);
    header.joints.push_back({world.name(id), std::string(joint.type()), joint.a(), joint.b(),
                             joint.reaction_point_B(), joint.course(), recorded_axes(world, id)});
  }
  for (const ForceId id : springs_) {
    const auto line = world.force(id).line_force(world.state());
    header.springs.push_back({(line->elastic ? "spring_" : "damper_") + std::to_string(id.index),
                              line->elastic,
                              {line->a, line->p_AP},
                              {line->b, line->p_BQ}});
  }
  using Group = RecordedScalar::Group;
  header.scalars = {{"kinetic energy", "J", Group::kEnergy},
                    {"potential energy", "J", Group::kEnergy},
                    {"gap", "m", Group::kGap},
                    {"gap angle", "rad", Group::kGap}};
  auto column = probes_.columns().begin();
  for (const Probe& probe : probes_.probes())
    for (const std::string& unit : units(scene_.world, probe))
      header.scalars.push_back({*column++, unit, Group::kProbe});
  collect_shapes(scene_, header);
  return header;
}

Frame FrameSampler::sample(Simulator& simulator) {
  const World& world = simulator.world();
  const State& state = world.state();
  Frame frame;
  frame.time = world.time();
  frame.poses = state.poses;
  frame.twists = state.twists;

  const std::vector<Gap> gaps = gaps_.all(world);
  const bool has_stepped = simulator.report().dt > 0;
  for (int j = 0; j < world.joint_count(); ++j) {
    const JointId id{j};
    frame.joints.push_back(
        {has_stepped ? simulator.mean_reaction(id) : simulator.reaction(id), gaps[j], world.is_attached(id)});
  }
  if (contacts_) contacts_(simulator, frame.contacts);
  for (const ForceId id : springs_) {
    const auto line = world.force(id).line_force(state);
    frame.tensions.push_back(line ? line->tension : 0);  // 0: another law has taken its place
  }

  const Gap largest = gaps_.largest(world);
  frame.scalars = {kinetic_energy(world, state), world.potential_energy(state), largest.metres,
                   largest.radians};
  const std::vector<double>& values = probes_.sample(simulator);
  frame.scalars.insert(frame.scalars.end(), values.begin(), values.end());
  return frame;
}

}  // namespace taut
