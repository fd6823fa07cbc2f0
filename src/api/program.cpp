#include "api/impl.h"

namespace quintet {

Program Program::load(const std::string& nameOrPath) {
  Program result;
  result.impl_ = std::make_shared<const Impl>(Impl{program::loadProgram(nameOrPath)});
  return result;
}

std::vector<std::string> Program::builtIn() { return program::builtInPrograms(); }
std::string Program::name() const { return impl_->program.name; }
std::string Program::description() const { return impl_->program.description; }

std::vector<ParameterInfo> Program::parameters() const {
  std::vector<ParameterInfo> result;
  for (const program::Parameter& p : impl_->program.parameters)
    result.push_back(
        {p.name, std::string(program::typeName(p.type)), program::formatDefault(p), p.min, p.max, p.unit, p.help});
  return result;
}

std::vector<std::string> Program::outputs() const { return program::outputNames(impl_->program); }

}  // namespace quintet
