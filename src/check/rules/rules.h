// SPDX-License-Identifier: Apache-2.0
// The rules of the check. check.cpp calls them, in order. Each id belongs to one rule, as the catalog says.
#ifndef QUINTET_CHECK_RULES_RULES_H
#define QUINTET_CHECK_RULES_RULES_H

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "check/device_limits.h"
#include "check/pipeline_graph.h"
#include "check/report.h"

namespace quintet::check {

// Rules across stages (rules/across_stages). Those that take a ProgramInput depend on Quintet's layout of the shader
// binding table, its library, or the description of a program, so they cannot run for raw modules.

struct CheckInput {
  const PipelineGraph& graph;
  const program::SceneFacts* scene;  // null for any scene
  const DeviceLimits& limits;
  bool featureDefines = false;  // the shaders are compiled for one scene, so code can be missing
  std::optional<std::set<std::size_t>> usedGroups = {};  // hit groups of the scene's geometry; nullopt for any scene
};

struct ProgramInput : CheckInput {
  const program::Program& program;
  std::vector<std::string> outputs = {};  // names of the optional outputs that are rendered
};

struct RecursionNeeds {
  std::uint32_t depth = 1;              // of nested traces
  std::uint64_t stackBytes = 0;         // of payloads, callable data and hit attributes
  bool cyclic = false;                  // traces form a cycle, so only a run can exceed the declared depth
  std::vector<std::size_t> chain = {};  // stages along the longest chain of traces, from ray generation on
};

class PayloadReceivers;
void checkPayloadTypes(const CheckInput& input, const PayloadReceivers& receivers, Report& report);  // Q101, Q103, Q106
void checkPayloadMembers(const CheckInput& input, const PayloadReceivers& receivers, Report& report);  // Q104, Q105
void checkPayloadInputs(const CheckInput& input, const PayloadReceivers& receivers, Report& report);   // Q107
void checkSharedLocations(const ProgramInput& input, Report& report);                                  // Q102, Q303
void checkHitAttributes(const CheckInput& input, Report& report);        // Q201 to Q203, Q205
void checkCandidates(const CheckInput& input, Report& report);           // Q206, Q606
void checkCallableData(const CheckInput& input, Report& report);         // Q304
void checkOutputs(const ProgramInput& input, Report& report);            // Q712, Q714
void checkCallableTypes(const CheckInput& input, Report& report);        // Q301
RecursionNeeds checkRecursion(const CheckInput& input, Report& report);  // Q401, Q402
void checkArguments(const CheckInput& input, Report& report);            // Q302, Q502 to Q506, Q605
void checkRecordLayout(const ProgramInput& input, Report& report);       // Q501 in Quintet's layout
void checkHitRecords(const CheckInput& input, Report& report);           // Q515, Q609, Q610
void checkArrayIndices(const CheckInput& input, Report& report);         // Q711
void checkEndlessRecursion(const CheckInput& input, Report& report);     // Q403
void checkGeometry(const ProgramInput& input, Report& report);           // Q601 to Q604
void checkHitKinds(const CheckInput& input, Report& report);             // Q608
void checkTriangleKinds(const ProgramInput& input, Report& report);      // Q607
void checkHitPositions(const CheckInput& input, Report& report);         // Q717
void checkMissDistances(const CheckInput& input, Report& report);        // Q719
void checkRandomSeeds(const ProgramInput& input, Report& report);        // Q718
void checkRayArguments(const CheckInput& input, Report& report);         // Q507 to Q510, Q512, Q513
void checkStrides(const ProgramInput& input, Report& report);            // Q511
void checkResources(const ProgramInput& input, Report& report);          // Q651 to Q654
void checkRayOrigins(const CheckInput& input, Report& report);           // Q705
void checkRayOrigins(const spirv::Module& module, Report& report);       // Q705 within one stage
void checkUnreachableStages(const CheckInput& input, Report& report);    // Q801
class PipelineSpaces;
void checkSpaces(const CheckInput& input, const PipelineSpaces& spaces, Report& report);           // Q702, Q708 to Q710
void checkUnusedHitGroups(const ProgramInput& input, Report& report);                              // Q802
void checkSharedIntersections(const ProgramInput& input, Report& report);                          // Q903
void checkColorEncoding(const ProgramInput& input, const PipelineSpaces& spaces, Report& report);  // Q715

// The parts of checkSpaces(). `stage` is an index of PipelineGraph::stages.
// `transformed`: instances have transforms, as far as known.
void checkSpaces(const PipelineSpaces& spaces, std::size_t stage, bool transformed,
                 Report& report);                               // Q702, Q708, Q709
void checkSpaces(const spirv::Module& module, Report& report);  // the same, of one stage alone
void checkBarycentrics(const PipelineSpaces& spaces, std::size_t stage, Report& report);  // Q710

// Rules within one stage (rules/within_stage): they follow values through a module that was compiled with `optimize`
// and `debugInfo`. A value that cannot be followed is not reported.

struct StageContext {
  bool usesLibrary = false;  // structures with the names of the shader library are those of the library
  bool hasAnyHit = false;    // a hit group of the intersection shader has an any-hit shader
  DriverDefects defects;     // of the device
};

// What only programs have.
struct ProgramStageContext {
  bool keepsInstanceOrder = false;  // Program::keepsInstanceOrder: gl_InstanceID is the index in the scene
};

void checkDistance(const spirv::Module& module, Report& report);           // Q701
void checkInstanceIndices(const spirv::Module& module, Report& report);    // Q703
void checkDescriptorIndices(const spirv::Module& module, Report& report);  // Q704
void checkPrintFormats(const spirv::Module& module, Report& report);       // Q707
void checkPixels(const spirv::Module& module, Report& report);             // Q713
// `library`: structures with the names of the library are those of the library.
void checkPixelDivision(const spirv::Module& module, bool library, Report& report);  // Q716
void checkNestedBuiltIns(const spirv::Module& module, Report& report);               // Q901
void checkAttributeWrites(const spirv::Module& module, Report& report);              // Q902
void checkRayLengths(const spirv::Module& module, Report& report);                   // Q514
void checkRayTmaxReads(const spirv::Module& module, Report& report);                 // Q904
void checkLocalArrays(const spirv::Module& module, Report& report);                  // Q905

}  // namespace quintet::check
#endif
