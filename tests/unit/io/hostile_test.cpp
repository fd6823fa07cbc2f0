// Every decoder against files that were cut or changed: a FileError or a picture, nothing else, and never a
// picture from a file that was cut.
#include <gtest/gtest.h>

#include <random>

#include "base/error.h"
#include "io/codec.h"
#include "io/samples.h"

namespace quintet::io {
namespace {

using test::Bytes;
using test::Sample;

constexpr int kMutations = 2000;  // per sample

enum class Outcome { picture, refused };
std::ostream& operator<<(std::ostream& out, Outcome outcome) {
  return out << (outcome == Outcome::picture ? "picture" : "refused");
}

// Anything but a picture or a FileError of one line fails the test (by the exception).
Outcome tryDecode(std::span<const std::byte> bytes, const std::string& name) {
  try {
    probeImage(bytes, name);
    readMetadata(bytes, name);
  } catch (const FileError&) {
  }
  try {
    const Image image = decodeImage(bytes, name);
    EXPECT_EQ(image.data.size(), image.rowBytes() * image.height);
    return Outcome::picture;
  } catch (const FileError& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with(name + ": ") && text.find('\n') == std::string::npos) << text;
    return Outcome::refused;
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

TEST_P(HostileTest, CutFilesAreErrors) {
  const auto& [name, bytes] = GetParam();
  EXPECT_EQ(tryDecode(bytes, name), Outcome::picture);
  // Smaller levels at the end of the file are not part of the picture: two thirds are the largest one.
  const std::size_t needed = name == "mipmapped.exr" ? bytes.size() * 2 / 3 : bytes.size();
  for (std::size_t size = 0; size < needed; ++size)
    EXPECT_EQ(tryDecode(std::span(bytes).first(size), name), Outcome::refused) << size << " of " << bytes.size();
}

TEST_P(HostileTest, ChangedFilesDoNoHarm) {
  const auto& [name, bytes] = GetParam();
  std::minstd_rand random(7);
  int refused = 0;
  for (int i = 0; i < kMutations; ++i) {
    Bytes changed = mutate(bytes, random);
    // With its checksums wrong, a PNG would never be looked at closely.
    if (name.ends_with(".png") && i % 2 == 0) test::repairPngChecksums(changed);
    refused += tryDecode(changed, name) == Outcome::refused;
  }
  EXPECT_GT(refused, 0);
}

INSTANTIATE_TEST_SUITE_P(Formats, HostileTest, testing::ValuesIn(test::allSamples()), [](const auto& sample) {
  std::string name = sample.param.name;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

}  // namespace
}  // namespace quintet::io
