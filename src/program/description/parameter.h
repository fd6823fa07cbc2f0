// SPDX-License-Identifier: Apache-2.0
// Parameters of a program: declared in program.toml, set by --set name=value or from JSON, read in GLSL as
// `parameters.name`. The fields of the shader record use the same declarations and types.
#ifndef QUINTET_PROGRAM_DESCRIPTION_PARAMETER_H
#define QUINTET_PROGRAM_DESCRIPTION_PARAMETER_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace quintet::program {

enum class ParameterType { boolean, integer, real, vec2, vec3, vec4, color, uinteger, choice, image };
inline constexpr int kParameterTypeCount = 10;

std::string_view typeName(ParameterType);  // as in program.toml: "bool", "int", "float", …, "uint", "choice", "image"
std::string_view glslType(ParameterType);  // bool is a uint of 0 or 1; choice and image are uint
int componentCount(ParameterType);
bool isWhole(ParameterType);                         // bool, int, uint
std::pair<double, double> typeRange(ParameterType);  // lowest and highest number that the type can hold

// A value of any type; unused components are 0. Colors are linear Rec. 709. A choice is its index.
using ParameterValue = std::array<double, 4>;

struct Parameter {
  std::string name;
  ParameterType type = ParameterType::real;
  ParameterValue defaultValue{};
  double min = -1e30;  // of each component, inclusive
  double max = 1e30;
  std::string unit;  // "m", "deg", …; can be empty
  std::string help;
  int line = 0;  // of the declaration; 0 if unknown

  std::vector<std::string> choices;  // choice: names of the values
  std::string defaultImage;          // image: file of the program; empty means white
  bool sRgb = true;                  // image: 8-bit and 16-bit colors are sRGB-encoded
};

// Return whether the limit is narrower than the type's range.
bool hasMin(const Parameter&);
bool hasMax(const Parameter&);
// "0.5,1,0", "true", the name of the choice, or the file of the default image.
std::string formatDefault(const Parameter&);

// The image of an image parameter.
struct ImageValue {
  std::string parameter;
  std::string file;        // empty means 1 × 1 white
  bool ofProgram = false;  // `file` is one of Program::files rather than a path
  bool sRgb = true;
};

// Bindless index of an image that has not been uploaded.
inline constexpr std::uint32_t kNoParameterTexture = 0xFFFFFFFFu;

// The values of a program's parameters, initially the defaults.
class ParameterValues {
 public:
  explicit ParameterValues(const std::vector<Parameter>& parameters);

  // Sets a parameter from "3", "0.5,1,0", "true", the name of a choice, or the path of an image (empty means white).
  // Throws UsageError for an unknown name (with the nearest one), a value of the wrong type, or one out of range.
  void set(const std::string& name, const std::string& text);
  // Sets a parameter from "name=value".
  void setAssignment(const std::string& assignment);
  // Sets all parameters from one value each, in order. The values must be valid.
  void setAll(const std::vector<ParameterValue>& values);
  // Sets the parameters in a JSON object: name → number, bool, list of numbers, or string (a choice, or an image's path
  // relative to the folder of `file`). `file` is the name in messages. Throws FileError with a JSON pointer ("/tint") or
  // a position ("byte 12") and then changes nothing.
  void setFromJson(const std::string& json, const std::string& file);
  // Returns every parameter in the form that setFromJson reads: {"tint": [1.0, 0.5, 0.0], "on": true}.
  std::string toJson() const;

  const ParameterValue& get(const std::string& name) const;
  const std::vector<Parameter>& parameters() const { return parameters_; }
  std::vector<ImageValue> images() const;  // one per image parameter, in order

  // Returns the GLSL struct Parameters in scalar layout, at least 4 bytes. `textures` holds the bindless index of each
  // of images().
  std::vector<std::byte> pack(std::span<const std::uint32_t> textures = {}) const;
  // Returns every parameter as "bounces=12 clamp=0", for the metadata of an image.
  std::string describe() const;

 private:
  std::size_t indexOf(const std::string& name) const;
  // `shown` is the value as the user wrote it.
  void assign(std::size_t parameter, const std::vector<double>& numbers, const std::string& shown);
  void assignText(std::size_t parameter, const std::string& text);
  [[noreturn]] void failType(std::size_t parameter, const std::string& shown) const;

  std::vector<Parameter> parameters_;
  std::vector<ParameterValue> values_;
  std::vector<std::optional<std::string>> imageFiles_;  // empty means the default image
};

}  // namespace quintet::program
#endif
