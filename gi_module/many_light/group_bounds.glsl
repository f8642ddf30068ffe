// Where a group's pixels lie and which way they look; which samples can light any of them.
//
// The including shader defines before: light_class, and includes light_row_shared.h.

struct PixelGroupBounds {
    vec3 low, high;
    vec3 axis;    // unit length, of a cone that holds all normals
    float cosine; // of its half angle; -1 where there is no cone
};

PixelGroupBounds no_bounds() { return PixelGroupBounds(vec3(1e30), vec3(-1e30), vec3(0.0), 1.0); }

vec3 middle_of(PixelGroupBounds bounds) { return 0.5 * (bounds.low + bounds.high); }
float radius_of(PixelGroupBounds bounds) { return 0.5 * length(bounds.high - bounds.low) * 1.0001 + 1e-4; }

// False only if each pixel is behind the sample's surface, or the sample behind each pixel's.
bool may_light(LightRow light, PixelGroupBounds bounds) {
    if (light_class == light_class_directional)
        return true;
    const float radius = radius_of(bounds);
    const vec3 to_light = light.position_bound.xyz - middle_of(bounds);
    if (light_class == light_class_surface && dot(light.normal_offset.xyz, -to_light) + radius <= 0.0)
        return false;
    const float distance = length(to_light);
    const float along = dot(bounds.axis, to_light) / max(distance, 1e-6);
    if (distance <= radius || along >= bounds.cosine)
        return true;
    // The normal of the cone that is nearest to the light.
    const float sines = sqrt(max(1.0 - along * along, 0.0) * max(1.0 - bounds.cosine * bounds.cosine, 0.0));
    return distance * (along * bounds.cosine + sines + 1e-3) + radius > 0.0;
}
