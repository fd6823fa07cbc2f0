#define RAY_MASK_CAMERA 0x01
#define RAY_MASK_SHADOW 0x08
struct Payload {
  vec3 color;
  float t;
};
