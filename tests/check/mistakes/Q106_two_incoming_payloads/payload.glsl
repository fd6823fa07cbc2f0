struct Payload {
  vec3 color;
};
struct Shadow {
  float visible;
};
