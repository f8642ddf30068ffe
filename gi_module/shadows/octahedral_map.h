// The projections of shadow maps, for shaders and C++ alike. Thesis sec. 4.2.1.
//
// Light space: d = (dot(tangent, v), dot(bitangent, v), dot(normal, v)) with v from the light to the point.
//
// Hemisphere (surface samples): the upper four faces of an octahedron fill the map: w = |x| + |y| + z,
// (u, v) = (x + y, x - y) / w in [-1, 1]^2. On each face the map is a planar projection with w as the homogeneous
// coordinate, so 1/w is linear across the map: planes are exact and rasterisation needs no subdivision. Faces meet on
// the square's diagonals. Sphere (point and spot lights): all eight faces; the upper four in the inner diamond, the
// lower four folded out to the corners. Cone (spot lights with a narrow cone): one planar projection, w = z, (u, v) =
// scale * (x, y) / w, since a spherical map would spend one texel in forty on a cone of 17 degrees. Orthographic
// (directional lights): (u, v) = (x, y) / radius.
//
// Stored value: near / w, reverse: 1 at the near distance, 0 at infinity; orthographic: 1 - z / (2 radius).
#ifndef SUNFLECK_GI_SHADOWS_OCTAHEDRAL_MAP_H
#define SUNFLECK_GI_SHADOWS_OCTAHEDRAL_MAP_H
#include "engine/core/shader_language.h"
SHARED_BEGIN

// In units of the scene (engine/scene/scene_space.h). Blockers nearer than this (in w) are treated as if at this
// distance. Determines the quantisation step of 16 bits, w^2 / (65535 * near): 8 mm at 5 m.
SHARED_CONSTANT float shadow_near = 0.05f;

// xy: map coordinates in [-1, 1]^2; z: 1 / w. Points behind a hemisphere, and the light's own place, get coordinates
// far outside the map: finite ones, since what is not lit is multiplied by zero.
SHARED_CONSTANT float shadow_least_w = 1e-12f;
SHARED_FUNCTION vec3 hemisphere_map(vec3 d) {
    float inverse_w = 1.0f / max(abs(d.x) + abs(d.y) + d.z, shadow_least_w);
    return vec3((d.x + d.y) * inverse_w, (d.x - d.y) * inverse_w, inverse_w);
}

SHARED_FUNCTION vec3 sphere_map(vec3 d) {
    float inverse_w = 1.0f / max(abs(d.x) + abs(d.y) + abs(d.z), shadow_least_w);
    vec2 p = vec2(d.x, d.y) * inverse_w;
    if (d.z < 0.0f)
        p = vec2((1.0f - abs(p.y)) * (p.x >= 0.0f ? 1.0f : -1.0f), (1.0f - abs(p.x)) * (p.y >= 0.0f ? 1.0f : -1.0f));
    return vec3(p, inverse_w);
}

// Points beside or behind the light get coordinates far outside the map.
SHARED_FUNCTION vec3 cone_map(vec3 d, float scale) {
    float inverse_w = 1.0f / max(d.z, 1e-4f);
    return vec3(d.x * scale * inverse_w, d.y * scale * inverse_w, inverse_w);
}

SHARED_CONSTANT uint cone_face = 8u; // the only face of a cone's map; 0 to 7 are the sphere's

// Signs of x, y, z on a face: hemisphere faces 0 to 3, sphere faces 0 to 7. Bit 0: x, bit 1: y, bit 2: z; set is
// negative.
SHARED_FUNCTION vec3 face_signs(uint face) {
    return vec3((face & 1u) != 0u ? -1.0f : 1.0f, (face & 2u) != 0u ? -1.0f : 1.0f, (face & 4u) != 0u ? -1.0f : 1.0f);
}

// Clip position (x, y, w) of d under one face's projection; equals the map above within the face and is linear in d.
SHARED_FUNCTION vec3 hemisphere_face_clip(vec3 d, uint face) {
    vec3 s = face_signs(face);
    return vec3(d.x + d.y, d.x - d.y, s.x * d.x + s.y * d.y + d.z);
}

SHARED_FUNCTION vec3 cone_clip(vec3 d, float scale) {
    return vec3(d.x * scale, d.y * scale, d.z);
}

SHARED_FUNCTION vec3 sphere_face_clip(vec3 d, uint face) {
    vec3 s = face_signs(face);
    float w = s.x * d.x + s.y * d.y + s.z * d.z;
    if (s.z > 0.0f)
        return vec3(d.x, d.y, w);
    return vec3(s.x * (w - s.y * d.y), s.y * (w - s.x * d.x), w);
}

// How kernels read the shadow maps.
SHARED_CONSTANT uint maps_none = 0u;           // no shadow test
SHARED_CONSTANT uint maps_texel_buffer = 1u;   // uniform texel buffer
SHARED_CONSTANT uint maps_storage_buffer = 2u; // storage buffer of packed words

// --- Bias, derived and not tuned -----------------------------------------------------------------------------------
// A look-up reads the texel centre c nearest to the receiver's direction q (both as points with w = 1). The receiver's
// plane n.p = h has 1/w = n.q / h at q and n.c / h at c, so its own depth in the map differs from the receiver's by at
// most |c - q| / |h|, where h is the light's distance to the receiver's plane. On the hemisphere map (u = x + y, v = x
// - y, z = 1 - |x| - |y|) half a texel of t = 2 / resolution in both directions gives |c - q| <= t / sqrt(2); on the
// sphere map (u = x, v = y) it gives sqrt(t^2/4 + t^2/4 + t^2) = t * sqrt(3/2), and folding does not change that; on a
// cone's map t / (scale * sqrt(2)). At grazing angles 1/h grows without bound while the light that arrives vanishes; a
// bias that grew along would leak light under walls. It is limited to a slope of 8 (83 degrees): beyond, a surface may
// shadow itself a little. So  bias = near * texel_reach * min(1 / h, 8 / w).
SHARED_CONSTANT float shadow_slope_limit = 8.0f;
SHARED_FUNCTION float perspective_bias(float texel_reach, float plane_distance, float inverse_w) {
    return shadow_near * texel_reach * min(1.0f / max(plane_distance, 1e-9f), shadow_slope_limit * inverse_w);
}
// Stored value of the receiver's plane at a texel centre with direction `centre`; `normal` in light space.
SHARED_FUNCTION float value_on_plane(vec3 normal, float plane_distance, vec3 centre) {
    return -shadow_near * dot(normal, centre) * (1.0f / max(plane_distance, 1e-9f));
}
SHARED_FUNCTION float hemisphere_texel_reach(float resolution) {
    return 1.41421356f / resolution;
}
SHARED_FUNCTION float sphere_texel_reach(float resolution) {
    return 2.44948974f / resolution;
}
SHARED_FUNCTION float cone_texel_reach(float resolution, float scale) {
    return 1.41421356f / (resolution * scale);
}
// Orthographic: the plane's depth changes by tan(angle) per unit of length across the map, at most 1/cos(angle); half a
// texel's diagonal is sqrt(2) * radius / resolution, or sqrt(1/2) / resolution in units of the stored value.
SHARED_FUNCTION float orthographic_bias(float resolution, float cosine) {
    return 0.70710678f / resolution * min(1.0f / max(cosine, 1e-9f), shadow_slope_limit);
}

// On hemisphere maps, which nearly all samples have, the texel is compared with the receiver's plane at the texel's
// centre, clamped to within the bias of the receiver: a blocker is then missed by the texel's true slope and not by the
// steepest one. Two tolerances remain. One is for surfaces that are not quite planar: a tenth of the bias. The other is
// for concave corners, where the texel's centre may lie on the other wall, nearer to the light than the receiver's
// plane, although nothing occludes the receiver: a blocker within about a texel's width of the receiver, one and a
// quarter times the head-on bias, does not shadow it. Both were chosen by counting errors: pairs that rays find free or
// blocked, and pixels in corners. Movers may be in the maps in simplified form, and then get the whole bias.
SHARED_CONSTANT float shadow_centre_slack = 0.1f;
SHARED_CONSTANT float shadow_head_on_slack = 1.25f;
// The receiver's value to compare with the texel. `inverse_w`: 1 / w at the receiver; `normal`: its normal in light
// space; `plane_distance`: from the light to its plane; `centre`: direction of the texel's centre; `simplified`: 1 for
// a surface that is simplified in the map, else 0.
SHARED_FUNCTION float receiver_centre_value(float inverse_w, vec3 normal, float plane_distance, vec3 centre,
                                            float texel_reach, float simplified) {
    float receiver = shadow_near * inverse_w;
    float bias = perspective_bias(texel_reach, plane_distance, inverse_w);
    float on_plane = value_on_plane(normal, plane_distance, centre);
    float clamped = clamp(on_plane, receiver - bias, receiver + bias) + shadow_centre_slack * bias;
    return max(clamped, receiver + max(shadow_head_on_slack * texel_reach * receiver, simplified * bias));
}

// --- Filtered look-up ----------------------------------------------------------------------------------------------
// Blends the comparisons of the four nearest texels (percentage-closer filtering). Each texel is compared with the
// receiver's own plane at that texel's centre, which is exact for planes; the plane's value may differ from the
// receiver's by at most `shadow_filter_window` times the bias above (the four centres are up to three times as far as
// the nearest).
//
// A texel has a vote only where it is sure. One that shows something behind the plane lies beyond the edge of the
// receiver's surface: were the surface there, it would be seen. Of the receiver, which is on the surface, it says
// nothing: light that passes outside of two walls does not come in where they meet. One that shows something nearer to
// the light by less than a quarter of a head-on bias shows the other wall of a corner, or a surface that is not quite
// planar. Where no texel has a vote, the receiver is lit.
SHARED_CONSTANT float shadow_filter_window = 3.0f;
SHARED_CONSTANT float shadow_filter_slack = 0.25f;

// Of one texel, which stores `stored`. `on_plane`: value of the receiver's plane at its centre; `receiver`: the value
// at the receiver; `window`: by how much they may differ; `step`: largest error of a comparison. x: 1 if lit, y: 1 if
// the texel has a vote.
SHARED_FUNCTION vec2 texel_vote(float on_plane, float receiver, float window, float slack, float step, float stored) {
    float held = min(clamp(on_plane, receiver - window, receiver + window), 1.0f) + step;
    bool lit = held + slack >= stored;
    bool on_surface = held >= stored && stored >= min(on_plane, 1.0f) - slack - step;
    return vec2(lit ? 1.0f : 0.0f, on_surface || !lit ? 1.0f : 0.0f);
}

// The same on hemisphere maps, with the tolerances of their unfiltered look-up: x: 1 if lit, y: 1 if dark. `head_on`:
// stored value up to which a blocker is too near to the receiver to be told from the other wall of a corner;
// `simplified`: by how much a mover's surface may lie before its place, where maps have it in simplified form.
struct HemisphereTolerance {
    float window;
    float slack;
    float step;
    float head_on;
    float simplified;
};
SHARED_FUNCTION vec2 hemisphere_texel_vote(float on_plane, float receiver, HemisphereTolerance tolerance,
                                           float stored) {
    float window = tolerance.window, step = tolerance.step;
    float held = min(clamp(on_plane, receiver - window, receiver + window) + tolerance.simplified, 1.0f) + step;
    bool lit = held >= stored && stored >= min(on_plane, 1.0f) - tolerance.slack - step;
    bool dark = stored > max(held + tolerance.slack, tolerance.head_on);
    return vec2(lit ? 1.0f : 0.0f, dark ? 1.0f : 0.0f);
}

// Blend of four votes: of the texels at corner + (i & 1, i >> 1), with the receiver at `place`, 0 to 1, between them.
SHARED_FUNCTION float count_votes(vec4 lit, vec4 vote, vec2 place) {
    vec4 weight = vec4((1.0f - place.x) * (1.0f - place.y), place.x * (1.0f - place.y), (1.0f - place.x) * place.y,
                       place.x * place.y) *
                  vote;
    float sum = weight.x + weight.y + weight.z + weight.w;
    return sum > 0.0f ? dot(weight, lit) / sum : 1.0f;
}

// A receiver that is not behind the surface which the four texels show together is lit, whatever they vote one by one.
// Where two surfaces meet, or a strip is narrower than a texel, texels show the other surface, nearer to the light than
// the receiver's plane although it blocks nothing: dark fringes along edges of rooms. Stored values are linear on
// planes, so their blend at the receiver's own place is that surface. Across a concave edge it is a chord: before the
// receiver by at most w (1 - w) times the bend, with a share of w of the blend on the receiver's surface, whose texels
// vote for it. The bend is that of a surface as steep as the slope limit. In head-on texel reaches, the receiver is lit
// where the blend is before it by less than `shadow_surface_near` and what w allows, and left to the votes from
// `shadow_surface_far` and that on. What texels show far behind counts as a few reaches behind: it is no part of the
// surface.
SHARED_CONSTANT float shadow_surface_near = 0.75f;
SHARED_CONSTANT float shadow_surface_far = 1.5f;
SHARED_CONSTANT float shadow_surface_bend = 8.0f;
SHARED_CONSTANT float shadow_surface_depth = 4.0f;
// `votes`: count_votes of the same texels.
SHARED_FUNCTION float surface_votes(vec4 stored, vec2 place, float receiver, float reach, float step, float votes) {
    float furthest = receiver - shadow_surface_depth * reach;
    vec4 kept = max(stored, vec4(furthest, furthest, furthest, furthest));
    vec2 across = vec2(kept.x + (kept.y - kept.x) * place.x, kept.z + (kept.w - kept.z) * place.x);
    float before = across.x + (across.y - across.x) * place.y - receiver - step;
    float allowed = shadow_surface_far + shadow_surface_bend * votes * (1.0f - votes);
    float lit = (allowed * reach - before) / max((shadow_surface_far - shadow_surface_near) * reach, 1e-12f);
    return max(votes, min(lit, 1.0f));
}

// Directions with w = 1 through map coordinates.
SHARED_FUNCTION vec3 hemisphere_direction(vec2 uv) {
    vec2 p = vec2(uv.x + uv.y, uv.x - uv.y) * 0.5f;
    return vec3(p, 1.0f - abs(p.x) - abs(p.y));
}
SHARED_FUNCTION vec3 sphere_direction(vec2 uv) {
    vec3 q = vec3(uv, 1.0f - abs(uv.x) - abs(uv.y));
    float fold = max(-q.z, 0.0f);
    q.x += q.x >= 0.0f ? -fold : fold;
    q.y += q.y >= 0.0f ? -fold : fold;
    return q;
}
SHARED_FUNCTION vec3 cone_direction(vec2 uv, float scale) {
    return vec3(uv.x / scale, uv.y / scale, 1.0f);
}

// Orthographic: value of the receiver's plane at map coordinates that differ from its own by `by`. A length of the
// map's radius is 1 across the map and 1/2 in the stored value.
SHARED_FUNCTION float orthographic_plane_value(float receiver, vec3 normal, vec2 by) {
    return receiver + 0.5f * (normal.x * by.x + normal.y * by.y) / min(normal.z, -1e-6f);
}

// Largest error of a comparison: half a step of 16-bit depth for the stored value, and rounding of the receiver's.
SHARED_FUNCTION float depth_step(uint bits) {
    return bits == 16u ? 1.0f / 65535.0f : 4e-7f;
}

SHARED_END
#endif
