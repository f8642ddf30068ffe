#ifndef SUNFLECK_ENGINE_RENDER_COMPOSITION_SHARED_H
#define SUNFLECK_ENGINE_RENDER_COMPOSITION_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// What the composition shows.
SHARED_CONSTANT uint view_final = 0u;
SHARED_CONSTANT uint view_irradiance = 1u;
SHARED_CONSTANT uint view_normals = 2u;
SHARED_CONSTANT uint view_albedo = 3u;
SHARED_CONSTANT uint view_depth = 4u;
SHARED_CONSTANT uint view_surfaces = 5u;
SHARED_CONSTANT uint view_motion = 6u;
SHARED_CONSTANT uint view_false_colours = 7u; // the irradiance image as it is

struct CompositionConstants {
    uint view;
    uint tone_map;  // 0: scene-linear output, 1: exposure, tone curve and sRGB
    float exposure; // exposure_factor(EV100)
    uint width;
    uint height;
    float sky_red, sky_green,
        sky_blue;       // radiance where nothing is, W/(sr m2); times the sky's picture, if there is one
    float sky_rotation; // rad, of that picture
    float glare_share;  // of what shines, scattered
    uint has_gloss;     // 1: the image of specular light holds that of glossy pixels
};

// Glare is found at a fraction of the size, and the coarser levels of its pyramid; the image is the sum of them all.
SHARED_CONSTANT uint glare_block = 8u; // pixels, of the side
SHARED_CONSTANT uint glare_levels = 4u;

// Points at which the exposure meter measures a picture.
SHARED_CONSTANT uint meter_columns = 48u;
SHARED_CONSTANT uint meter_rows = 27u;

// The albedo image holds square roots, which spread 8 bits about as sRGB does and cost a CPU device much less. Its
// alpha says what the pixel is, so that the final picture need not read surface ids.
SHARED_CONSTANT float albedo_of_nothing = 0.0f; // no surface
SHARED_CONSTANT float albedo_unlit = 0.5f;      // shown as it is, whatever the light
SHARED_CONSTANT float albedo_glossy = 0.75f;    // lit, and reflects by microfacets
SHARED_CONSTANT float albedo_lit = 1.0f;
SHARED_CONSTANT float albedo_step = 0.1f; // within which the alpha is one of these
SHARED_FUNCTION vec4 pack_albedo(vec3 albedo, bool unlit, bool glossy) {
    return vec4(sqrt(max(albedo, vec3(0.0f))), unlit ? albedo_unlit : glossy ? albedo_glossy : albedo_lit);
}
SHARED_FUNCTION vec3 unpack_albedo(vec4 texel) {
    return vec3(texel) * vec3(texel);
}

// An emitting surface in the final picture.
struct EmissionConstants {
    vec4 model[3];          // as in DrawConstants
    vec4 emission_exposure; // rgb: radiance W/(sr m2); w: exposure_factor(EV100)
    uint surface;           // as in the G-buffer
    float glare_share;
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::CompositionConstants) == 44);
static_assert(sizeof(sunfleck::shared::EmissionConstants) == 72);
#endif
#endif
