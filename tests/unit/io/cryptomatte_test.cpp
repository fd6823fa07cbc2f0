// SPDX-License-Identifier: Apache-2.0
#include "io/exr/cryptomatte.h"

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

namespace quintet::io {
namespace {

using testing::ElementsAre;

// Well-known test vectors, and texts of every length modulo 4 from a Python implementation.
TEST(CryptomatteTest, ComputesMurmurHash3) {
  using namespace std::string_view_literals;
  EXPECT_EQ(murmurHash3(""), 0u);
  EXPECT_EQ(murmurHash3("", 1), 0x514e28b7u);
  EXPECT_EQ(murmurHash3("\xff\xff\xff\xff"), 0x76293b50u);
  EXPECT_EQ(murmurHash3("\x21\x43\x65\x87", 0x5082edeeu), 0x2362f9deu);
  EXPECT_EQ(murmurHash3("\0\0\0\0"sv), 0x2362f9deu);
  EXPECT_EQ(murmurHash3("aaaa", 0x9747b28cu), 0x5a97808au);
  EXPECT_EQ(murmurHash3("Hello, world!", 0x9747b28cu), 0x24884cbau);
  EXPECT_EQ(murmurHash3("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
  EXPECT_EQ(murmurHash3("a"), 0x3c2569b2u);
  EXPECT_EQ(murmurHash3("ab"), 0x9bbfd75fu);
  EXPECT_EQ(murmurHash3("abc"), 0xb3dd93fau);
  EXPECT_EQ(murmurHash3("abcd"), 0x43ed676au);
  EXPECT_EQ(murmurHash3("\u00e4"), 0x7e32d1d4u);
}

TEST(CryptomatteTest, MatchesIdsOfTheSpecification) {
  EXPECT_EQ(cryptomatteHex(cryptomatteId("bunny")), "13851a76");
  EXPECT_EQ(cryptomatteHex(cryptomatteId("default")), "42c9679f");
}

TEST(CryptomatteTest, CreatesNormalFloatsAsIds) {
  EXPECT_EQ(cryptomatteBits(0x00000000u), 0x00800000u);
  EXPECT_EQ(cryptomatteBits(0x80000001u), 0x80800001u);
  EXPECT_EQ(cryptomatteBits(0x7f800000u), 0x7f000000u);
  EXPECT_EQ(cryptomatteBits(0xffffffffu), 0xff7fffffu);
  EXPECT_EQ(cryptomatteBits(0x00800000u), 0x00800000u);
  EXPECT_EQ(cryptomatteBits(0x7f7fffffu), 0x7f7fffffu);
  // The hashes of these names, found by search, are a denormal (802d54be) and a NaN (7fbea3d3).
  EXPECT_EQ(cryptomatteHex(cryptomatteId("object85")), "80ad54be");
  EXPECT_EQ(cryptomatteHex(cryptomatteId("object878")), "7f3ea3d3");
  for (int i = 0; i < 5000; ++i) EXPECT_TRUE(std::isnormal(cryptomatteId("object" + std::to_string(i)))) << i;
}

MATCHER_P2(Rank, id, coverage, "") { return arg.id == id && std::abs(arg.coverage - coverage) < 1e-6f; }

TEST(CryptomatteTest, SortsRanksByCoverage) {
  const CryptomatteCoverage samples[]{{2, 0.25f}, {7, 0.25f}, {0, 0.125f}, {2, 0.125f}, {3, 0.25f}, {9, 0.0f}};
  EXPECT_THAT(rankCryptomatte(samples, 4),
              ElementsAre(Rank(2.0f, 0.375f), Rank(3.0f, 0.25f), Rank(7.0f, 0.25f), Rank(0.0f, 0.0f)));
  EXPECT_THAT(rankCryptomatte(samples, 2), ElementsAre(Rank(2.0f, 0.375f), Rank(3.0f, 0.25f)));
  EXPECT_THAT(rankCryptomatte({}, 2), ElementsAre(Rank(0.0f, 0.0f), Rank(0.0f, 0.0f)));
  // The result does not depend on the order of the samples.
  const CryptomatteCoverage turned[]{{7, 0.25f}, {3, 0.25f}, {2, 0.375f}};
  EXPECT_THAT(rankCryptomatte(turned, 3), ElementsAre(Rank(2.0f, 0.375f), Rank(3.0f, 0.25f), Rank(7.0f, 0.25f)));
}

TEST(CryptomatteTest, NamesChannelsOfIdsAndCoverage) {
  EXPECT_EQ(cryptomatteChannel("CryptoObject", 0, false), "CryptoObject00.R");
  EXPECT_EQ(cryptomatteChannel("CryptoObject", 0, true), "CryptoObject00.G");
  EXPECT_EQ(cryptomatteChannel("CryptoObject", 1, false), "CryptoObject00.B");
  EXPECT_EQ(cryptomatteChannel("CryptoObject", 1, true), "CryptoObject00.A");
  EXPECT_EQ(cryptomatteChannel("CryptoMaterial", 5, true), "CryptoMaterial02.A");
}

TEST(CryptomatteTest, WritesTheManifestAsJson) {
  const std::vector<std::string> names{"bunny", "a \"b\"\\\n\x7f", "\u00e4", "bunny"};
  const auto json = nlohmann::json::parse(cryptomatteManifest(names));
  ASSERT_EQ(json.size(), 3u);
  EXPECT_EQ(json["bunny"], "13851a76");
  for (const std::string& name : names) EXPECT_EQ(json.at(name), cryptomatteHex(cryptomatteId(name))) << name;
  EXPECT_EQ(cryptomatteManifest({}), "{}");
}

TEST(CryptomatteTest, LimitsAttributeNamesTo31Bytes) {
  const std::vector<std::string> names{"default"};
  const Metadata data = cryptomatteMetadata("CryptoObject", names);
  EXPECT_THAT(data, ElementsAre(testing::Pair("cryptomatte/3ae39a5/name", "CryptoObject"),
                                testing::Pair("cryptomatte/3ae39a5/hash", "MurmurHash3_32"),
                                testing::Pair("cryptomatte/3ae39a5/conversion", "uint32_to_float32"),
                                testing::Pair("cryptomatte/3ae39a5/manifest", "{\"default\":\"42c9679f\"}")));
  for (const auto& [key, text] : data) EXPECT_LE(key.size(), 31u);  // the limit of attribute names before OpenEXR 1.7
}

}  // namespace
}  // namespace quintet::io
