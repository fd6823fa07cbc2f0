#version 460
#extension GL_EXT_ray_tracing : require
struct hitPayload
{
  vec3 hitValue;
};
layout(location = 0) rayPayloadInEXT hitPayload prd;
layout(push_constant) uniform PushConstantRay  // EXPECT Q652
{
  vec4  clearColor;
  vec3  lightPosition;
  float lightIntensity;
  int   lightType;
} pcRay;

void main()
{
  prd.hitValue = pcRay.clearColor.xyz * 0.8;
}
