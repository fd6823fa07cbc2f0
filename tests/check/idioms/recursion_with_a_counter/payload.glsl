struct Bounce { vec3 color; uint remaining; };
