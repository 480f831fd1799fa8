/// Writes a recording with one body of every shape above a floor, each pressed on by a contact force, the
/// first one held by a spring and a damper:
///   make_sample FILE
#include <cmath>
#include <iostream>

#include "scenes/recording/recording_writer.h"

using namespace taut;

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  RecordingHeader header;
  header.scene = "every shape";
  header.gravity = {0, 0, -9.81};
  header.bodies = {{"ground", 0, true}};
  header.shapes = {HalfSpace{},
                   Sphere{0.3},
                   Box{{0.5, 0.4, 0.6}},
                   Capsule{0.2, 0.4},
                   Cylinder{0.25, 0.6},
                   Ellipsoid{{0.2, 0.3, 0.4}},
                   Cone{0.3, 0.6},
                   ConvexHull{{{0.3, 0, -0.3}, {-0.3, 0.3, -0.3}, {-0.3, -0.3, -0.3}, {0, 0, 0.4}}},
                   TriangleMesh{{{0.3, 0, -0.3}, {-0.3, 0.3, -0.3}, {-0.3, -0.3, -0.3}, {0, 0, 0.4}},
                                {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}},
                   HeightField{3, 3, 0.3, 0.3, {0, 0.1, 0, 0.1, 0.3, 0.1, 0, 0.1, 0}}};
  header.drawn = {{0, kGround, {}}};
  const int count = static_cast<int>(header.shapes.size()) - 1;
  for (int b = 1; b <= count; ++b) {
    header.bodies.push_back({shape_name(header.shapes[b]), 1, false});
    header.drawn.push_back({b, {b}, {}});
  }
  header.springs = {{"spring_0", true, {kGround, {-4, 0, 2}}, {{1}, {0, 0, 0.3}}},
                    {"damper_1", false, {{1}, {0.3, 0, 0}}, {{2}, {-0.25, 0, 0}}}};
  RecordingWriter writer(argv[1], header);
  for (int f = 0; f < 31; ++f) {
    Frame frame;
    frame.time = f / 30.0;
    frame.poses.resize(count + 1);
    frame.twists.resize(count + 1);
    for (int b = 1; b <= count; ++b) {
      frame.poses[b] = {exp_so3(Vec3(0, 0, frame.time)),
                        {b - 5.0, 0, 0.7 + 0.2 * std::sin(6 * frame.time + b)}};
      frame.contacts.push_back({kGround, {b}, {b - 5.0, -0.6, 0}, {0, 0, 1}, {0, 0, 5.0 * b}});
    }
    frame.tensions = {20 * std::sin(6 * frame.time), -5 + 10 * frame.time};
    writer.append(std::move(frame));
  }
  if (!writer.finish("success", "")) std::cerr << writer.error() << '\n';
  return writer.error().empty() ? 0 : 1;
}
