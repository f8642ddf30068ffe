// Projects a vertex to the face of a shadow map. The instance (ShadowJob) selects the map, which is a layer of the
// staging image, the face and the occluder, so that one call draws many. Thesis sec. 4.2.2, with instances in place of
// four passes per map. Included by vertex shaders that declare gl_PerVertex.
layout(location = 0) in vec3 in_position;
layout(location = 1) in vec4 in_x;
layout(location = 2) in vec4 in_y;
layout(location = 3) in vec4 in_w;
layout(location = 4) in vec4 in_z;
layout(location = 5) in vec4 in_tile;
layout(location = 6) in uvec2 in_layer_face_row;

void project_on_map() {
    const uint face = (in_layer_face_row.x >> 16) & 0xfu;
    const uint kind = in_layer_face_row.x >> 20;
    gl_Layer = int(in_layer_face_row.x & 0xffffu);

    const vec4 p = vec4(in_position, 1.0);
    const float x = dot(in_x, p), y = dot(in_y, p), z = dot(in_z, p), w = dot(in_w, p);
    // What is drawn may be a tile of the map.
    const vec2 place = (vec2(x, y) - in_tile.xy * w) * in_tile.z;
    if (kind == light_class_directional) {
        gl_Position = vec4(place, z, w);
        gl_ClipDistance[0] = gl_ClipDistance[1] = gl_ClipDistance[2] = 1.0;
        return;
    }
    gl_Position = vec4(place, shadow_near, w);
    if (face == cone_face) {
        gl_ClipDistance[0] = gl_ClipDistance[1] = gl_ClipDistance[2] = 1.0;
        return;
    }
    // Light-space x and y, recovered from the face's projection.
    const vec3 s = face_signs(face);
    const bool hemisphere = kind == light_class_surface;
    vec2 d = vec2(x, y);
    if (hemisphere)
        d = vec2(x + y, x - y) * 0.5;
    else if (s.z < 0.0)
        d = vec2(s.x * (w - s.y * y), s.y * (w - s.x * x));
    // Neighbouring faces meet on texel centres. Each face is drawn a quarter of a texel wider, so that rounding leaves
    // no gap on a shared centre, while no other centre gets a value from the wrong face.
    const float margin = in_tile.w * w;
    gl_ClipDistance[0] = s.x * d.x + margin;
    gl_ClipDistance[1] = s.y * d.y + margin;
    // Nothing behind a surface sample's tangent plane can shadow what it lights.
    gl_ClipDistance[2] = hemisphere ? z - 1e-5 : s.z * z + margin;
}
