// How much travels with a ray: the payloads of a compiled program, as SPIR-V has them.
#ifndef QUINTET_PROGRAM_PAYLOAD_SIZES_H
#define QUINTET_PROGRAM_PAYLOAD_SIZES_H

#include <cstdint>
#include <string>
#include <vector>

#include "program/link.h"

namespace quintet::program {

struct PayloadSize {
  std::string stage;    // file
  std::string type;     // as in GLSL: "HitPayload"
  std::uint64_t bytes;  // scalar layout; 0: unknown
};

// Payloads that are sent (rayPayloadEXT) or received (rayPayloadInEXT), stage by stage, as far as the compiler leaves
// what is not used. `compiled`: with debug information, else types have no names.
std::vector<PayloadSize> payloadSizes(const CompiledProgram& compiled);

}  // namespace quintet::program
#endif
