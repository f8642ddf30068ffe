// How a pixel finds the visibility node that it belongs to: instance row -> charts -> cell -> node. The only inputs
// from the G-buffer are position, geometric normal and surface id.
#ifndef SUNFLECK_GI_VISIBILITY_SURFACE_LOOKUP_SHARED_H
#define SUNFLECK_GI_VISIBILITY_SURFACE_LOOKUP_SHARED_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

SHARED_CONSTANT uint no_node = 0xffffffffu;

// By instance row.
struct SurfaceInstance {
    uint first_chart;
    uint chart_count;
    uint first_box_node; // for points in no chart; no_node if there is none
    uint octants;        // 1: eight box nodes, by octant around `centre`
    vec3 centre;
    uint first_curved_chart; // of baked light (curved_charts.h); no_node if there is none. Filled in by the uploader
};

// A planar rectangle: coordinates (u, v) in [0, 1]^2 = (dot(u_axis, (p, 1)), dot(v_axis, (p, 1))).
struct SurfaceChart {
    vec4 plane; // dot(xyz, p) + w = 0, xyz towards the lit side
    vec4 u_axis;
    vec4 v_axis;
    uint first_cell;
    uint columns; // of cells
    uint rows;
    uint cut_sides; // where the surface goes on as another chart: chart_cut_low_u and the like
};

SHARED_CONSTANT uint chart_cut_low_u = 1u;
SHARED_CONSTANT uint chart_cut_high_u = 2u;
SHARED_CONSTANT uint chart_cut_low_v = 4u;
SHARED_CONSTANT uint chart_cut_high_v = 8u;

// State of a pair of node and sample in a visibility row, two bits each, sixteen pairs per word.
SHARED_CONSTANT uint pair_full = 0u;    // blocked: no light arrives
SHARED_CONSTANT uint pair_none = 1u;    // unblocked
SHARED_CONSTANT uint pair_partial = 2u; // may be blocked: the shadow map decides
SHARED_CONSTANT uint pair_unlit = 3u;   // facing away: no light arrives
SHARED_CONSTANT uint pairs_per_word = 16u;

// Tolerances of a pixel's reconstructed position and packed normal.
SHARED_CONSTANT float chart_distance = 2e-3f; // m, from the chart's plane
SHARED_CONSTANT float chart_cosine = 0.999f;
SHARED_CONSTANT float chart_margin = 1e-3f; // beyond the border, as a fraction of the chart's sides
SHARED_CONSTANT float cut_margin = 1e-6f;   // the same where another chart begins: what rounding may leave between them

// Whether a point with this geometric normal lies on the chart.
SHARED_FUNCTION bool on_chart(SurfaceChart chart, vec3 position, vec3 geometric_normal) {
    float u = dot(vec3(chart.u_axis), position) + chart.u_axis.w;
    float v = dot(vec3(chart.v_axis), position) + chart.v_axis.w;
    return dot(vec3(chart.plane), geometric_normal) > chart_cosine &&
           abs(dot(vec3(chart.plane), position) + chart.plane.w) < chart_distance &&
           abs(u - 0.5f) < 0.5f + chart_margin && abs(v - 0.5f) < 0.5f + chart_margin;
}

// Whether a point on the chart, or in its margin, lies beyond a side where another chart begins.
SHARED_FUNCTION bool beyond_cut(SurfaceChart chart, vec3 position) {
    float u = dot(vec3(chart.u_axis), position) + chart.u_axis.w;
    float v = dot(vec3(chart.v_axis), position) + chart.v_axis.w;
    return ((chart.cut_sides & chart_cut_low_u) != 0u && u < -cut_margin) ||
           ((chart.cut_sides & chart_cut_high_u) != 0u && u > 1.0f + cut_margin) ||
           ((chart.cut_sides & chart_cut_low_v) != 0u && v < -cut_margin) ||
           ((chart.cut_sides & chart_cut_high_v) != 0u && v > 1.0f + cut_margin);
}

// The cell of a point on the chart; the point is clamped to the chart.
SHARED_FUNCTION uint chart_cell(SurfaceChart chart, vec3 position) {
    float u = dot(vec3(chart.u_axis), position) + chart.u_axis.w;
    float v = dot(vec3(chart.v_axis), position) + chart.v_axis.w;
    uint column = uint(clamp(u * float(chart.columns), 0.0f, float(chart.columns) - 1.0f));
    uint row = uint(clamp(v * float(chart.rows), 0.0f, float(chart.rows) - 1.0f));
    return chart.first_cell + row * chart.columns + column;
}

SHARED_FUNCTION uint box_node(SurfaceInstance instance, vec3 position) {
    if (instance.octants == 0u || instance.first_box_node == no_node)
        return instance.first_box_node;
    return instance.first_box_node + (position.x >= instance.centre.x ? 1u : 0u) +
           (position.y >= instance.centre.y ? 2u : 0u) + (position.z >= instance.centre.z ? 4u : 0u);
}

#ifdef __cplusplus
inline uint find_node(const SurfaceInstance& instance, const SurfaceChart* charts, const uint* cells, vec3 position,
                      vec3 geometric_normal) {
    for (uint i = 0; i < instance.chart_count; ++i)
        if (const SurfaceChart& chart = charts[instance.first_chart + i];
            on_chart(chart, position, geometric_normal) && !beyond_cut(chart, position))
            return cells[chart_cell(chart, position)];
    return box_node(instance, position);
}
#endif

SHARED_END
#ifdef __cplusplus
static_assert(sizeof(sunfleck::shared::SurfaceInstance) == 32);
static_assert(sizeof(sunfleck::shared::SurfaceChart) == 64);
#endif
#endif
