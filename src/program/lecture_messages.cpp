// The compiler's messages about names of the lecture form, in the words of its documentation.
#include <fmt/format.h>

#include "program/lecture.h"

namespace quintet::program {

void explainLectureNames(std::vector<shader::Diagnostic>& diagnostics, shader::Stage stage) {
  using shader::Stage;
  if (stage != Stage::rayGeneration && stage != Stage::miss && stage != Stage::callable) return;
  for (shader::Diagnostic& d : diagnostics) {
    for (const std::string_view name : {"hit", "baryCoord"}) {
      if (d.text != fmt::format("'{}' : undeclared identifier", name)) continue;
      d.id = "Q204";
      d.text =
          fmt::format("'{}' is not there in a {} shader: only intersection, any-hit and closest-hit shaders have a hit",
                      name, shader::stageName(stage));
    }
  }
}

}  // namespace quintet::program
