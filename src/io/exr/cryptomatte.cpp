// SPDX-License-Identifier: Apache-2.0
#include "io/exr/cryptomatte.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <set>

namespace quintet::io {
namespace {

constexpr std::uint32_t kFirstFactor = 0xcc9e2d51u;
constexpr std::uint32_t kSecondFactor = 0x1b873593u;

// Mixes a block of four bytes before it enters the state.
std::uint32_t mixBlock(std::uint32_t block) { return std::rotl(block * kFirstFactor, 15) * kSecondFactor; }

// Reads `count` bytes, least significant byte first.
std::uint32_t littleEndian(std::string_view text, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value |= std::uint32_t{static_cast<unsigned char>(text[at + i])} << (8 * i);
  return value;
}

// Final mix: every bit of the input affects every bit of the result.
std::uint32_t avalanche(std::uint32_t h) {
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h = (h ^ (h >> 13)) * 0xc2b2ae35u;
  return h ^ (h >> 16);
}

std::string jsonString(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      (result += '\\') += c;
    else if (static_cast<unsigned char>(c) < 32 || c == 127)
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      result += c;
  }
  return result + '"';
}

}  // namespace

std::uint32_t murmurHash3(std::string_view text, std::uint32_t seed) {
  std::uint32_t state = seed;
  const std::size_t whole = text.size() / 4 * 4;
  for (std::size_t at = 0; at < whole; at += 4)
    state = std::rotl(state ^ mixBlock(littleEndian(text, at, 4)), 13) * 5 + 0xe6546b64u;
  if (whole < text.size()) state ^= mixBlock(littleEndian(text, whole, text.size() - whole));
  return avalanche(state ^ static_cast<std::uint32_t>(text.size()));
}

std::uint32_t cryptomatteBits(std::uint32_t hash) {
  const std::uint32_t exponent = (hash >> 23) & 255u;
  return exponent == 0 || exponent == 255 ? hash ^ (1u << 23) : hash;
}

float cryptomatteId(std::string_view name) { return std::bit_cast<float>(cryptomatteBits(murmurHash3(name))); }

std::string cryptomatteHex(float id) { return fmt::format("{:08x}", std::bit_cast<std::uint32_t>(id)); }

std::vector<CryptomatteCoverage> rankCryptomatte(std::span<const CryptomatteCoverage> samples, std::size_t count) {
  std::vector<CryptomatteCoverage> ranks;
  for (const CryptomatteCoverage& sample : samples) {
    if (sample.id == 0 || !(sample.coverage > 0)) continue;
    const auto known = std::ranges::find(ranks, sample.id, &CryptomatteCoverage::id);
    if (known == ranks.end())
      ranks.push_back(sample);
    else
      known->coverage += sample.coverage;
  }
  std::ranges::sort(ranks, [](const CryptomatteCoverage& a, const CryptomatteCoverage& b) {
    if (a.coverage != b.coverage) return a.coverage > b.coverage;
    return std::bit_cast<std::uint32_t>(a.id) < std::bit_cast<std::uint32_t>(b.id);
  });
  ranks.resize(count);
  return ranks;
}

std::string cryptomatteChannel(std::string_view type, std::size_t rank, bool coverage) {
  return fmt::format("{}{:02}.{}", type, rank / 2, "RGBA"[2 * (rank % 2) + (coverage ? 1 : 0)]);
}

std::string cryptomatteKey(std::string_view type) { return cryptomatteHex(cryptomatteId(type)).substr(0, 7); }

std::string cryptomatteManifest(std::span<const std::string> names) {
  std::string text = "{";
  std::set<std::string_view> seen;
  for (const std::string& name : names) {
    if (!seen.insert(name).second) continue;
    if (text.size() > 1) text += ',';
    text += fmt::format("{}:\"{}\"", jsonString(name), cryptomatteHex(cryptomatteId(name)));
  }
  return text + '}';
}

Metadata cryptomatteMetadata(std::string_view type, std::span<const std::string> names) {
  const std::string prefix = fmt::format("cryptomatte/{}/", cryptomatteKey(type));
  return {{prefix + "name", std::string(type)},
          {prefix + "hash", "MurmurHash3_32"},
          {prefix + "conversion", "uint32_to_float32"},
          {prefix + "manifest", cryptomatteManifest(names)}};
}

}  // namespace quintet::io
