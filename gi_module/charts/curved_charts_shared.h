// Charts of curved surfaces as shaders read them. See curved_charts.h.
#ifndef SUNFLECK_GI_MANY_LIGHT_CURVED_CHARTS_SHARED_H
#define SUNFLECK_GI_MANY_LIGHT_CURVED_CHARTS_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

SHARED_CONSTANT uint curved_directions = 6u; // charts of an instance: along +x, -x, +y, -y, +z, -z

// A texel's point of the surface, world space.
struct CurvedPoint {
    vec4 position;
    uint normal; // shading normal, see pack_normal
    uint geometric_normal;
    uint exists; // 0: no surface here
    uint unused;
};

// By chart.
struct CurvedChartRow {
    vec4 place; // position of texel (0, 0) and of height 0, m; texels per m
    vec4 size;  // columns and rows (0: empty chart), first texel, height units per m
};

// Heights within a chart are in [0, 1/2]; rough cells have this value instead.
SHARED_CONSTANT float curved_rough = 1.0f;
SHARED_CONSTANT float curved_max_height = 0.5f;
// Charts contain surfaces that are up to 66 degrees off their direction, a slope of 2.25. Over the diagonal of a cell
// that is a height of 3.2 cells; more is a step. From the mean of a cell's corners it is half of that.
SHARED_CONSTANT float curved_min_cosine = 0.4f;
SHARED_CONSTANT float curved_cell_span = 3.3f;
SHARED_CONSTANT float curved_point_span = 1.7f;

// The direction nearest to a normal.
SHARED_FUNCTION uint curved_direction(vec3 n) {
    float x = abs(n.x), y = abs(n.y), z = abs(n.z);
    if (x >= y && x >= z)
        return n.x >= 0.0f ? 0u : 1u;
    if (y >= z)
        return n.y >= 0.0f ? 2u : 3u;
    return n.z >= 0.0f ? 4u : 5u;
}

// Coordinates on the chart's plane and height above it, m.
SHARED_FUNCTION vec3 curved_place(uint direction, vec3 p) {
    float side = (direction & 1u) == 0u ? 1.0f : -1.0f;
    if (direction < 2u)
        return vec3(p.y, p.z, side * p.x);
    if (direction < 4u)
        return vec3(p.z, p.x, side * p.y);
    return vec3(p.x, p.y, side * p.z);
}

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::CurvedPoint) == 32);
static_assert(sizeof(sunfleck::shared::CurvedChartRow) == 32);
#endif
#endif
