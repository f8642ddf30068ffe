// Textures and patterns in an enlarged picture, by the light of the pixels that it is made of: subpixel_edges.h.
#include "engine/render/composition_shared.h"
#include "engine/render/four_pixels.glsl"
#include "engine/render/tone_map.h"

layout(constant_id = 1) const uint has_gloss = 0;
layout(set = 0, binding = 9) uniform sampler2D albedo_image; // this and the next two: of the source's size
layout(set = 0, binding = 10) uniform sampler2D irradiance_image;
layout(set = 0, binding = 11) uniform sampler2D specular_image; // see CompositionInput; any without gloss

// Of four pixels, exposed.
struct FourPixels {
    vec3 light[4]; // what a white surface would reflect diffusely
    vec3 rest[4];  // what the pixel shows besides its own diffuse reflection: gloss, glare
};

// `shown`: the display values of a pixel of the source.
void find_light(inout FourPixels pixels, int i, ivec2 pixel, vec3 shown) {
    const vec4 texel = texelFetch(albedo_image, pixel, 0);
    vec3 light = texelFetch(irradiance_image, pixel, 0).rgb * constants.exposed;
    if (texel.a <= albedo_of_nothing)
        light = vec3(0.0); // nobody says what the image holds there
    if (has_gloss != 0 && abs(texel.a - albedo_glossy) < albedo_step)
        light *= texelFetch(specular_image, pixel, 0).a;
    pixels.light[i] = light;
    // Never negative, as it would be where display values are the greatest that there are.
    const vec3 exposed = radiance_from_display(linear_from_srgb_colour(shown), 1.0);
    pixels.rest[i] = max(exposed - light * unpack_albedo(texel), vec3(0.0));
}

// Display values of a surface with that square root of albedo in the light of the four.
vec3 detailed_colour(FourPixels pixels, vec4 shares, vec3 root) {
    return display_from_radiance(weighted(pixels.rest, shares) + root * root * weighted(pixels.light, shares), 1.0);
}
