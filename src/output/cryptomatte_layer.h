// SPDX-License-Identifier: Apache-2.0
// From the ids that a film counts to the ranks of Cryptomatte (specification 1.1.0; io/exr has hashes and metadata).
#ifndef QUINTET_OUTPUT_CRYPTOMATTE_LAYER_H
#define QUINTET_OUTPUT_CRYPTOMATTE_LAYER_H

#include <cstddef>
#include <string>
#include <vector>

#include "io/exr/exr.h"
#include "job/result.h"

namespace quintet::output {

inline constexpr std::size_t kCryptomatteLayers = 3;  // six ranks, as the specification suggests

// Type name of a program's output: "cryptomatte_object" becomes "CryptoObject".
std::string cryptomatteType(const std::string& output);

// Names of the channels in a file: three layers of four channels.
std::vector<std::string> cryptomatteChannels(const std::string& output);

// Appends the channels, and the metadata with the manifest. `index`: of the output.
void addCryptomatte(io::ExrImage& image, const std::string& output, std::size_t index, const job::RenderResult& result);

}  // namespace quintet::output
#endif
