#pragma once

#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

/// Scene texts shared by the tests of the reader and of the schema.
namespace taut::scene_file_cases {

/// Bodies P at (1, 0, 0), turned by 90° about z, and Q at (2, 0, 0), with more keys at the top.
inline std::string two_bodies(const std::string& more) {
  return R"({"format": "taut-scene/1", "bodies": [
      {"name": "P", "mass": 1, "inertia": [1, 1, 1], "position": [1, 0, 0],
       "orientation": {"axis": [0, 0, 1], "angle_deg": 90}},
      {"name": "Q", "mass": 1, "inertia": [1, 1, 1], "position": [2, 0, 0]}], )" +
         more + "}";
}

/// Uses every key of the format.
inline constexpr const char* kEverything = R"({
  "$schema": "taut-scene.schema.json", "format": "taut-scene/1", "name": "everything",
  "gravity": [0, 0, -1.62], "dt": 0.01, "duration": 3, "time": 0.25, "energy_scale": 12, "assemble": true,
  "settings": {
    "integrator": "rattle", "position_tolerance": 1e-8, "velocity_tolerance": 1e-7,
    "max_newton_iterations": 7, "max_substeps": 64, "tension": "ignore", "max_tension_number": 0.5,
    "max_rotation": 0.25, "drift_cure": "position-push", "erp": 0.5, "cfm": 1e-9, "penalty_frequency": 30,
    "penalty_damping_ratio": 0.7, "theta": 0.75, "factor": "multifrontal", "solver": "pairwise",
    "iterations": 9, "relaxation": 1.5, "threads": 3, "contacts": false, "contact_margin": 0.01, "resting_speed": 0.02, "max_contacts": 5000,
    "inexact_tolerance": 1e-6, "sleep": true, "sleep_speed": 1e-3, "sleep_time": 0.75, "merge_fixed_joints": true, "report_energy": false, "report_rank": true},
  "generate": [{"builder": "chain", "parameters": {"n": 2}, "prefix": "c/", "position": [0, 9, 0],
                "orientation": [0, 0, 0, 1]}],
  "materials": {
    "ice": {"static_friction": 0.05, "dynamic_friction": 0.03},
    "rubber": {"restitution": 0.7, "dynamic_friction": 0.9, "rolling_friction": 0.001, "spinning_friction": 0.002,
               "rolling_friction_linear": 0.003, "spinning_friction_linear": 0.004, "compliance": 1e-6}},
  "ground": {"shapes": [
    {"type": "half_space", "material": "ice", "groups": [1, 31], "collides_with": [0]},
    {"type": "height_field", "nx": 2, "ny": 3, "dx": 1, "dy": 0.5, "heights": [0, 0.1, 0, 0.1, 0.2, 0.3]}]},
  "bodies": [
    {"name": "wall", "fixed": true, "position": [0, 0, 1]},
    {"name": "shapes", "density": 1000, "position": [5, 6, 7], "orientation": {"axis": [0, 0, 1], "angle_deg": 90},
     "velocity": [1, 0, 0], "shapes": [
      {"type": "box", "size": [1, 1, 1], "material": "rubber"},
      {"type": "sphere", "radius": 0.5, "position": [2, 0, 0], "material": {"static_friction": 0.7}},
      {"type": "ellipsoid", "radii": [1, 2, 3], "density": 1},
      {"type": "rod", "length": 2, "radius": 0.1, "orientation": {"axis": [0, 0, 1], "angle_deg": 90}},
      {"type": "cylinder", "radius": 0.1, "length": 2},
      {"type": "capsule", "radius": 0.1, "length": 0},
      {"type": "cone", "radius": 0.1, "height": 2, "orientation": {"rpy_deg": [90, 0, 0]}},
      {"type": "convex_hull", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.1, 0.1, 0.1]]},
      {"type": "triangle_mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
       "triangles": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]}]},
    {"name": "scaled", "mass": 5, "shapes": [{"type": "sphere", "radius": 0.5, "position": [0, 0, 1]}]},
    {"name": "plate", "fixed": true, "shapes": [{"type": "triangle_mesh",
     "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]]}]},
    {"name": "given", "mass": 5, "inertia": [1, 1, 1], "shapes": [{"type": "box", "size": [1, 1, 1]}]},
    {"name": "moments", "mass": 2, "inertia": [1, 2, 2.5], "position": [1, 2, 3], "velocity": [4, 5, 6],
     "angular_velocity": [7, 8, 9]},
    {"name": "matrix", "fixed": false, "mass": 2, "inertia": [[1, 0.1, 0], [0.1, 2, 0], [0, 0, 2.5]]},
    {"name": "box", "density": 100, "shape": {"type": "box", "size": [1, 2, 3]},
     "orientation": {"axis": [0, 0, 1], "angle_deg": 90}, "angular_velocity_body": [2, 0, 0]},
    {"name": "sphere", "mass": 2, "shape": {"type": "sphere", "radius": 0.5},
     "orientation": {"rpy_deg": [90, 0, 90]}},
    {"name": "ellipsoid", "mass": 2, "shape": {"type": "ellipsoid", "radii": [1, 2, 3]},
     "orientation": {"rpy_rad": [0, 0, 1]}},
    {"name": "rod", "mass": 2, "shape": {"type": "rod", "length": 2, "radius": 0.1}, "orientation": [0, 1, 0, 0]},
    {"name": "cylinder", "mass": 2, "shape": {"type": "cylinder", "radius": 0.1, "length": 2},
     "orientation": {"axis": [0, 0, 1], "angle_rad": 0.5}},
    {"name": "capsule", "mass": 2, "shape": {"type": "capsule", "radius": 0.1, "length": 2}},
    {"name": "cone", "mass": 2, "shape": {"type": "cone", "radius": 0.1, "height": 2}},
    {"name": "rod by ends", "density": 2, "rod": {"from": [20, 0, 0], "to": [20, 0, 2], "radius": 0.1, "material": "ice",
     "groups": [2], "collides_with": [0, 2]}},
    {"name": "capsule by ends", "mass": 2, "velocity": [1, 0, 0],
     "capsule": {"from": [21, 0, 0], "to": [21, 3, 4], "radius": 0.1, "material": {"restitution": 0.5},
     "groups": [2], "collides_with": []}},
    {"name": "beam", "fixed": true, "beam": {"from": [22, 0, 0], "to": [22, 3, 0], "width": 0.1, "height": 0.3,
     "up": [1, 0, 0], "material": "ice", "groups": [2], "collides_with": [0]}}
  ],
  "cables": [
    {"name": "line", "from": [20, 0, 2], "to": [20, 4, 2], "links": 4, "radius": 0.01, "mass": 2, "length": 5,
     "a": "rod by ends", "b": "ground", "material": "ice", "groups": [2], "collides_with": [0, 2]},
    {"name": "free", "from": [30, 0, 2], "to": [30, 4, 2], "links": 2, "radius": 0.01, "density": 1000}
  ],
  "joints": [
    {"name": "ball", "type": "ball", "a": "ground", "b": "c/rod_0", "anchor": [0, 0, 0],
     "frame_orientation": {"rpy_deg": [0, 90, 0]}, "compliance": {"translation": 1e-6, "translation_damping": 3},
     "break": {"force": 100, "torque": 30},
     "axes": {"swing": {"limits": {"upper": 0.5, "compliance": 1e-3, "damping": 2}},
              "turn_x": {"friction": {"static": 1, "per_load": 0.01}}}},
    {"name": "framed", "type": "ball", "a": "rod", "b": "cone", "anchor": [0, 0, 0], "orientation_a": [1, 0, 0, 0],
     "orientation_b": {"axis": [1, 0, 0], "angle_deg": 90}, "attached": false},
    {"name": "hinge", "type": "hinge", "a": "rod", "b": "cone", "anchor": [0, 0, 0], "axis": [0, 1, 0],
     "compliance": {"rotation": "infinite", "rotation_damping": 2},
     "axes": {"angle": {"value": 12.5, "motor": {"trajectory": {"linear": {"rate": 2}}}}}},
    {"name": "slider", "type": "slider", "a": "wall", "b": "cone", "frame": "body", "anchor_a": [0, 0, 0],
     "anchor_b": [0, 0, 0], "axis_a": [0, 1, 0], "orientation": [1, 0, 0, 0]},
    {"name": "fixed", "type": "fixed", "a": "rod", "b": "box", "anchor": [0, 0, 0], "orientation": [1, 0, 0, 0]},
    {"name": "universal", "type": "universal", "a": "rod", "b": "cone", "frame": "world", "anchor": [0, 0, 0],
     "axis_a": [0, 1, 0], "axis_b": [0, 0, 1]},
    {"name": "distance", "type": "distance", "a": "rod", "b": "cone", "frame": "world", "anchor_a": [0, 0, 0],
     "anchor_b": [0, 1, 0], "length": 2,
     "axes": {}},
    {"name": "cylindrical", "type": "cylindrical", "a": "rod", "b": "cone", "anchor": [0, 0, 0], "axis": [0, 1, 0]},
    {"name": "screw", "type": "screw", "a": "rod", "b": "cone", "anchor": [0, 0, 0], "axis": [0, 1, 0],
     "pitch": -0.1},
    {"name": "planar", "type": "planar", "a": "rod", "b": "cone", "frame": "body", "anchor_a": [0, 0, 0],
     "anchor_b": [0, 1, 0], "axis_a": [0, 1, 0], "axis_b": [0, 0, 1]},
    {"name": "point_on_line", "type": "point_on_line", "a": "rod", "b": "cone", "anchor": [0, 0, 0],
     "axis": [0, 1, 0], "axes": {"displacement": {"spring": {"table": [[-1, -2], [0, 0], [1, 3]], "damping_table": [[0, 0], [1, 3]]}}}},
    {"name": "hinge2", "type": "hinge2", "a": "rod", "b": "cone", "frame": "world", "anchor": [0, 0, 0],
     "axis_a": [0, 0, 1], "axis_b": [0, 1, 0], "axes": {
       "travel": {"limits": {"lower": -0.1, "upper": 0.2, "restitution": 0.5},
                  "spring": {"stiffness": 1e4, "damping": 300, "rest": 0.1}},
       "steering": {"motor": {"position": 0.2, "max_force": 50, "max_speed": 2}},
       "spin": {"motor": {"velocity": -3, "force_of_speed": [[0, 100], [300, 20]]},
                "friction": {"static": 2, "dynamic": 1.5, "viscous": 0.1}}}},
    {"name": "six_dof", "type": "six_dof", "a": "rod", "b": "cone", "anchor": [0, 0, 0],
     "locked": ["x", "z", "angle_x", "angle_y"], "frame_orientation": {"axis": [0, 0, 1], "angle_deg": 90}},
    {"name": "rope", "type": "rope", "a": "rod", "b": "cone", "frame": "body", "anchor_a": [0, 0, 0],
     "anchor_b": [0, 0, 0], "length": 9, "restitution": 0.25},
    {"name": "threaded", "type": "rope", "frame": "world", "restitution": 0.5, "points": [
     {"body": "rod", "point": [0, 0, 0]}, {"body": "wall", "point": [0, 0, 1]}, {"body": "cone", "point": [0, 3, 1]}]},
    {"name": "pulley", "type": "pulley", "frame": "body", "ratio": 2, "points": [
     {"body": "rod", "point": [0, 0, 0]}, {"body": "ground", "point": [0, 0, 1]},
     {"body": "ground", "point": [0, 1, 1]}, {"body": "cone", "point": [0, 0, 0]}]},
    {"name": "point_on_curve", "type": "point_on_curve", "a": "wall", "b": "cone", "anchor": [0, 0, 1],
     "points": [[0, 0, 0], [0, 0, 1], [1, 0, 2], [0, 0, 0]], "parameters": [0, 1, 2, 3.5], "closed": true},
    {"name": "pose_driver", "type": "pose_driver", "a": "wall", "b": "moments",
     "position": [1, {"linear": {"value": 2, "rate": 0.5}}, 2], "orientation": [1, 0, 0, 0],
     "turns": [{"axis": [0, 0, 1], "angle": {"harmonic": {"amplitude": 0.2, "omega": 3}}},
               {"axis": [1, 0, 0], "angle": 0.5}]},
    {"name": "second", "type": "hinge", "a": "rod", "b": "box", "anchor": [0, 0, 0], "axis": [0, 1, 0]},
    {"name": "third", "type": "hinge", "a": "rod", "b": "sphere", "anchor": [0, 0, 0], "axis": [0, 1, 0]},
    {"name": "gear", "type": "gear", "driving": {"joint": "hinge", "axis": "angle"},
     "driven": {"joint": "second", "axis": "angle"}, "ratio": -2.5},
    {"name": "rack_and_pinion", "type": "rack_and_pinion", "pinion": {"joint": "hinge", "axis": "angle"},
     "rack": {"joint": "slider", "axis": "displacement"}, "radius": 0.1},
    {"name": "differential", "type": "differential", "input": {"joint": "hinge", "axis": "angle"},
     "left": {"joint": "second", "axis": "angle"}, "right": {"joint": "third", "axis": "angle"}},
    {"name": "driver", "type": "driver", "of": {"joint": "hinge", "axis": "angle"},
     "motion": {"harmonic": {"mean": 0.1, "amplitude": 2, "omega": 3, "phase": 0.5}}},
    {"type": "driver", "of": {"joint": "second", "axis": "angle"},
     "motion": {"linear": {"value": 1, "rate": 2, "start": 0.5}}},
    {"type": "driver", "of": {"joint": "third", "axis": "angle"},
     "motion": {"spline": [[0, 0], [1, 2], [2, 1]]}},
    {"type": "driver", "of": {"joint": "slider", "axis": "displacement"},
     "motion": {"speeds": [[0, 0], [1, 2]], "value": 0.5}},
    {"name": "tower", "type": "hinge", "a": "rod", "b": "capsule", "anchor": [0, 0, 0], "axis": [0, 1, 0],
     "axes": {"angle": {"motor": {"trajectory": {"ramp": {"from": 0, "to": 1, "start": 2, "duration": 3, "smooth": true}}}}}},
    {"name": "clamp", "type": "fixed", "a": "rod", "b": "ground", "anchor": [0, 0, 0], "attached": false}
  ],
  "pairs": [
    {"a": "shapes", "b": "ground", "shape_a": 0, "shape_b": 1, "material": "ice"},
    {"a": "given", "b": "plate", "collide": false, "material": {"restitution": 0.5}},
    {"a": "rod", "b": "cone", "collide": true}
  ],
  "forces": [
    {"type": "point-force", "body": "rod", "point": [1, 0, 0], "force": [0, 0, 3], "follows_body": true},
    {"type": "torque", "body": "rod", "torque": [0, 0, 3], "follows_body": false},
    {"type": "spring-damper", "a": "rod", "b": "cone", "frame": "body", "anchor_a": [0, 0, 0],
     "anchor_b": [0, 0, 0], "stiffness": 3, "rest_length": 0.5, "damping": 0.1},
    {"type": "spring-damper", "a": "rod", "b": "cone", "anchor": [0, 0, 0], "stiffness": 3},
    {"type": "spring-damper", "a": "rod", "b": "cone", "anchor": [0, 0, 0], "rest_length": 0.2,
     "table": [[-1, -2], [1, 3]], "damping_table": [[-1, -1], [0, 0], [1, 3]]},
    {"type": "point-force", "body": "rod", "force": [0, 0, 3], "factor": {"gust": {"peak": 2, "start": 1, "duration": 0.5}}},
    {"type": "torque", "body": "rod", "torque": [0, 0, 3], "factor": {"table": [[0, 0], [1, 2], [2, 0]], "periodic": true}},
    {"type": "acceleration", "acceleration": [0, 0, 3], "bodies": ["rod", "cone"],
     "factor": {"harmonics": {"mean": 1, "terms": [{"amplitude": 2, "omega": 3, "phase": 0.5}, {"amplitude": 1, "omega": 5}]}}},
    {"type": "acceleration", "acceleration": [1, 0, 0]}
  ],
  "events": [
    {"name": "e0", "at": 0.5, "do": [{"attach": "clamp", "where": "as_is"}, {"attach": "clamp", "where": "closed", "tolerance": 1e-3},
     {"detach": "clamp"}, {"gravity": [0, 0, -1]}, {"end": true}]},
    {"name": "e1", "when": {"quantity": "position", "body": "rod", "point": [0.5, 0, 0], "along": [0, 0, 1], "rises_above": 2, "each_time": true, "located": false},
     "do": [{"motor": {"joint": "hinge2", "axis": "spin"}, "target": 3, "max_force": 20}, {"motor": {"joint": "tower", "axis": "angle"}, "remove": true}]},
    {"name": "e2", "when": {"quantity": "velocity", "body": "rod", "point": [0.5, 0, 0], "falls_below": 2}, "do": [
     {"load": "rod", "point": [1, 0, 0], "force": [1, 0, 0], "torque": [0, 1, 0], "follows_body": true, "duration": 2, "factor": {"ramp": {"to": 1, "duration": 1}}}]},
    {"name": "e3", "when": {"quantity": "angular-velocity", "body": "rod", "along": [1, 0, 0], "passes": 2}, "do": [{"end": true}]},
    {"name": "e4", "when": {"quantity": "distance", "a": "rod", "b": "cone", "point_a": [1, 0, 0], "point_b": [0, 0, 0], "passes": 2}, "do": [{"end": true}]},
    {"name": "e5", "when": {"quantity": "axis", "axis": {"joint": "tower", "axis": "angle"}, "passes": 2}, "do": [{"end": true}]},
    {"name": "e6", "when": {"quantity": "axis-rate", "axis": {"joint": "tower", "axis": "angle"}, "passes": 2}, "do": [{"end": true}]},
    {"name": "e7", "when": {"quantity": "reaction-force", "joint": "tower", "along": [0, 0, 1], "passes": 2}, "do": [{"end": true}]},
    {"name": "e8", "when": {"quantity": "reaction-torque", "joint": "tower", "passes": 2}, "do": [{"end": true}]},
    {"name": "e9", "when": {"quantity": "gap", "joint": "clamp", "falls_below": 2}, "do": [{"end": true}]},
    {"name": "e10", "when": {"quantity": "contact-gap", "a": "shapes", "b": "ground", "falls_below": 0.001}, "do": [{"end": true}]},
    {"name": "e11", "when": {"probe": "p0", "along": [1, 0, 0], "passes": 2}, "do": [{"end": true}]},
    {"name": "e12", "when": {"probe": "p10", "passes": 2}, "do": [{"end": true}]}
  ],
  "probes": [
    {"name": "p0", "quantity": "position", "body": "rod", "point": [0.5, 0, 0]},
    {"name": "p1", "quantity": "velocity", "body": "rod"},
    {"name": "p2", "quantity": "orientation", "body": "rod"},
    {"name": "p3", "quantity": "angular-velocity", "body": "c/rod_1"},
    {"name": "p4", "quantity": "reaction-force", "joint": "ball"},
    {"name": "p5", "quantity": "reaction-torque", "joint": "hinge"},
    {"name": "p6", "quantity": "gap", "joint": "slider"},
    {"name": "p7", "quantity": "energy"},
    {"name": "p8", "quantity": "momentum"},
    {"name": "p9", "quantity": "angular-momentum"},
    {"name": "p10", "quantity": "axis", "axis": {"joint": "hinge", "axis": "angle"}},
    {"name": "p11", "quantity": "axis-force", "axis": {"joint": "hinge", "axis": "angle"}},
    {"name": "p12", "quantity": "axis-power", "axis": {"joint": "slider", "axis": "displacement"}},
    {"name": "p13", "quantity": "axis-state", "axis": {"joint": "hinge2", "axis": "spin"}}
  ]
})";

/// Every angle that a file can give, with "_deg" for where "_deg" stands in the keys, and its number: the
/// same scene in degrees and in radians.
inline std::string every_angle(bool in_degrees) {
  std::string text = R"({
  "format": "taut-scene/1", "dt": 0.01, "settings": {"max_rotation@": #20#},
  "bodies": [
    {"name": "p", "mass": 1, "inertia": [1, 1, 1], "angular_velocity@": [#0#, #0#, #90#]},
    {"name": "q", "mass": 1, "inertia": [1, 1, 1], "angular_velocity_body@": [#0#, #0#, #-45#]},
    {"name": "r", "mass": 1, "inertia": [1, 1, 1]}],
  "joints": [
    {"name": "hinge", "type": "hinge", "a": "ground", "b": "p", "anchor": [0, 0, 0], "axis": [0, 0, 1],
     "axes": {"angle": {"limits": {"lower@": #-90#, "upper@": #120#},
       "motor": {"velocity@": #30#, "max_force": 2, "force_of_speed@": [[#0#, 3], [#60#, 1]]},
       "spring": {"stiffness": 3, "rest@": #15#}, "value@": #360#}}},
    {"name": "other", "type": "hinge", "a": "ground", "b": "q", "anchor": [0, 0, 0], "axis": [0, 0, 1],
     "axes": {"angle": {"motor": {"position@": #30#, "max_force": 2, "max_speed@": #45#},
       "spring": {"table@": [[#-30#, -2], [#0#, 0], [#30#, 3]], "damping_table@": [[#-60#, -1], [#60#, 1]]}}}},
    {"name": "third", "type": "cylindrical", "a": "ground", "b": "r", "anchor": [0, 0, 0], "axis": [0, 0, 1],
     "axes": {"displacement": {"limits": {"lower": -90, "upper": 90}},
       "angle": {"motor": {"trajectory": {"spline@": [[0, #0#], [1, #90#]]}, "max_force": 1}}}},
    {"type": "driver", "of": {"joint": "hinge", "axis": "angle"},
     "motion": {"harmonic": {"mean@": #10#, "amplitude@": #20#, "omega@": #180#, "phase@": #90#}}},
    {"type": "driver", "of": {"joint": "other", "axis": "angle"},
     "motion": {"linear": {"value@": #5#, "rate@": #10#, "start": 0.5}}},
    {"type": "driver", "of": {"joint": "third", "axis": "angle"},
     "motion": {"speeds@": [[0, #0#], [1, #90#]], "value@": #45#}},
    {"type": "pose_driver", "a": "ground", "b": "r", "turns": [
     {"axis": [0, 0, 1], "angle": {"spline@": [[0, #0#], [1, #90#]]}}, {"axis": [1, 0, 0], "angle@": #30#}]}],
  "probes": [{"name": "w", "quantity": "angular-velocity", "body": "p"},
    {"name": "angle", "quantity": "axis", "axis": {"joint": "hinge", "axis": "angle"}}],
  "events": [
    {"name": "e0", "when": {"quantity": "angular-velocity", "body": "p", "rises_above@": #100#}, "do": [{"end": true}]},
    {"name": "e1", "when": {"quantity": "angular-velocity", "body": "q", "along": [0, 0, 1], "falls_below@": #-50#},
     "do": [{"end": true}]},
    {"name": "e2", "when": {"probe": "w", "along": [0, 0, 1], "passes@": #80#}, "do": [{"end": true}]},
    {"name": "e3", "when": {"quantity": "axis", "axis": {"joint": "hinge", "axis": "angle"}, "rises_above@": #45#},
     "do": [{"motor": {"joint": "hinge", "axis": "angle"}, "target@": #60#}]},
    {"name": "e4", "when": {"quantity": "axis-rate", "axis": {"joint": "hinge", "axis": "angle"}, "passes@": #200#},
     "do": [{"end": true}]},
    {"name": "e5", "when": {"probe": "angle", "falls_below@": #-30#}, "do": [{"end": true}]},
    {"name": "e6", "when": {"quantity": "axis-rate", "axis": {"joint": "third", "axis": "displacement"}, "passes": 3},
     "do": [{"end": true}]}],
  "assemble": true})";
  std::string result;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '@') {
      result += in_degrees ? "_deg" : "";
    } else if (text[at] == '#') {
      const std::size_t end = text.find('#', at + 1);
      const double degrees = std::stod(text.substr(at + 1, end - at - 1));
      char number[40];
      std::snprintf(number, sizeof number, "%.17g", in_degrees ? degrees : degrees * std::numbers::pi / 180);
      result += number;
      at = end;
    } else {
      result += text[at];
    }
  }
  return result;
}

/// A text with exactly one problem.
struct BadScene {
  std::string text;
  std::string path, message, value;
  bool schema_catches = true;  ///< whether the JSON Schema can see it
};

}  // namespace taut::scene_file_cases
