// Where a point of the scene lies in a reflective shadow map, and what else the kernel shares with the CPU.
#ifndef SUNFLECK_GI_RSM_GATHER_RSM_GATHER_SHARED_H
#define SUNFLECK_GI_RSM_GATHER_RSM_GATHER_SHARED_H
#include "gi_module/low_resolution/low_resolution_shared.h"
#include "gi_module/transport/pixel_light_shared.h"
SHARED_BEGIN

SHARED_CONSTANT uint gather_maps_per_batch = 384u; // 36 KiB: within the uniform buffer range of every supported device

// How texels of a map follow from places, the inverse of sample_emitter_ray (gi_module/light_sampling/emitters.h).
SHARED_CONSTANT uint no_map_layout = 0u;     // neighbours in the map are not neighbours in the scene
SHARED_CONSTANT uint sphere_map_layout = 1u; // directions from a point
SHARED_CONSTANT uint cone_map_layout = 2u;   // the same within a cone
SHARED_CONSTANT uint cosine_map_layout = 3u; // directions from a flat light, as dense as their cosine
SHARED_CONSTANT uint disc_map_layout = 4u;   // places on a disc across parallel light

struct GatherMapRow {
    vec4 origin_flux; //  0: xyz: of the emitter; w: flux of a texel whose packed flux is 1, W
    vec4 axis_x;      // 16: w: of a cone 1 / (1 - cosine of its angle), of a disc 1 / radius
    vec4 axis_y;      // 32
    vec4 axis_z;      // 48: direction that the emitter looks in
    uint kind;        // 64
    uint side;        // texels, a power of two
    uint first_light;
    uint first_sample; // of the pattern
    uint sample_count; // 80
    uint unused0;
    uint unused1;
    uint unused2;
};

// A texel to look up: offset from the pixel's place in the map, texels; how many texels it stands for.
struct GatherSample {
    vec2 offset;
    float weight;
    float softness; // times that of its texel alone
};

struct GatherConstants {
    uint map_count; // in this batch
    float scale;    // of all light
};

// Share of a turn, 0 to 1.
SHARED_FUNCTION float turn_of(vec2 direction) {
    float turn = atan(direction.y, direction.x) * (0.5f / pixel_light_pi);
    return turn < 0.0f ? turn + 1.0f : turn;
}

// In [0, 1]^2, x along rows. In every map, y is an angle: its ends meet.
SHARED_FUNCTION vec2 place_in_map(GatherMapRow map, vec3 point) {
    vec3 way = point - vec3(map.origin_flux);
    vec3 local = vec3(dot(vec3(map.axis_x), way), dot(vec3(map.axis_y), way), dot(vec3(map.axis_z), way));
    if (map.kind == no_map_layout)
        return vec2(0.5f, 0.5f);
    if (map.kind == disc_map_layout) {
        float radius = length(vec2(local)) * map.axis_x.w;
        return vec2(min(radius * radius, 1.0f), turn_of(vec2(local)));
    }
    vec3 direction = local / max(length(local), 1e-12f);
    if (map.kind == cone_map_layout)
        return vec2(clamp((1.0f - direction.z) * map.axis_x.w, 0.0f, 1.0f), turn_of(vec2(direction)));
    if (map.kind == cosine_map_layout) {
        vec3 normal = vec3(map.axis_z); // the other axes are those of the scene: see sample_cosine_direction
        vec3 world = way / max(length(way), 1e-12f);
        direction = 2.0f * dot(world, normal) * world - normal;
    }
    return vec2(0.5f - 0.5f * direction.z, turn_of(vec2(direction)));
}

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::GatherMapRow) == 96);
static_assert(sizeof(sunfleck::shared::GatherSample) == 16);
#endif
#endif
