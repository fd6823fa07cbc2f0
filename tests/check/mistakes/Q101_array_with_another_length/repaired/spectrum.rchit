#version 460
#extension GL_EXT_ray_tracing : require
#define NSAMPLES 8
layout(location = 0) rayPayloadInEXT Spectrum { float s[NSAMPLES]; } radiance;
void main() { for (int i = 0; i < NSAMPLES; ++i) radiance.s[i] = exp(-float(i)); }
