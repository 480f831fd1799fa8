#pragma once

#include "tests/scenes/files/scene_bad_ends.h"
#include "tests/scenes/files/scene_bad_shapes.h"

namespace taut::scene_file_cases {

inline std::string top(const std::string& more) { return R"({"format": "taut-scene/1", )" + more + "}"; }
inline std::string body(const std::string& keys) { return top(R"("bodies": [{)" + keys + "}]"); }
inline std::string sound_body(const std::string& more) {
  return body(R"("mass": 1, "inertia": [1, 1, 1], )" + more);
}
inline std::string joint(const std::string& keys) {
  return two_bodies(R"("joints": [{"a": "P", "b": "Q", )" + keys + "}]");
}
inline std::string force(const std::string& keys) { return two_bodies(R"("forces": [{)" + keys + "}]"); }
inline std::string probe(const std::string& keys) { return two_bodies(R"("probes": [{)" + keys + "}]"); }

inline std::vector<BadScene> bad_top_level() {
  const std::string known_settings =
      R"("cfm", "contact_margin", "contacts", "drift_cure", "erp", "factor", "inexact_tolerance", )"
      R"("integrator", "iterations", "locate_plastic_impacts", "max_contacts", "max_newton_iterations", "max_rotation", "max_substeps", )"
      R"("max_tension_number", "merge_fixed_joints", )"
      R"("penalty_damping_ratio", "penalty_frequency", "position_tolerance", "relaxation", "report_energy", )"
      R"("report_rank", )"
      R"("resting_speed", "sleep", "sleep_speed", "sleep_time", "solver", "tension", "theta", "threads", "velocity_tolerance")";
  return {
      {"[]", "/", "must be an object", "[]"},
      {"{}", "/", R"("format" is missing)", ""},
      {R"({"format": "taut-scene/2"})", "/format", R"(must be "taut-scene/1")", R"("taut-scene/2")"},
      {top(R"("name": 3)"), "/name", "must be a string that is not empty", "3"},
      {top(R"("name": "")"), "/name", "must be a string that is not empty", R"("")"},
      {top(R"("dt": -0.5)"), "/dt", "must be finite and positive", "-0.5"},
      {top(R"("dt": 1e999)"), "/dt", "must be finite", "inf", false},
      {top(R"("dt": -1e999)"), "/dt", "must be finite", "-inf", false},
      {top(R"("dt": "1")"), "/dt", "must be a number", R"("1")"},
      {top(R"("dt": 1, "dt": 1)"), "/dt", "this key is given twice in the same object", "", false},
      {top(R"("duration": 0)"), "/duration", "must be finite and positive", "0"},
      {top(R"("energy_scale": -1)"), "/energy_scale", "must be finite and not negative", "-1"},
      {top(R"("assemble": 1)"), "/assemble", "must be true or false", "1"},
      {top(R"("gravity": [0, 0])"), "/gravity", "must be an array of 3 numbers", "[0,0]"},
      {top(R"("gravity": [0, null, 0])"), "/gravity/1", "must be a number", "null"},
      {top(R"("bodies": {})"), "/bodies", "must be an array", "{}"},
      {top(R"("bodies": [7])"), "/bodies/0", "must be an object", "7"},
      {top(R"("a/b~c": {"x": 1e999})"), "/a~1b~0c",
       R"(unknown key; known here are "$schema", "assemble", "bodies", "cables", "dt", "duration", "energy_scale", )"
       R"("events", "forces", "format", "generate", "gravity", "ground", "joints", "material_pairs", "materials", "name", "pairs", )"
       R"("probes", "settings", "time")",
       R"({"x":null})", false},
      {top(R"("settings": {"integrator": "ratle"})"), "/settings/integrator",
       R"(must be one of "rattle", "rattle4", "rattle6", "rattle8", "force-euler", "force-runge-kutta", "moreau-jean", )"
       R"("recursive", "recursive-midpoint", "lagrangian", "lagrangian-midpoint"; )"
       R"(did you mean "rattle"?)",
       R"("ratle")"},
      {top(R"("settings": {"drift_cure": 2})"), "/settings/drift_cure",
       R"(must be one of "auto", "none", "baumgarte", "velocity-impulse", "position-push", "penalty")", "2"},
      {top(R"("settings": {"max_substeps": 1.5})"), "/settings/max_substeps",
       "must be a positive whole number", "1.5"},
      {top(R"("settings": {"max_substeps": 0})"), "/settings/max_substeps", "must be a positive whole number",
       "0"},
      {top(R"("settings": {"theta": 0.3})"), "/settings/theta", "must be between 1/2 and 1", "0.3"},
      {top(R"("settings": {"relaxation": 2})"), "/settings/relaxation", "must be between 0 and 2", "2"},
      {top(R"("settings": {"tension": "implicit", "integrator": "moreau-jean"})"), "/settings/tension",
       R"(excludes "integrator": "moreau-jean" of /settings/integrator, since "moreau-jean" takes tension explicitly)",
       R"("implicit")", false},
      {top(R"("settings": {"drift_cure": "penalty", "integrator": "moreau-jean"})"), "/settings/drift_cure",
       R"(excludes "integrator": "moreau-jean" of /settings/integrator, since "moreau-jean" has "position-push" and )"
       R"("none" only)",
       R"("penalty")", false},
      {top(R"("settings": {"solver": "pairwise", "integrator": "force-euler"})"), "/settings/integrator",
       R"(excludes "solver": "pairwise" of /settings/solver, since iterative solvers need the integrator "rattle")",
       R"("force-euler")", false},
      {top(R"("settings": {"position_tolerance": 0})"), "/settings/position_tolerance",
       "must be finite and positive", "0"},
      {top(R"("settings": {"positon_tolerance": 1})"), "/settings/positon_tolerance",
       "unknown key; known here are " + known_settings + R"(; did you mean "position_tolerance"?)", "1"},
  };
}

inline std::vector<BadScene> bad_bodies() {
  return {
      {body(R"("inertia": [1, 1, 1])"), "/bodies/0", R"(one of "mass", "density" is missing)", ""},
      {body(R"("mass": 1)"), "/bodies/0",
       R"(one of "inertia", "shape", "shapes", "rod", "capsule", "beam" is missing)", ""},
      {body(R"("fixed": true, "mass": 1)"), "/bodies/0",
       R"(one of "inertia", "shape", "shapes", "rod", "capsule", "beam" is missing)", ""},
      {body(R"("mass": 0, "inertia": [1, 1, 1])"), "/bodies/0/mass", "must be finite and positive", "0"},
      {body(R"("mass": -1, "inertia": [1, 1, 1])"), "/bodies/0/mass", "must be finite and positive", "-1"},
      {body(R"("mass": 1e400, "inertia": [1, 1, 1])"), "/bodies/0/mass", "must be finite", "inf", false},
      {body(R"("density": 1, "inertia": [1, 1, 1])"), "/bodies/0/density",
       "needs a shape; give the mass with an inertia", "1"},
      {sound_body(R"("density": 1)"), "/bodies/0/density", R"(only one of "mass", "density" may be given)",
       "1"},
      {body(R"("mass": 1, "inertia": [1, 1, 2.5])"), "/bodies/0/inertia",
       "principal moments must obey the triangle inequality", "[1,1,2.5]", false},
      {body(R"("mass": 1, "inertia": [1, 1, 0])"), "/bodies/0/inertia",
       "principal moments must be finite and positive", "[1,1,0]"},
      {body(R"("mass": 1, "inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 2.5]])"), "/bodies/0/inertia",
       "principal moments must obey the triangle inequality", "[[1,0,0],[0,1,0],[0,0,2.5]]", false},
      {body(R"("mass": 1, "inertia": [[1, 0.1, 0], [0, 1, 0], [0, 0, 1]])"), "/bodies/0/inertia",
       "must be symmetric", "[[1,0.1,0],[0,1,0],[0,0,1]]", false},
      {body(R"("mass": 1, "inertia": [[1, 0, 0]])"), "/bodies/0/inertia",
       "must be 3 principal moments or a 3x3 matrix", "[[1,0,0]]"},
      {body(R"("mass": 1, "inertia": 1)"), "/bodies/0/inertia", "must be 3 principal moments or a 3x3 matrix",
       "1"},
      {body(R"("mass": 1, "shape": {"type": "spere", "radius": 1})"), "/bodies/0/shape/type",
       R"(must be one of "box", "sphere", "ellipsoid", "rod", "cylinder", "capsule", "cone"; )"
       R"(did you mean "sphere"?)",
       R"("spere")"},
      {body(R"("mass": 1, "shape": {"type": "sphere"})"), "/bodies/0/shape", R"("radius" is missing)", ""},
      {body(R"("mass": 1, "shape": {"type": "sphere", "radius": 0})"), "/bodies/0/shape/radius",
       "must be finite and positive", "0"},
      {body(R"("mass": 1, "shape": {"type": "sphere", "radius": 1, "height": 1})"), "/bodies/0/shape/height",
       R"(unknown key; known here are "radius", "type")", "1"},
      {body(R"("mass": 1, "shape": {"type": "box", "size": [1, 1, 0]})"), "/bodies/0/shape/size",
       "must be 3 positive numbers", "[1,1,0]"},
      {body(R"("density": 1e300, "shape": {"type": "sphere", "radius": 1e10})"), "/bodies/0/shape",
       "mass: must be finite and positive", R"({"radius":10000000000.0,"type":"sphere"})", false},
      {sound_body(R"("orientation": [0, 0, 0, 0])"), "/bodies/0/orientation",
       "must not be 0: it has no direction", "[0,0,0,0]", false},
      {sound_body(R"("angular_velocity": [0, 0, 0], "angular_velocity_deg": [0, 0, 0])"),
       "/bodies/0/angular_velocity_deg", R"("angular_velocity" is given as well)", "[0,0,0]"},
      {sound_body(R"("orientation": [1, 0, 0])"), "/bodies/0/orientation",
       "must be a quaternion of 4 numbers w, x, y, z", "[1,0,0]"},
      {sound_body(R"("orientation": 0)"), "/bodies/0/orientation",
       "must be a quaternion [w, x, y, z], an axis with an angle, or roll, pitch and yaw", "0"},
      {sound_body(R"("orientation": {"x": 0.6, "y": 0, "z": 0, "w": 0.8})"), "/bodies/0/orientation",
       "a quaternion is a list here, [w, x, y, z]: [0.8,0.6,0,0]", R"({"w":0.8,"x":0.6,"y":0,"z":0})"},
      {sound_body(R"("orientation": {"axis": [0, 0, 1]})"), "/bodies/0/orientation",
       R"(one of "angle_deg", "angle_rad" is missing)", ""},
      {sound_body(R"("orientation": {"axis": [0, 0, 0], "angle_deg": 1})"), "/bodies/0/orientation/axis",
       "must not be 0: it has no direction", "[0,0,0]", false},
      {sound_body(R"("orientation": {"rpy_deg": [0, 0, 0], "rpy_rad": [0, 0, 0]})"),
       "/bodies/0/orientation/rpy_rad", R"(only one of "rpy_deg", "rpy_rad" may be given)", "[0,0,0]"},
      {sound_body(R"("velocity": [0, 0, 1e999])"), "/bodies/0/velocity/2", "must be finite", "inf", false},
      {sound_body(R"("angular_velocity": [0, 0, 0], "angular_velocity_body": [0, 0, 0])"),
       "/bodies/0/angular_velocity_body", "angular_velocity is given as well", "[0,0,0]"},
      {body(R"("fixed": true, "velocity": [0, 0, 1])"), "/bodies/0", "a fixed body cannot have a velocity",
       R"({"fixed":true,"velocity":[0,0,1]})", false},
      {body(R"("name": "ground", "fixed": true)"), "/bodies/0/name", "name is already taken by the ground",
       R"("ground")", false},
      {top(R"("bodies": [{"name": "a", "fixed": true}, {"name": "a", "fixed": true}])"), "/bodies/1/name",
       "name is already taken by /bodies/0", R"("a")", false},
  };
}

/// A hinge "h" from P to Q with these axes, and one more joint.
inline std::string with_axes(const std::string& axes) {
  return joint(R"("name": "h", "type": "hinge", "anchor": [0, 0, 0], "axis": [0, 0, 1], "axes": )" + axes);
}
inline std::string beside_hinge(const std::string& keys) {
  return two_bodies(R"("joints": [{"name": "h", "type": "hinge", "a": "P", "b": "Q", "anchor": [0, 0, 0],
      "axis": [0, 0, 1]}, {)" +
                    keys + "}]");
}

/// What has another name elsewhere is not missing as well.
inline std::vector<BadScene> bad_names() {
  return {
      {body(R"("weight": 1, "inertia": [1, 1, 1])"), "/bodies/0/weight",
       R"(unknown key; "weight" is called "mass" here)", "1"},
      {joint(R"("type": "hinge", "point": [0, 0, 0], "axis": [0, 0, 1])"), "/joints/0/point",
       R"(unknown key; "point" is called "anchor" here)", "[0,0,0]"},
      {two_bodies(R"("joints": [{"parent": "P", "b": "Q", "type": "ball", "anchor": [0, 0, 0]}])"),
       "/joints/0/parent", R"(unknown key; "parent" is called "a" here)", R"("P")"},
      {joint(R"("type": "revolute", "anchor": [0, 0, 0], "axis": [0, 0, 1])"), "/joints/0/type",
       R"(is not known; "revolute" is called "hinge" here)", R"("revolute")"},
  };
}

inline std::vector<BadScene> bad_axes() {
  const std::string angle = R"({"joint": "h", "axis": "angle"})", at = "/joints/0/axes/angle";
  return {
      {with_axes("3"), "/joints/0/axes", "must be an object", "3"},
      {with_axes(R"({"angel": {}})"), "/joints/0/axes/angel",
       "axis of h: there is none of this name, only angle", "{}", false},
      {with_axes(R"({"angle": {"limit": {}}})"), at + "/limit",
       R"(unknown key; "limit" is called "limits" here)", "{}"},
      {with_axes(R"({"angle": {"limits": {"lower": 2, "upper": 1}}})"), at + "/limits",
       "lower limit of h angle: must not exceed the upper limit 1.000000", R"({"lower":2,"upper":1})", false},
      {with_axes(R"({"angle": {"limits": {"lower": 0, "lower_deg": 0}}})"), at + "/limits/lower_deg",
       R"("lower" is given as well)", "0"},
      {with_axes(R"({"angle": {"limits": {"lower_deg": "0"}}})"), at + "/limits/lower_deg",
       "must be a number", R"("0")"},
      {with_axes(R"({"angle": {"motor": {"position": 0, "velocity_deg": 0}}})"), at + "/motor/position",
       R"(only one of "velocity", "position", "trajectory" may be given)", "0"},
      {with_axes(R"({"angle": {"motor": {"velocity_deg": 1, "max_force_deg": 1}}})"),
       at + "/motor/max_force_deg",
       R"(unknown key; known here are "damping", "force_of_speed", "max_force", "max_speed", "position", )"
       R"("pulls_only", "stiffness", "trajectory", "velocity")",
       "1"},
      {with_axes(R"({"angle": {"limits": {"lower_dge": 0, "upper": 1}}})"), at + "/limits/lower_dge",
       R"(unknown key; known here are "compliance", "damping", "lower", "restitution", "upper"; )"
       R"(did you mean "lower_deg"?)",
       "0"},
      // A displacement has no degrees; the schema does not know which axes a joint has.
      {joint(R"("name": "s", "type": "slider", "anchor": [0, 0, 0], "axis": [0, 0, 1],
         "axes": {"displacement": {"limits": {"lower_deg": 0, "upper": 1}}})"),
       "/joints/0/axes/displacement/limits/lower_deg",
       R"(unknown key; known here are "compliance", "damping", "lower", "restitution", "upper")", "0", false},
      {with_axes(R"({"angle": {"limits": {}}})"), at + "/limits",
       R"(at least one of "lower", "upper" is missing)", ""},
      {with_axes(R"({"angle": {"limits": {"restitution": 0.5}}})"), at + "/limits",
       R"(at least one of "lower", "upper" is missing)", ""},
      {with_axes(R"({"angle": {"friction": {}}})"), at + "/friction",
       R"(at least one of "static", "dynamic", "viscous", "per_load" is missing)", ""},
      {with_axes(R"({"angle": {"spring": {"rest": 1}}})"), at + "/spring",
       R"(at least one of "stiffness", "damping", "table", "damping_table" is missing)", ""},
      {with_axes(R"({"angle": {"limits": {"lower": 0, "restitution": -1}}})"), at + "/limits/restitution",
       "must be between 0 and 1", "-1"},
      {with_axes(R"({"angle": {"limits": {"lower": 0, "restitution": 2}}})"), at + "/limits/restitution",
       "must be between 0 and 1", "2"},
      {with_axes(R"({"angle": {"motor": {}}})"), at + "/motor",
       R"(one of "velocity", "position", "trajectory" is missing)", ""},
      {with_axes(R"({"angle": {"motor": {"velocity": 1, "max_force": -2}}})"), at + "/motor/max_force",
       "must be finite and not negative", "-2"},
      {with_axes(R"({"angle": {"motor": {"velocity": 1, "force_of_speed": []}}})"),
       at + "/motor/force_of_speed", "curve: must have a point", "[]"},
      {with_axes(R"({"angle": {"motor": {"velocity": 1, "force_of_speed": [[1, 2], [0, 3]]}}})"),
       at + "/motor/force_of_speed", "curve point 2: must lie to the right of the point before it",
       "[[1,2],[0,3]]", false},
      {with_axes(R"({"angle": {"motor": {"velocity": 1, "force_of_speed": [[1]]}}})"),
       at + "/motor/force_of_speed/0", "must be a pair of numbers [x, y]", "[1]"},
      {with_axes(R"({"angle": {"spring": {"table": []}}})"), at + "/spring/table", "curve: must have a point",
       "[]"},
      {with_axes(R"({"angle": {"spring": {"table": [[0, 0], [1, 2], [1, 3]]}}})"), at + "/spring/table",
       "curve point 3: must lie to the right of the point before it", "[[0,0],[1,2],[1,3]]", false},
      {with_axes(R"({"angle": {"friction": {"viscous": -1}}})"), at + "/friction/viscous",
       "must be finite and not negative", "-1"},
      {with_axes(R"({"angle": {"friction": {"static": -1}}})"), at + "/friction/static",
       "must be finite and not negative", "-1"},
      {with_axes(R"({"angle": {"friction": {"static": 1, "dynamic": 2}}})"), at + "/friction",
       "dynamic friction of h angle: must not exceed the static friction 1.000000",
       R"({"dynamic":2,"static":1})", false},
      {with_axes(R"({"angle": {"spring": {"damping_table": []}}})"), at + "/spring/damping_table",
       "curve: must have a point", "[]"},
      {with_axes(R"({"angle": {"spring": {"damping_table": [[0, 0], [-1, 2]]}}})"),
       at + "/spring/damping_table", "curve point 2: must lie to the right of the point before it",
       "[[0,0],[-1,2]]", false},
      {with_axes(R"({"angle": {"spring": {"damping_table": [[0, 1], [1, 2]]}}})"), at + "/spring",
       "damping table of h angle: must give no force at rest", R"({"damping_table":[[0,1],[1,2]]})", false},
      {with_axes(R"({"angle": {"spring": {"damping_table": [[0, 0], [1, 2], [2, 1]]}}})"), at + "/spring",
       "damping table of h angle: must not fall with the rate", R"({"damping_table":[[0,0],[1,2],[2,1]]})",
       false},
      {with_axes(R"({"angle": {"spring": {"damping": 1, "damping_table": [[0, 0]]}}})"), at + "/spring",
       "spring damping of h angle: must be 0 beside a damping table",
       R"({"damping":1,"damping_table":[[0,0]]})", false},
      {with_axes(R"({"angle": {"spring": {"stiffness": 1, "table": [[0, 0]]}}})"), at + "/spring",
       "spring stiffness of h angle: must be 0 beside a table", R"({"stiffness":1,"table":[[0,0]]})", false},
      {joint(R"("type": "screw", "anchor": [0, 0, 0], "axis": [0, 0, 1])"), "/joints/0",
       R"("pitch" is missing)", ""},
      {joint(R"("type": "screw", "anchor": [0, 0, 0], "axis": [0, 0, 1], "pitch": 0)"), "/joints/0",
       "screw pitch: must not be 0", R"({"a":"P","anchor":[0,0,0],"axis":[0,0,1],"b":"Q","pitch":0,"...)",
       false},
      {joint(R"("type": "six_dof", "anchor": [0, 0, 0], "locked": ["w"])"), "/joints/0/locked/0",
       R"(must be one of "x", "y", "z", "angle_x", "angle_y", "angle_z")", R"("w")"},
      {joint(R"("type": "six_dof", "anchor": [0, 0, 0], "locked": ["x", "x"])"), "/joints/0/locked/1",
       "is given twice", R"("x")"},
      {beside_hinge(R"("type": "gear", "driving": {"joint": "g", "axis": "angle"}, "driven": )" + angle +
                    R"(, "ratio": 2)"),
       "/joints/1/driving/joint", "there is no joint of this name", R"("g")", false},
      {beside_hinge(R"("type": "gear", "driving": {"joint": "h", "axis": "turn"}, "driven": )" + angle +
                    R"(, "ratio": 2)"),
       "/joints/1/driving/axis", "axis of h: there is none of this name, only angle", R"("turn")", false},
      {beside_hinge(R"("type": "gear", "driving": {"joint": "h"}, "driven": )" + angle + R"(, "ratio": 2)"),
       "/joints/1/driving", R"("axis" is missing)", ""},
      {beside_hinge(R"("type": "gear", "driving": )" + angle + R"(, "driven": )" + angle + R"(, "ratio": 2)"),
       "/joints/1", "gear: couples an axis to itself",
       R"({"driven":{"axis":"angle","joint":"h"},"driving":{"axis":"an...)", false},
      {beside_hinge(R"("type": "rack_and_pinion", "pinion": )" + angle + R"(, "rack": )" + angle +
                    R"(, "radius": 2)"),
       "/joints/1", "rack and pinion: the rack's axis must be a displacement",
       R"({"pinion":{"axis":"angle","joint":"h"},"rack":{"axis":"angle...)", false},
      {beside_hinge(R"("type": "driver", "of": )" + angle + R"(, "motion": {"speeds": []})"),
       "/joints/1/motion/speeds", "curve: must have a point", "[]"},
      {beside_hinge(R"("type": "driver", "of": )" + angle + R"(, "motion": {"speeds": [[1, 0], [0, 0]]})"),
       "/joints/1/motion/speeds", "curve point 2: must lie to the right of the point before it",
       "[[1,0],[0,0]]", false},
      {beside_hinge(R"("type": "driver", "of": )" + angle + R"(, "motion": {"spline": []})"),
       "/joints/1/motion/spline", "must have more points", "[]"},
      {beside_hinge(R"("type": "driver", "of": )" + angle), "/joints/1", R"("motion" is missing)", ""},
      {beside_hinge(R"("type": "driver", "of": )" + angle + R"(, "motion": {"linear": {}})"),
       "/joints/1/motion/linear", R"("rate" is missing)", ""},
      {beside_hinge(R"("type": "driver", "of": )" + angle + R"(, "motion": {"spline": [[0, 1], [0, 2]]})"),
       "/joints/1/motion/spline", "spline parameter 2: must exceed the one before it", "[[0,1],[0,2]]",
       false},
  };
}

inline std::vector<BadScene> bad_joints() {
  const std::string open =
      R"( must be closed at the start to 1e-06 m or rad, but has a gap; "assemble": true )"
      "lets the simulator close it";
  return {
      {joint(R"("anchor": [0, 0, 0])"), "/joints/0", R"("type" is missing)", ""},
      {joint(R"("type": "hing", "anchor": [0, 0, 0])"), "/joints/0/type",
       R"(must be one of "ball", "hinge", "slider", "fixed", "universal", "distance", "cylindrical", "screw", )"
       R"("planar", "point_on_line", "hinge2", "six_dof", "rope", "pulley", "point_on_curve", "pose_driver", )"
       R"("gear", "rack_and_pinion", "differential", "driver"; did you mean "hinge"?)",
       R"("hing")"},
      {joint(R"("type": "ball")"), "/joints/0", R"("anchor" is missing)", ""},
      {joint(R"("type": "ball", "anchor": [0, 0, 0], "axis": [0, 0, 1])"), "/joints/0/axis",
       R"(unknown key; known here are "a", "anchor", "anchor_a", "anchor_b", "attached", "axes", "b", "break", )"
       R"("compliance", "frame", "frame_orientation", "name", "orientation_a", "orientation_b", "type"; did you )"
       R"(mean "axes"?)",
       "[0,0,1]"},
      {joint(R"("type": "ball", "anchor": [0, 0, 0], "anchor_a": [0, 0, 0])"), "/joints/0/anchor_a",
       R"("anchor" is given as well)", "[0,0,0]"},
      {joint(R"("type": "ball", "frame": "body", "anchor": [0, 0, 0])"), "/joints/0/anchor",
       R"(is in the world's frame, but "frame" is "body"; give "anchor_a" and "anchor_b")", "[0,0,0]", false},
      {joint(R"("type": "ball", "anchor_a": [0, 0, 0], "anchor_b": [0, 0, 0])"), "/joints/0",
       R"("frame" is missing: "world" or "body" for "anchor_a")", ""},
      {joint(R"("type": "ball", "frame": "body", "anchor_a": [0, 0, 0])"), "/joints/0",
       R"("anchor_b" is missing)", ""},
      {joint(R"("type": "ball", "frame": "bodies", "anchor": [0, 0, 0])"), "/joints/0/frame",
       R"(must be one of "world", "body")", R"("bodies")"},
      {joint(R"("type": "hinge", "anchor": [0, 0, 0])"), "/joints/0", R"("axis" is missing)", ""},
      {joint(R"("type": "hinge", "anchor": [0, 0, 0], "axis": [0, 0, 0])"), "/joints/0/axis",
       "must not be 0: it has no direction", "[0,0,0]", false},
      {joint(R"("type": "slider", "anchor": [0, 0, 0])"), "/joints/0", R"("axis" is missing)", ""},
      {joint(R"("type": "universal", "anchor": [0, 0, 0], "axis_a": [0, 0, 1], "axis_b": [0, 1, 0])"),
       "/joints/0", R"("frame" is missing: "world" or "body" for "axis_a")", ""},
      {joint(R"("type": "distance", "anchor": [0, 0, 0])"), "/joints/0",
       "distance length: must be finite and positive",
       R"({"a":"P","anchor":[0,0,0],"b":"Q","type":"distance"})", false},
      {joint(R"("type": "distance", "anchor": [0, 0, 0], "length": 0)"), "/joints/0/length",
       "must be finite and positive", "0"},
      {joint(R"("type": "distance", "frame": "body", "anchor_a": [0, 0, 0], "anchor_b": [0, 0, 0],
                "length": 3)"),
       "/joints/0", R"(distance "joint_0")" + open, "2 m", false},
      {joint(R"("name": "j", "type": "ball", "frame": "body", "anchor_a": [0, 0, 0], "anchor_b": [0, 0, 0])"),
       "/joints/0", R"(ball "j")" + open, "1 m", false},
      {joint(
           R"("name": "j", "type": "fixed", "anchor": [0, 0, 0], "orientation": {"rpy_deg": [0, 0, -89.5]})"),
       "/joints/0", R"(fixed "j")" + open, "0.00872662 rad", false},
      {two_bodies(R"("joints": [{"type": "ball", "a": "P", "anchor": [0, 0, 0]}])"), "/joints/0",
       R"("b" is missing)", ""},
      {two_bodies(R"("joints": [{"type": "ball", "a": "P", "b": "R", "anchor": [0, 0, 0]}])"), "/joints/0/b",
       "there is no body of this name", R"("R")", false},
      {two_bodies(R"("joints": [{"type": "ball", "a": "world", "b": "P", "anchor": [0, 0, 0]}])"),
       "/joints/0/a", R"(there is no body of this name; "world" is called "ground" here)", R"("world")",
       false},
      {two_bodies(R"("joints": [{"type": "ball", "a": "grond", "b": "P", "anchor": [0, 0, 0]}])"),
       "/joints/0/a", R"(there is no body of this name; did you mean "ground"?)", R"("grond")", false},
      {two_bodies(R"("joints": [{"type": "ball", "a": "P", "b": 1, "anchor": [0, 0, 0]}])"), "/joints/0/b",
       "must be a string that is not empty", "1"},
      {two_bodies(R"("joints": [{"type": "ball", "a": "P", "b": "P", "anchor": [0, 0, 0]}])"), "/joints/0/b",
       "joins a body to itself", R"("P")", false},
      {top(R"("bodies": [{"name": "wall", "fixed": true}], "joints": [{"type": "ball", "a": "ground",
             "b": "wall", "anchor": [0, 0, 0]}])"),
       "/joints/0", "joins two fixed bodies", "ground, wall", false},
      {two_bodies(R"("joints": [{"name": "j", "type": "ball", "a": "ground", "b": "P", "anchor": [0, 0, 0]},
             {"name": "j", "type": "ball", "a": "ground", "b": "Q", "anchor": [0, 0, 0]}])"),
       "/joints/1/name", "name is already taken by /joints/0", R"("j")", false},
      // A body with an error of its own still counts as there, and its joints are not blamed.
      {top(R"("bodies": [{"name": "a", "mass": 0, "inertia": [1, 1, 1], "position": [5, 0, 0]}],
             "joints": [{"type": "ball", "a": "ground", "b": "a", "frame": "body", "anchor_a": [5, 0, 1],
             "anchor_b": [0, 0, 1]}])"),
       "/bodies/0/mass", "must be finite and positive", "0"},
  };
}

/// Beside a hinge "hip" of P and Q with a motor on its angle, and a probe "tip".
inline std::string event(const std::string& keys) {
  return two_bodies(
      R"("joints": [{"name": "hip", "type": "hinge", "a": "P", "b": "Q", "anchor": [0, 0, 0], "axis": [0, 0, 1],
    "axes": {"angle": {"motor": {"velocity": 1}}}}], "probes": [{"name": "tip", "quantity": "position", "body": "P"},
    {"name": "all", "quantity": "energy"}], "events": [{)" +
      keys + "}]");
}

inline std::vector<BadScene> bad_events() {
  const std::string at = R"("name": "x", "at": 1, "do": )",
                    when = R"("name": "x", "do": [{"end": true}], "when": )";
  return {
      {event(R"("at": 1, "do": [{"end": true}])"), "/events/0", R"("name" is missing)", ""},
      {event(R"("name": "x", "do": [{"end": true}])"), "/events/0", R"(one of "at", "when" is missing)", ""},
      {event(R"("name": "x", "at": 1)"), "/events/0", R"("do" is missing)", ""},
      {event(at + "[]"), "/events/0", "event x: must do something", R"({"at":1,"do":[],"name":"x"})"},
      {event(at + R"([{"attach": "hop"}])"), "/events/0/do/0/attach",
       R"(there is no joint of this name; did you mean "hip"?)", R"("hop")", false},
      {event(at + R"([{"attach": "hip", "where": "open"}])"), "/events/0/do/0/where",
       R"(must be one of "closed", "as_is")", R"("open")"},
      {event(at + R"([{"motor": {"joint": "hip", "axis": "angel"}, "target": 1}])"),
       "/events/0/do/0/motor/axis", "axis of hip: there is none of this name, only angle", R"("angel")",
       false},
      {event(at + R"([{"motor": {"joint": "hip", "axis": "angle"}}])"), "/events/0",
       "event x: motor of hip angle: needs a target, a largest force, or to be removed",
       R"({"at":1,"do":[{"motor":{"axis":"angle","joint":"hip"}}],"nam...)"},
      {event(at + R"([{"load": "p", "force": [0, 0, 1]}])"), "/events/0/do/0/load",
       R"(there is no body of this name; did you mean "P"?)", R"("p")", false},
      {event(at + R"([{"load": "P", "force": [0, 0, 1], "duration": 0}])"), "/events/0/do/0/duration",
       "must be finite and positive", "0"},
      {event(at + R"([{"end": false}])"), "/events/0/do/0/end", "must be true", "false"},
      {event(when + R"({"quantity": "axis", "axis": {"joint": "hip", "axis": "angle"}})"), "/events/0/when",
       R"(one of "rises_above", "falls_below", "passes" is missing)", ""},
      {event(when + R"({"quantity": "pace", "body": "P", "passes": 1})"), "/events/0/when/quantity",
       R"(must be one of "position", "velocity", "angular-velocity", "distance", "axis", "axis-rate", "reaction-force", )"
       R"("reaction-torque", "gap", "contact-gap")",
       R"("pace")"},
      {event(when + R"({"probe": "top", "passes": 1})"), "/events/0/when/probe",
       R"(there is no probe of this name; did you mean "tip"?)", R"("top")", false},
      {event(when + R"({"probe": "all", "passes": 1})"), "/events/0/when/probe",
       "must be a probe of a position, velocity, reaction, gap or axis", R"("all")", false},
  };
}

inline std::vector<BadScene> bad_forces_and_probes() {
  return {
      {force(R"("body": "P", "force": [0, 0, 1])"), "/forces/0", R"("type" is missing)", ""},
      {force(R"("type": "callback", "body": "P")"), "/forces/0/type",
       R"(must be one of "point-force", "torque", "acceleration", "spring-damper")", R"("callback")"},
      {force(R"("type": "point-force", "body": "P")"), "/forces/0", R"("force" is missing)", ""},
      {force(R"("type": "torque", "body": "X", "torque": [0, 0, 1])"), "/forces/0/body",
       "there is no body of this name", R"("X")", false},
      {force(R"("type": "torque", "body": "P", "torque": [0, 0, 1], "point": [0, 0, 1])"), "/forces/0/point",
       R"(unknown key; known here are "body", "factor", "follows_body", "torque", "type")", "[0,0,1]"},
      {force(R"("type": "spring-damper", "a": "P", "b": "Q", "anchor": [0, 0, 0], "stiffness": -1)"),
       "/forces/0/stiffness", "must be finite and not negative", "-1"},
      {force(R"("type": "spring-damper", "a": "P", "b": "Q", "anchor": [0, 0, 0])"), "/forces/0",
       R"("stiffness" is missing)", ""},
      {force(R"("type": "spring-damper", "a": "P", "b": "Q", "anchor": [0, 0, 0], "table": [])"),
       "/forces/0/table", "curve: must have a point", "[]"},
      {force(R"("type": "spring-damper", "a": "P", "b": "Q", "anchor": [0, 0, 0], "stiffness": 1, )"
             R"("damping_table": [[1, 0], [0, 2]])"),
       "/forces/0/damping_table", "curve point 2: must lie to the right of the point before it",
       "[[1,0],[0,2]]", false},
      {probe(R"("name": "x", "quantity": "energie")"), "/probes/0/quantity",
       R"(must be one of "position", "velocity", "orientation", "angular-velocity", "reaction-force", )"
       R"("reaction-torque", "gap", "energy", "momentum", "angular-momentum", "axis", "axis-force", "axis-power", )"
       R"("axis-state"; did you mean "energy"?)",
       R"("energie")"},
      {probe(R"("quantity": "energy")"), "/probes/0", R"("name" is missing)", ""},
      {probe(R"("name": "x", "quantity": "energy", "body": "P")"), "/probes/0/body",
       R"(unknown key; known here are "name", "quantity")", R"("P")"},
      {probe(R"("name": "x", "quantity": "axis", "axis": {"joint": "j", "axis": "angle"})"),
       "/probes/0/axis/joint", "there is no joint of this name", R"("j")", false},
      {probe(R"("name": "x", "quantity": "axis-force")"), "/probes/0", R"("axis" is missing)", ""},
      {probe(R"("name": "x", "quantity": "gap")"), "/probes/0", R"("joint" is missing)", ""},
      {probe(R"("name": "x", "quantity": "gap", "joint": "j")"), "/probes/0/joint",
       "there is no joint of this name", R"("j")", false},
      {probe(R"("name": "x", "quantity": "position", "body": "P", "point": [0])"), "/probes/0/point",
       "must be an array of 3 numbers", "[0]"},
      {probe(R"("name": "x", "quantity": "energy"}, {"name": "x", "quantity": "momentum")"), "/probes/1/name",
       "name is already taken by another probe", R"("x")", false},
  };
}

inline std::vector<BadScene> bad_blocks() {
  const auto block = [](const std::string& keys) { return top(R"("generate": [{)" + keys + "}]"); };
  return {
      {block(R"("parameters": {})"), "/generate/0", R"("builder" is missing)", ""},
      {block(R"("builder": "chain", "parameters": {"n": 2.5})"), "/generate/0/parameters/n",
       "must be a whole number from 1 to 1e+06", "2.5", false},
      {block(R"("builder": "chain", "parameters": {"n": -1})"), "/generate/0/parameters/n",
       "must be a whole number from 1 to 1e+06", "-1", false},
      {block(R"("builder": "chain", "parameters": {"n": "2"})"), "/generate/0/parameters/n",
       "must be a number", R"("2")"},
      {block(R"("builder": "chain", "parameters": {"m": 2})"), "/generate/0/parameters/m",
       R"(unknown key; known here are "n")", "2", false},
      {block(R"("builder": "chain", "prefix": "")"), "/generate/0/prefix",
       "must be a string that is not empty", R"("")"},
      {block(R"("builder": "chain", "parameters": {"n": 2}}, {"builder": "chain", "parameters": {"n": 2})"),
       "/generate/1", R"(body "rod_0" is there already; give each block a "prefix" of its own)",
       R"({"builder":"chain","parameters":{"n":2}})", false},
      // Names of a block with problems are not known, so nothing that refers to them is blamed.
      {top(R"("generate": [{"builder": "chain", "size": 3}], "joints": [{"type": "ball", "a": "rod_0",
             "b": "rod_1", "anchor": [0, 0, 0]}])"),
       "/generate/0/size",
       R"(unknown key; known here are "builder", "orientation", "parameters", "position", "prefix")", "3"},
  };
}

/// Texts with exactly one problem each.
inline std::vector<BadScene> bad_scenes() {
  std::vector<BadScene> all;
  for (const auto& group :
       {bad_top_level(), bad_bodies(), bad_joints(), bad_axes(), bad_forces_and_probes(), bad_events(),
        bad_blocks(), bad_shapes(), bad_masses_of_shapes(), bad_materials_and_pairs(), bad_wires_and_curves(),
        bad_joint_properties(), bad_ends(), bad_names()})
    all.insert(all.end(), group.begin(), group.end());
  return all;
}

}  // namespace taut::scene_file_cases
