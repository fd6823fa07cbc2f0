// SPDX-License-Identifier: Apache-2.0
// Cryptomatte (Friedman and Jones, Psyop; specification 1.1.0 and later): for each pixel the ids of the visible objects
// and their coverage. Ids are hashes of names, so a compositing program can create mattes from names.
#ifndef QUINTET_IO_EXR_CRYPTOMATTE_H
#define QUINTET_IO_EXR_CRYPTOMATTE_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/image.h"

namespace quintet::io {

// MurmurHash3_x86_32 (Austin Appleby 2011, public domain).
std::uint32_t murmurHash3(std::string_view text, std::uint32_t seed = 0);

// Returns the bits of a normal float: an exponent of 0 (denormal) becomes 1, an exponent of 255 (infinity, NaN) becomes
// 254.
std::uint32_t cryptomatteBits(std::uint32_t hash);
// Returns the id of a name: "uint32_to_float32" of its hash. It is never 0, which is the id of no object.
float cryptomatteId(std::string_view name);
// Returns the eight hexadecimal digits of an id in a manifest.
std::string cryptomatteHex(float id);

struct CryptomatteCoverage {
  float id = 0;
  float coverage = 0;  // fraction of the pixel in [0,1]
};

// Returns the ranks of a pixel: entries with the same id are added, entries with id 0 or coverage 0 are skipped, and
// the rest is sorted by descending coverage, then by ascending bits of the id. The result has `count` entries, padded
// with 0.
std::vector<CryptomatteCoverage> rankCryptomatte(std::span<const CryptomatteCoverage> samples, std::size_t count);

// Returns a channel name such as "CryptoObject00.R". Rank 0 is R (id) and G (coverage) of layer 00, rank 1 is B and A
// of layer 00, rank 2 is R and G of layer 01, and so on.
std::string cryptomatteChannel(std::string_view type, std::size_t rank, bool coverage);

// Returns the first seven digits of the hash of a type's name: "3ae39a5" for "CryptoObject".
std::string cryptomatteKey(std::string_view type);

// Returns the JSON text {"name":"id", ...} in the order of the names, without duplicates.
std::string cryptomatteManifest(std::span<const std::string> names);

// Returns the attributes name, hash, conversion and manifest of a type.
Metadata cryptomatteMetadata(std::string_view type, std::span<const std::string> names);

}  // namespace quintet::io
#endif
