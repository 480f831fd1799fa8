#pragma once

#include <cmath>
#include <string>

#include "scenes/recording/recording_reader.h"
#include "scenes/recording/recording_writer.h"

/// A small recording with known numbers: two spheres on a stick, one of them fixed, two joints of which one
/// is a rod that is detached in frame 3, a spring and a damper, a contact now and then.
namespace taut::testing {

inline RecordingHeader sample_header() {
  using Group = RecordedScalar::Group;
  RecordingHeader header;
  header.scene = "sample <&\"> \xc3\xa4";
  header.parameters = {{"n", 3}};
  header.dt = 0.01;
  header.frames_per_second = 100;
  header.gravity = {0, 0, -9.81};
  header.bodies = {{"ground", 0, true}, {"post", 2, true}, {"ball, red", 0.5, false}};
  header.joints = {{"pin", "ball", {0}, {2}, {0, 0, 0.25}}, {"strut", "distance", {1}, {2}, {0.125, 0, 0}}};
  header.joints[1].course = {{{1}, {0, 0, 0.5}}, {{2}, {0.125, 0, 0}}};
  header.springs = {{"spring_0", true, {{0}, {-1, 0, 0.5}}, {{2}, {0, 0, 0.25}}},
                    {"damper_4", false, {{1}, {0, 0.5, 0}}, {{2}, {0, 0.25, 0}}}};
  header.scalars = {{"kinetic energy", "J", Group::kEnergy},
                    {"potential energy", "J", Group::kEnergy},
                    {"gap", "m", Group::kGap},
                    {"gap angle", "rad", Group::kGap},
                    {"tip.x", "m", Group::kProbe}};
  header.shapes = {Sphere{0.25}, Cylinder{0.05, 1}, HalfSpace{}};
  const Quat tilted = exp_so3(Vec3(0, 0.5, 0));
  header.drawn = {{0, {2}, {}}, {1, {1}, {tilted, {0, 0, 0.5}}}, {2, {0}, {}}};
  return header;
}

inline Frame sample_frame(int i) {
  const double t = 0.01 * i;
  Frame frame;
  frame.time = t;
  frame.poses = {Pose{}, Pose{Quat::Identity(), {1, 0, 0}},
                 Pose{exp_so3(Vec3(0.3 * i, 0.1, -0.2)), {std::sin(7 * t), 0.5 * t, 1 - 4.9 * t * t}}};
  frame.twists = {Twist{}, Twist{}, Twist{{30, 0, 0}, {7 * std::cos(7 * t), 0.5, -9.8 * t}}};
  frame.joints = {{{{10.0 * i, -3, 0.5}, {0, 0, 0}}, {1e-12 * (i + 1), 0}},
                  {{{0, 0, -2.5}, {0.1, 0, 0.25 * i}}, {0, 3e-14}}};
  if (i == 3) frame.joints[1] = {.wrench = {}, .gap = {}, .attached = false};
  if (i % 3 == 1) frame.contacts = {{{0}, {2}, {0.5, 0.25, 0}, {0, 0, 1}, {0, 1.5, 8.0 * i}}};
  frame.tensions = {-7.5 + 4 * i, 0.1 * i * i};
  frame.scalars = {1.0 / 3 + i, -0.1 * i, 1e-12 * (i + 1), 3e-14, frame.poses[2].p.x()};
  return frame;
}

/// Writes frames 0 … count − 1 in chunks of two.
inline void write_sample(const std::string& file, int count) {
  RecordingWriter writer(file, sample_header());
  for (int i = 0; i < count; ++i) {
    writer.append(sample_frame(i));
    if (i % 2 == 1) writer.flush();
  }
  writer.finish("success", "");
}

}  // namespace taut::testing
