struct Light {
  vec3 color;
  float power;
};
struct Payload {
  Light light;
  float t;  // negative if the ray hit nothing
};
