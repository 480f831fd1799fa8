#include "scenes/pose_trace.h"

#include "core/check.h"
#include "scenes/recorder.h"

namespace taut {

PoseTrace::PoseTrace(const std::filesystem::path& file, double interval) : out_(file), interval_(interval) {
  if (!out_) fail("--poses", "cannot write the file", file.string());
  out_ << "time,body,px,py,pz,qw,qx,qy,qz\n";
}

void PoseTrace::record(const World& world) {
  if (world.time() < next_ - 5e-7) return;
  next_ += interval_;
  for (int i = 0; i < world.body_count(); ++i) {
    const BodyId body{i};
    if (world.is_fixed(body)) continue;
    const Pose& pose = world.pose(body);
    out_ << shortest(world.time()) << ',' << csv_field(world.name(body));
    for (double value : {pose.p.x(), pose.p.y(), pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()})
      out_ << ',' << shortest(value);
    out_ << '\n';
  }
}

}  // namespace taut
