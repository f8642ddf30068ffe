// Constants and structs that the kernels of splatted light share with the CPU.
#ifndef SUNFLECK_GI_SPLATTING_SPLATTING_SHARED_H
#define SUNFLECK_GI_SPLATTING_SPLATTING_SHARED_H
#include "gi_module/low_resolution/low_resolution_shared.h"
#include "gi_module/transport/pixel_light_shared.h"
SHARED_BEGIN

// Pixel lights of a dispatch: 40 KiB of rows, within the uniform buffer range of every supported device. Which of them
// reach a pixel group is a mask of a bit each.
SHARED_CONSTANT uint splats_per_batch = 256u;
SHARED_CONSTANT uint splat_mask_words = 8u;

// Debug views in place of light.
SHARED_CONSTANT uint show_no_splats = 0u;
SHARED_CONSTANT uint show_overdraw = 1u;        // lights that are evaluated for a pixel
SHARED_CONSTANT uint show_splat_occlusion = 2u; // share of their light that arrives
SHARED_CONSTANT uint show_splat_places = 3u;    // where the lights are
SHARED_CONSTANT uint show_map_flux = 4u;        // texels of the reflective shadow maps, by flux
SHARED_CONSTANT uint show_importance = 5u;      // the same by importance
SHARED_CONSTANT float most_overdraw = 256.0f;   // white

// Dots where lights or texels are.
SHARED_FUNCTION bool shows_places(uint show) {
    return show == show_splat_places || show == show_map_flux || show == show_importance;
}

struct SplattingConstants {
    uint width; // of the picture
    uint height;
    uint group_count; // pixel groups of the low-resolution picture
    uint light_count; // in this batch
    uint map_side;    // texels of a light's shadow map
    float least;      // irradiance, W/m2, below which light may be cut; 0: nowhere
};

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::SplattingConstants) == 24);
static_assert(sunfleck::shared::splats_per_batch == 32 * sunfleck::shared::splat_mask_words);
#endif
#endif
