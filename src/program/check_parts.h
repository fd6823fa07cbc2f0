// The parts of the check, one file each. They read the model and report.
#ifndef QUINTET_PROGRAM_CHECK_PARTS_H
#define QUINTET_PROGRAM_CHECK_PARTS_H

#include "program/check.h"
#include "program/link_model.h"

namespace quintet::program {

// Collects diagnostics: severity from the catalogue, each text once for a place.
class Report {
 public:
  void add(std::string_view id, const shader::Place& place, std::string text);
  std::vector<shader::Diagnostic> take();  // sorted by id, file, line
  bool has(std::string_view id) const;

 private:
  std::vector<shader::Diagnostic> diagnostics_;
};

struct CheckInput {
  const LinkModel& model;
  const SceneFacts* scene;  // null: any scene
  const DeviceLimits& limits;
  bool featureDefines;
};

void checkPayloads(const CheckInput& input, Report& report);                        // Q101 ... Q103
void checkPayloadMembers(const CheckInput& input, Report& report);                  // Q104, Q105
void checkHitAttributes(const CheckInput& input, Report& report);                   // Q201 ... Q203
void checkCallables(const CheckInput& input, Report& report);                       // Q301 ... Q303
void checkRecursion(const CheckInput& input, Report& report, CheckResult& result);  // Q401, Q402, depth, stack
void checkTable(const CheckInput& input, Report& report);                           // Q501 ... Q506
void checkFlags(const CheckInput& input, Report& report);                           // Q605
void checkGeometry(const CheckInput& input, Report& report);                        // Q601 ... Q604
void checkStages(const CheckInput& input, Report& report);                          // Q701 ... Q705, Q901 ... Q905
void checkUnused(const CheckInput& input, Report& report, CheckResult& result);     // Q801, Q802, reached

}  // namespace quintet::program
#endif
