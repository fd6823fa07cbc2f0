// SPDX-License-Identifier: Apache-2.0
// Adds to an instrumented module (quintet/explain.glsl) the stores of the payload or callable data around each call of
// traceRayEXT and executeCallableEXT. GLSL cannot do this, because only the call names the variable, by its location. The
// shader marks where the data belong by the store of a constant, before and after each call.
#ifndef QUINTET_SPIRV_LOG_CALL_DATA_H
#define QUINTET_SPIRV_LOG_CALL_DATA_H

#include <cstdint>
#include <string>
#include <vector>

#include "base/diagnostic.h"

namespace quintet::spirv {

// A scalar or vector in the data of a call.
struct DataField {
  enum class Kind { floating, signedInteger, unsignedInteger, boolean };

  std::string name;  // as GLSL accesses it: "payload.light.color", "payload.weights[2]"; a column of a matrix: "m[1]"
  std::string type;  // GLSL name
  Kind kind = Kind::floating;
  std::uint32_t width = 32;  // bits of a logged component: 32 or 64; narrower numbers are widened to 32
  std::uint32_t components = 1;
  std::uint32_t firstWord = 0;  // in the logged data

  std::uint32_t wordCount() const { return components * width / 32; }
};

// A call and what is logged of its data.
struct CallSite {
  std::string variable;           // name in GLSL; empty if unknown
  std::string type;               // GLSL name
  std::vector<DataField> fields;  // those that fit; parts of other types (addresses) are left out
  bool complete = true;           // `fields` has all parts
  SourceLocation location;        // of the call; unknown without debug information
};

struct DataMarkers {
  std::uint32_t before = 0, after = 0;  // values of the marking stores
  std::uint32_t maxWords = 0;           // that the shader reserves for the data
};

struct LoggedCalls {
  std::vector<std::uint32_t> spirv;
  std::vector<CallSite> sites;
  std::uint32_t maxWords = 0;  // of the data of a call, also if they do not fit
};

// Number that a record contains for a marker without a call.
inline constexpr std::uint32_t kNoCallSite = 0xFFFFFFFFu;

// Replaces each marking store by stores of firstNumber + the index of its call site, and of the data in the following
// words. The module must be one that shader::Compiler optimized. Throws Error if it cannot be read.
LoggedCalls logCallData(const std::vector<std::uint32_t>& words, const DataMarkers& markers, std::uint32_t firstNumber);

}  // namespace quintet::spirv
#endif
