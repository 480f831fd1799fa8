#include "benchmarks/peers/mujoco_model.h"

#include <algorithm>
#include <sstream>

namespace taut::peers {
namespace {

std::string text(const Vec3& v) {
  std::ostringstream out;
  out.precision(17);
  out << v.x() << ' ' << v.y() << ' ' << v.z();
  return out.str();
}

std::string text(const Quat& q) {
  std::ostringstream out;
  out.precision(17);
  out << q.w() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z();
  return out.str();
}

std::string name_of(int body) { return std::string("b").append(std::to_string(body)); }

class Writer {
 public:
  Writer(const System& system, const Method& method) : system_(system), free_(method.get("free", 0) > 0) {
    children_.resize(system.body_count());
    for (const TreeEdge& edge : system.tree) children_[edge.parent].push_back(&edge);
    out_.precision(17);
  }

  std::string worldbody() {
    if (free_)
      for (int b = 1; b < system_.body_count(); ++b) {
        open(b, system_.pose(b));
        out_ << "<freejoint/></body>\n";
      }
    else
      for (const TreeEdge* edge : children_[0]) nested(*edge);
    return out_.str();
  }

  std::string equality() const {
    std::ostringstream out;
    for (std::size_t j = 0; j < system_.joints.size(); ++j) {
      const bool in_tree =
          std::find(system_.loops.begin(), system_.loops.end(), static_cast<int>(j)) == system_.loops.end();
      if (free_ || !in_tree) add_equality(out, system_.joints[j]);
    }
    return out.str();
  }

 private:
  void open(int body, const Pose& pose) {
    out_ << "<body name=\"" << name_of(body) << "\" pos=\"" << text(pose.p) << "\" quat=\"" << text(pose.q)
         << "\"><inertial pos=\"0 0 0\" mass=\"" << system_.mass(body) << "\" diaginertia=\""
         << text(system_.moments(body)) << "\"/>";
  }
  /// Bodies below an edge; chains are deep, so the open ones are kept in a list.
  void nested(const TreeEdge& first) {
    struct Open {
      const TreeEdge* edge;
      std::size_t next = 0;
    };
    std::vector<Open> stack;
    const auto enter = [&](const TreeEdge* edge) {
      const Pose &P = system_.pose(edge->parent), &C = system_.pose(edge->child);
      open(edge->child, {P.q.conjugate() * C.q, P.local(C.p)});
      add_joint(*edge);
      stack.push_back({edge});
    };
    enter(&first);
    while (!stack.empty()) {
      const auto& below = children_[stack.back().edge->child];
      if (stack.back().next < below.size()) {
        enter(below[stack.back().next++]);
      } else {
        out_ << "</body>\n";
        stack.pop_back();
      }
    }
  }
  void add_joint(const TreeEdge& edge) {
    const PeerJoint& joint = system_.joints[edge.joint];
    const Pose& C = system_.pose(edge.child);
    if (joint.kind == JointKind::kFixed) return;
    out_ << "<joint type=\"" << (joint.kind == JointKind::kBall ? "ball" : "hinge") << "\" pos=\""
         << text(C.local(joint.p_W)) << '"';
    if (joint.kind == JointKind::kHinge) out_ << " axis=\"" << text(C.q.conjugate() * joint.axis_W) << '"';
    out_ << "/>";
  }
  /// A hinge is two points on its axis.
  void add_equality(std::ostringstream& out, const PeerJoint& joint) const {
    const bool swap = joint.b == 0;
    const int one = swap ? joint.a : joint.b, two = swap ? joint.b : joint.a;
    const std::string bodies =
        " body1=\"" + name_of(one) + '"' + (two == 0 ? "" : " body2=\"" + name_of(two) + '"');
    const auto connect = [&](const Vec3& p_W) {
      out << "<connect" << bodies << " anchor=\"" << text(system_.pose(one).local(p_W)) << "\"/>\n";
    };
    if (joint.kind == JointKind::kFixed) {
      out << "<weld" << bodies << "/>\n";
      return;
    }
    const Vec3 aside = joint.kind == JointKind::kHinge ? Vec3(0.4 * joint.axis_W) : Vec3(Vec3::Zero());
    connect(joint.p_W - aside);
    if (joint.kind == JointKind::kHinge) connect(joint.p_W + aside);
  }

  const System& system_;
  bool free_;
  std::vector<std::vector<const TreeEdge*>> children_;
  std::ostringstream out_;
};

}  // namespace

MujocoModel mujoco_model(const System& system, const Method& method, double dt) {
  const bool cg = method.name == "cg", rk4 = method.get("rk4", 0) > 0;
  if (!cg && method.name != "newton") throw Unsupported("method " + method.name);
  Writer writer(system, method);
  std::ostringstream xml;
  xml.precision(17);
  // Every joint as an equality takes at most six rows.
  const std::size_t rows = 100 + 6 * (system.joints.size() + 1);
  xml << "<mujoco><compiler angle=\"radian\" boundmass=\"0\"/><size njmax=\"" << rows
      << "\" nstack=\"-1\"/>\n<option timestep=\"" << dt << "\" gravity=\"" << text(system.world->gravity())
      << "\" solver=\"" << (cg ? "CG" : "Newton") << "\" iterations=\""
      << static_cast<int>(method.get("iters", 100)) << "\" tolerance=\"" << method.get("tol", 1e-10)
      << "\" jacobian=\"sparse\" integrator=\"" << (rk4 ? "RK4" : "Euler")
      << "\"><flag contact=\"disable\"/></option>\n<default><equality";
  if (method.get("stiff", 0) > 0) xml << " solref=\"" << 2 * dt << " 1\" solimp=\"0.9999 0.9999 0.001\"";
  xml << "/></default>\n<worldbody>\n"
      << writer.worldbody() << "</worldbody>\n<equality>\n"
      << writer.equality() << "</equality></mujoco>\n";
  MujocoModel model;
  model.xml = xml.str();
  model.body_names.emplace_back("world");
  for (int b = 1; b < system.body_count(); ++b) model.body_names.push_back(name_of(b));
  return model;
}

}  // namespace taut::peers
