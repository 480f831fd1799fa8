#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numbers>

#include "core/joints/joints.h"
#include "scenes/files/scene_file.h"
#include "scenes/recording/film.h"
#include "scenes/recording/frame_sampler.h"
#include "scenes/recording/recording_chunk.h"
#include "tests/run_program.h"
#include "tests/scenes/program/resource_limit.h"
#include "tests/scenes/recording/sample_recording.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

namespace taut::testing::recording_test {
namespace {

constexpr int kFrames = 5;
constexpr double kFloat = 6e-8;  // half the spacing of floats, relative

void expect_float(const Vec3& read, const Vec3& written) {
  for (int i = 0; i < 3; ++i) EXPECT_EQ(read[i], static_cast<double>(static_cast<float>(written[i])));
}

/// The frame is the sample frame of its time, to the last bit that the format keeps.
void expect_sample(const Frame& frame) {
  const Frame expected = sample_frame(static_cast<int>(std::lround(frame.time / 0.01)));
  EXPECT_EQ(frame.time, expected.time);
  EXPECT_EQ(frame.scalars, expected.scalars);
  ASSERT_EQ(frame.poses.size(), 3u);
  for (int b = 0; b < 3; ++b) {
    expect_float(frame.poses[b].p, expected.poses[b].p);
    EXPECT_LT(frame.poses[b].q.angularDistance(expected.poses[b].q), 4 * kFloat);
    EXPECT_NEAR(frame.poses[b].q.norm(), 1, 1e-15);
    expect_float(frame.twists[b].w, expected.twists[b].w);
    expect_float(frame.twists[b].v, expected.twists[b].v);
  }
  ASSERT_EQ(frame.joints.size(), 2u);
  for (int j = 0; j < 2; ++j) {
    expect_float(frame.joints[j].wrench.force, expected.joints[j].wrench.force);
    expect_float(frame.joints[j].wrench.torque, expected.joints[j].wrench.torque);
    EXPECT_NEAR(frame.joints[j].gap.metres, expected.joints[j].gap.metres, 1e-18);
    EXPECT_NEAR(frame.joints[j].gap.radians, expected.joints[j].gap.radians, 1e-20);
    EXPECT_EQ(frame.joints[j].attached, expected.joints[j].attached);
  }
  ASSERT_EQ(frame.contacts.size(), expected.contacts.size());
  for (std::size_t c = 0; c < frame.contacts.size(); ++c) {
    EXPECT_EQ(frame.contacts[c].a, expected.contacts[c].a);
    EXPECT_EQ(frame.contacts[c].b, expected.contacts[c].b);
    expect_float(frame.contacts[c].position, expected.contacts[c].position);
    expect_float(frame.contacts[c].normal, expected.contacts[c].normal);
    expect_float(frame.contacts[c].force, expected.contacts[c].force);
  }
  ASSERT_EQ(frame.tensions.size(), 2u);
  for (int s = 0; s < 2; ++s) EXPECT_EQ(frame.tensions[s], static_cast<float>(expected.tensions[s]));
}

std::string sample_bytes() {
  const std::string file = temporary("sample.taut");
  write_sample(file, kFrames);
  return read_text(file);
}

TEST(Recording, GivesBackWhatWasWritten) {
  const std::string file = temporary("whole.taut");
  write_sample(file, kFrames);
  RecordingReader reader(file);
  EXPECT_EQ(reader.damage(), "");
  ASSERT_TRUE(reader.end());
  EXPECT_EQ(reader.end()->status, "success");
  EXPECT_EQ(reader.end()->frames, kFrames);
  ASSERT_EQ(reader.frame_count(), kFrames);
  for (const int i : {0, 1, 2, 3, 4, 2, 0}) {  // forwards and back
    EXPECT_EQ(reader.time(i), sample_frame(i).time);
    expect_sample(reader.frame(i));
  }
  EXPECT_THROW((void)reader.frame(kFrames), std::out_of_range);
  EXPECT_THROW((void)reader.frame(-1), std::out_of_range);

  const RecordingHeader expected = sample_header();
  const RecordingHeader& header = reader.header();
  EXPECT_EQ(header.scene, expected.scene);
  EXPECT_EQ(header.parameters, expected.parameters);
  EXPECT_EQ(header.gravity, expected.gravity);
  ASSERT_EQ(header.bodies.size(), 3u);
  EXPECT_EQ(header.bodies[2].name, "ball, red");
  EXPECT_EQ(header.bodies[2].mass, 0.5);
  EXPECT_TRUE(header.bodies[1].fixed);
  ASSERT_EQ(header.joints.size(), 2u);
  EXPECT_EQ(header.joints[1].type, "distance");
  EXPECT_EQ(header.joints[1].a, BodyId{1});
  EXPECT_EQ(header.joints[1].anchor_B, Vec3(0.125, 0, 0));
  EXPECT_TRUE(header.joints[0].course.empty());
  ASSERT_EQ(header.joints[1].course.size(), 2u);
  EXPECT_EQ(header.joints[1].course[0].body, BodyId{1});
  EXPECT_EQ(header.joints[1].course[0].p_BP, Vec3(0, 0, 0.5));
  ASSERT_EQ(header.springs.size(), 2u);
  EXPECT_EQ(header.springs[0].name, "spring_0");
  EXPECT_EQ(header.springs[0].to.body, BodyId{2});
  EXPECT_EQ(header.springs[0].from.p_BP, Vec3(-1, 0, 0.5));
  EXPECT_TRUE(header.springs[0].elastic);
  EXPECT_FALSE(header.springs[1].elastic);
  ASSERT_EQ(header.scalars.size(), 5u);
  EXPECT_EQ(header.scalars[3].group, RecordedScalar::Group::kGap);
  ASSERT_EQ(header.drawn.size(), 3u);
  EXPECT_EQ(std::get<Cylinder>(header.shapes[header.drawn[1].shape]).length, 1);
  EXPECT_EQ(header.drawn[1].pose.q.coeffs(), expected.drawn[1].pose.q.coeffs());
}

// What a killed program leaves behind: every prefix of the file.
TEST(Recording, EveryCutPositionStaysReadable) {
  const std::string bytes = sample_bytes(), file = temporary("cut.taut");
  int with_frames = 0, refused = 0, most = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    write_text(file, bytes.substr(0, size));
    try {
      RecordingReader reader(file);
      EXPECT_NE(reader.damage(), "") << size;
      EXPECT_FALSE(reader.end()) << size;
      EXPECT_GE(reader.frame_count(), most) << size;  // a longer file never has less
      most = reader.frame_count();
      for (int i = 0; i < reader.frame_count(); ++i) expect_sample(reader.frame(i));
      with_frames += reader.frame_count() > 0;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(most, 0) << size;
      EXPECT_NE(std::string(error.what()).find(file), std::string::npos);
      ++refused;
    }
  }
  EXPECT_EQ(most, kFrames);  // the end alone was cut
  EXPECT_GT(with_frames, 500);
  EXPECT_GT(refused, 16);
}

// No byte can change without being noticed, and what is read all the same is right.
TEST(Recording, DamageOfAnyByteIsSaid) {
  const std::string bytes = sample_bytes(), file = temporary("damaged.taut");
  int survivors = 0;
  for (std::size_t place = 0; place < bytes.size(); ++place) {
    std::string damaged = bytes;
    damaged[place] = static_cast<char>(damaged[place] ^ 0x41);
    write_text(file, damaged);
    try {
      RecordingReader reader(file);
      EXPECT_NE(reader.damage(), "") << place;
      for (int i = 0; i < reader.frame_count(); ++i) expect_sample(reader.frame(i));
      survivors += reader.frame_count() > 0;
    } catch (const std::invalid_argument&) {
    }
  }
  EXPECT_GT(survivors, 500);
}

TEST(Recording, AnyRestAfterABadPayloadIsStillRead) {
  const std::string bytes = sample_bytes(), file = temporary("hole.taut");
  std::string damaged = bytes;
  const std::size_t first_frames = bytes.find("tCHKFRMS");
  ASSERT_NE(first_frames, std::string::npos);
  damaged[first_frames + kChunkHeadSize + 5] ^= 1;
  write_text(file, damaged);
  RecordingReader reader(file);
  EXPECT_NE(reader.damage().find("left out"), std::string::npos) << reader.damage();
  ASSERT_EQ(reader.frame_count(), kFrames - 2);
  EXPECT_EQ(reader.time(0), sample_frame(2).time);
  expect_sample(reader.frame(0));
}

// Right checksums around the wrong things, as only malice writes them.
TEST(Recording, SoundChunksWithWrongContentsDoNotCrash) {
  const std::string bytes = sample_bytes(), file = temporary("malice.taut");
  const std::string header = bytes.substr(0, bytes.find("tCHKFRMS"));
  const auto le = [](std::uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
  for (const std::string& raw :
       {std::string(), std::string(15, '\0'), le(1) + le(2) + le(2) + le(5),
        le(1u << 30) + le(2) + le(2) + le(5), le(1) + le(2) + le(2) + le(5) + std::string(500, '\xff'),
        le(2) + le(9) + le(9) + le(9) + std::string(800, '\0')}) {
    write_text(file, header + make_chunk(kFramesChunk, raw));
    RecordingReader reader(file);
    for (int i = 0; i < reader.frame_count(); ++i) EXPECT_THROW((void)reader.frame(i), std::runtime_error);
  }
  for (const char* json : {"", "[]", "{\"scene\": 3}", "{\"bodies\": []}"}) {
    write_text(file, std::string(kRecordingMark) + make_chunk(kHeaderChunk, json));
    EXPECT_THROW(RecordingReader{file}, std::invalid_argument) << json;
  }
}

// A file that a version without springs wrote: the double pendulum, let fall for 0.05 s, four frames.
TEST(Recording, FilesOfTheFirstFormatAreRead) {
  RecordingReader reader(testing::source_dir() + "/tests/scenes/recording/first_format.taut");
  EXPECT_EQ(reader.damage(), "");
  EXPECT_TRUE(reader.header().springs.empty());
  ASSERT_EQ(reader.frame_count(), 4);
  const Scene scene = load_scene_file(testing::source_dir() + "/scenes/examples/double_pendulum.json");
  const Frame& frame = reader.frame(0);
  ASSERT_EQ(frame.poses.size(), scene.world.state().poses.size());
  for (std::size_t b = 0; b < frame.poses.size(); ++b)
    expect_float(frame.poses[b].p, scene.world.state().poses[b].p);
  EXPECT_TRUE(frame.tensions.empty());
  const double start = frame.scalars[0] + frame.scalars[1];
  const Frame& last = reader.frame(3);
  EXPECT_GT(last.scalars[0], frame.scalars[0]);
  EXPECT_NEAR(last.scalars[0] + last.scalars[1], start, 1e-6 * last.scalars[0]);
}

TEST(Recording, AnUnknownFormatIsNamed) {
  std::string bytes = sample_bytes();
  bytes[kRecordingMark.size() - 1] = '9';
  write_text(temporary("later.taut"), bytes);
  try {
    RecordingReader reader(temporary("later.taut"));
    FAIL() << "it was read";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("taut-recording/9"), std::string::npos) << error.what();
  }
}

TEST(Recording, WhatIsNoRecordingIsRefused) {
  EXPECT_THROW(RecordingReader{"/no/such/file"}, std::invalid_argument);
  EXPECT_THROW(RecordingReader{std::filesystem::temp_directory_path()}, std::invalid_argument);
  write_text(temporary("text"), "this is some text that is longer than the mark");
  EXPECT_THROW(RecordingReader{temporary("text")}, std::invalid_argument);
  EXPECT_THROW(RecordingWriter("/no/such/folder/r.taut", sample_header()), std::invalid_argument);
}

TEST(Recording, AFullDiskIsSaid) {
  RecordingWriter writer("/dev/full", sample_header());
  EXPECT_FALSE(writer.append(sample_frame(0)));
  EXPECT_FALSE(writer.finish("success", ""));
  EXPECT_NE(writer.error().find("No space left on device"), std::string::npos) << writer.error();
  EXPECT_NE(writer.error().find("/dev/full"), std::string::npos);
}

// Wherever in the file the space ends, what was said to be written is there, and nothing of the rest.
TEST(Recording, WhatFillsUpStaysReadable) {
  const std::string whole = sample_bytes(), file = temporary("filled.taut");
  const std::size_t header = whole.find("tCHKFRMS");
  int lost = 0;
  for (std::size_t size = header; size < whole.size(); size += 7) {
    std::string error;
    {
      const FileSizeLimit limit(size);
      RecordingWriter writer(file, sample_header());
      for (int i = 0; i < kFrames; ++i) {
        writer.append(sample_frame(i));
        if (i % 2 == 1) writer.flush();
      }
      EXPECT_FALSE(writer.finish("success", "")) << size;
      error = writer.error();
    }
    const RecordingReader reader(file);
    EXPECT_NE(error.find("cut short after " + std::to_string(reader.frame_count()) + " frames"),
              std::string::npos)
        << size << ": " << error;
    EXPECT_FALSE(reader.end());
    lost += reader.frame_count() < kFrames;
  }
  EXPECT_GT(lost, 20);
}

TEST(Recording, WithoutFramesIsWholeButShowsNothing) {
  const std::string file = temporary("empty.taut");
  write_sample(file, 0);
  const RecordingReader reader(file);
  EXPECT_EQ(reader.damage(), "");
  EXPECT_EQ(reader.frame_count(), 0);
  const Outcome replay = run_program({"replay", file, "--plot", temporary("empty.svg")});
  EXPECT_EQ(replay.exit_status, 2);
  EXPECT_NE(replay.err.find("no frames"), std::string::npos) << replay.err;
}

/// An axis turns or slides, and its rate has a unit of its own.
TEST(FrameSampler, UnitsAreThoseOfEachNumber) {
  Scene scene;
  const BodyId body = scene.world.add_body({.mass = MassProperties::box(Vec3(1, 1, 1), 1)});
  const JointId joint =
      scene.world.add("joint", Cylindrical::at(scene.world, kGround, body, Vec3::Zero(), Vec3::UnitZ()));
  const AxisId turn = scene.world.axis(joint, "angle"), slide = scene.world.axis(joint, "displacement");
  using Quantity = Probe::Quantity;
  scene.probes = {{.name = "turn", .quantity = Quantity::kAxis, .axis = turn},
                  {.name = "slide", .quantity = Quantity::kAxis, .axis = slide},
                  {.name = "torque", .quantity = Quantity::kAxisForce, .axis = turn},
                  {.name = "pull", .quantity = Quantity::kAxisForce, .axis = slide},
                  {.name = "gap", .quantity = Quantity::kGap, .joint = joint}};
  std::map<std::string, std::string> found;
  for (const RecordedScalar& scalar : FrameSampler(scene).header(60).scalars)
    found[scalar.name] = scalar.unit;
  const std::map<std::string, std::string> expected{
      {"turn.value", "rad"},   {"turn.rate", "rad/s"}, {"slide.value", "m"}, {"slide.rate", "m/s"},
      {"torque.motor", "N m"}, {"pull.motor", "N"},    {"gap.metres", "m"},  {"gap.radians", "rad"}};
  for (const auto& [name, unit] : expected) EXPECT_EQ(found[name], unit) << name;
}

TEST(FrameSampler, AContactIsHalfWayBetweenItsPointsInTheWorld) {
  World world;
  const BodyId ball = world.add_body({.name = "ball",
                                      .mass = MassProperties::sphere(0.5, 1),
                                      .pose = {exp_so3(Vec3(0, std::numbers::pi / 2, 0)), {3, 2, 0.49}}});
  // Its own x axis points down: the lowest point is 0.5 along it, 0.01 below the floor's.
  const ContactSample sample = contact_sample(
      world, {{0}, {1}, kGround, ball, {3, 2, 0}, {0.5, 0, 0}, {0, 0, 1}, -0.01, 0}, {1, 0, 7});
  EXPECT_EQ(sample.a, kGround);
  EXPECT_EQ(sample.b, ball);
  EXPECT_LT((sample.position - Vec3(3, 2, -0.005)).norm(), 1e-15);
  EXPECT_EQ(sample.normal, Vec3(0, 0, 1));
  EXPECT_EQ(sample.force, Vec3(1, 0, 7));
}

// Frames from a simulation have the simulator's own numbers.
TEST(FrameSampler, TakesWrenchesGapsAndProbesFromTheSimulator) {
  Scene scene = build_scene("chain", {{"n", 4}});
  Simulator simulator(scene.world, scene.settings);
  FrameSampler sampler(scene);
  const RecordingHeader header = sampler.header(60);
  EXPECT_EQ(header.bodies.size(), 5u);
  EXPECT_EQ(header.scalars.back().name, "probe.z");

  // Before the first step: released from rest, the first joint carries less than the weight (the rods fall
  // freely but for the pivot), and all of it points up.
  const Frame start = sampler.sample(simulator);
  EXPECT_GT(start.joints[0].wrench.force.z(), 0.1);
  EXPECT_LT(start.joints[0].wrench.force.z(), 0.4 * 9.81);

  for (int i = 0; i < 20; ++i) ASSERT_TRUE(simulator.step(0.005).exact());
  sampler.set_contact_source([](const Simulator& s, std::vector<ContactSample>& contacts) {
    contacts.push_back({{0}, {1}, s.world().pose(BodyId{1}).p, {0, 0, 1}, {0, 0, 7}});
  });
  const Frame frame = sampler.sample(simulator);
  EXPECT_EQ(frame.time, scene.world.time());
  for (int j = 0; j < 4; ++j)
    EXPECT_EQ(frame.joints[j].wrench.force, simulator.mean_reaction(JointId{j}).force);
  EXPECT_EQ(frame.scalars[0], kinetic_energy(scene.world, scene.world.state()));
  EXPECT_EQ(frame.scalars[6], scene.world.pose(BodyId{4}).p.z());
  EXPECT_EQ(frame.scalars[2], std::max({frame.joints[0].gap.metres, frame.joints[1].gap.metres,
                                        frame.joints[2].gap.metres, frame.joints[3].gap.metres}));
  ASSERT_EQ(frame.contacts.size(), 1u);
  EXPECT_EQ(frame.contacts[0].force.z(), 7);
}

TEST(FrameSampler, AxesOfJointsAreWhereTheyWereMadeAndSurviveTheFile) {
  Scene scene;
  World& world = scene.world;
  // Both bodies are turned, so that body axes are not world axes.
  const Quat turned = exp_so3(Vec3(0.3, -0.7, 0.2));
  const BodyId a =
      world.add_body({.name = "a", .mass = MassProperties::sphere(0.1, 1.0), .pose = {turned, {0, 0, 1}}});
  const BodyId b = world.add_body(
      {.name = "b", .mass = MassProperties::sphere(0.1, 1.0), .pose = {turned.conjugate(), {1, 0, 1}}});
  const Vec3 across = Vec3(1, 2, -1).normalized(), along = Vec3(-2, 1, 0).normalized();  // perpendicular
  world.add("hinge", Hinge::at(world, kGround, a, {0, 0, 1}, across));
  world.add("slider", Slider::at(world, a, b, {1, 0, 1}, along));
  world.add("cylindrical", Cylindrical::at(world, kGround, b, {1, 0, 1}, along));
  world.add("cross", Universal::at(world, a, b, {0.5, 0, 1}, across, along));
  world.add("ball", Ball::at(world, a, b, {0.5, 0, 1}));
  const std::string file = temporary("axes.taut");
  Film film(scene, file);
  film.finish();
  const RecordingHeader header = RecordingReader(file).header();
  struct Expected {
    const char* joint;
    const char* axis;
    bool angular;
    Vec3 direction;
  };
  std::vector<Expected> found;
  for (const RecordedJoint& joint : header.joints)
    for (const RecordedAxis& axis : joint.axes)
      found.push_back(
          {joint.name.c_str(), axis.name.c_str(), axis.angular, world.pose(axis.body).q * axis.axis_B});
  const std::vector<Expected> expected = {
      {"hinge", "angle", true, across},      {"slider", "displacement", false, along},
      {"cylindrical", "angle", true, along}, {"cylindrical", "displacement", false, along},
      {"cross", "angle_1", true, across},    {"cross", "angle_2", true, along}};
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_STREQ(found[i].joint, expected[i].joint);
    EXPECT_STREQ(found[i].axis, expected[i].axis);
    EXPECT_EQ(found[i].angular, expected[i].angular);
    // The second axis of a universal joint is counted against its direction, since it is seen from B.
    EXPECT_LT(found[i].direction.cross(expected[i].direction).norm(), 1e-15) << found[i].joint;  // round-off
    EXPECT_NEAR(found[i].direction.norm(), 1, 1e-15);
  }
}

// Tensions are those of Hooke's and the damper's law, and other forces are no springs.
TEST(FrameSampler, TakesTheTensionOfSprings) {
  Scene scene;
  World& world = scene.world;
  world.set_gravity(Vec3::Zero());
  const BodyId ball = world.add_body({.name = "ball",
                                      .mass = MassProperties::sphere(0.1, 2),
                                      .pose = {.q = Quat::Identity(), .p = {0, 0, -3}},
                                      .twist = {.w = Vec3::Zero(), .v = {0, 0, -0.5}}});
  world.add_force(PointForce(ball, Vec3::Zero(), Vec3::UnitX()));
  world.add_force(SpringDamper(kGround, ball, {0, 0, 1}, {0, 0, 0.5}, 10, 3, 4));  // 3.5 m long
  world.add_force(SpringDamper(kGround, ball, {0, 0, 1}, Vec3::Zero(), 0, 0, 6));
  Simulator simulator(world, scene.settings);
  const FrameSampler constant(scene);
  FrameSampler sampler(scene);
  const RecordingHeader header = constant.header(60);
  ASSERT_EQ(header.springs.size(), 2u);
  EXPECT_EQ(header.springs[0].name, "spring_1");
  EXPECT_EQ(header.springs[1].name, "damper_2");
  EXPECT_EQ(header.springs[0].to.p_BP, Vec3(0, 0, 0.5));
  const Frame frame = sampler.sample(simulator);
  ASSERT_EQ(frame.tensions.size(), 2u);
  EXPECT_NEAR(frame.tensions[0], 10 * 0.5 + 4 * 0.5, 1e-13);
  EXPECT_NEAR(frame.tensions[1], 6 * 0.5, 1e-13);
  world.set_force(ForceId{1}, std::make_shared<BodyTorque>(ball, Vec3::UnitZ()));
  EXPECT_EQ(sampler.sample(simulator).tensions[0], 0);  // the spring is no longer there
}

// A body on a joint of half the strength that it needs: it falls freely, and the joint is no gap of metres.
TEST(FrameSampler, ABrokenJointIsDetachedAndNotOpen) {
  Scene scene;
  World& world = scene.world;
  const BodyId ball = world.add_body({.name = "ball", .mass = MassProperties::sphere(0.1, 1)});
  const JointId joint = world.add("hook", Ball::at(world, kGround, ball, Vec3::Zero()));
  world.set_break(joint, BreakLimits{.force = 0.5 * 9.81});
  Simulator simulator(world, scene.settings);
  FrameSampler sampler(scene);
  EXPECT_TRUE(sampler.sample(simulator).joints[0].attached);
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(simulator.step(0.01).exact());
  const Frame frame = sampler.sample(simulator);
  EXPECT_LT(frame.poses[1].p.z(), -1);  // ½ g (0.5 s)² = 1.23 m
  EXPECT_FALSE(frame.joints[0].attached);
  EXPECT_EQ(frame.joints[0].gap.metres, 0);
  EXPECT_EQ(frame.joints[0].wrench.force, Vec3(0, 0, 0));
  EXPECT_EQ(frame.scalars[2], 0);  // the largest gap
}

}  // namespace
}  // namespace taut::testing::recording_test
