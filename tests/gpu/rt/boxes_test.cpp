// SPDX-License-Identifier: Apache-2.0
// Boxes with an intersection shader that reports the inscribed sphere.
#include "base/error.h"
#include "rt_test_support.h"

namespace quintet::rt::test {
namespace {

std::vector<Bounds3> randomBoxes(std::size_t count, std::uint32_t seed) {
  std::vector<Bounds3> boxes;
  const Mesh centers = randomMesh(count, seed);
  for (std::size_t k = 0; k < count; ++k) {
    const float radius = 0.02f + 0.03f * centers.positions[3 * k].x;
    boxes.push_back({centers.positions[3 * k] - radius, centers.positions[3 * k] + radius});
  }
  return boxes;
}

// Returns the nearest sphere that `accept` accepts.
template <class Accept>
Hit bruteForceSpheres(const std::vector<Bounds3>& boxes, const Ray& ray, const Accept& accept) {
  Hit best;
  double bestT = ray.tMax;
  const glm::dvec3 direction(ray.direction);
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    if (!accept(k)) continue;
    const glm::dvec3 toCenter = glm::dvec3(boxes[k].center()) - glm::dvec3(ray.origin);
    const double radius = 0.5 * boxes[k].extent().x, a = dot(direction, direction), b = dot(toCenter, direction);
    const double d = b * b - a * (dot(toCenter, toCenter) - radius * radius);
    if (d < 0.0) continue;
    for (const double t : {(b - std::sqrt(d)) / a, (b + std::sqrt(d)) / a}) {
      if (t < ray.tMin || t >= bestT) continue;
      bestT = t;
      best.t = static_cast<float>(t);
      best.primitive = static_cast<std::uint32_t>(k);
    }
  }
  return best;
}

template <class Accept>
void expectSpheres(const std::vector<Hit>& hits, const std::vector<Bounds3>& boxes, const std::vector<Ray>& rays,
                   const Accept& accept) {
  std::size_t different = 0, hitCount = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const Hit expected = bruteForceSpheres(boxes, rays[k], accept);
    hitCount += expected.t >= 0.0f;
    different +=
        std::abs(hits[k].t - expected.t) > 1e-3f || (expected.t >= 0.0f && hits[k].primitive != expected.primitive);
  }
  EXPECT_LE(different, rays.size() / 300);
  EXPECT_GT(hitCount, rays.size() / 20);
}

class BoxScene {
 public:
  BoxScene(const std::vector<Bounds3>& boxes, bool opaque, bool allowUpdate = false) : boxes_(boxes) {
    gpu::Context& context = quintet::test::testContext();
    deviceBoxes = gpu::makeBufferOf(context, boxes, 0, "boxes");
    BlasInput input{.geometries = {geometry(opaque)}, .options = {.allowUpdate = allowUpdate, .name = "boxes"}};
    blas = std::move(BlasBuilder(context).build({&input, 1})[0]);
    buildTlas();
  }
  GeometryInput geometry(bool opaque) const { return {.kind = GeometryKind::boxes, .boxes = boxes_, .opaque = opaque}; }
  void buildTlas() {
    const InstanceInput instance{.blas = &blas};
    tlas.buildAndWait({&instance, 1});
  }
  std::vector<Hit> trace(Group group, const std::vector<Ray>& rays) {
    const RecordData data{.map = blas.primitiveMap(0), .boxes = deviceBoxes.address()};
    return traceRays(tlas, contentsOf({hitRecord(group, data)}), rays);
  }
  const std::vector<Bounds3>& boxes_;
  gpu::Buffer deviceBoxes;
  Blas blas;
  Tlas tlas{quintet::test::testContext(), 1};
};

constexpr auto kAll = [](std::size_t) { return true; };
constexpr auto kOdd = [](std::size_t k) { return k % 2 == 1; };

TEST(RtBoxes, MatchesBruteForce) {
  const std::vector<Bounds3> boxes = randomBoxes(800, 51);
  BoxScene scene(boxes, true);
  const std::vector<Ray> rays = randomRays(3000, 52);
  const std::vector<Hit> hits = scene.trace(kBoxHit, rays);
  expectSpheres(hits, boxes, rays, kAll);
  for (const Hit& hit : hits) EXPECT_TRUE(hit.t < 0.0f || hit.kind == 1 || hit.kind == 2);
}

// Two hit groups with the same intersection shader and different any-hit shaders (Quirks::sharesAnyHit).
TEST(RtBoxes, RunsTheAnyHitShaderOfEachGroup) {
  const std::vector<Bounds3> boxes = randomBoxes(800, 53);
  BoxScene scene(boxes, false);
  const std::vector<Ray> rays = randomRays(3000, 54);
  expectSpheres(scene.trace(kBoxHit, rays), boxes, rays, kAll);
  expectSpheres(scene.trace(kBoxHitOddOnly, rays), boxes, rays, kOdd);
}

TEST(RtBoxes, SkipsInactiveBoxes) {
  std::vector<Bounds3> boxes = randomBoxes(300, 55);
  boxes[0].max.y = std::numeric_limits<float>::infinity();
  boxes[17].min.x = std::numeric_limits<float>::quiet_NaN();
  boxes[299] = Bounds3{};
  BoxScene scene(boxes, true);
  EXPECT_EQ(scene.blas.inactiveCount(), 3u);
  const std::vector<Ray> rays = randomRays(2000, 56);
  expectSpheres(scene.trace(kBoxHit, rays), boxes, rays, [](std::size_t k) { return k != 0 && k != 17 && k != 299; });
}

TEST(RtBoxes, RefitsMovedBoxes) {
  std::vector<Bounds3> boxes = randomBoxes(300, 57);
  BoxScene scene(boxes, true, true);
  for (Bounds3& box : boxes) box = {box.min + vec3(0.2f, 0, 0), box.max + vec3(0.2f, 0, 0)};
  BlasBuilder(quintet::test::testContext()).refit(scene.blas, {.geometries = {scene.geometry(true)}, .options = {}});
  scene.deviceBoxes.uploadAs(std::span<const Bounds3>(boxes));
  scene.buildTlas();
  const std::vector<Ray> rays = randomRays(2000, 58);
  expectSpheres(scene.trace(kBoxHit, rays), boxes, rays, kAll);
}

}  // namespace
}  // namespace quintet::rt::test
