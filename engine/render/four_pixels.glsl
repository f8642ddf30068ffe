// The four pixels of a picture about a place of its enlargement, by the first: subpixel_edges.h. The includer has
// `constants.source_size`.
ivec2 source_pixel(ivec2 first, int i) { return clamp(first + ivec2(i & 1, i >> 1), ivec2(0), constants.source_size - 1); }

// By a place from the first's middle, 0 to 1.
vec4 bilinear_shares(vec2 place) {
    return vec4(1.0 - place.x, place.x, 1.0 - place.x, place.x) * vec4(vec2(1.0 - place.y), vec2(place.y));
}

vec3 weighted(vec3 values[4], vec4 shares) {
    return values[0] * shares.x + values[1] * shares.y + values[2] * shares.z + values[3] * shares.w;
}
