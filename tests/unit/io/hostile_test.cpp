// SPDX-License-Identifier: Apache-2.0
// Runs every decoder on truncated and changed files. A changed file gives an image or a FileError; a truncated file
// always gives a FileError.
#include <gtest/gtest.h>

#include <cctype>
#include <random>

#include "base/error.h"
#include "io/codec.h"
#include "io/samples.h"

namespace quintet::io {
namespace {

using test::Bytes;
using test::Sample;

constexpr int kMutations = 2000;  // per sample

enum class Outcome { decoded, rejected };
std::ostream& operator<<(std::ostream& out, Outcome outcome) {
  return out << (outcome == Outcome::decoded ? "decoded" : "rejected");
}

// Any exception other than a FileError of one line fails the test.
Outcome tryDecode(std::span<const std::byte> bytes, const std::string& name) {
  try {
    probeImage(bytes, name);
    readMetadata(bytes, name);
  } catch (const FileError&) {
  }
  try {
    const Image image = decodeImage(bytes, name);
    EXPECT_EQ(image.data.size(), image.rowBytes() * image.height);
    return Outcome::decoded;
  } catch (const FileError& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with(name + ": ") && text.find('\n') == std::string::npos) << text;
    return Outcome::rejected;
  }
}

Bytes mutate(const Bytes& original, std::minstd_rand& random) {
  Bytes bytes = original;
  const auto position = [&] { return static_cast<std::ptrdiff_t>(random() % bytes.size()); };
  constexpr std::byte kExtremes[]{std::byte{0}, std::byte{0xff}, std::byte{0x7f}, std::byte{0x80}, std::byte{1}};
  for (auto changes = 1 + random() % 4; changes > 0; --changes) {
    switch (random() % 6) {
      case 0: bytes.erase(bytes.begin() + position()); break;
      case 1: bytes.insert(bytes.begin() + position(), static_cast<std::byte>(random())); break;
      case 2: bytes[static_cast<std::size_t>(position())] = kExtremes[random() % 5]; break;
      default: bytes[static_cast<std::size_t>(position())] ^= static_cast<std::byte>(1u << random() % 8);
    }
  }
  return bytes;
}

class HostileTest : public testing::TestWithParam<Sample> {};

TEST_P(HostileTest, RejectsTruncatedFiles) {
  const auto& [name, bytes] = GetParam();
  EXPECT_EQ(tryDecode(bytes, name), Outcome::decoded);
  // The smaller levels at the end of the file are not read; the largest level takes two thirds of the file.
  const std::size_t needed = name == "mipmapped.exr" ? bytes.size() * 2 / 3 : bytes.size();
  for (std::size_t size = 0; size < needed; ++size)
    EXPECT_EQ(tryDecode(std::span(bytes).first(size), name), Outcome::rejected) << size << " of " << bytes.size();
}

TEST_P(HostileTest, SurvivesChangedFiles) {
  const auto& [name, bytes] = GetParam();
  std::minstd_rand random(7);
  int rejected = 0;
  for (int i = 0; i < kMutations; ++i) {
    Bytes changed = mutate(bytes, random);
    // A PNG with wrong checksums is rejected before its content is read.
    if (name.ends_with(".png") && i % 2 == 0) test::repairPngChecksums(changed);
    rejected += tryDecode(changed, name) == Outcome::rejected;
  }
  EXPECT_GT(rejected, 0);
}

INSTANTIATE_TEST_SUITE_P(Formats, HostileTest, testing::ValuesIn(test::allSamples()), [](const auto& sample) {
  std::string name = sample.param.name;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

}  // namespace
}  // namespace quintet::io
