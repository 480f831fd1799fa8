#pragma once

#include "tests/scenes/files/scene_file_cases.h"

/// Bad bodies by their ends, and cables; one problem in each.
namespace taut::scene_file_cases {

inline std::string rod_body(const std::string& keys, const std::string& of_body = R"("mass": 1, )") {
  return R"({"format": "taut-scene/1", "bodies": [{"name": "r", )" + of_body + R"("rod": {)" + keys + "}}]}";
}
inline std::string cable(const std::string& keys) {
  return R"({"format": "taut-scene/1", "cables": [{)" + keys + "}]}";
}
inline std::string sound_cable(const std::string& keys) {
  return cable(R"("name": "c", "from": [0, 0, 0], "to": [1, 0, 0], "radius": 0.01, "density": 1000, )" +
               keys);
}

inline std::vector<BadScene> bad_ends() {
  const std::string ends = R"("from": [0, 0, 0], "to": [1, 0, 0])", sound = ends + R"(, "radius": 0.1)";
  const std::string at = "/bodies/0/rod";
  return {
      {rod_body(ends), at, R"("radius" is missing)", ""},
      {rod_body(R"("from": [0, 0, 0], "radius": 0.1)"), at, R"("to" is missing)", ""},
      {rod_body(R"("from": [0, 0, 0], "to": [0, 0, 0], "radius": 0.1)"), at + "/to",
       R"(is the same point as "from")", "[0,0,0]", false},
      {rod_body(R"("from": [0, 0], "to": [1, 0, 0], "radius": 0.1)"), at + "/from",
       "must be an array of 3 numbers", "[0,0]"},
      {rod_body(sound + R"(, "length": 1)"), at + "/length",
       R"(unknown key; known here are "collides_with", "from", "groups", "material", "radius", "to")", "1"},
      {rod_body(sound + R"(, "material": "ice")"), at + "/material", "there is no material of this name",
       R"("ice")", false},
      {rod_body(R"("start": [0, 0, 0], "to": [1, 0, 0], "radius": 0.1)"), at + "/start",
       R"(unknown key; "start" is called "from" here)", "[0,0,0]"},
      {rod_body(sound, ""), "/bodies/0", R"(one of "mass", "density" is missing)", ""},
      {rod_body(sound, R"("mass": 1, "density": 1, )"), "/bodies/0/density",
       R"(only one of "mass", "density" may be given)", "1"},
      {rod_body(sound, R"("mass": 1, "position": [0, 0, 0], )"), "/bodies/0/position",
       R"(has no place here: "rod" says it)", "[0,0,0]"},
      {rod_body(sound, R"("mass": 1, "shapes": [{"type": "sphere", "radius": 1}], )"), "/bodies/0/shapes",
       R"(has no place here: "rod" says it)", R"([{"radius":1,"type":"sphere"}])"},
      {rod_body(sound, R"("mass": 1, "capsule": {"from": [0, 0, 0], "to": [1, 0, 0], "radius": 1}, )"),
       "/bodies/0/capsule", R"("rod" is given as well)", R"({"from":[0,0,0],"radius":1,"to":[1,0,0]})"},
      {R"({"format": "taut-scene/1", "bodies": [{"mass": 1, "beam": {"from": [0, 0, 0], "to": [1, 0, 0], "width": 1}}]})",
       "/bodies/0/beam", R"("height" is missing)", ""},
      {cable(R"("from": [0, 0, 0], "to": [1, 0, 0], "radius": 0.01, "density": 1000, "links": 2)"),
       "/cables/0", R"("name" is missing)", ""},
      {sound_cable(R"("links": 0)"), "/cables/0/links", "must be a positive whole number", "0"},
      {sound_cable(R"("links": 100001)"), "/cables/0/links", "must be at most 100000", "100001"},
      {sound_cable(R"("links": 2, "mass": 1)"), "/cables/0/density",
       R"(only one of "mass", "density" may be given)", "1000"},
      {sound_cable(R"("links": 2, "length": 0.9)"), "/cables/0/length",
       "must not be less than the distance of the ends", "0.9", false},
      {sound_cable(R"("links": 1, "length": 2)"), "/cables/0/length",
       "must be the distance of the ends, since one link cannot sag", "2", false},
      {sound_cable(R"("links": 2, "a": "hook")"), "/cables/0/a", "there is no body of this name", R"("hook")",
       false},
      {sound_cable(R"("links": 2, "sag": 1)"), "/cables/0/sag",
       R"(unknown key; known here are "a", "b", "collides_with", "density", "from", "groups", "length", "links", )"
       R"("mass", "material", "name", "radius", "to")",
       "1"},
      {R"({"format": "taut-scene/1", "bodies": [{"name": "c_1", "mass": 1, "inertia": [1, 1, 1]}], "cables": [
        {"name": "c", "from": [0, 0, 0], "to": [1, 0, 0], "radius": 0.01, "density": 1000, "links": 2}]})",
       "/cables/0/name", R"(makes the body "c_1", which is there already)", R"("c")", false},
  };
}

}  // namespace taut::scene_file_cases
