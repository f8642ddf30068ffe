// Radiance where no surface is, at a place of the picture, in pixels. The including shader declares constants, camera,
// sky_image and sky_has_picture.

const float pi = 3.14159265358979;

// Equirectangular, as scene::EnvironmentImage has it.
vec3 sky_radiance(vec2 place) {
    const vec3 sky = vec3(constants.sky_red, constants.sky_green, constants.sky_blue);
    if (sky_has_picture == 0)
        return sky;
    const vec3 d = normalize(camera_ray(camera, place));
    const float c = cos(-constants.sky_rotation), s = sin(-constants.sky_rotation);
    const vec3 turned = vec3(c * d.x + s * d.z, d.y, c * d.z - s * d.x);
    const vec2 on_image = vec2(0.5 + atan(turned.x, -turned.z) / (2.0 * pi), acos(clamp(turned.y, -1.0, 1.0)) / pi);
    return sky * textureLod(sky_image, on_image, 0.0).rgb;
}
