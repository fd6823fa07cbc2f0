#version 460
#extension GL_EXT_ray_tracing : require

// The any-hit shader has counted.
void main() {}
