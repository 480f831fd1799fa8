#pragma once

#include "tests/scenes/files/scene_file_cases.h"

/// Bad shapes, materials, pairs, wires and properties of joints; one problem in each.
namespace taut::scene_file_cases {

inline std::string shape(const std::string& keys) {
  return R"({"format": "taut-scene/1", "materials": {"ice": {"static_friction": 0.1}}, "bodies": [
      {"name": "S", "density": 1, "shapes": [{)" +
         keys + "}]}]}";
}
inline std::string sphere(const std::string& keys) {
  return shape(R"("type": "sphere", "radius": 1, )" + keys);
}
inline std::string material(const std::string& keys) {
  return R"({"format": "taut-scene/1", "materials": {"m": {)" + keys + "}}}";
}

inline std::vector<BadScene> bad_shapes() {
  const std::string at = "/bodies/0/shapes/0";
  const std::string mesh = R"("type": "triangle_mesh", "vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], )";
  const std::string field = R"("type": "height_field", "nx": 2, "ny": 2, "dx": 1, "dy": 1, )";
  return {
      {shape(R"("radius": 1)"), at, R"("type" is missing)", ""},
      {shape(R"("type": "torus", "radius": 1)"), at + "/type",
       R"(must be one of "box", "sphere", "ellipsoid", "rod", "cylinder", "capsule", "cone", "convex_hull", )"
       R"("triangle_mesh", "half_space", "height_field")",
       R"("torus")"},
      {shape(R"("type": "sphere", "radius": 0)"), at + "/radius", "must be finite and positive", "0"},
      {shape(R"("type": "box", "size": [1, -1, 1])"), at + "/size", "must be 3 positive numbers", "[1,-1,1]"},
      {shape(R"("type": "cylinder", "radius": 1, "length": 0)"), at + "/length",
       "must be finite and positive", "0"},
      {shape(R"("type": "capsule", "radius": 1, "length": -1)"), at + "/length",
       "must be finite and not negative", "-1"},
      {shape(R"("type": "cone", "radius": 1)"), at, R"("height" is missing)", ""},
      {sphere(R"("size": [1, 1, 1])"), at + "/size",
       R"(unknown key; known here are "collides_with", "density", "groups", "material", "orientation", )"
       R"("position", "radius", "type")",
       "[1,1,1]"},
      {sphere(R"("position": [0, 0])"), at + "/position", "must be an array of 3 numbers", "[0,0]"},
      {sphere(R"("position": [0, 1e999, 0])"), at + "/position/1", "must be finite", "inf", false},
      {sphere(R"("orientation": [0, 0, 0, 0])"), at + "/orientation", "must not be 0: it has no direction",
       "[0,0,0,0]", false},
      {sphere(R"("density": 0)"), at + "/density", "must be finite and positive", "0"},
      {sphere(R"("groups": [32])"), at + "/groups/0", "must be a whole number from 0 to 31", "32"},
      {sphere(R"("collides_with": [0, 1.5])"), at + "/collides_with/1", "must be a whole number from 0 to 31",
       "1.5"},
      {sphere(R"("groups": 1)"), at + "/groups", "must be an array of groups", "1"},
      // Hulls, meshes and height fields.
      {shape(R"("type": "convex_hull", "points": [[0,0,0],[1,0,0],[0,1,0]])"), at,
       "convex hull: needs at least four points",
       R"({"points":[[0,0,0],[1,0,0],[0,1,0]],"type":"convex_hull"})"},
      {shape(R"("type": "convex_hull", "points": [[0,0,0],[1,0,0],[0,1,0],[1,1,0]])"), at,
       "convex hull: hull without volume: all points in one plane, on a line or in one place; extent [m]",
       R"({"points":[[0,0,0],[1,0,0],[0,1,0],[1,1,0]],"type":"convex_h...)", false},
      {shape(R"("type": "convex_hull", "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,"1"]])"), at + "/points/3/2",
       "must be a number", R"("1")"},
      {shape(R"("type": "convex_hull", "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,-1e999]])"),
       at + "/points/3/2", "must be finite", "-inf", false},
      {shape(mesh + R"("triangles": [])"), at, "triangle mesh: has no triangles",
       R"({"triangles":[],"type":"triangle_mesh","vertices":[[0,0,0],[...)"},
      {shape(mesh + R"("triangles": [[0, 1]])"), at + "/triangles/0", "must be 3 indices of vertices, from 0",
       "[0,1]"},
      {shape(mesh + R"("triangles": [[0, 1, -1]])"), at + "/triangles/0",
       "must be 3 indices of vertices, from 0", "[0,1,-1]"},
      {shape(mesh + R"("triangles": [[0, 1, 0.5]])"), at + "/triangles/0",
       "must be 3 indices of vertices, from 0", "[0,1,0.5]"},
      {shape(mesh + R"("triangles": [[0, 1, 4]])"), at, "triangle mesh, triangle 0: no such vertex",
       R"({"triangles":[[0,1,4]],"type":"triangle_mesh","vertices":[[0...)", false},
      {shape(mesh + R"("triangles": [[0, 1, 1]])"), at, "triangle mesh, triangle 0: has no area",
       R"({"triangles":[[0,1,1]],"type":"triangle_mesh","vertices":[[0...)", false},
      {shape(mesh + R"("triangles": [[0, 1, 2]])"), at,
       "mass of triangle mesh: the mesh is not closed at the edge between vertices",
       R"({"triangles":[[0,1,2]],"type":"triangle_mesh","vertices":[[0...)", false},
      {shape(mesh + R"("triangles": [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])"), at,
       "mass of triangle mesh: the mesh is inside out; volume [m³]",
       R"({"triangles":[[0,1,2],[0,3,1],[0,2,3],[1,3,2]],"type":"trian...)", false},
      {shape(R"("type": "triangle_mesh", "vertices": [])"), at, R"("triangles" is missing)", ""},
      {shape(R"("type": "triangle_mesh", "file": "none.obj", "vertices": [])"), at + "/vertices",
       R"("file" is given as well)", "[]"},
      {shape(R"("type": "convex_hull", "file": "none.txt")"), at + "/file",
       "mesh file none.txt: must be .obj or .stl", R"("none.txt")", false},
      {shape(R"("type": "convex_hull", "file": "none.obj", "scale": 0)"), at + "/scale",
       "must be finite and positive", "0"},
      {shape(R"("type": "triangle_mesh", "file": 3)"), at + "/file", "must be a string that is not empty",
       "3"},
      {shape(field + R"("heights": [0, 0, 0])"), at, "height field: must have nx·ny heights",
       R"({"dx":1,"dy":1,"heights":[0,0,0],"nx":2,"ny":2,"type":"heigh...)", false},
      {shape(field + R"("heights": [0, 0, 0, 1e999])"), at + "/heights/3", "must be finite", "inf", false},
      {shape(field + R"("heights": [0, 0, 0, 0])"), at, "mass of height field: has no volume",
       R"({"dx":1,"dy":1,"heights":[0,0,0,0],"nx":2,"ny":2,"type":"hei...)", false},
      {shape(R"("type": "height_field", "nx": 1, "ny": 2, "dx": 1, "dy": 1, "heights": [0, 0])"), at,
       "height field nx: needs at least two heights",
       R"({"dx":1,"dy":1,"heights":[0,0],"nx":1,"ny":2,"type":"height_...)"},
      {shape(R"("type": "half_space")"), at, "mass of half-space: has no volume", R"({"type":"half_space"})",
       false},
  };
}

inline std::vector<BadScene> bad_masses_of_shapes() {
  const auto body = [](const std::string& keys) {
    return R"({"format": "taut-scene/1", "bodies": [{)" + keys + "}]}";
  };
  const std::string ball = R"({"type": "sphere", "radius": 1})",
                    heavy = R"({"type": "sphere", "radius": 1, "density": 2})";
  const std::string no_effect = "has no effect, since the mass does not come from the shapes";
  return {
      {body(R"("shapes": [)" + ball + "]"), "/bodies/0", R"(one of "mass", "density" is missing)", ""},
      {body(R"("shapes": [)" + heavy + ", " + ball + "]"), "/bodies/0",
       R"(one of "mass", "density" is missing)", ""},
      {body(R"("density": 1, "shapes": [])"), "/bodies/0",
       R"(one of "inertia", "shape", "shapes", "rod", "capsule", "beam" is missing)", ""},
      {body(R"("mass": 1, "density": 1, "shapes": [)" + ball + "]"), "/bodies/0/density",
       R"(only one of "mass", "density" may be given)", "1"},
      {body(R"("mass": 1, "shapes": [)" + heavy + ", " + ball + "]"), "/bodies/0/mass",
       "all of the shapes or none of them must have a density", "1"},
      {body(R"("mass": 1, "inertia": [1, 1, 1], "shapes": [)" + heavy + "]"), "/bodies/0/shapes/0/density",
       no_effect, "2"},
      {body(R"("mass": 1, "shape": {"type": "sphere", "radius": 1}, "shapes": [)" + heavy + "]"),
       "/bodies/0/shapes/0/density", no_effect, "2"},
      {body(R"("density": 1, "shapes": 3)"), "/bodies/0/shapes", "must be an array of shapes", "3"},
      {body(R"("density": 1, "shapes": [3])"), "/bodies/0/shapes/0", "must be an object", "3"},
      {R"({"format": "taut-scene/1", "ground": {"shapes": [)" + heavy + "]}}", "/ground/shapes/0/density",
       "has no effect on the ground", "2"},
      {R"({"format": "taut-scene/1", "ground": {"mass": 1}})", "/ground/mass",
       R"(unknown key; known here are "shapes")", "1"},
  };
}

inline std::vector<BadScene> bad_materials_and_pairs() {
  const auto pair = [](const std::string& keys) {
    return two_bodies(R"("ground": {"shapes": [{"type": "half_space"}]}, "pairs": [{)" + keys + "}]");
  };
  const auto materials = [](const std::string& pairs) {
    return R"({"format": "taut-scene/1", "materials": {"ice": {}, "tar": {}}, "material_pairs": [)" + pairs +
           "]}";
  };
  return {
      {materials(R"({"a": "ice", "b": "tor", "material": {}})"), "/material_pairs/0/b",
       R"(there is no material of this name; did you mean "tar"?)", R"("tor")", false},
      {materials(R"({"a": "ice", "material": {}})"), "/material_pairs/0", R"("b" is missing)", ""},
      {materials(R"({"a": "ice", "b": "tar"})"), "/material_pairs/0", R"("material" is missing)", ""},
      {materials(R"({"a": {}, "b": "tar", "material": {}})"), "/material_pairs/0/a",
       "must be a string that is not empty", "{}"},
      {materials(R"({"a": "ice", "b": "tar", "material": {"restitution": 2}})"),
       "/material_pairs/0/material/restitution", "must be between 0 and 1", "2"},
      {materials(R"({"a": "ice", "b": "tar", "material": {}}, {"a": "tar", "b": "ice", "material": {}})"),
       "/material_pairs/1", "these two materials are there already", R"({"a":"tar","b":"ice","material":{}})",
       false},
      {material(R"("restitution": -0.1)"), "/materials/m/restitution", "must be between 0 and 1", "-0.1"},
      {material(R"("restitution": 1.5)"), "/materials/m/restitution", "must be between 0 and 1", "1.5"},
      {material(R"("static_friction": -1)"), "/materials/m/static_friction",
       "must be finite and not negative", "-1"},
      {material(R"("static_friction": 0.2, "dynamic_friction": 0.3)"), "/materials/m",
       "static friction: must not be below dynamic friction",
       R"({"dynamic_friction":0.3,"static_friction":0.2})", false},
      {material(R"("rolling_friction": "1")"), "/materials/m/rolling_friction", "must be a number", R"("1")"},
      {material(R"("rolling_friction_linear": -0.1)"), "/materials/m/rolling_friction_linear",
       "must be finite and not negative", "-0.1"},
      {material(R"("spinning_friction_linear": true)"), "/materials/m/spinning_friction_linear",
       "must be a number", "true"},
      {material(R"("friction": 1)"), "/materials/m/friction",
       R"(unknown key; "friction" is called "static_friction" here)", "1"},
      {R"({"format": "taut-scene/1", "materials": [1]})", "/materials", "must be an object", "[1]"},
      {sphere(R"("material": "icy")"), "/bodies/0/shapes/0/material",
       R"(there is no material of this name; did you mean "ice"?)", R"("icy")", false},
      {sphere(R"("material": 3)"), "/bodies/0/shapes/0/material",
       "must be the name of a material, or a material", "3"},
      {sphere(R"("material": {"restitution": 2})"), "/bodies/0/shapes/0/material/restitution",
       "must be between 0 and 1", "2"},
      {pair(R"("a": "P", "b": "Q")"), "/pairs/0", R"(one of "collide", "material" is missing)", ""},
      {pair(R"("a": "P", "b": "R", "collide": true)"), "/pairs/0/b", "there is no body of this name",
       R"("R")", false},
      {pair(R"("a": "P", "collide": true)"), "/pairs/0", R"("b" is missing)", ""},
      {pair(R"("a": "P", "b": "P", "collide": true)"), "/pairs/0/b", R"(is the same body as "a")", R"("P")",
       false},
      {pair(R"("a": "P", "b": "Q", "collide": 1)"), "/pairs/0/collide", "must be true or false", "1"},
      {pair(R"("a": "P", "b": "ground", "material": {})"), "/pairs/0/a", "has no shapes", R"("P")", false},
      {pair(R"("a": "ground", "b": "Q", "collide": true, "shape_a": 0)"), "/pairs/0/shape_a",
       R"(needs a "material")", "0"},
      {R"({"format": "taut-scene/1", "ground": {"shapes": [{"type": "half_space"}]}, "bodies": [{"name": "S",
          "density": 1, "shapes": [{"type": "sphere", "radius": 1}]}], "pairs": [{"a": "S", "b": "ground",
          "material": {}, "shape_b": 1}]})",
       "/pairs/0/shape_b", "must be the index of one of the 1 shapes, from 0", "1", false},
  };
}

inline std::string joint_of(const std::string& keys) { return two_bodies(R"("joints": [{)" + keys + "}]"); }

inline std::vector<BadScene> bad_wires_and_curves() {
  const std::string P = R"({"body": "P", "point": [0, 0, 0]})", Q = R"({"body": "Q", "point": [0, 0, 0]})",
                    G = R"({"body": "ground", "point": [0, 0, 3]})";
  const auto pulley = [](const std::string& points, const std::string& more = "") {
    return joint_of(R"("type": "pulley", "frame": "body")" + more + R"(, "points": [)" + points + "]");
  };
  const std::string curve = R"("type": "point_on_curve", "a": "ground", "b": "P", )";
  const std::string driver = R"("type": "pose_driver", "a": "ground", "b": "P", )";
  return {
      {pulley(P + "," + G + "," + Q), "/joints/0/points",
       "must be 4 points: of A, where the wire meets and leaves the sheaves, of B",
       R"([{"body":"P","point":[0,0,0]},{"body":"ground","point":[0,0,...)"},
      {pulley(P + "," + G + "," + G + "," + P), "/joints/0", "pulley: must join two bodies",
       R"({"frame":"body","points":[{"body":"P","point":[0,0,0]},{"bod...)", false},
      {pulley(P + "," + G + "," + G + "," + Q, R"(, "ratio": 0)"), "/joints/0/ratio",
       "must be finite and positive", "0"},
      {pulley(P + "," + G + "," + G + R"(, {"body": "X", "point": [0, 0, 0]})"), "/joints/0/points/3/body",
       "there is no body of this name", R"("X")", false},
      {pulley(P + "," + G + "," + G + R"(, {"body": "Q"})"), "/joints/0/points/3", R"("point" is missing)",
       ""},
      {joint_of(R"("type": "pulley", "points": [)" + P + "," + G + "," + G + "," + Q + "]"), "/joints/0",
       R"("frame" is missing)", ""},
      {joint_of(R"("type": "rope", "frame": "body", "points": [)" + P + "]"), "/joints/0",
       "rope: must have two points or more",
       R"({"frame":"body","points":[{"body":"P","point":[0,0,0]}],"typ...)"},
      {joint_of(R"("type": "rope", "frame": "body", "a": "P", "points": [)" + P + "," + Q + "]"),
       "/joints/0/a",
       R"(unknown key; known here are "attached", "axes", "break", "compliance", "frame", "length", "name", )"
       R"("points", "restitution", "stop", "type")",
       R"("P")"},
      {joint_of(R"("type": "rope", "frame": "world", "length": -1, "points": [)" + P + "," + Q + "]"),
       "/joints/0/length", "must be finite and positive", "-1"},
      {joint_of(curve + R"("anchor": [1, 0, 0])"), "/joints/0", R"("points" is missing)", ""},
      {joint_of(curve + R"("anchor": [1, 0, 0], "points": [[1, 0, 0]])"), "/joints/0",
       "spline: must have more points", R"({"a":"ground","anchor":[1,0,0],"b":"P","points":[[1,0,0]],"t...)"},
      {joint_of(curve + R"("anchor": [1, 0, 0], "points": [[1, 0, 0], [1, 0, 0]])"), "/joints/0",
       "spline parameter 2: must exceed the one before it",
       R"({"a":"ground","anchor":[1,0,0],"b":"P","points":[[1,0,0],[1,...)", false},
      {joint_of(curve + R"("anchor": [1, 0, 0], "points": [[1, 0, 0], [2, 0, 0]], "parameters": [0, 1, 2])"),
       "/joints/0", "spline: must have one parameter per point",
       R"({"a":"ground","anchor":[1,0,0],"b":"P","parameters":[0,1,2],...)", false},
      {joint_of(
           curve +
           R"("anchor": [1, 0, 0], "closed": true, "points": [[1, 0, 0], [2, 1, 0], [2, 0, 0], [0, 0, 1]])"),
       "/joints/0", "spline: must end where it starts to be closed",
       R"({"a":"ground","anchor":[1,0,0],"b":"P","closed":true,"points...)", false},
      {joint_of(curve + R"("anchor_b": [0, 0, 0], "points": [[1, 0, 0], [2, 0, 0]])"), "/joints/0",
       R"("frame" is missing: "world" or "body" for "anchor_b")", ""},
      {joint_of(curve + R"("points": [[1, 0, 0], [2, 0, 0]])"), "/joints/0", R"("anchor" is missing)", ""},
      {joint_of(driver + R"("position": [1, 0])"), "/joints/0/position",
       "must be an array of 3 numbers or motions", "[1,0]"},
      {joint_of(driver + R"("position": [1, 0, "0"])"), "/joints/0/position/2", "must be an object",
       R"("0")"},
      {joint_of(driver + R"("turns": [{"axis": [0, 0, 1]}])"), "/joints/0/turns/0", R"("angle" is missing)",
       ""},
      {joint_of(driver + R"("turns": [{"axis": [0, 0, 0], "angle": 1}])"), "/joints/0/turns/0/axis",
       "must not be 0: it has no direction", "[0,0,0]", false},
      {joint_of(driver + R"("turns": [{"axis": [0, 0, 1], "angle_deg": {"linear": {"rate": 1}}}])"),
       "/joints/0/turns/0/angle_deg", "must be a number", R"({"linear":{"rate":1}})"},
      {joint_of(driver + R"("position": [2, 0, 0])"), "/joints/0",
       R"(pose_driver "joint_0" must be closed at the start to 1e-06 m or rad, but has a gap; "assemble": true )"
       "lets the simulator close it",
       "1 m", false},
  };
}

inline std::vector<BadScene> bad_joint_properties() {
  const auto ball = [](const std::string& keys) {
    return joint_of(R"("name": "j", "type": "ball", "a": "P", "b": "Q", "anchor": [0, 0, 0], )" + keys);
  };
  const std::string swing = R"("frame_orientation": [1, 0, 0, 0], "axes": )";
  return {
      {ball(R"("compliance": 1)"), "/joints/0/compliance", "must be an object", "1"},
      {ball(R"("compliance": {"translation": -1})"), "/joints/0/compliance/translation",
       "must be finite and not negative", "-1"},
      {ball(R"("compliance": {"translation": "inf"})"), "/joints/0/compliance/translation",
       "must be a number", R"("inf")"},
      {ball(R"("compliance": {"translation": "infinite"})"), "/joints/0/compliance",
       "j translation compliance: must be finite without damping", R"({"translation":"infinite"})", false},
      {ball(R"("compliance": {})"), "/joints/0/compliance",
       R"(at least one of "translation", "rotation", "translation_damping", "rotation_damping" is missing)",
       ""},
      {ball(R"("break": {})"), "/joints/0/break", R"(at least one of "force", "torque" is missing)", ""},
      {ball(R"("break": {"force": 0})"), "/joints/0/break/force", "must be finite and positive", "0"},
      {ball(R"("break": {"moment": 1})"), "/joints/0/break/moment",
       R"(unknown key; "moment" is called "torque" here)", "1"},
      {ball(R"("attached": 1)"), "/joints/0/attached", "must be true or false", "1"},
      {ball(R"("orientation_a": [1, 0, 0, 0])"), "/joints/0", R"("orientation_b" is missing)", ""},
      {ball(R"("frame_orientation": [1, 0, 0, 0], "orientation_a": [1, 0, 0, 0])"), "/joints/0/orientation_a",
       R"("frame_orientation" is given as well)", "[1,0,0,0]"},
      {ball(R"("axes": {"swing": {}})"), "/joints/0/axes/swing", "axis of j: the joint has no free axis",
       "{}", false},
      {ball(swing + R"({"turn_x": {"spring": {"stiffness": 1}}})"), "/joints/0/axes/turn_x/spring",
       "spring of j turn_x: needs an axis with a position, not a turn about", R"({"stiffness":1})", false},
      {ball(swing + R"({"swing": {"limits": {"upper": 1, "compliance": 1, "restitution": 0.5}}})"),
       "/joints/0/axes/swing/limits", "restitution of j swing: must be 0 beside a compliance",
       R"({"compliance":1,"restitution":0.5,"upper":1})", false},
      {ball(swing + R"({"swing": {"motor": {"trajectory": 3}}})"), "/joints/0/axes/swing/motor/trajectory",
       "must be an object", "3"},
      {ball(swing + R"({"swing": {"friction": {"per_load": -1}}})"), "/joints/0/axes/swing/friction/per_load",
       "must be finite and not negative", "-1"},
      {ball(swing + R"({"swing": {"value": "x"}})"), "/joints/0/axes/swing/value", "must be a number",
       R"("x")"},
      // Names may hold any character.
      {ball(swing + R"({"\u0000": {}})"), std::string("/joints/0/axes/\0", 16),
       "axis of j: there is none of this name, only swing, twist, turn_x, turn_y, turn_z, swing_x, swing_y",
       "{}", false},
      {R"({"format": "taut-scene/1", "materials": {"\u0000": 1}})", std::string("/materials/\0", 12),
       "must be an object", "1"},
      {R"({"format": "taut-scene/1", "time": "now"})", "/time", "must be a number", R"("now")"},
  };
}

}  // namespace taut::scene_file_cases
