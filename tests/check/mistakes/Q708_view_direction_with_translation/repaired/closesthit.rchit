#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 hitValue;
void main()
{
    vec3 viewObject = gl_WorldToObjectEXT * vec4(gl_WorldRayDirectionEXT, 0.0);
    hitValue = 0.5 - 0.5 * normalize(viewObject);
}
