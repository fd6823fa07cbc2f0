struct Payload {
  vec3 color;
  float t;  // negative: nothing was hit
};

struct BallHit {
  vec3 normal;
};
