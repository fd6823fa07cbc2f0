// The linked program as the check sees it: every stage's facts, every trace and call, and which stages each of them
// can reach over the program's tables. Arguments that are constants are taken exactly; of the others every value
// within the tables is assumed. No scene decides here: a hit group is reached if some geometry could be bound to it.
#ifndef QUINTET_PROGRAM_LINK_MODEL_H
#define QUINTET_PROGRAM_LINK_MODEL_H

#include <memory>

#include "program/link.h"
#include "shader/stage_facts.h"

namespace quintet::program {

// gl_RayFlags…EXT
constexpr std::uint32_t kFlagOpaque = 1, kFlagNoOpaque = 2, kFlagTerminateOnFirstHit = 4, kFlagSkipClosestHit = 8,
                        kFlagCullBack = 16, kFlagCullFront = 32, kFlagCullOpaque = 64, kFlagCullNoOpaque = 128,
                        kFlagSkipTriangles = 256, kFlagSkipBoxes = 512;

struct LinkStage {
  std::string file;  // as the program names it
  shader::Stage kind = shader::Stage::rayGeneration;
  std::unique_ptr<shader::StageFacts> facts;
};

// A place in a hit group's row of the table.
struct HitRow {
  std::size_t group = 0;
  std::size_t ray = 0;
};

enum class Role { miss, closestHit, anyHit, intersection, callable };

// One stage that a trace or a call can reach.
struct Edge {
  std::size_t stage = 0;  // in LinkModel::stages
  Role role = Role::miss;
  bool exact = true;      // by constant arguments; else assumed
  HitRow row;             // of the hit roles
  std::size_t index = 0;  // of misses and callables
};

struct TraceSite {
  std::size_t stage = 0;
  const shader::TraceFacts* trace = nullptr;
  std::vector<Edge> edges;
  std::vector<HitRow> hits;  // rows that a hit can use
  bool skipsClosestHit() const { return trace->flags.must(kFlagSkipClosestHit); }
};

struct CallSite {
  std::size_t stage = 0;
  const shader::CallFacts* call = nullptr;
  std::vector<Edge> edges;
};

struct LinkModel {
  LinkModel(const Program& program, const CompiledProgram& compiled);

  const Program& program;
  std::vector<LinkStage> stages;
  std::vector<MissShader> misses;
  std::vector<TraceSite> traces;
  std::vector<CallSite> calls;
  std::string problem;  // a module that cannot be analysed, and why; empty: all can

  std::size_t rayCount() const { return program.rays.size(); }
  const LinkStage* stage(const std::string& file) const;  // null: none
  const shader::StageFacts* facts(const std::string& file) const;
  const HitShaders& shaders(HitRow row) const;  // empty if the group has nothing for that ray type
  bool hasIntersection(std::size_t group) const;
  // Rows of the table that the trace can use for geometry of a group.
  std::vector<std::size_t> rayTypes(const shader::TraceFacts& trace) const;

  // "closest-hit shader 'a.rchit' (hit group 'surface', ray type 'primary')"
  std::string describe(const Edge& edge) const;
  std::string describe(HitRow row) const;  // "hit group 'surface', ray type 'primary'"
  // A place in the description of the program.
  shader::Place at(int line) const;
  // The place of a declaration, or the file of the stage alone.
  shader::Place at(const LinkStage& stage, const shader::Place& place) const;

 private:
  void addTraces(std::size_t stage);
  void addCalls(std::size_t stage);
  void reachHits(TraceSite& site);
  void addEdge(std::vector<Edge>& edges, const std::string& file, Edge edge) const;
};

}  // namespace quintet::program
#endif
