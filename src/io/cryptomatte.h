// Cryptomatte (Friedman and Jones, Psyop; specification 1.1.0 and later): per pixel the things that are seen and how much of
// the pixel each covers, by ids that are hashes of names, so that a compositing program makes mattes from names.
#ifndef QUINTET_IO_CRYPTOMATTE_H
#define QUINTET_IO_CRYPTOMATTE_H

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/codec.h"

namespace quintet::io {

// MurmurHash3_x86_32 (Austin Appleby 2011, public domain).
std::uint32_t murmurHash3(std::string_view text, std::uint32_t seed = 0);

// The bits of a float that is no denormal, infinity or NaN: an exponent of 0 becomes 1, one of 255 becomes 254.
std::uint32_t cryptomatteBits(std::uint32_t hash);
// "uint32_to_float32" of the hash of a name. The id of nothing is 0, which no name has.
float cryptomatteId(std::string_view name);
// The eight digits of an id in a manifest.
std::string cryptomatteHex(float id);

struct CryptomatteCoverage {
  float id = 0;
  float coverage = 0;  // of the pixel, 0 to 1
};

// A pixel's ranks: entries of the same id are added up, nothing (id 0) and coverage 0 are left out; then by falling
// coverage, among equals by rising bits of the id. Always `count` entries, the last ones 0.
std::vector<CryptomatteCoverage> rankCryptomatte(std::span<const CryptomatteCoverage> samples, std::size_t count);

// "CryptoObject00.R": rank 0 is R (id) and G (coverage) of layer 00, rank 1 its B and A, rank 2 R and G of 01, ...
std::string cryptomatteChannel(std::string_view type, std::size_t rank, bool coverage);

// The first seven digits of the hash of a type's name ("CryptoObject"): "3ae39a5".
std::string cryptomatteKey(std::string_view type);

// {"name":"id", ...} in the order of the names; what JSON cannot hold is escaped; a name given twice stands once.
std::string cryptomatteManifest(std::span<const std::string> names);

// The attributes name, hash, conversion and manifest of a type.
Metadata cryptomatteMetadata(std::string_view type, std::span<const std::string> names);

}  // namespace quintet::io
#endif
