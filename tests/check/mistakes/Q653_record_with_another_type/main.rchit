#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 c;
layout(shaderRecordEXT) buffer SbtData {  // EXPECT Q653
  uint materialIndex;
  vec4 albedo;
} sbt;
void main() {
  c = sbt.albedo.rgb * (sbt.materialIndex == 0u ? 1.0 : 0.5);
}
