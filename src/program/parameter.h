// Parameters of a program: declared once in program.toml, set by --set name=value or from JSON, read in GLSL
// as `parameters.name`.
#ifndef QUINTET_PROGRAM_PARAMETER_H
#define QUINTET_PROGRAM_PARAMETER_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/nearest_name.h"

namespace quintet::program {

enum class ParameterType { boolean, integer, real, vec2, vec3, vec4, color, uinteger, choice, image };
inline constexpr int kParameterTypeCount = 10;

std::string_view typeName(ParameterType);  // as in program.toml: "bool", "int", "float", …, "uint", "choice", "image"
std::string_view glslType(ParameterType);  // bool is a uint of 0 or 1, choice and image are uint
int componentCount(ParameterType);
bool isWhole(ParameterType);                         // bool, int, uint
std::pair<double, double> typeRange(ParameterType);  // the numbers that it can hold at all

// A value of any type; unused components are 0. Colours are linear Rec. 709. A choice is its index.
using ParameterValue = std::array<double, 4>;

struct Parameter {
  std::string name;
  ParameterType type = ParameterType::real;
  ParameterValue defaultValue{};
  double min = -1e30;  // each component, inclusive
  double max = 1e30;
  std::string unit;  // "m", "deg", …; may be empty
  std::string help;
  int line = 0;  // of its declaration; 0: unknown

  std::vector<std::string> choices;  // of a choice: the values by name
  std::string defaultImage;          // of an image: a file of the program's folder; empty: white
  bool sRgb = true;                  // of an image: 8 and 16 bit colours are under the sRGB curve
};

// A limit narrower than the type's.
bool hasMin(const Parameter&);
bool hasMax(const Parameter&);
// "0.5,1,0", "true", the choice's name, the default image's file.
std::string formatDefault(const Parameter&);

// An image parameter's picture.
struct ImageValue {
  std::string parameter;
  std::string file;        // empty: 1 × 1 white
  bool ofProgram = false;  // `file` is one of Program::files; else a path
  bool sRgb = true;
};

// The bindless index of an image that nobody has put on the device.
inline constexpr std::uint32_t kNoParameterTexture = 0xFFFFFFFFu;

// The values of a program's parameters, starting with the defaults.
class ParameterValues {
 public:
  explicit ParameterValues(const std::vector<Parameter>& parameters);

  // "3", "0.5,1,0", "true", "name of a choice", "path/of/an/image.png" (empty: white); throws UsageError for an
  // unknown name (naming the nearest), a value that is not of the type, or one out of range.
  void set(const std::string& name, const std::string& text);
  // "name=value"
  void setAssignment(const std::string& assignment);
  // One value per parameter, in their order, already checked.
  void setAll(const std::vector<ParameterValue>& values);
  // An object: name → number, bool, list of numbers, or string (choice, image: a path from the file's folder).
  // `file`: as errors show it. Throws FileError with the place ("/tint", "byte 12"); then nothing is set.
  void setFromJson(const std::string& json, const std::string& file);
  // Every parameter, so that setFromJson gives the same values: {"tint": [1.0, 0.5, 0.0], "on": true}.
  std::string toJson() const;

  const ParameterValue& get(const std::string& name) const;
  const std::vector<Parameter>& parameters() const { return parameters_; }
  std::vector<ImageValue> images() const;  // one per image parameter, in their order

  // The GLSL struct Parameters in scalar layout, at least 4 bytes. `textures`: the bindless index of each of images().
  std::vector<std::byte> pack(std::span<const std::uint32_t> textures = {}) const;
  // "bounces=12 clamp=0": every parameter, for an image's metadata.
  std::string describe() const;

 private:
  std::size_t indexOf(const std::string& name) const;
  // `shown`: the value as the user wrote it.
  void assign(std::size_t parameter, const std::vector<double>& numbers, const std::string& shown);
  void assignText(std::size_t parameter, const std::string& text);
  [[noreturn]] void failType(std::size_t parameter, const std::string& shown) const;

  std::vector<Parameter> parameters_;
  std::vector<ParameterValue> values_;
  std::vector<std::optional<std::string>> imageFiles_;  // nothing: the default
};

using quintet::nearestName;

}  // namespace quintet::program
#endif
