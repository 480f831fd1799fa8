#include <gtest/gtest.h>

#include <fstream>

#include "scenes/files/scene_file.h"
#include "scenes/import/imported_model.h"
#include "tests/run_program.h"
#include "tests/scenes/import/corpus_checker.h"
#include "tests/temporary.h"

// Nothing that is fed in crashes or hangs.
namespace taut::import_robust_test {
namespace {

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

void expect_refused(const std::string& text, const std::string& message) {
  try {
    (void)parse_scene(import_model_text(text, "x.xml").document.dump(), "x.xml");
    ADD_FAILURE() << "is not refused: " << message;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
  }
}

TEST(RobustImport, NestingIsBounded) {
  const int depth = 200'000;
  expect_refused("<mujoco><worldbody>" + repeated("<body>", depth) + repeated("</body>", depth) +
                     "</worldbody></mujoco>",
                 "nested too deep");
  expect_refused(
      "<mujoco>" + repeated("<default class='a'>", depth) + repeated("</default>", depth) + "</mujoco>",
      "nested too deep");
}

TEST(RobustImport, CopiesOfCopiesAreBounded) {
  expect_refused("<mujoco><worldbody>" + repeated("<replicate count='1000'>", 5) + "<geom size='1'/>" +
                     repeated("</replicate>", 5) + "</worldbody></mujoco>",
                 "more than 200,000 elements");
}

/// Each got the first free number, found by trying all of them: 100,000 took hours.
TEST(RobustImport, ManyOfOneName) {
  const std::string body = "<body><geom size='.1'/></body>";
  const ImportedModel model = import_model_text(
      "<mujoco><option><flag contact='disable'/></option><worldbody>"
      "<replicate count='50000'>" +
          body + "</replicate></worldbody></mujoco>",
      "x.xml");
  const auto& bodies = model.document["bodies"];
  ASSERT_EQ(bodies.size(), 50'000u);
  EXPECT_EQ(bodies[0]["name"], "link");
  EXPECT_EQ(bodies[1]["name"], "link_2");
  EXPECT_EQ(bodies[49'999]["name"], "link_50000");
}

TEST(RobustImport, WhatIsNoModelIsRefused) {
  expect_refused("", "is no XML");
  expect_refused("<robot", "is no XML");
  expect_refused(R"({"format": "taut-scene/1"})", "x.xml:1: is a scene already, which needs no import");
  expect_refused("<html/>", "is none of <robot>, <sdf> and <mujoco>");
  expect_refused("<sdf/>", "has no <model>");
  expect_refused(std::string("<robot>\0</robot>", 16), "x.xml:1");
  expect_refused("<!DOCTYPE a [<!ENTITY b '&b;&b;'>]><robot>&b;</robot>", "has no links");
}

TEST(RobustImport, FilesThatIncludeEachOtherAreRefused) {
  std::ofstream(testing::temporary("a.xml")) << "<mujoco><include file='b.xml'/></mujoco>";
  std::ofstream(testing::temporary("b.xml")) << "<mujoco><include file='a.xml'/></mujoco>";
  std::ofstream(testing::temporary("c.xml"))
      << "<mujoco model='c'><asset><model name='c' file='c.xml'/></asset><worldbody>"
         "<attach model='c' prefix='p'/></worldbody></mujoco>";
  EXPECT_THROW((void)import_model(testing::temporary("a.xml")), ImportError);
  EXPECT_THROW((void)import_model(testing::temporary("c.xml")), ImportError);
  EXPECT_THROW((void)import_model(testing::temporary("nowhere.xml")), ImportError);
}

/// A byte in each hundred of a file is another.
TEST(RobustImport, DamagedFilesLoadOrAreRefused) {
  unsigned state = 1;
  const auto random = [&state](unsigned below) {
    return (state = state * 1664525u + 1013904223u) / 65536 % below;
  };
  const std::string bytes = "\"'<>/=0 9-.eax";
  int count = 0;
  for (const std::string& name : testing::model_files()) {
    if (++count % 9 != 0) continue;
    std::string text = read_text_file(testing::model_folder() / name);
    if (text.size() > 20'000) continue;
    for (int round = 0; round < 5; ++round) {
      std::string damaged = text;
      for (std::size_t i = 0; i < text.size() / 100; ++i)
        damaged[random(static_cast<unsigned>(text.size()))] =
            bytes[random(static_cast<unsigned>(bytes.size()))];
      try {
        (void)parse_scene(import_model_text(damaged, testing::model_folder() / name).document.dump(), name);
      } catch (const std::invalid_argument&) {
      }
    }
  }
}

TEST(ImportProgram, WritesASceneThatRuns) {
  const std::string model =
      (testing::model_folder() / "urdf/drake_iiwa_description_urdf_iiwa14_spheres_dense_collision.urdf")
          .string();
  const testing::Outcome written =
      testing::run_program({"import", model, "-o", testing::temporary("scene.json")});
  EXPECT_EQ(written.exit_status, 0) << written.err;
  EXPECT_NE(written.err.find(model + ":"), std::string::npos);
  EXPECT_NE(written.err.find("<transmission>: of controllers, left out"), std::string::npos) << written.err;
  EXPECT_EQ(testing::run_program({"run", testing::temporary("scene.json"), "--steps", "2"}).exit_status, 0);
  EXPECT_EQ(testing::run_program({"run", model, "--steps", "2"}).exit_status, 0);
  EXPECT_EQ(testing::run_program({"run", model, "--steps", "2", "--csv", model}).exit_status, 2);
  const testing::Outcome checked = testing::run_program({"check", model});
  EXPECT_NE(checked.out.find("<transmission>: of controllers, left out"), std::string::npos) << checked.out;
  EXPECT_EQ(testing::run_program({"import", "none.urdf"}).exit_status, 2);
  std::ofstream(testing::temporary("one.xml"))
      << "<mujoco><option timestep='.01' noslip_iterations='1'/><worldbody><body><joint/><geom "
         "size='.1'/></body>"
         "</worldbody></mujoco>";
  const testing::Outcome one = testing::run_program({"import", testing::temporary("one.xml")});
  EXPECT_NE(one.err.find("taut: 1 moving body, 1 joint, 1 shape; 1 notice\n"), std::string::npos) << one.err;
  const testing::Outcome run = testing::run_program({"run", testing::temporary("one.xml"), "--steps", "2"});
  EXPECT_NE(run.err.find("taut: 1 kind of thing in "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find(" is not, or not as it is, in the scene"), std::string::npos) << run.err;
  EXPECT_NE(run.out.find(": 1 body, 1 joint (5 rows), "), std::string::npos) << run.out;
}

}  // namespace
}  // namespace taut::import_robust_test
