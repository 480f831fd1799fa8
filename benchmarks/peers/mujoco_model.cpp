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
    shapes_.resize(system.body_count());
    for (int s = 0; s < system.world->shape_count(); ++s)
      shapes_[system.world->shape(ShapeId{s}).body.index].push_back(ShapeId{s});
    for (const TreeEdge& edge : system.tree) children_[edge.parent].push_back(&edge);
    out_.precision(17);
  }

  std::string worldbody() {
    for (ShapeId shape : shapes_[0]) add_geom(shape);
    if (free_)
      for (int b = 1; b < system_.body_count(); ++b) {
        open(b, system_.pose(b));
        out_ << "<freejoint/></body>\n";
      }
    else
      for (const TreeEdge* edge : children_[0]) nested(*edge);
    return out_.str();
  }

  /// Neighbours at a joint, who do not touch each other.
  std::string exclusions() const {
    std::string out;
    if (system_.has_contact())
      for (const PeerJoint& joint : system_.joints)
        if (joint.a != 0 && joint.b != 0)
          out += "<exclude body1=\"" + name_of(joint.a) + "\" body2=\"" + name_of(joint.b) + "\"/>\n";
    return out;
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
    for (ShapeId shape : shapes_[body]) add_geom(shape);
  }
  /// MuJoCo takes the larger friction of two geoms, and lets them touch if one's mask has the other's group.
  void add_geom(ShapeId id) {
    const ShapeRecord& record = system_.world->shape(id);
    const Material& material = record.material;
    const bool rolls = material.rolling_friction > 0;
    out_ << "<geom pos=\"" << text(record.pose.p) << "\" quat=\"" << text(record.pose.q) << "\" friction=\""
         << material.dynamic_friction << ' ' << material.spinning_friction << ' ' << material.rolling_friction
         << "\" condim=\"" << (rolls ? 6 : 3) << "\" contype=\"" << record.filter.groups
         << "\" conaffinity=\"" << (record.filter.mask & 0x7fffffff) << "\" ";
    if (std::holds_alternative<HalfSpace>(*record.shape))
      out_ << "type=\"plane\" size=\"0 0 1\"/>\n";
    else if (const auto* sphere = std::get_if<Sphere>(&*record.shape))
      out_ << "type=\"sphere\" size=\"" << sphere->radius << "\"/>\n";
    else if (const auto* box = std::get_if<Box>(&*record.shape))
      out_ << "type=\"box\" size=\"" << text(0.5 * box->size) << "\"/>\n";
    else if (const auto* capsule = std::get_if<Capsule>(&*record.shape))
      out_ << "type=\"capsule\" size=\"" << capsule->radius << ' ' << 0.5 * capsule->length << "\"/>\n";
    else if (const auto* cylinder = std::get_if<Cylinder>(&*record.shape))
      out_ << "type=\"cylinder\" size=\"" << cylinder->radius << ' ' << 0.5 * cylinder->length << "\"/>\n";
    else
      throw Unsupported(shape_name(*record.shape));
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
    if (edge.joint == TreeEdge::kFree) {
      out_ << "<freejoint/>";
      return;
    }
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
  std::vector<std::vector<ShapeId>> shapes_;  ///< by body
  std::ostringstream out_;
};

struct Room {
  int rows = 0, contacts = 0;
};

/// MuJoCo makes room for the square of the rows, which bounds the contacts of large systems with joints.
Room room_for(const System& system, bool elliptic) {
  constexpr int kMostRows = 11000, kContactsOfABody = 20, kSpare = 100;
  Room room{.rows = kSpare};
  for (const PeerJoint& joint : system.joints) room.rows += joint.kind == JointKind::kBall ? 3 : 6;
  if (!system.has_contact()) return room;
  bool rolls = false;
  for (int s = 0; s < system.world->shape_count(); ++s)
    rolls = rolls || system.world->shape(ShapeId{s}).material.rolling_friction > 0;
  const int dimensions = rolls ? 6 : 3, rows = elliptic ? dimensions : 2 * (dimensions - 1);
  room.contacts = std::min((kMostRows - room.rows) / rows, kSpare + kContactsOfABody * system.body_count());
  room.contacts = std::max(room.contacts, kSpare);
  room.rows += rows * room.contacts;
  return room;
}

}  // namespace

MujocoModel mujoco_model(const System& system, const Method& method, double dt) {
  const bool cg = method.name == "cg", rk4 = method.get("rk4", 0) > 0;
  require_plain_contact(system);
  if (!cg && method.name != "newton") throw Unsupported("method " + method.name);
  Writer writer(system, method);
  std::ostringstream xml;
  xml.precision(17);
  const bool stiff = method.get("stiff", 0) > 0, elliptic = method.get("elliptic", 0) > 0;
  const Room room = room_for(system, elliptic);
  std::ostringstream hardness;  // as hard as the step allows
  if (stiff) hardness << " solref=\"" << 2 * dt << " 1\" solimp=\"0.9999 0.9999 0.001\"";
  xml << "<mujoco><compiler angle=\"radian\" boundmass=\"0\"/><size njmax=\"" << room.rows << "\" nconmax=\""
      << room.contacts << "\" nstack=\"-1\"/>\n<option timestep=\"" << dt << "\" gravity=\""
      << text(system.world->gravity()) << "\" solver=\"" << (cg ? "CG" : "Newton") << "\" iterations=\""
      << static_cast<int>(method.get("iters", 100)) << "\" tolerance=\"" << method.get("tol", 1e-10)
      << "\" jacobian=\"sparse\" integrator=\"" << (rk4 ? "RK4" : "Euler") << "\" cone=\""
      << (elliptic ? "elliptic" : "pyramidal") << "\" noslip_iterations=\""
      << static_cast<int>(method.get("noslip", 0)) << "\">"
      << (system.has_contact() ? "" : "<flag contact=\"disable\"/>") << "</option>\n<default><equality"
      << hardness.str() << "/><geom" << hardness.str() << "/></default>\n<worldbody>\n"
      << writer.worldbody() << "</worldbody>\n<contact>\n"
      << writer.exclusions() << "</contact>\n<equality>\n"
      << writer.equality() << "</equality></mujoco>\n";
  MujocoModel model;
  model.xml = xml.str();
  model.body_names.emplace_back("world");
  for (int b = 1; b < system.body_count(); ++b) model.body_names.push_back(name_of(b));
  return model;
}

}  // namespace taut::peers
