// Whether a pixel light may reach a box of receivers. A light is left out only if it gives none of them any light: they are
// behind its surface or it behind theirs; or none above the threshold: they are outside of the ellipsoid that the paper
// bounds it by, or farther away than they face it. Before this: the constants.

// Boxes around the positions and the normals of pixels.
struct GroupBounds {
    vec3 low, high;
    vec3 normal_low, normal_high;
};

const float angle_margin = 1e-3; // rad, more than what is lost in acos near 1

// The most that a light can give a receiver in a box, W/m2. `along`: greatest part of the way to it along the light's
// normal; `facing`: the same along the receivers' normals.
float most_irradiance(PixelLightRow light, vec3 centre, vec3 half_size, float along, float facing) {
    const float peak = max(max(light.row.intensity_slot.r, light.row.intensity_slot.g), light.row.intensity_slot.b);
    const vec3 gap = max(abs(centre) - half_size, vec3(0.0));
    const float squared = dot(gap, gap);
    if (light.lobe.w <= 1.0)
        return peak * softened_term(along, facing, squared, light.extent.x);
    const float distance = sqrt(squared), to_centre = length(centre), radius = length(half_size);
    if (distance <= 0.0 || to_centre <= radius)
        return 1e30; // beside the light
    // Where lobes widen: the widest of the box for the angle, the narrowest for the peak.
    const float exponent = light.lobe.w, tilt = dot(light.lobe.xyz, light.row.normal_offset.xyz);
    const float widest = widened_exponent(exponent, distance, light.extent.x);
    const float narrowest = widened_exponent(exponent, to_centre + radius, light.extent.x);
    const float peak_scale = narrowest < exponent ? lobe_norm(narrowest, tilt) / lobe_norm(exponent, tilt) : 1.0;
    const float angle = acos(clamp(dot(light.lobe.xyz, centre) / to_centre, -1.0, 1.0)) - asin(radius / to_centre) - angle_margin;
    const float cosine = max(cos(max(angle, 0.0)), 0.0);
    return peak * peak_scale * pow(cosine, widest) * min(facing / distance, 1.0) / squared;
}

bool may_reach(PixelLightRow light, GroupBounds bounds) {
    const vec3 position = light.row.position_bound.xyz, normal = light.row.normal_offset.xyz;
    const vec3 centre = 0.5 * (bounds.low + bounds.high) - position, half_size = 0.5 * (bounds.high - bounds.low);
    const float forward = dot(normal, centre) + dot(abs(normal), half_size);
    if (forward <= 0.0)
        return false;
    // The greatest scalar product of a normal and a way to the light.
    const vec3 near = position - bounds.low, far = position - bounds.high;
    const vec3 most = max(max(bounds.normal_low * near, bounds.normal_low * far),
                          max(bounds.normal_high * near, bounds.normal_high * far));
    const float facing = most.x + most.y + most.z;
    if (facing <= 0.0)
        return false;
    if (light.extent.y < 0.0)
        return true;
    if (most_irradiance(light, centre, half_size, forward, facing) < constants.least)
        return false;
    // Along the lobe's axis and across it, the point of the box's surroundings that is deepest in the ellipsoid.
    const float along = dot(light.lobe.xyz, centre), size = length(half_size);
    const float across = sqrt(max(dot(centre, centre) - along * along, 0.0));
    const vec2 outside = max(vec2(abs(along - light.extent.y) - dot(abs(light.lobe.xyz), half_size), across - size), 0.0) /
                         max(light.extent.zw, vec2(1e-12));
    return dot(outside, outside) <= 1.0;
}
