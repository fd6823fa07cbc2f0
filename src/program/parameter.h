// Parameters of a program: declared once in program.toml, set by --set name=value, read in GLSL as
// `parameters.name`.
#ifndef QUINTET_PROGRAM_PARAMETER_H
#define QUINTET_PROGRAM_PARAMETER_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace quintet::program {

enum class ParameterType { boolean, integer, real, vec2, vec3, vec4, color };

std::string_view typeName(ParameterType);   // as in program.toml: "bool", "int", "float", "vec2", …, "color"
std::string_view glslType(ParameterType);   // bool is a uint of 0 or 1
int componentCount(ParameterType);

// A value of any type; unused components are 0. Colours are linear Rec. 709.
using ParameterValue = std::array<double, 4>;

struct Parameter {
  std::string name;
  ParameterType type = ParameterType::real;
  ParameterValue defaultValue{};
  double min = -1e30;  // each component, inclusive
  double max = 1e30;
  std::string unit;    // "m", "deg", …; may be empty
  std::string help;
  int line = 0;        // of its declaration; 0: unknown
};

// The values of a program's parameters, starting with the defaults.
class ParameterValues {
 public:
  explicit ParameterValues(const std::vector<Parameter>& parameters);

  // "3", "0.5,1,0", "true"; throws UsageError for an unknown name (naming the nearest), a value that is
  // not of the type, or one out of range.
  void set(const std::string& name, const std::string& text);
  // "name=value"
  void setAssignment(const std::string& assignment);

  // One value per parameter, in their order, already checked.
  void setAll(const std::vector<ParameterValue>& values);

  const ParameterValue& get(const std::string& name) const;
  const std::vector<Parameter>& parameters() const { return parameters_; }

  // The GLSL struct Parameters in scalar layout, at least 4 bytes.
  std::vector<std::byte> pack() const;
  // "bounces=12 clamp=0": every parameter, for an image's metadata.
  std::string describe() const;

 private:
  std::vector<Parameter> parameters_;
  std::vector<ParameterValue> values_;
};

// The candidate with the smallest edit distance to `name`, or empty if none is near.
std::string nearestName(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace quintet::program
#endif
