// What the new frame shows near the middle of a pixel of the larger picture: temporal_enlargement.h.

// Pixels of the source up to which a sample counts where none is nearer, and how much less it counts.
const float reach = 1.5, share_of_far = 0.01;
const float least_weight = 1.0 / 1024.0; // of a new picture that has no sample near a pixel

// Of samples at a distance along one axis: smooth, 1 at 0, and 0 from 1 on.
vec3 bell(vec3 distance) {
    const vec3 rest = max(1.0 - distance * distance, 0.0);
    return rest * rest;
}
float largest(vec3 v) { return max(max(v.x, v.y), v.z); }

// The mean of nine pixels of the source, as for sample_near, by their distances.
vec3 blurred(vec3 colour[9], vec2 away) {
    const vec3 x = bell((away.x + vec3(-1.0, 0.0, 1.0)) / reach), y = bell((away.y + vec3(-1.0, 0.0, 1.0)) / reach);
    const vec3 sum = y.x * (x.x * colour[0] + x.y * colour[1] + x.z * colour[2]) +
                     y.y * (x.x * colour[3] + x.y * colour[4] + x.z * colour[5]) +
                     y.z * (x.x * colour[6] + x.y * colour[7] + x.z * colour[8]);
    return sum / (dot(x, vec3(1.0)) * dot(y, vec3(1.0)));
}

// `colour`: nine pixels of the source, row by row; `away`: from the pixel's middle to where the one in their middle was
// sampled, in pixels of the source, of which `scale` make one of the picture. The colour, and as alpha what it weighs:
// as much as its nearest sample is near.
vec4 sample_near(vec3 colour[9], vec2 away, vec2 scale) {
    const vec3 dx = away.x + vec3(-1.0, 0.0, 1.0), dy = away.y + vec3(-1.0, 0.0, 1.0);
    const vec3 near_x = bell(dx / scale.x), near_y = bell(dy / scale.y);
    const vec3 x = near_x + share_of_far * bell(dx / reach), y = near_y + share_of_far * bell(dy / reach);
    const vec3 sum = y.x * (x.x * colour[0] + x.y * colour[1] + x.z * colour[2]) +
                     y.y * (x.x * colour[3] + x.y * colour[4] + x.z * colour[5]) +
                     y.z * (x.x * colour[6] + x.y * colour[7] + x.z * colour[8]);
    return vec4(sum / (dot(x, vec3(1.0)) * dot(y, vec3(1.0))), max(largest(near_x) * largest(near_y), least_weight));
}
