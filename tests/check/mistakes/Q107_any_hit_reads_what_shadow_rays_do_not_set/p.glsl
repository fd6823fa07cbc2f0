struct Payload { vec3 color; uint bits; };
