// Base colour of a surface with a pattern, filtered over the pixel. The includer has `draw` and `pattern_kind`. `local`:
// the place on the mesh, as its vertices have it; `pattern`: of InstanceRow. (Both come from the vertex shader, since
// beside a triangle's edge a device may not read buffers, and because a CPU device reads each pixel's by itself.)
vec3 pattern_albedo(vec3 local, vec4 pattern) {
    if (pattern_kind == pattern_none)
        return base_colour_of(draw);
    const vec3 across = dFdx(local), down = dFdy(local);
    const vec3 footprint = sqrt(across * across + down * down);
    return mix(base_colour_of(draw), pattern.rgb,
               filtered_pattern_share(pattern_kind, pattern.w, local, cross(across, down), footprint));
}
