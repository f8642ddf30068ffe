// Bounds of a pixel group's positions and normals, and which samples may light any of its pixels; conservative.
//
// The including shader first defines light_class and includes light_row_shared.h.

struct PixelGroupBounds {
    vec3 low, high;
    vec3 axis;    // unit length, of a cone that contains all normals
    float cosine; // of the cone's half angle; -1 if there is no cone
};

PixelGroupBounds no_bounds() { return PixelGroupBounds(vec3(1e30), vec3(-1e30), vec3(0.0), 1.0); }

vec3 centre_of(PixelGroupBounds bounds) { return 0.5 * (bounds.low + bounds.high); }
float radius_of(PixelGroupBounds bounds) { return 0.5 * length(bounds.high - bounds.low) * 1.0001 + 1e-4; }

// False only if all pixels are behind the sample's surface, or the sample is behind every pixel's surface.
bool may_light(LightRow light, PixelGroupBounds bounds) {
    if (light_class == light_class_directional)
        return true;
    const float radius = radius_of(bounds);
    const vec3 to_light = light.position_bound.xyz - centre_of(bounds);
    if (light_class == light_class_surface && dot(light.normal_offset.xyz, -to_light) + radius <= 0.0)
        return false;
    const float distance = length(to_light);
    const float along = dot(bounds.axis, to_light) / max(distance, 1e-6);
    if (distance <= radius || along >= bounds.cosine)
        return true;
    // The normal in the cone that is nearest to the direction of the light.
    const float sines = sqrt(max(1.0 - along * along, 0.0) * max(1.0 - bounds.cosine * bounds.cosine, 0.0));
    return distance * (along * bounds.cosine + sines + 1e-3) + radius > 0.0;
}
