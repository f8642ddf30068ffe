// Whether a pixel light may reach a box of receivers. A light is left out only if it gives none of them any light: they are
// behind its surface or it behind theirs; or none above the threshold: they are outside of the ellipsoid that the paper
// bounds it by, or farther away than they face it. Before this: the constants.

// Boxes around the positions and the normals of pixels.
struct GroupBounds {
    vec3 low, high;
    vec3 normal_low, normal_high;
};

const float cosine_margin = 1e-6; // more than what rounding loses

// The most that a light can give a receiver in a box, W/m2. `along`: greatest part of the way to it along the light's
// normal; `facing`: the same along the receivers' normals.
float most_irradiance(PixelLightRow light, vec3 centre, vec3 half_size, float along, float facing) {
    const float peak = max(max(light.row.intensity_slot.r, light.row.intensity_slot.g), light.row.intensity_slot.b);
    const vec3 gap = max(abs(centre) - half_size, vec3(0.0));
    const float squared = dot(gap, gap);
    if (light.lobe.w <= 1.0)
        return peak * softened_term(along, facing, squared, light.extent.x);
    // Along the line to the box's centre, all of the box is farther than `near`.
    const float distance = sqrt(squared), to_centre = length(centre);
    const vec3 towards = centre / max(to_centre, 1e-30);
    const float near = to_centre - dot(abs(towards), half_size);
    if (near <= 0.0)
        return 1e30; // beside the light
    // Where lobes widen: the widest of the box for the angle, the narrowest for the peak. Of the norms' ratio (lobe_norm):
    // of a lobe's flux, all at most and (1 + tilt) / 2 at least is before the light's surface.
    const float exponent = light.lobe.w, tilt = dot(light.lobe.xyz, light.row.normal_offset.xyz);
    const float widest = widened_exponent(exponent, distance, light.extent.x);
    const float narrowest = widened_exponent(exponent, to_centre + length(half_size), light.extent.x);
    const float peak_scale = narrowest < exponent ? (narrowest + 1.0) / (exponent + 1.0) * 2.0 / (1.0 + max(tilt, 0.0)) : 1.0;
    // In the plane of the axis and that line: the line's angle to the axis, less the angle that the box reaches towards it.
    const float sine = length(cross(light.lobe.xyz, towards)), cosine = dot(light.lobe.xyz, towards);
    const vec3 across = (towards * cosine - light.lobe.xyz) / max(sine, 1e-6);
    const float reach = dot(abs(across), half_size);
    const float nearest = sine * near > cosine * reach ? (cosine * near + sine * reach) * inversesqrt(near * near + reach * reach) : 1.0;
    return peak * peak_scale * pow(clamp(nearest + cosine_margin, 0.0, 1.0), widest) * min(facing / distance, 1.0) / squared;
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
