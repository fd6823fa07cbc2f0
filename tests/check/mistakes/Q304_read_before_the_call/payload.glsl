struct Payload {
  vec3 color;
};
struct Data {
  vec3 normal;  // in
  vec3 color;   // out
};
