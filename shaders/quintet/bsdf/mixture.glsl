// From the material's parameters to the lobes and the chances of sampling them.
#ifndef QUINTET_BSDF_MIXTURE_GLSL
#define QUINTET_BSDF_MIXTURE_GLSL

#include "../features.glsl"
#include "clearcoat.glsl"
#include "dielectric.glsl"
#include "diffuse.glsl"
#include "specular.glsl"
#include "thin.glsl"

// Colours and factors are linear and in [0,1] unless said otherwise.
struct BsdfParameters {
  vec3 baseColor;
  float metallic;
  float alpha;           // roughness squared
  float transmission;
  float ior;             // the material's, at least 1; 0: reflectance is specular * specularColor
  bool entering;         // wo is on the outside
  bool thin;             // a thin wall rather than a solid: transmission does not refract
  float specular;
  vec3 specularColor;    // at least 0
  float clearcoat;
  float clearcoatAlpha;  // clearcoatRoughness squared
  vec3 clearcoatNormal;  // unit, in the local frame
};

struct Bsdf {
  SpecularLobe specular;
  DiffuseLobe diffuse;
  ThinLobe thin;
  DielectricLobe dielectric;
  ClearcoatLobe clearcoat;
  AlbedoCell row;          // of the specular layer's roughness
  vec4 chance;             // of sampling coat, specular, diffuse, transmission: their sum is 1, or 0 for black
  float underCoat;         // passed by the clearcoat
  bool refractive;         // transmission is `dielectric`, not `thin`
  bool specularDelta;
  bool transmissionDelta;
  bool clearcoatDelta;
};

Bsdf makeBsdf(BsdfParameters p, vec3 wo) {
  vec3 baseColor = clamp(p.baseColor, 0.0, 1.0);
  float dielectric = 1.0 - p.metallic;
  float transmission = kHasTransmission ? p.transmission : 0.0;
  float opaque = dielectric * (1.0 - transmission);
  float clear = dielectric * transmission;
  float alpha = max(p.alpha, kDeltaAlpha);

  Bsdf b;
  b.refractive = kHasSolidTransmission && clear > 0.0 && !(kHasThinTransmission && p.thin);
  b.specularDelta = p.alpha < kDeltaAlpha;
  b.clearcoatDelta = p.clearcoatAlpha < kDeltaAlpha;

  // KHR_materials_specular: reflectance of the dielectric part.
  vec3 clearF0 = min(reflectanceFromIor(p.ior) * p.specularColor, 1.0);
  vec3 colorF0 = p.specular * clearF0;
  float f0 = maxComponent(colorF0);
  b.row = albedoRow(p.alpha);
  float schlick = schlickWeight(wo.z);
  vec2 lb = b.specularDelta ? vec2(0.0, schlick) : albedoSchlick(b.row, wo.z);
  vec2 average = albedoAverage(b.row);

  // The metal and all of the dielectric that `dielectric` does not reflect itself. For ior 0 it has no reflectance of
  // its own, and bends nothing: what the layer lets pass goes straight on.
  bool bends = b.refractive && p.ior >= 1.0;
  float reflecting = bends ? opaque : dielectric;
  b.specular.f0 = p.metallic * baseColor + reflecting * colorF0;
  b.specular.f90 = p.metallic + reflecting * p.specular;
  b.specular.alpha = alpha;

  // Multiple scattering in both, and how the layer of the dielectric is coupled to what lies below.
  vec3 colorMultiple = multipleFactor(colorF0, p.specular, average.x);
  vec3 multiple = lb.x * (p.metallic * multipleFactor(baseColor, 1.0, average.x) + reflecting * colorMultiple);
  vec3 single = albedoSingle(b.specular.f0, b.specular.f90, lb);
  b.specular.multiple = multiple / average.x;
  b.specular.multipleChance = luminance(multiple) / max(luminance(single + multiple), 1e-20);

  float layerMultiple = maxComponent(colorMultiple);
  vec3 passing = layerPassing(f0, p.specular, layerMultiple);
  float passed = layerPassed(passing, lb);
  b.diffuse.color = opaque * baseColor * (passed / max(layerPassed(passing, average), 1e-4));
  b.diffuse.passing = passing;

  vec3 clearColor = clear * baseColor;
  float through = lb.x * (1.0 - layerMultiple);
  b.thin = ThinLobe(clearColor, f0, p.specular, alpha, through / average.x * clearColor, min(through / max(passed, 1e-20), 1.0));

  // Where the indices nearly match, refraction is too narrow for its half vector: straight on.
  float ior = max(p.ior, 1.0);
  b.transmissionDelta = b.specularDelta || (b.refractive && (ior < 1.01 || p.alpha * (ior - 1.0) < 1e-5));
  vec2 glass = b.refractive && !b.transmissionDelta ? albedoGlass(wo.z, p.alpha, ior, p.entering) : vec2(1.0);
  b.dielectric.compensation = clear / mix(glass.y, glass.x, p.specular);
  b.dielectric.color = b.dielectric.compensation * (bends ? 1.0 : passed) * baseColor;
  b.dielectric.f0 = clearF0;
  b.dielectric.specular = bends ? p.specular : 0.0;
  b.dielectric.eta = p.entering ? ior : 1.0 / ior;
  b.dielectric.alpha = alpha;

  // The coat of a solid is on its outside only.
  bool coated = dot(wo, p.clearcoatNormal) > 0.0 && (p.entering || !b.refractive);
  b.clearcoat = ClearcoatLobe(p.clearcoatNormal, coated ? p.clearcoat : 0.0, max(p.clearcoatAlpha, kDeltaAlpha));
  float coat = kHasClearcoat ? clearcoatAlbedo(b.clearcoat, wo, b.clearcoatDelta) : 0.0;
  b.underCoat = 1.0 - coat;

  float tint = luminance(baseColor);
  float glassAlbedo = mix(tint, 1.0, max(fresnelDielectric(wo.z, b.dielectric.eta), 0.1));
  b.chance = vec4(coat, b.underCoat * luminance(single + multiple),
                  b.underCoat * opaque * tint * passed,
                  kHasTransmission ? b.underCoat * clear * (bends ? glassAlbedo : tint * passed) : 0.0);
  float sum = b.chance.x + b.chance.y + b.chance.z + b.chance.w;
  b.chance *= sum > 0.0 ? 1.0 / sum : 0.0;
  return b;
}

#endif
