#include "scenes/files/synonyms.h"

#include <algorithm>
#include <cctype>

namespace taut {
namespace {

/// What the value must be for a name to be a synonym: "from" is a body or a point.
enum class SynonymOf { kAny, kAllButLists, kLists };

/// What one thing is called elsewhere, in lower case and without '-', '_' and spaces.
struct Synonyms {
  const char* here;
  std::vector<std::string_view> elsewhere;
  const char* note = "";  ///< what is different about it
  SynonymOf of = SynonymOf::kAny;
};

/// The first entry counts whose name is known where the other one is met, so that "ball" is a sphere among
/// shapes only, and "translation" a position in bodies, a displacement among axes.
const std::vector<Synonyms>& synonyms() {
  static const std::vector<Synonyms> all{
      // Joints.
      {"hinge", {"revolute", "pin", "rotational", "rotary", "continuous", "pivot", "axle", "revolutejoint"}},
      {"slider", {"prismatic", "translational", "slide", "linear", "rail"}},
      {"ball",
       {"spherical", "ballsocket", "ballandsocket", "socket", "point", "pointtopoint", "p2p", "gimbal"}},
      {"fixed", {"weld", "rigid", "lock", "glue", "bond"}},
      {"universal", {"cardan", "hooke", "ujoint", "cross", "hookes"}},
      {"six_dof", {"generic", "d6", "bushing", "6dof", "generic6dof"}},
      {"distance", {"rodjoint", "link", "stick", "massless", "linkage"}},
      {"rope", {"string", "tether", "cable", "maxdistance"}},
      {"hinge2", {"wheel", "suspension", "car"}},
      {"planar", {"plane", "inplane"}},
      {"point_on_line", {"inline", "pointline", "slot"}},
      {"point_on_curve", {"track", "curve", "path", "spline", "pointcurve"}},
      {"screw", {"helical", "leadscrew", "helix"}},
      {"cylindrical", {"sleeve"}},
      {"gear", {"gearing", "gears", "mimic"}},
      {"rack_and_pinion", {"rackpinion", "rack"}},
      {"driver", {"actuator", "servo", "motion", "motor", "prescribed"}},
      // Shapes.
      {"box", {"cuboid", "cube", "brick", "block", "rectangle", "beam"}},
      {"sphere", {"ball", "globe", "orb"}},
      {"half_space", {"plane", "floor", "infiniteplane", "halfspace"}, ", all that is below its z = 0"},
      {"capsule", {"pill", "stadium", "spherocylinder", "sphyl"}, ", along z"},
      {"ellipsoid", {"ellipse", "spheroid", "egg", "ovoid"}},
      {"cylinder", {"disk", "disc", "wheel"}, ", along z"},
      {"rod", {"bar", "stick", "pole", "link", "segment"}, ", along x"},
      // A body by its ends.
      {"rod", {"cylinder"}, ", from one end to the other"},
      {"beam", {"box", "cuboid", "brick", "block"}, ", from one end to the other"},
      {"convex_hull", {"convex", "hull", "polyhedron", "polytope", "convexmesh"}},
      {"triangle_mesh", {"mesh", "trimesh", "concave", "obj", "stl", "polygonmesh"}},
      {"height_field", {"heightmap", "terrain", "hfield", "heightfield", "heights", "elevation", "dem"}},
      // Forces, quantities, integrators.
      {"spring-damper", {"spring", "damper", "tsda", "springdamper", "shock"}},
      {"point-force", {"force", "load", "push"}},
      {"torque", {"moment", "couple"}},
      {"angular-velocity", {"omega", "spin", "rotationrate", "angvel"}},
      {"reaction-force", {"force", "reaction", "constraintforce"}},
      {"reaction-torque", {"torque", "moment"}},
      {"rattle", {"shake", "verlet", "symplectic"}},
      {"force-euler", {"euler", "semiimpliciteuler", "symplecticeuler", "explicit"}},
      {"force-runge-kutta", {"rk4", "rungekutta"}},
      {"moreau-jean", {"moreau", "timestepping", "implicit"}},
      {"recursive", {"featherstone", "aba", "articulated", "reduced", "reducedcoordinates", "generalized"}},
      {"recursive-midpoint", {"midpoint", "implicitmidpoint"}},
      {"lagrangian", {"lagrange", "crba", "eulerlagrange"}},
      {"gauss-seidel", {"pgs", "projectedgaussseidel", "sor", "sequentialimpulse", "iterative"}},
      // Keys.
      {"a",
       {"parent", "body1", "bodya", "link1", "base", "from", "predecessor"},
       "",
       SynonymOf::kAllButLists},
      {"b", {"child", "body2", "bodyb", "link2", "follower", "to", "successor"}, "", SynonymOf::kAllButLists},
      {"anchor_a", {"from", "start", "p1", "end1"}, "", SynonymOf::kLists},
      {"anchor_b", {"to", "end", "p2", "end2"}, "", SynonymOf::kLists},
      {"anchor", {"point", "pivot", "position", "pos", "origin", "location", "center", "centre", "where"}},
      {"anchor_a", {"point1", "pointa", "anchor1", "positiona", "localanchora", "attachment1"}},
      {"anchor_b", {"point2", "pointb", "anchor2", "positionb", "localanchorb", "attachment2"}},
      {"axis_a", {"axis1"}},
      {"axis_b", {"axis2"}},
      {"position", {"pos", "xyz", "location", "translation", "origin", "place", "com", "center", "centre"}},
      {"orientation", {"rotation", "rot", "quaternion", "quat", "rpy", "euler", "attitude", "rotate"}},
      {"rpy_deg", {"euler", "eulerdeg", "rollpitchyaw", "rpy"}, ": roll, pitch, yaw in degrees"},
      {"angle_deg", {"angle", "degrees", "deg"}, ", or \"angle_rad\""},
      {"velocity", {"vel", "linearvelocity", "linvel", "speed", "targetvelocity", "rate"}},
      {"angular_velocity", {"angvel", "omega", "spin", "angularvel", "rotationrate"}},
      {"fixed", {"static", "immovable", "kinematic", "isstatic", "anchored"}, ": true"},
      {"mass", {"weight", "m"}},
      {"density", {"rho"}},
      {"inertia", {"momentofinertia", "inertiatensor", "moments"}},
      {"shapes", {"geometry", "geom", "geoms", "collision", "collisions", "collider", "colliders", "shape"}},
      {"static_friction", {"mustatic", "mus", "friction", "mu"}},
      {"dynamic_friction", {"mudynamic", "mud", "muk", "kineticfriction", "slidingfriction"}},
      {"static", {"staticfriction", "mustatic", "mus", "coulomb", "dry", "stiction"}},
      {"dynamic", {"dynamicfriction", "mudynamic", "mud", "muk", "kinetic", "kineticfriction"}},
      {"restitution", {"bounce", "bounciness", "elasticity", "cor", "coefficientofrestitution"}},
      {"size",
       {"dimensions", "extents", "dims", "lengths", "halfextents", "halfsize", "sides"},
       ": whole lengths along x, y and z"},
      {"radius", {"r"}},
      {"radius", {"diameter", "d"}, ", half of the diameter"},
      {"length", {"l", "len", "height", "maxlength", "maxdistance", "ropelength"}},
      {"height", {"h", "length"}},
      {"limits", {"limit", "range", "bounds", "stops"}},
      {"lower", {"min", "minimum", "lo", "low", "from", "lowerlimit", "start"}},
      {"upper", {"max", "maximum", "hi", "high", "to", "upperlimit", "end"}},
      {"max_force", {"maxtorque", "effort", "torquelimit", "forcelimit", "torque", "force", "maxeffort"}},
      {"stiffness", {"k", "springconstant", "springstiffness", "kp"}},
      {"damping", {"c", "damper", "dampingcoefficient", "kd", "viscous"}},
      {"rest_length", {"length", "l0", "naturallength", "freelength", "rest"}},
      {"rest", {"restangle", "springreference", "equilibrium", "neutral"}},
      {"motor", {"actuator", "drive", "servo"}},
      {"axes",
       {"limits", "limit", "motor", "spring", "friction", "range", "actuator", "damping", "stiffness"},
       ": what acts along a free axis stands there, as in \"axes\": {\"angle\": {\"limits\": {...}}}"},
      {"axes",
       {"lower", "upper", "lowerdeg", "upperdeg", "lowerlimit", "upperlimit"},
       ": limits of a free axis stand there, as in \"axes\": {\"angle\": {\"limits\": {...}}}"},
      {"limits",
       {"lower", "upper", "lowerdeg", "upperdeg", "lowerlimit", "upperlimit"},
       ": both stand there, as in \"limits\": {\"lower\": ..., \"upper\": ...}"},
      {"compliance", {"softness", "flexibility"}},
      {"break", {"breakable", "strength", "breakforce"}},
      {"type", {"kind", "class", "shape", "jointtype"}},
      {"name", {"id", "label"}},
      {"material", {"surface", "materialid"}},
      {"dt", {"timestep", "step", "stepsize", "h", "deltat"}},
      {"duration", {"endtime", "tend", "stoptime", "simulationtime", "tstop", "time"}},
      {"gravity", {"g", "gravitation"}},
      {"bodies", {"links", "rigidbodies", "objects", "body", "parts"}},
      {"joints", {"constraints", "joint", "connections"}},
      {"cables", {"ropes", "chains", "cable", "rope", "wires"}},
      {"forces", {"loads", "springs", "force", "actuators"}},
      {"probes", {"sensors", "outputs", "measurements", "sensor"}},
      {"settings", {"options", "option", "solver", "config", "parameters"}},
      {"materials", {"surfaces"}},
      {"builder", {"scene", "generator", "type"}},
      {"parameters", {"params", "arguments", "args"}},
      {"ground", {"world", "environment", "floor"}},
      {"follows_body", {"local", "follower"}},
      {"collide", {"collision", "contact", "collides"}},
      {"ratio", {"multiplier", "gearratio"}},
      {"displacement", {"translation", "distance"}},
      {"angle", {"rotation", "theta"}},
      {"from", {"start", "begin", "p1", "point1", "end1", "fromto"}},
      {"to", {"end", "stop", "p2", "point2", "end2", "fromto"}},
      {"links", {"n", "segments", "count", "elements", "pieces"}},
  };
  return all;
}

std::string without_marks(std::string_view name) {
  std::string result;
  for (unsigned char c : name)
    if (c != '-' && c != '_' && c != ' ') result += static_cast<char>(std::tolower(c));
  return result;
}

/// Null if none of the known names has another one that is given.
const Synonyms* entry_of(std::string_view given, const std::vector<std::string>& known, bool is_list) {
  const std::string name = without_marks(given);
  for (const Synonyms& entry : synonyms()) {
    if (entry.of == (is_list ? SynonymOf::kAllButLists : SynonymOf::kLists)) continue;
    if (std::find(entry.elsewhere.begin(), entry.elsewhere.end(), name) == entry.elsewhere.end()) continue;
    if (std::find(known.begin(), known.end(), entry.here) != known.end()) return &entry;
  }
  return nullptr;
}

}  // namespace

std::string called_here(std::string_view given, const std::vector<std::string>& known, bool is_list) {
  const Synonyms* entry = entry_of(given, known, is_list);
  return entry ? "; \"" + std::string(given) + "\" is called \"" + entry->here + "\" here" + entry->note : "";
}

std::string name_here(std::string_view given, const std::vector<std::string>& known) {
  const Synonyms* entry = entry_of(given, known, false);
  return entry ? entry->here : "";
}

bool are_synonyms(std::string_view one, std::string_view other) {
  return std::ranges::any_of(synonyms(), [&](const Synonyms& entry) {
    const auto is_its_name = [&](std::string_view name) {
      return name == entry.here ||
             std::ranges::find(entry.elsewhere, without_marks(name)) != entry.elsewhere.end();
    };
    return is_its_name(one) && is_its_name(other);
  });
}

}  // namespace taut
