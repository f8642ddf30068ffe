// What a diffuse pixel light gives a pixel, for the kernels that evaluate it at pixels and at nodes of tiles. Before this:
// shadowed_light.glsl, the camera, and `show`.

// Eq. 1 and 2, as a factor of the intensity, of a light that is softened: see softened_term.
float softened_factor(PixelLightRow light, Pixel pixel) {
    const vec3 v = pixel.position - light.row.position_bound.xyz;
    const float along = dot(light.row.normal_offset.xyz, v);
    const bool faces = along > 0.0 && dot(pixel.geometric_normal, v) < 0.0;
    return softened_term(along, faces ? max(-dot(pixel.normal, v), 0.0) : 0.0, dot(v, v), light.extent.x);
}

// What a light adds to a pixel: its light, or what the debug view shows.
vec3 contribution(LightRow light, LightFactor factor, Pixel pixel) {
    const vec3 intensity = light.intensity_slot.rgb;
    const float brightness = max(intensity.r, max(intensity.g, intensity.b));
    if (show == show_overdraw)
        return vec3(1.0);
    if (show == show_splat_occlusion)
        return brightness * factor.unshadowed * vec3(factor.visibility, 1.0, 0.0);
    if (shows_places(show)) {
        const float radius = (show == show_splat_places ? 0.01 : 0.006) * distance(pixel.position, camera.position.xyz);
        const vec3 colour = show == show_splat_places ? intensity / max(brightness, 1e-30) : intensity;
        return distance(pixel.position, light.position_bound.xyz) < radius ? colour : vec3(0.0);
    }
    return intensity * (factor.unshadowed * factor.visibility);
}
