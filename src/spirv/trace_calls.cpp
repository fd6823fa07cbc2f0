// SPDX-License-Identifier: Apache-2.0
#include "spirv/trace_calls.h"

#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "spirv/module.h"
#include "spirv/module_writer.h"

namespace quintet::spirv {

std::vector<std::uint32_t> addTraceCalls(const std::vector<std::uint32_t>& words) {
  using spv::Op;
  std::string why;
  const std::optional<Module> module = Module::read(words, &why);
  if (!module) throw Error(fmt::format("cannot read the SPIR-V of a stage with heat maps: {}", why));
  const Id begin = module->functionNamed("heatTraceBegin_"), end = module->functionNamed("heatTraceEnd_"),
           keep = module->functionNamed("heatKeep_");
  if (begin == 0 || end == 0 || keep == 0) throw Error("a module with heat maps has no functions for them");
  const Id voidType = module->definition(begin)->type;
  ModuleWriter out(words);
  while (!out.atEnd()) {
    const Op op = out.next();
    if (op == Op::OpFunctionCall && out.word(3) == keep) {
      out.skip();
    } else if (op == Op::OpTraceRayKHR) {  // acceleration structure, flags, mask, …
      out.emit(Op::OpFunctionCall, {voidType, out.newId(), begin, out.word(2), out.word(3)});
      out.copy();
      out.emit(Op::OpFunctionCall, {voidType, out.newId(), end});
    } else {
      out.copy();
    }
  }
  return out.take();
}

}  // namespace quintet::spirv
