#include "scenes/export/pose_trace.h"

#include "core/base/check.h"
#include "scenes/recording/recorder.h"

namespace taut {

PoseTrace::PoseTrace(const std::string& file, double interval)
    : out_(file, OutputFile::Way::kStreamed), interval_(interval) {
  if (!out_.error().empty()) fail("--poses", "cannot write the file", out_.error());
  out_.out() << "time,body,px,py,pz,qw,qx,qy,qz\n";
}

void PoseTrace::record(const World& world) {
  std::ostream& out = out_.out();
  if (world.time() < next_ - 5e-7) return;
  next_ += interval_;
  for (int i = 0; i < world.body_count(); ++i) {
    const BodyId body{i};
    if (world.is_fixed(body)) continue;
    const Pose& pose = world.pose(body);
    out << shortest(world.time()) << ',' << csv_field(world.name(body));
    for (double value : {pose.p.x(), pose.p.y(), pose.p.z(), pose.q.w(), pose.q.x(), pose.q.y(), pose.q.z()})
      out << ',' << shortest(value);
    out << '\n';
  }
}

}  // namespace taut
