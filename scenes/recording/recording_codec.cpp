#include "scenes/recording/recording_codec.h"

#include <cstdint>
#include <stdexcept>

#include "scenes/support/byte_order.h"

namespace taut {
namespace {

// Numbers of a frame in each column.
constexpr std::size_t kPoseNumbers = 7, kTwistNumbers = 6, kJointNumbers = 8;
constexpr std::size_t kContactWords = 11;
constexpr double kDetached = -1;  // in place of the gap, which is a length

struct Counts {
  std::uint32_t frames = 0, bodies = 0, joints = 0, scalars = 0;  // bodies without the ground
};

Counts read_counts(std::string_view raw) {
  return {read_little<std::uint32_t>(raw.data()), read_little<std::uint32_t>(raw.data() + 4),
          read_little<std::uint32_t>(raw.data() + 8), read_little<std::uint32_t>(raw.data() + 12)};
}

void append_float(std::vector<std::uint32_t>& words, double value) {
  words.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}
void append(std::vector<std::uint32_t>& words, const Vec3& v) {
  for (int i = 0; i < 3; ++i) append_float(words, v[i]);
}

/// The words of all frames, each as its difference to the frame before (modulo 2³²: small where a number
/// changes little), then split into four planes of bytes, the lowest bytes first.  Both help deflate, neither
/// loses anything.
void append_column(std::string& raw, std::vector<std::uint32_t> words, std::size_t per_frame) {
  for (std::size_t i = words.size(); i-- > per_frame;) words[i] -= words[i - per_frame];
  for (int plane = 0; plane < 4; ++plane)
    for (const std::uint32_t word : words) raw += static_cast<char>(word >> (8 * plane) & 255);
}

/// Takes bytes from the front; `sound` becomes false when there are too few.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}
  bool sound() const { return sound_; }
  bool at_end() const { return place_ == bytes_.size(); }

  std::string_view take(std::size_t size) {
    if (!sound_ || size > bytes_.size() - place_) {
      sound_ = false;
      return {};
    }
    place_ += size;
    return bytes_.substr(place_ - size, size);
  }
  template <typename Number>
  Number number() {
    const std::string_view bytes = take(sizeof(Number));
    return sound_ ? read_little<Number>(bytes.data()) : Number{};
  }
  /// The inverse of append_column().
  std::vector<std::uint32_t> column(std::size_t frames, std::size_t per_frame) {
    // Both are counts of 32 bits times a few words, and their product may not fit.
    const std::size_t left = (bytes_.size() - place_) / 4;
    if (per_frame > 0 && frames > left / per_frame) sound_ = false;
    const std::size_t count = sound_ ? frames * per_frame : 0;
    const std::string_view planes = take(4 * count);
    if (!sound_) return {};
    std::vector<std::uint32_t> words(count, 0);
    for (int plane = 0; plane < 4; ++plane)
      for (std::size_t i = 0; i < count; ++i)
        words[i] |= static_cast<std::uint32_t>(static_cast<unsigned char>(planes[plane * count + i]))
                    << (8 * plane);
    for (std::size_t i = per_frame; i < count; ++i) words[i] += words[i - per_frame];
    return words;
  }

 private:
  std::string_view bytes_;
  std::size_t place_ = 0;
  bool sound_ = true;
};

/// Takes floats from a column.
class WordReader {
 public:
  WordReader(const std::vector<std::uint32_t>& words, std::size_t first) : word_(words.data() + first) {}
  std::uint32_t word() { return *word_++; }
  double number() { return std::bit_cast<float>(word()); }
  Vec3 vector() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }
  Quat quaternion() {
    const double w = number();
    const Vec3 v = vector();
    return Quat(w, v.x(), v.y(), v.z()).normalized();
  }

 private:
  const std::uint32_t* word_;
};

void append_contacts(std::string& raw, std::span<const Frame> frames) {
  std::vector<std::uint32_t> words;
  for (const Frame& frame : frames) {
    append_little<std::uint32_t>(raw, static_cast<std::uint32_t>(frame.contacts.size()));
    for (const ContactSample& contact : frame.contacts) {
      words.push_back(static_cast<std::uint32_t>(contact.a.index));
      words.push_back(static_cast<std::uint32_t>(contact.b.index));
      for (const Vec3& v : {contact.position, contact.normal, contact.force}) append(words, v);
    }
  }
  append_column(raw, std::move(words), kContactWords);
}

bool read_contacts(ByteReader& bytes, std::vector<Frame>& frames, int body_count) {
  std::size_t total = 0;
  std::vector<std::uint32_t> counts;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    counts.push_back(bytes.number<std::uint32_t>());
    total += counts.back();
  }
  const std::vector<std::uint32_t> words = bytes.column(total, kContactWords);
  if (!bytes.sound()) return false;  // no count is believed before what it counts is there
  WordReader reader(words, 0);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    frames[f].contacts.resize(counts[f]);
    for (ContactSample& contact : frames[f].contacts) {
      contact.a.index = static_cast<int>(reader.word());
      contact.b.index = static_cast<int>(reader.word());
      for (BodyId body : {contact.a, contact.b})
        if (body.index < 0 || body.index >= body_count) return false;
      for (Vec3* v : {&contact.position, &contact.normal, &contact.force}) *v = reader.vector();
    }
  }
  return true;
}

void append_tensions(std::string& raw, std::span<const Frame> frames) {
  std::vector<std::uint32_t> words;
  for (const Frame& frame : frames)
    for (const double tension : frame.tensions) append_float(words, tension);
  append_column(raw, std::move(words), frames.front().tensions.size());
}

bool read_tensions(ByteReader& bytes, std::vector<Frame>& frames, std::size_t spring_count) {
  const std::vector<std::uint32_t> words = bytes.column(frames.size(), spring_count);
  if (!bytes.sound()) return false;
  WordReader reader(words, 0);
  for (Frame& frame : frames)
    for (std::size_t i = 0; i < spring_count; ++i) frame.tensions.push_back(reader.number());
  return true;
}

/// Of all bodies but the ground.
void read_bodies(WordReader pose, WordReader twist, std::size_t count, Frame& frame) {
  frame.poses.resize(count);
  frame.twists.resize(count);
  for (std::size_t b = 1; b < count; ++b) {
    frame.poses[b].p = pose.vector();
    frame.poses[b].q = pose.quaternion();
    frame.twists[b].w = twist.vector();
    frame.twists[b].v = twist.vector();
  }
}

void read_joints(WordReader joint, std::uint32_t count, Frame& frame) {
  for (std::uint32_t j = 0; j < count; ++j) {
    JointSample& sample = frame.joints.emplace_back();
    sample.wrench.force = joint.vector();
    sample.wrench.torque = joint.vector();
    sample.gap.metres = joint.number();
    sample.gap.radians = joint.number();
    sample.attached = sample.gap.metres != kDetached;
    if (!sample.attached) sample.gap = {};
  }
}

/// The parts that a recording with this header has, and no more frames than there are bytes for.
bool fits(const Counts& counts, const RecordingHeader& header, std::size_t bytes) {
  return counts.bodies + 1 == header.bodies.size() && counts.joints == header.joints.size() &&
         counts.scalars == header.scalars.size() && counts.frames <= bytes / frame_size(header);
}

}  // namespace

std::size_t frame_size(const RecordingHeader& header) {
  return 8 + 8 * header.scalars.size() + 4 + 4 * (kPoseNumbers + kTwistNumbers) * (header.bodies.size() - 1) +
         4 * kJointNumbers * header.joints.size() + 4 * header.springs.size();
}

std::string encode_frames(std::span<const Frame> frames) {
  const Frame& first = frames.front();
  std::string raw;
  for (const std::size_t count :
       {frames.size(), first.poses.size() - 1, first.joints.size(), first.scalars.size()})
    append_little<std::uint32_t>(raw, static_cast<std::uint32_t>(count));
  for (const Frame& frame : frames) append_little(raw, frame.time);
  for (const Frame& frame : frames)
    for (const double value : frame.scalars) append_little(raw, value);

  std::vector<std::uint32_t> poses, twists, joints;
  for (const Frame& frame : frames) {
    for (std::size_t b = 1; b < frame.poses.size(); ++b) {
      append(poses, frame.poses[b].p);
      append_float(poses, frame.poses[b].q.w());
      append(poses, frame.poses[b].q.vec());
      append(twists, frame.twists[b].w);
      append(twists, frame.twists[b].v);
    }
    for (const JointSample& joint : frame.joints) {
      append(joints, joint.wrench.force);
      append(joints, joint.wrench.torque);
      append_float(joints, joint.attached ? joint.gap.metres : kDetached);
      append_float(joints, joint.gap.radians);
    }
  }
  append_column(raw, std::move(poses), kPoseNumbers * (first.poses.size() - 1));
  append_column(raw, std::move(twists), kTwistNumbers * (first.poses.size() - 1));
  append_column(raw, std::move(joints), kJointNumbers * first.joints.size());
  append_contacts(raw, frames);
  append_tensions(raw, frames);
  return raw;
}

std::size_t frame_times_size(std::string_view head) {
  return kFramesHeadSize + 8 * std::size_t{read_counts(head).frames};
}

std::vector<double> decode_frame_times(std::string_view raw) {
  std::vector<double> times(read_counts(raw).frames);
  for (std::size_t i = 0; i < times.size(); ++i)
    times[i] = read_little<double>(raw.data() + kFramesHeadSize + 8 * i);
  return times;
}

std::optional<std::vector<Frame>> decode_frames(std::string_view raw, const RecordingHeader& header) {
  if (raw.size() < kFramesHeadSize || raw.size() < frame_times_size(raw)) return std::nullopt;
  const Counts counts = read_counts(raw);
  if (!fits(counts, header, raw.size())) return std::nullopt;
  std::vector<Frame> frames(counts.frames);
  ByteReader bytes(raw);
  bytes.take(kFramesHeadSize);
  for (Frame& frame : frames) frame.time = bytes.number<double>();
  for (Frame& frame : frames)
    for (std::uint32_t i = 0; i < counts.scalars; ++i) frame.scalars.push_back(bytes.number<double>());
  const auto poses = bytes.column(counts.frames, kPoseNumbers * counts.bodies);
  const auto twists = bytes.column(counts.frames, kTwistNumbers * counts.bodies);
  const auto joints = bytes.column(counts.frames, kJointNumbers * counts.joints);
  if (!bytes.sound()) return std::nullopt;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    read_bodies(WordReader(poses, f * kPoseNumbers * counts.bodies),
                WordReader(twists, f * kTwistNumbers * counts.bodies), header.bodies.size(), frames[f]);
    read_joints(WordReader(joints, f * kJointNumbers * counts.joints), counts.joints, frames[f]);
  }
  if (!read_contacts(bytes, frames, static_cast<int>(header.bodies.size())) ||
      !read_tensions(bytes, frames, header.springs.size()) || !bytes.at_end())
    return std::nullopt;
  return frames;
}

}  // namespace taut
