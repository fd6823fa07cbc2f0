// SPDX-License-Identifier: Apache-2.0
#include "spirv/newer_queries.h"

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <unordered_map>
#include <utility>

#include "spirv/raw_instructions.h"

namespace quintet::spirv {
namespace {

using spv::Op;

enum class Result { same, array, truth };

// An instruction of SPV_KHR_ray_tracing_position_fetch, SPV_NV_cluster_acceleration_structure or SPV_NV_linear_swept_spheres.
struct NewerQuery {
  std::uint32_t op;
  Result result;
  std::size_t operands;  // without result type and result
  Op known;              // with the same operands; for arrays it gives an element
  std::uint32_t count;   // of elements
};
constexpr NewerQuery kQueries[] = {
    {5340, Result::array, 2, Op::OpRayQueryGetIntersectionObjectRayOriginKHR, 3},  // triangle vertices
    {5345, Result::same, 2, Op::OpRayQueryGetIntersectionPrimitiveIndexKHR, 1},    // cluster of a ray query
    {5346, Result::same, 1, Op::OpHitObjectGetPrimitiveIndexNV, 1},                // cluster of a hit object
    {5427, Result::same, 2, Op::OpRayQueryGetIntersectionObjectRayOriginKHR, 1},   // position of a sphere
    {5428, Result::same, 2, Op::OpRayQueryGetIntersectionTKHR, 1},                 // radius of a sphere
    {5429, Result::array, 2, Op::OpRayQueryGetIntersectionObjectRayOriginKHR, 2},  // positions of a swept sphere
    {5430, Result::array, 2, Op::OpRayQueryGetIntersectionTKHR, 2},                // radii of a swept sphere
    {5431, Result::same, 2, Op::OpRayQueryGetIntersectionTKHR, 1},                 // hit value
    {5432, Result::same, 1, Op::OpHitObjectGetObjectRayOriginNV, 1},
    {5433, Result::same, 1, Op::OpHitObjectGetRayTMaxNV, 1},
    {5434, Result::array, 1, Op::OpHitObjectGetObjectRayOriginNV, 2},
    {5435, Result::array, 1, Op::OpHitObjectGetRayTMaxNV, 2},
    {5436, Result::truth, 1, Op::OpHitObjectGetRayTMaxNV, 1},  // is a sphere
    {5437, Result::truth, 1, Op::OpHitObjectGetRayTMaxNV, 1},  // is a swept sphere
    {5438, Result::same, 2, Op::OpRayQueryGetIntersectionFrontFaceKHR, 1},
    {5439, Result::same, 2, Op::OpRayQueryGetIntersectionFrontFaceKHR, 1}};

constexpr std::size_t kQueryBoundWord = 3;         // of the header
constexpr std::uint32_t kQueryIdLimit = 1u << 22;  // the validator's limit

class QueryRewriter {
 public:
  explicit QueryRewriter(Words words) : result_(headerOf(words)) { result_.reserve(words.size()); }

  std::vector<std::uint32_t> run(Words words) {
    for (const RawInstruction& i : RawInstructions(words)) {
      if (i.op == Op::OpTypeArray) elements_[i.at(0)] = i.at(1);
      if (i.op == Op::OpTypeFloat && i.at(1) == 32) float_ = i.at(0);
      if (!rewrite(i)) append(result_, i.words);
    }
    return std::move(result_);
  }

 private:
  void put(Op op, std::initializer_list<std::uint32_t> first, Words more) {
    result_.push_back(static_cast<std::uint32_t>((1 + first.size() + more.size()) << 16) |
                      static_cast<std::uint32_t>(op));
    result_.insert(result_.end(), first.begin(), first.end());
    append(result_, more);
  }

  bool rewrite(const RawInstruction& i) {
    const auto query = std::ranges::find(kQueries, static_cast<std::uint32_t>(i.op), &NewerQuery::op);
    if (query == std::end(kQueries) || i.operands.size() != 2 + query->operands) return false;
    const Words operands = i.operands.subspan(2);
    const std::uint32_t type = i.at(0), result = i.at(1), first = result_[kQueryBoundWord];
    if (query->result != Result::same && first >= kQueryIdLimit - 3) return false;
    switch (query->result) {
      case Result::same: put(query->known, {type, result}, operands); return true;
      case Result::array: {
        const auto element = elements_.find(type);
        if (element == elements_.end()) return false;
        std::vector<std::uint32_t> parts;
        for (std::uint32_t k = 0; k < query->count; ++k) {
          parts.push_back(first + k);
          put(query->known, {element->second, first + k}, operands);
        }
        put(Op::OpCompositeConstruct, {type, result}, parts);
        break;
      }
      case Result::truth:  // a comparison that does not say whether there is a hit
        if (float_ == 0) return false;
        put(query->known, {float_, first}, operands);
        put(Op::OpHitObjectGetRayTMinNV, {float_, first + 1}, operands);
        put(Op::OpFOrdLessThan, {type, result}, std::vector{first, first + 1});
        break;
    }
    result_[kQueryBoundWord] = first + 3;
    return true;
  }

  std::vector<std::uint32_t> result_;
  std::unordered_map<std::uint32_t, std::uint32_t> elements_;  // of array types
  std::uint32_t float_ = 0;                                    // the type; 0 if there is none yet
};

}  // namespace

std::vector<std::uint32_t> withKnownQueries(std::span<const std::uint32_t> words) {
  return QueryRewriter(words).run(words);
}

}  // namespace quintet::spirv
