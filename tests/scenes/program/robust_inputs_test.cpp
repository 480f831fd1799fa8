#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>

#include "collision/mesh/mesh_file.h"
#include "scenes/accuracy/reference_case.h"
#include "scenes/export/svg_plot.h"
#include "scenes/files/scene_file.h"
#include "scenes/files/state_file.h"
#include "scenes/recording/recording_chunk.h"
#include "scenes/recording/recording_codec.h"
#include "scenes/recording/recording_reader.h"
#include "scenes/support/byte_order.h"
#include "scenes/support/printable.h"
#include "scenes/support/printable_stream.h"
#include "tests/run_program.h"
#include "tests/scenes/recording/sample_recording.h"
#include "tests/source_dir.h"
#include "tests/temporary.h"

// What is read is bounded by what is there, and what it is called is no syntax of another format.
namespace taut::testing::robust_inputs_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Of this process so far [bytes].
long peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss * 1024L;
}

std::string message_of(auto&& act) {
  try {
    act();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

/// [ISO 3309], bit by bit.
std::uint32_t crc(std::string_view bytes) {
  std::uint32_t sum = ~0u;
  for (const unsigned char c : bytes) {
    sum ^= c;
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (sum & 1 ? 0xEDB88320u : 0);
  }
  return ~sum;
}

/// Sound in itself, whatever it says.
std::string chunk_head(ChunkType type, std::uint64_t stored, std::uint64_t raw) {
  std::string head = "tCHK" + std::string(type.data(), type.size());
  append_little(head, stored);
  append_little(head, raw);
  append_little(head, std::uint32_t{0});
  append_little(head, crc(head));
  return head;
}

/// 354 bytes that promise 2²⁸ contacts in a frame.
TEST(RobustInputs, NoCountOfARecordingIsBelieved) {
  const long before = peak_memory();
  RecordingReader reader(source_dir() + "/tests/adversary/recording_bomb_tiny.taut");
  ASSERT_GT(reader.frame_count(), 0);
  EXPECT_THROW((void)reader.frame(0), std::runtime_error);
  EXPECT_LT(peak_memory() - before, 50'000'000);
}

/// Each 32-bit number of the encoded frames, one after the other, is made the largest, and some that
/// overflow.
TEST(RobustInputs, NoNumberOfFramesTakesMemoryThatIsNotThere) {
  std::vector<Frame> frames;
  for (int i = 0; i < 3; ++i) frames.push_back(sample_frame(i));
  const std::string whole = encode_frames(frames);
  const RecordingHeader header = sample_header();
  ASSERT_TRUE(decode_frames(whole, header));
  const long before = peak_memory();
  for (const std::uint32_t number : {~0u, 0x80000000u, 0x10000000u, 0x08000000u, 100'000'000u})
    for (std::size_t place = 0; place + 4 <= whole.size(); ++place) {
      std::string bytes = whole;
      std::memcpy(bytes.data() + place, &number, 4);
      (void)decode_frames(bytes, header);
      (void)decode_frames(bytes.substr(0, place), header);
    }
  EXPECT_LT(peak_memory() - before, 50'000'000);
}

TEST(RobustInputs, AChunkIsNotBelievedToBeLargerThanItIs) {
  const long before = peak_memory();
  EXPECT_FALSE(inflate_payload(deflate("x", 2), std::size_t{1} << 40));
  EXPECT_LT(peak_memory() - before, 50'000'000);
  for (const std::uint64_t raw : {std::uint64_t{100} << 20, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    EXPECT_FALSE(read_chunk_head(chunk_head(kHeaderChunk, raw / 1024, raw))) << raw;
    EXPECT_FALSE(read_chunk_head(chunk_head(kEndChunk, raw / 1024, raw))) << raw;
    EXPECT_FALSE(read_chunk_head(chunk_head(kFramesChunk, raw / 2048, raw))) << raw;
  }
  EXPECT_FALSE(read_chunk_head(chunk_head(kFramesChunk, std::uint64_t{1} << 31, std::uint64_t{1} << 31)));
  EXPECT_TRUE(read_chunk_head(chunk_head(kFramesChunk, 1'000'000, 500'000'000)));
  EXPECT_TRUE(read_chunk_head(chunk_head(kHeaderChunk, 1'000'000, 100'000'000)));
}

TEST(RobustInputs, NoFileIsReadWithoutEnd) {
  const std::string huge = temporary("huge.json");
  write_text(huge, "{");
  fs::resize_file(huge, std::uintmax_t{10} << 30);  // takes no room on the disk
  World world;
  for (const std::string& place : {huge, std::string("/dev/zero")}) {
    EXPECT_TRUE(contains(message_of([&] { (void)load_scene_file(place); }), "too long")) << place;
  }
  EXPECT_TRUE(contains(message_of([&] { (void)load_state_file(world, huge); }), "too long"));
  EXPECT_TRUE(contains(message_of([&] { (void)reference::load_case(huge); }), "too long"));
  const std::string mesh = temporary("huge.stl");
  fs::rename(huge, mesh);
  EXPECT_TRUE(contains(message_of([&] { (void)read_mesh(mesh, 1); }), "too long"));
  EXPECT_NE(message_of([&] { RecordingReader reader("/dev/zero"); }), "");
  EXPECT_NE(message_of([&] { RecordingReader reader(mesh); }), "");
}

TEST(RobustInputs, TheProgramReadsNoDeviceWithoutEnd) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"check", "/dev/zero"}, {"run", "chain", "--from", "/dev/zero"}}) {
    const Outcome run = run_program(words);
    EXPECT_EQ(run.exit_status, 2);
    EXPECT_TRUE(contains(run.err, "/dev/zero") && contains(run.err, "too long")) << run.err;
  }
  for (const std::vector<std::string>& words : {std::vector<std::string>{"replay", "/dev/zero"},
                                                {"run", "/tmp/"},
                                                {"run", "/"},
                                                {"replay", "/tmp"}}) {
    const Outcome run = run_program(words);
    EXPECT_EQ(run.exit_status, 2) << words.back();
    EXPECT_NE(run.err, "");
  }
}

TEST(RobustInputs, DeepNestingIsRefused) {
  for (const std::string& level : {std::string("["), std::string("{\"a\":")}) {
    std::string deep;
    for (int i = 0; i < 1'000'000; ++i) deep += level;
    for (const std::string& text : {deep, "{\"bodies\":" + deep}) {
      EXPECT_TRUE(contains(message_of([&] { (void)parse_scene(text, "deep.json"); }), "nested"));
      World world;
      EXPECT_TRUE(contains(message_of([&] { (void)apply_state(world, text, "deep.json"); }), "nested"));
      write_text(temporary("deep.json"), text);
      EXPECT_NE(message_of([&] { (void)reference::load_case(temporary("deep.json")); }), "");
      EXPECT_NE(message_of([&] { (void)decode_header(text); }), "");
      EXPECT_NE(message_of([&] { (void)decode_end(text); }), "");
    }
  }
  // Whole, too: what is taken apart again must not do so by recursion.
  const std::string whole = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  EXPECT_NE(message_of([&] { (void)decode_header(whole); }), "");
  EXPECT_NE(message_of([&] { (void)decode_header("{\"scene\":" + whole + "}"); }), "");
  write_text(temporary("deep.json"), "{\"id\":" + whole + "}");
  EXPECT_NE(message_of([&] { (void)reference::load_case(temporary("deep.json")); }), "");
}

TEST(RobustInputs, NamesBecomePrintable) {
  EXPECT_EQ(printable("beam \xc3\xa4 <&\"> \xe2\x82\xac \xf0\x9f\x98\x80"),
            "beam \xc3\xa4 <&\"> \xe2\x82\xac \xf0\x9f\x98\x80");
  EXPECT_EQ(printable(std::string("a\0b\x01\x1f\x7f\n", 7)),
            "a\xe2\x90\x80"
            "b\xe2\x90\x81\xe2\x90\x9f\xe2\x90\xa1\xe2\x90\x8a");
  for (const char* bad : {"\x80", "\xc0\xaf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xff",
                          "\xc3", "\xe2\x82", "\xef\xbf\xbe", "\xef\xbf\xbf"}) {
    const std::string text = printable(bad);
    EXPECT_EQ(text.size() % 3, 0u) << text;
    EXPECT_TRUE(text.starts_with("\xef\xbf\xbd")) << text;
    EXPECT_EQ(printable(text), text);
  }
  EXPECT_EQ(gnuplot_quoted("it's `rm` \"x\" \\ \n"), "\"it's \\140rm\\140 \\042x\\042 \\134 \\012\"");
}

/// Nothing that XML 1.0 forbids: control characters, as themselves or by number.
void expect_is_xml(const std::string& text) {
  pugi::xml_document document;
  ASSERT_TRUE(document.load_buffer(text.data(), text.size()));
  for (const unsigned char c : text) EXPECT_TRUE(c >= 0x20 || c == '\n' || c == '\t') << int(c);
  for (std::size_t at = text.find("&#"); at != std::string::npos; at = text.find("&#", at + 1)) {
    const int code = std::atoi(text.c_str() + at + 2);
    EXPECT_TRUE(code >= 0x20 || code == 9 || code == 10 || code == 13) << text.substr(at, 8);
  }
}

TEST(RobustInputs, NamesOfAllBytesMakeAPlot) {
  std::string name;
  for (int c = 0; c < 256; ++c) name += static_cast<char>(c);
  for (std::size_t length = 1; length < 4; ++length)  // and cut within a character
    for (int i = 0; i < 200; ++i) name += std::string("\xf0\x9f\x98\x80").substr(0, length);
  RecordingHeader header = sample_header();
  header.scene = name;
  for (RecordedBody& body : header.bodies) body.name += name;
  for (RecordedJoint& joint : header.joints) joint.name += name;
  for (RecordedScalar& scalar : header.scalars) scalar.name = name + scalar.name;
  const std::string file = temporary("names.taut");
  {
    RecordingWriter writer(file, header);
    for (int i = 0; i < 4; ++i) writer.append(sample_frame(i));
    ASSERT_TRUE(writer.finish("success", name));
  }
  RecordingReader reader(file);
  expect_is_xml(svg_plot(reader));
}

TEST(RobustInputs, AllFilesOfAStrangelyNamedRunAreSound) {
  std::string name;
  for (int c = 1; c < 0x80; ++c) name += static_cast<char>(c);
  const Json scene{
      {"format", "taut-scene/1"},
      {"name", name},
      {"dt", 0.01},
      {"duration", 0.05},
      {"bodies", {{{"name", name}, {"mass", 1}, {"shape", {{"type", "sphere"}, {"radius", 0.1}}}}}},
      {"joints", {{{"name", name}, {"type", "ball"}, {"a", "ground"}, {"b", name}, {"anchor", {0, 0, 1}}}}},
      {"probes", {{{"name", name}, {"quantity", "position"}, {"body", name}}}}};
  const std::string file = temporary("strange.json"), report = temporary("strange_report.json"),
                    plot = temporary("strange.svg"), gltf = temporary("strange.glb"),
                    vtk = temporary("strange_vtk");
  write_text(file, scene.dump());
  const Outcome run =
      run_program({"run", file, "--quiet", "--report", report, "--plot", plot, "--gltf", gltf, "--vtk", vtk});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_EQ(Json::parse(read_text(report))["scene"], name);
  expect_is_xml(read_text(plot));
  const std::string binary = read_text(gltf);
  std::uint32_t length = 0;
  std::memcpy(&length, binary.data() + 12, 4);  // of the JSON chunk, after the head of the file
  const Json model = Json::parse(binary.substr(20, length));
  bool found = false;
  for (const Json& node : model["nodes"]) found = found || node["name"] == name;
  EXPECT_TRUE(found);
  int count = 0;
  for (const auto& entry : fs::directory_iterator(vtk)) {
    if (entry.path().extension() == ".csv") continue;
    expect_is_xml(read_text(entry.path()));
    ++count;
  }
  EXPECT_GT(count, 5);
}

/// Printed in any pieces: pictures of control characters, and everything else as it was.
TEST(RobustInputs, WhatIsPrintedMovesNoCursor) {
  const std::string text =
                        "\x1b[2J a\tb\n\x07\x7f \xc2\x9b"
                        "31m \xc2\xb5 \xe2\x82\xac \xc2",
                    seen =
                        "\u241b[2J a\tb\n\u2407\u2421 \ufffd"
                        "31m \xc2\xb5 \xe2\x82\xac \xc2";
  for (std::size_t piece = 1; piece <= text.size(); ++piece) {
    std::ostringstream out;
    {
      const PrintableStream filter(out);
      for (std::size_t at = 0; at < text.size(); at += piece) out << text.substr(at, piece) << std::flush;
      out.put('\r');
    }
    EXPECT_EQ(out.str(), seen + "\u240d") << piece;
  }
  const std::string file = temporary("names.json");
  std::ofstream(file) << R"({"format": "taut-scene/1", "bodies": [
    {"name": "a\u001b[2J\u009b", "mass": 1, "inertia": [1, 1, 1]},
    {"name": "b\u001b]0;title\u0007", "mass": 1, "inertia": [1, 1, 1], "position": [1, 0, 0]}],
    "joints": [{"type": "ball", "a": "a\u001b[2J\u009b", "b": "b\u001b]0;title\u0007",
                "a_point": [0, 0, 0], "b_point": [0, 0, 0]}]})";
  for (const char* command : {"run", "check"}) {
    const Outcome outcome = run_program({command, file, "--verbose"});
    for (const char control : {'\x1b', '\x07', '\x9b'})
      EXPECT_EQ((outcome.out + outcome.err).find(control), std::string::npos) << outcome.out << outcome.err;
  }
}

}  // namespace
}  // namespace taut::testing::robust_inputs_test
