// Eine Kugel im Nebel. Alle Namen sind deutsch, und "normale" ist hier eine Ebene.
struct RayPayloadType { vec3 licht; float strecke; };
uniform vec3 nebelfarbe;  // defaultval="0.6, 0.65, 0.7" type="color"
uniform float dichte;     // defaultval="0.1" min="0" max="1"

struct Ebene { vec3 normale; float abstand; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 bild = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 6.0), 0.001, normalize(vec3(bild, -2.0)), 40.0, 0);
  gsnSetPixel(vec4(mix(nebelfarbe, payload.licht, exp(-dichte * payload.strecke)), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  Ebene normal = Ebene(vec3(0.0, 1.0, 0.0), -1.0);
  vec3 ort = gl_ObjectToWorldEXT * vec4(gl_ObjectRayOriginEXT + gl_HitTEXT * gl_ObjectRayDirectionEXT, 1.0);
  float hoehe = dot(normal.normale, ort) - normal.abstand;
  payload.licht = vec3(clamp(0.3 * hoehe, 0.0, 1.0));
  payload.strecke = gl_HitTEXT;
}

void main() { /**** MISS SHADER ****/
  payload.licht = vec3(0.0);
  payload.strecke = 40.0;
}
