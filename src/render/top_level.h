// The instances of a scene on the device: their table, which shaders index by gl_InstanceCustomIndexEXT, and the
// top-level acceleration structure, rebuilt for a number of ray types, an order, or a frame of the animation.
#ifndef QUINTET_RENDER_TOP_LEVEL_H
#define QUINTET_RENDER_TOP_LEVEL_H

#include <memory>
#include <span>
#include <vector>

#include "quintet/shared/frame.h"
#include "rt/acceleration_structure.h"
#include "scene/scene.h"

namespace quintet::render {

// What an instance refers to in the scene's arrays.
struct InstancePlace {
  const rt::Blas* blas = nullptr;
  std::uint32_t firstGeometry = 0;
  std::uint32_t firstLightSlot = 0;
};

class TopLevel {
 public:
  // One place per instance; `scene` is needed during construction only. Frame 0.
  TopLevel(gpu::Context& context, const scene::Scene& scene, std::span<const InstancePlace> places);

  shared::Address table() const { return table_.address(); }  // shared::InstanceData[]; the same for all frames
  std::vector<mat4> places() const;  // world from object of each instance, at the present frame
  // The table of the frame before the one that was set last (frame 0: itself); 0: nothing has keyframes.
  shared::Address previousTable() const { return animated() ? previousTable_.address() : 0; }
  bool animated() const { return !moving_.empty(); }

  // Hit record of geometry k and ray type r: k · rayTypeCount + r. keepOrder: gl_InstanceID is the instance's index in
  // the scene. anyHitForAll: no instance is opaque unless it is forced to be. Blocks; returns false if nothing had to
  // be done.
  bool prepareFor(std::uint32_t rayTypeCount, bool keepOrder, bool anyHitForAll);
  // Moves what has keyframes. Blocks; the device must not be tracing. False: it was there already.
  bool setFrame(float frame);

  const rt::Tlas& structure() const { return *tlas_; }  // after prepareFor

 private:
  void build();

  gpu::Context& context_;
  std::vector<scene::Instance> moving_;     // those with keyframes
  std::vector<std::uint32_t> movingIndex_;  // their indices in the scene
  std::vector<shared::InstanceData> data_;
  std::vector<rt::InstanceInput> inputs_;
  gpu::Buffer table_, previousTable_;
  std::unique_ptr<rt::Tlas> tlas_;
  std::uint32_t rayTypeCount_ = 0;
  bool keepOrder_ = false;
  bool anyHitForAll_ = false;
  float frame_ = 0.0f;
};

}  // namespace quintet::render
#endif
