// Light of one sample (VPL) at one pixel: shared by all kernels that evaluate samples per pixel.
//
// The including shader first defines, as constants: light_class; maps (maps_none: no shadow test); filtered (0: look-ups
// of surface samples are not; all others always are, see light_row.h); map_bits; stale_maps (some maps show movers where
// they were); simplified_movers (in the maps). And as functions: map_side(), the texels along a map's side; and
// map_value(slot, texel), the stored value.
#include "gi_module/shadows/octahedral_map.h"

struct Pixel {
    vec3 position;
    vec3 normal;
    vec3 geometric_normal;
    float on_mover; // 1: on a mover, which maps may show simplified or, if stale, where it was; else 0
};

// The effect of one sample on a pixel, as factors of its intensity.
struct LightFactor {
    float unshadowed;
    float clamped;    // removed by the bound of the geometry term
    float visibility; // 0 to 1, from the shadow map
};

vec2 map_texel(vec2 uv) { return (uv * 0.5 + 0.5) * map_side(); }
ivec2 inside_map(ivec2 texel) { return clamp(texel, ivec2(0), ivec2(int(map_side()) - 1)); }

// Filtered over the four nearest texels. `place`: map coordinates and value of the receiver; `normal`: in light space;
// `bias`: see octahedral_map.h; `reach`: of a head-on texel, in the stored value; `lag`: see below.
float filtered_visibility(uint slot, float scale, vec3 place, vec3 normal, float plane_distance, float bias, float reach,
                          float lag) {
    const vec2 position = map_texel(place.xy) - 0.5;
    const ivec2 corner = ivec2(floor(position));
    vec4 lit, vote;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const ivec2 texel = inside_map(corner + ivec2(i & 1, i >> 1));
        const vec2 uv = (vec2(texel) + 0.5) / map_side() * 2.0 - 1.0;
        float on_plane;
        if (light_class == light_class_directional) {
            on_plane = orthographic_plane_value(place.z, normal, uv - place.xy);
        } else {
            vec3 centre = hemisphere_direction(uv);
            if (light_class == light_class_point)
                centre = scale > 0.0 ? cone_direction(uv, scale) : sphere_direction(uv);
            on_plane = value_on_plane(normal, plane_distance, centre);
        }
        const vec2 result = texel_vote(on_plane, place.z, shadow_filter_window * bias, shadow_filter_slack * reach,
                                       depth_step(map_bits) + lag, map_value(slot, texel));
        lit[i] = result.x;
        vote[i] = result.y;
    }
    return count_votes(lit, vote, position - floor(position));
}

// The same on a hemisphere's map, which nearly all samples have: the plane's value at a texel centre, -k n.c with c =
// (x, y, 1 - |x| - |y|), is a function of x plus one of y, and the four centres have three x and three y between them.
float filtered_hemisphere_visibility(uint slot, vec3 place, vec3 normal, float plane_distance, float bias, float reach,
                                     float simplified, float lag) {
    const float side = map_side(), texel = 1.0 / side; // in x and y; twice that in u and v
    const vec2 position = map_texel(place.xy) - 0.5;
    const vec2 corner = clamp(floor(position), vec2(0.0), vec2(side - 2.0));
    const vec2 uv = (corner + 0.5) * (2.0 * texel) - 1.0;
    const vec3 x = 0.5 * (uv.x + uv.y) + vec3(0.0, texel, 2.0 * texel);
    const vec3 y = 0.5 * (uv.x - uv.y) + vec3(-texel, 0.0, texel);
    const vec3 n = normal * (shadow_near / max(plane_distance, 1e-9));
    const vec3 of_x = n.z * abs(x) - n.x * x, of_y = n.z * abs(y) - n.y * y - n.z;
    const vec4 on_plane = of_x.xyyz + of_y.yzxy;
    const float step = depth_step(map_bits) + lag;
    const HemisphereTolerance tolerance =
        HemisphereTolerance(shadow_filter_window * bias, shadow_filter_slack * reach, step,
                            place.z + shadow_head_on_slack * reach + step, simplified * bias);
    vec4 lit, dark, values;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const float stored = map_value(slot, ivec2(corner) + ivec2(i & 1, i >> 1));
        const vec2 votes = hemisphere_texel_vote(on_plane[i], place.z, tolerance, stored);
        lit[i] = votes.x;
        dark[i] = votes.y;
        values[i] = stored;
    }
    const vec2 inside = clamp(position - corner, 0.0, 1.0);
    return surface_votes(values, inside, place.z, reach, step, count_votes(lit, lit + dark, inside));
}

// Extra bias for a receiver on a mover in a stale map: the mover's old image in the map may be nearer to the light by
// as much as the mover has moved since, and would shadow its whole lit side. 1/w changes by the change of w over w
// squared, and w, the sum of three coordinates, by at most sqrt(3) times the distance.
float lag_value(LightRow light, Pixel pixel, float inverse_w) {
    return stale_maps == 0 ? 0.0 : pixel.on_mover * shadow_near * 1.7320508 * light.bitangent.w * inverse_w * inverse_w;
}

LightFactor unshadowed_factor(LightRow light, Pixel pixel) {
    const vec3 v = pixel.position - light.position_bound.xyz;
    const float along = dot(light.normal_offset.xyz, v);
    LightFactor factor = LightFactor(0.0, 0.0, 1.0);
    if (light_class == light_class_directional) {
        const float geometric_cosine = -dot(pixel.geometric_normal, light.normal_offset.xyz);
        factor.unshadowed = geometric_cosine > 0.0 ? max(-dot(pixel.normal, light.normal_offset.xyz), 0.0) : 0.0;
        return factor;
    }
    const float squared_distance = max(dot(v, v), 1e-12);
    const float receiver_distance = -dot(pixel.normal, v);        // |v| times the receiver's cosine
    const float plane_distance = -dot(pixel.geometric_normal, v); // from the light to the receiver's plane
    const float lit_side = plane_distance > 0.0 ? max(receiver_distance, 0.0) : 0.0;
    if (light_class == light_class_surface) {
        const float inverse = 1.0 / squared_distance;
        const float term = max(along, 0.0) * lit_side * inverse * inverse;
        factor.unshadowed = min(term, light.position_bound.w);
        factor.clamped = term - factor.unshadowed;
    } else {
        const float inverse_distance = inversesqrt(squared_distance);
        const float cone = clamp(along * inverse_distance * light.tangent_scale.w + light.normal_offset.w, 0.0, 1.0);
        factor.unshadowed = cone * cone * lit_side * inverse_distance * inverse_distance * inverse_distance;
    }
    return factor;
}

vec3 to_light_space(LightRow light, vec3 v) {
    return vec3(dot(light.tangent_scale.xyz, v), dot(light.bitangent.xyz, v), dot(light.normal_offset.xyz, v));
}

float directional_visibility(LightRow light, Pixel pixel, vec3 d) {
    const vec3 normal = to_light_space(light, pixel.geometric_normal);
    const float bias = orthographic_bias(map_side(), -normal.z);
    const float lag = stale_maps == 0 ? 0.0 : pixel.on_mover * light.bitangent.w * light.normal_offset.w;
    const vec3 place = vec3(d.xy * light.tangent_scale.w, 1.0 - d.z * light.normal_offset.w);
    const uint slot = uint(light.intensity_slot.w);
    return filtered_visibility(slot, 0.0, place, normal, 0.0, bias, orthographic_bias(map_side(), 1.0), lag);
}

// Unfiltered look-up, which only surface samples have: the nearest texel against the receiver's plane at its centre.
float hemisphere_visibility(uint slot, vec3 place, vec3 light_space_normal, float plane_distance,
                            float simplified, float lag) {
    const vec2 texel = clamp(floor(map_texel(place.xy)), vec2(0.0), vec2(map_side() - 1.0));
    const vec3 centre = hemisphere_direction((texel + 0.5) * (2.0 / map_side()) - 1.0);
    const float value = receiver_centre_value(place.z, light_space_normal, plane_distance, centre,
                                              hemisphere_texel_reach(map_side()), simplified);
    return min(value, 1.0) + depth_step(map_bits) + lag >= map_value(slot, ivec2(texel)) ? 1.0 : 0.0;
}

// Result of the shadow test, 0 to 1.
float map_visibility(LightRow light, Pixel pixel) {
    const vec3 v = pixel.position - light.position_bound.xyz;
    const vec3 d = to_light_space(light, v);
    if (light_class == light_class_directional)
        return directional_visibility(light, pixel, d);
    const float plane_distance = -dot(pixel.geometric_normal, v);
    const bool hemisphere = light_class == light_class_surface;
    const float scale = light.position_bound.w;
    const bool cone = !hemisphere && scale > 0.0;
    const vec3 place = hemisphere ? hemisphere_map(d) : cone ? cone_map(d, scale) : sphere_map(d);
    const float lag = lag_value(light, pixel, place.z);
    const uint slot = uint(light.intensity_slot.w);
    const vec3 normal = to_light_space(light, pixel.geometric_normal);
    if (filtered == 0 && hemisphere)
        return hemisphere_visibility(slot, place, normal, plane_distance,
                                     simplified_movers != 0 ? pixel.on_mover : 0.0, lag);
    const float reach = hemisphere ? hemisphere_texel_reach(map_side())
                        : cone     ? cone_texel_reach(map_side(), scale)
                                   : sphere_texel_reach(map_side());
    const float bias = perspective_bias(reach, plane_distance, place.z);
    const float receiver = shadow_near * place.z;
    if (hemisphere)
        return filtered_hemisphere_visibility(slot, vec3(place.xy, receiver), normal, plane_distance, bias,
                                              reach * receiver, simplified_movers != 0 ? pixel.on_mover : 0.0, lag);
    return filtered_visibility(slot, scale, vec3(place.xy, receiver), normal, plane_distance, bias, reach * receiver, lag);
}

// `test`: whether to test against the shadow map; a constant at each call, so that it is folded.
LightFactor light_factor(LightRow light, Pixel pixel, bool test) {
    LightFactor factor = unshadowed_factor(light, pixel);
    if (maps != maps_none && test)
        factor.visibility = map_visibility(light, pixel);
    return factor;
}
