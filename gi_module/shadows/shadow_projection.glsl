// Where a vertex lies on the face of a shadow map. Included by vertex shaders that declare rows, jobs and lights.
void project_on_map(ShadowJob job, vec3 world) {
    const uint layer = job.layer_face & 0xffffu;
    const uint face = (job.layer_face >> 16) & 0xfu;
    const uint kind = job.layer_face >> 20;
    gl_Layer = int(layer);

    const vec3 v = world - lights[layer].position_bound.xyz;
    const vec3 d = vec3(dot(lights[layer].tangent_scale.xyz, v), dot(lights[layer].bitangent.xyz, v),
                        dot(lights[layer].normal_offset.xyz, v));
    if (kind == light_class_directional) {
        const float inverse_radius = lights[layer].tangent_scale.w;
        gl_Position = vec4(d.xy * inverse_radius, 1.0 - d.z * lights[layer].normal_offset.w, 1.0);
        gl_ClipDistance[0] = gl_ClipDistance[1] = gl_ClipDistance[2] = 1.0;
        return;
    }
    // Neighbouring faces meet on texel centres. Each is drawn a quarter of a texel wider, so that rounding leaves no
    // gap on a centre that both share, and no other centre gets a value from the wrong face.
    const vec3 s = face_signs(face);
    const bool hemisphere = kind == light_class_surface;
    const vec3 clip = hemisphere ? hemisphere_face_clip(d, face) : sphere_face_clip(d, face);
    const float margin = constants.half_texel_margin * clip.z;
    gl_Position = vec4(clip.xy, shadow_near, clip.z);
    gl_ClipDistance[0] = s.x * d.x + margin;
    gl_ClipDistance[1] = s.y * d.y + margin;
    // Nothing behind a surface sample's tangent plane can shadow what it lights.
    gl_ClipDistance[2] = hemisphere ? d.z - 1e-5 : s.z * d.z + margin;
}
