// SPDX-License-Identifier: Apache-2.0
// SPIR-V modules of other applications as `quintet check --spirv` and the layer read them: validated and optimized, and, to
// reach the rules without the validator, as they are. All entry points form one pipeline. Specialization constants, and a
// shader binding table as an application writes it, are made of the words too.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "check/check.h"
#include "check/modules/stage_groups.h"
#include "check/modules/stage_module.h"
#include "check/modules/table_check.h"
#include "spirv/plain_code.h"
#include "spirv/plain_lines.h"
#include "spirv/shader_record.h"
#include "target.h"

namespace quintet::fuzz {
namespace {

void checkAll(const std::vector<check::ModuleStage>& stages) {
  const check::CheckResult result = check::checkModules(check::groupsOfStages(stages), stages, {});
  for (const Diagnostic& diagnostic : result.diagnostics) {
    if (diagnostic.text.find(spirv::kIdMark) != std::string::npos) reportFinding("a text has the mark of an id");
    if (diagnostic.file.find(spirv::kIdMark) != std::string::npos) reportFinding("a file has the mark of an id");
  }
}

// Some constants of small ids, of one or two words.
shader::SpecializationValues valuesOf(const std::vector<std::uint32_t>& words) {
  shader::SpecializationValues values;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::uint32_t id = words[(7 * i + 5) % words.size()], value = words[(3 * i + 2) % words.size()];
    values[id & 0xFu] = std::vector<std::uint32_t>(1 + (id >> 31), value);
  }
  return values;
}

// Regions with any address, stride and size, of which some bytes could be read.
void checkTables(const std::vector<std::uint32_t>& words, Input input) {
  std::size_t at = words.size();
  const auto next = [&] { return words[--at % words.size()]; };
  check::TableLimits limits{next() & 0x3Fu, next() & 0x3Fu, next() & 0x7Fu, next()};
  std::vector<check::TableGroup> groups;
  for (std::size_t i = 0; i < 6; ++i) {
    check::TableGroup group{static_cast<check::TableKind>(next() % check::kTableKinds), "group", {}, next() & 0xFFu};
    const std::size_t first = next() % input.size();
    group.handle.assign(
        input.begin() + static_cast<std::ptrdiff_t>(first),
        input.begin() + static_cast<std::ptrdiff_t>(std::min(first + limits.handleBytes, input.size())));
    groups.push_back(std::move(group));
  }
  std::array<check::TableRegion, check::kTableKinds> regions;
  for (check::TableRegion& region : regions) {
    region.address = std::uint64_t{next()} << (next() & 0x1Fu);
    region.stride = next() >> (next() & 0x1Fu);
    region.bytes = next() >> (next() & 0x1Fu);
    if ((next() & 1u) != 0) region.available = next() & 0xFFFFu;
    const std::size_t first = next() % input.size();
    const std::size_t count = std::min<std::size_t>({region.bytes, input.size() - first, next() & 0xFFFu});
    region.data.assign(input.begin() + static_cast<std::ptrdiff_t>(first),
                       input.begin() + static_cast<std::ptrdiff_t>(first + count));
  }
  for (const Diagnostic& d : check::checkTable(regions, groups, limits).diagnostics) checkMessage(d.text);
}

}  // namespace

void readInput(Input input) {
  std::vector<std::uint32_t> words(input.size() / sizeof(std::uint32_t));
  if (words.empty()) return;
  std::memcpy(words.data(), input.data(), words.size() * sizeof(std::uint32_t));
  std::string why;
  const auto summary = check::summarize(words, why);
  if (!summary) return checkMessage(why);
  std::vector<check::ModuleStage> optimized, raw;
  for (const spirv::EntryPoint& entry : summary->entryPoints) {
    const std::string name = "module " + std::to_string(raw.size());
    optimized.push_back(check::stageModule(name, words, entry, valuesOf(words)));
    raw.push_back({name, *check::stageOf(entry.stage), spirv::withEntryPoint(words, entry), {}});
    if (raw.size() == 8) break;
  }
  checkAll(optimized);
  checkAll(raw);
  checkTables(words, input);
  (void)spirv::withPlainLines(words);
  (void)spirv::withPlainCode(words);
  (void)spirv::withoutDeclaration(words, words.back());
  if (const auto module = spirv::Module::read(words)) (void)spirv::shaderRecordBytes(*module);
}

}  // namespace quintet::fuzz
