// SPDX-License-Identifier: Apache-2.0
// The format of debugPrintfEXT: checked against the types of the arguments, and applied to the words that a shader has
// stored for them.
#ifndef QUINTET_SPIRV_PRINT_FORMAT_H
#define QUINTET_SPIRV_PRINT_FORMAT_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace quintet::spirv {

// The type of an argument: a scalar or a vector of 2 to 4 components.
struct PrintArgument {
  enum class Kind {
    boolean,
    integer,
    floating,
    other,  // cannot be printed: matrices, arrays, structures, strings, …
  };
  Kind kind = Kind::other;
  bool isSigned = false;
  std::uint32_t bits = 32;  // of a component
  std::uint32_t count = 1;  // components
  std::string typeName;     // in GLSL

  // Words that a shader stores: components of 64 bits have two, low word first; all others have one. Integers of 8 and 16
  // bits are extended to 32, and float16_t is converted to float.
  std::size_t wordCount() const { return std::size_t{count} * (bits == 64 ? 2 : 1); }
};

// A specifier such as "%5.2v3f": % [flags - + space # 0] [width] [.precision] [v2, v3, v4] [l] conversion. Conversions:
// d i o u x X c for integers and booleans (0 or 1); f F e E g G a A for floats. l, before or after the conversion (%lu,
// %ul), is required for integers of 64 bits.
class PrintFormat {
 public:
  // Throws Error if the format is invalid or does not match the arguments; the message has no location.
  PrintFormat(std::string_view format, const std::vector<PrintArgument>& arguments);

  // Components of vectors are separated by ", ". `words` are those of the arguments, in order; missing words count as 0.
  std::string text(std::span<const std::uint32_t> words) const;
  std::size_t wordCount() const { return wordCount_; }  // of all arguments

 private:
  struct Specifier {
    std::string format;  // of one component, for fmt::sprintf
    char conversion = 'd';
    PrintArgument argument;
  };
  std::vector<std::variant<std::string, Specifier>> parts_;  // literal text and specifiers
  std::size_t wordCount_ = 0;
};

}  // namespace quintet::spirv
#endif
