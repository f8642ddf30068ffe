// Tiles of the low-resolution picture and their nodes. Before this: splatting_shared.h, the camera, the constants.

// Within this of a tile's normal (squared length of the difference of unit vectors), and of its plane (as a share of its
// box), pixels are on one flat surface: neither changes what they receive by more than a hundredth.
const float flat_normals = 1e-4, flat_positions = 0.01;
// Where a tile's nodes are farther apart in depth, interpolation on the screen is not one on the surface.
const float most_depth_ratio = 2.0;

uvec2 tile_grid(uint level) { return uvec2(tiles_along(constants.columns, level), tiles_along(constants.rows, level)); }
uint tile_at(uint level, uvec2 place) {
    return first_tile(constants.columns, constants.rows, level) + place.y * tile_grid(level).x + place.x;
}
uvec2 tile_place(uint level, uint index) { return uvec2(index % tile_grid(level).x, index / tile_grid(level).x); }

// Ray through a place of a tile, coordinates -1 to 1. Low-resolution pixels are pixels in the middle of their blocks.
vec3 tile_ray(uint level, uvec2 tile, vec2 place) {
    const float side = float(pixel_group_side << level);
    const vec2 low = (vec2(tile) + 0.5 * (place + 1.0)) * side;
    return camera_ray(camera, (low - 0.5) * float(constants.scale) + float(constants.scale / 2u) + 0.5);
}
// As a multiple of the ray, where that meets the plane; <= 0: nowhere before the camera.
float plane_distance(vec4 plane, vec3 ray) {
    const float along = dot(plane.xyz, ray), distance = plane.w - dot(plane.xyz, camera.position.xyz);
    return abs(along) > 0.0 ? distance / along : 0.0;
}

// A sphere about the part of a plane that a tile of the constants' level shows; a radius < 0 if not all of it is there.
vec4 sphere_of(vec4 plane, uvec2 place) {
    vec3 corners[4];
    float nearest = 1e30, farthest = 0.0;
    for (uint i = 0; i < 4u; ++i) {
        const vec3 ray = tile_ray(constants.level, place, node_place(i));
        const float along = plane_distance(plane, ray);
        corners[i] = camera.position.xyz + ray * along;
        nearest = min(nearest, along);
        farthest = max(farthest, along);
    }
    const vec3 centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    float radius = 0.0;
    for (uint i = 0; i < 4u; ++i)
        radius = max(radius, distance(corners[i], centre));
    const bool whole = nearest > 0.0 && farthest <= most_depth_ratio * nearest;
    return vec4(centre, whole ? radius : -1.0);
}

const SplatTile no_tile = SplatTile(vec4(1e30, 1e30, 1e30, 0.0), vec4(-1e30), vec4(1.0), vec4(-1.0), vec4(0.0), vec4(0.0),
                                    vec4(0.0, 0.0, 0.0, -1.0));
