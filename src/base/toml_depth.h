// A guard in front of toml++ (3.x), which frees nested tables recursively: a key "a.a.a.…" of 200,000 parts overflows the
// stack. Brackets are no danger, it allows 256 nested values.
#ifndef QUINTET_BASE_TOML_DEPTH_H
#define QUINTET_BASE_TOML_DEPTH_H

#include <string_view>

namespace quintet {

inline constexpr int kMaxTomlKeyDots = 16;

// The line (from 1) of the first dotted key with more dots than that; 0: there is none. For text that is not TOML up
// to there the answer means nothing, and the parser stops before it.
int deepTomlKey(std::string_view text);

}  // namespace quintet
#endif
