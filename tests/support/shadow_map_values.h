// Shadow maps read back and looked up on the CPU as shaders do, with points on a scene's surfaces to ask about.
#pragma once

#include "tests/support/gpu_world.h"

#include "engine/core/octahedral.h"
#include "engine/core/random.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/shadows/shadow_jobs.h"

namespace sunfleck::tests {

using namespace shared;

// The maps of all samples on the CPU, and the look-up that the shader does.
struct ShadowMapValues {
    ShadowMapValues(GpuWorld& world, std::uint32_t map_bits) : bits(map_bits) {
        gi::System& lighting = world.renderer->lighting();
        const gi::ShadowMaps& maps = lighting.shadows().maps();
        resolution = maps.resolution();
        const std::size_t count = std::size_t(resolution) * resolution * maps.slots();
        const gpu::Buffer target = read_back(world, maps.texels(), count * bits / 8);
        values.resize(count);
        for (std::size_t i = 0; i < count; ++i)
            values[i] = bits == 16 ? float(reinterpret_cast<const std::uint16_t*>(target.mapped())[i]) / 65535.0f
                                   : reinterpret_cast<const float*>(target.mapped())[i];
        for (const gi::LightSample& sample : lighting.samples()) {
            rows.push_back(gi::make_light_row(sample, sample.index, 1e30f, {}));
            hemisphere.push_back(sample.kind == gi::SampleKind::surface);
        }
    }

    // Light-space vector to a point, its place on the map, and the bias there.
    struct Look {
        vec3 place;
        ivec2 texel;
        float bias;
        float receiver;
        bool lit;
        float filtered; // share of the light that the filtered look-up lets through
    };
    vec3 to_light_space(std::size_t light, vec3 v) const {
        return {glm::dot(vec3(rows[light].tangent_scale), v), glm::dot(vec3(rows[light].bitangent), v),
                glm::dot(vec3(rows[light].normal_offset), v)};
    }
    Look look(std::size_t light, vec3 position, vec3 normal) const {
        const vec3 v = position - vec3(rows[light].position_bound);
        const vec3 d = to_light_space(light, v);
        Look result;
        const float side = float(resolution), scale = cone_scale(light);
        result.place = hemisphere[light] ? hemisphere_map(d) : scale > 0.0f ? cone_map(d, scale) : sphere_map(d);
        const float reach = hemisphere[light] ? hemisphere_texel_reach(side)
                            : scale > 0.0f    ? cone_texel_reach(side, scale)
                                              : sphere_texel_reach(side);
        result.bias = perspective_bias(reach, -glm::dot(normal, v), result.place.z) + depth_step(bits);
        result.receiver = std::min(shadow_near * result.place.z, 1.0f);
        const vec2 at = (vec2(result.place) * 0.5f + 0.5f) * float(resolution);
        result.texel = glm::clamp(ivec2(at), ivec2(0), ivec2(int(resolution) - 1));
        const float bias = result.bias - depth_step(bits);
        if (hemisphere[light]) {
            const float held = receiver_centre_value(result.place.z, to_light_space(light, normal),
                                                     -glm::dot(normal, v), centre(light, result.texel), reach, 0.0f);
            result.bias = std::min(held, 1.0f) + depth_step(bits) - result.receiver;
        }
        result.lit = result.receiver + result.bias >= value(light, result.texel);
        const vec2 corner = glm::floor(at - 0.5f);
        vec4 filter_lit(0.0f), vote(0.0f), stored(0.0f);
        for (int i = 0; i < 4; ++i) {
            const ivec2 t = glm::clamp(ivec2(corner) + ivec2(i & 1, i >> 1), ivec2(0), ivec2(int(resolution) - 1));
            const float receiver = shadow_near * result.place.z;
            const float on_plane =
                value_on_plane(to_light_space(light, normal), -glm::dot(normal, v), centre(light, t));
            const float step = depth_step(bits);
            const HemisphereTolerance tolerance{shadow_filter_window * bias, shadow_filter_slack * reach * receiver,
                                                step, receiver * (1.0f + shadow_head_on_slack * reach) + step, 0.0f};
            const vec2 said = hemisphere[light] ? hemisphere_texel_vote(on_plane, receiver, tolerance, value(light, t))
                                                : texel_vote(on_plane, receiver, tolerance.window, tolerance.slack,
                                                             step, value(light, t));
            filter_lit[i] = said.x;
            vote[i] = hemisphere[light] ? said.x + said.y : said.y;
            stored[i] = value(light, t);
        }
        result.filtered = count_votes(filter_lit, vote, at - 0.5f - corner);
        const float receiver = shadow_near * result.place.z;
        if (hemisphere[light])
            result.filtered = surface_votes(stored, at - 0.5f - corner, receiver, reach * receiver, depth_step(bits),
                                            result.filtered);
        return result;
    }
    float value(std::size_t light, ivec2 texel) const {
        return values[(light * resolution + std::size_t(texel.y)) * resolution + std::size_t(texel.x)];
    }
    // Light-space direction with w = 1 through a texel's centre, or a little beside it (in texels).
    vec3 centre(std::size_t light, ivec2 texel, vec2 beside = vec2(0.0f)) const {
        const vec2 uv = (vec2(texel) + 0.5f + beside) / float(resolution) * 2.0f - 1.0f;
        const float scale = cone_scale(light);
        return hemisphere[light] ? hemisphere_direction(uv)
               : scale > 0.0f    ? cone_direction(uv, scale)
                                 : sphere_direction(uv);
    }
    // Of a narrow spot light's map; 0 for others.
    float cone_scale(std::size_t light) const { return hemisphere[light] ? 0.0f : rows[light].position_bound.w; }
    // The same in world space; false outside the map.
    bool centre_direction(std::size_t light, ivec2 texel, vec2 beside, vec3& direction) const {
        if (texel.x < 0 || texel.y < 0 || texel.x >= int(resolution) || texel.y >= int(resolution))
            return false;
        const vec3 q = centre(light, texel, beside);
        direction = q.x * vec3(rows[light].tangent_scale) + q.y * vec3(rows[light].bitangent) +
                    q.z * vec3(rows[light].normal_offset);
        return true;
    }

    std::uint32_t bits;
    std::uint32_t resolution = 0;
    std::vector<float> values;
    std::vector<LightRow> rows;
    std::vector<bool> hemisphere;
};

struct SurfaceSampler {
    explicit SurfaceSampler(GpuWorld& world) {
        ecs::Registry& registry = world.renderer->registry();
        registry.view<scene::MeshInstance, scene::WorldTransform>().each(
            [&](ecs::Entity, const scene::MeshInstance& instance, const scene::WorldTransform& transform) {
                const scene::Mesh& mesh = world.renderer->meshes()[instance.mesh];
                const mat4 matrix = world.renderer->space().place(transform.matrix);
                for (std::size_t i = 0; i < mesh.indices.size(); ++i)
                    corners.push_back(vec3(matrix * vec4(mesh.positions[mesh.indices[i]], 1.0f)));
            });
        for (std::size_t i = 0; i < corners.size(); i += 3)
            cumulative.push_back(
                total += double(glm::length(glm::cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]))));
    }
    void sample(RandomSequence& random, vec3& position, vec3& normal) const {
        const std::size_t t =
            3 * std::min<std::size_t>(
                    std::size_t(std::upper_bound(cumulative.begin(), cumulative.end(), double(random.next()) * total) -
                                cumulative.begin()),
                    cumulative.size() - 1);
        const float root = std::sqrt(random.next()), v = random.next();
        position =
            corners[t] + root * (1.0f - v) * (corners[t + 1] - corners[t]) + root * v * (corners[t + 2] - corners[t]);
        normal = glm::normalize(glm::cross(corners[t + 1] - corners[t], corners[t + 2] - corners[t]));
    }
    std::vector<vec3> corners;
    std::vector<double> cumulative;
    double total = 0;
};

// Why the map and Embree may differ: a ray through one of the 5x5 neighbouring texel centres gives the map's answer at
// the receiver's depth, or the blocker is nearer to the receiver than the documented bias.
inline bool explained(const ShadowMapValues& maps, const raytrace::RayScene& rays, std::size_t light,
                      const ShadowMapValues::Look& look, vec3 position) {
    const vec3 origin(maps.rows[light].position_bound);
    // The depth that the map's values are held against: the receiver's, less the bias; values are rounded to whole
    // steps.
    const float rounding = (look.lit ? 0.5f : -0.5f) * depth_step(maps.bits);
    const float w = 1.0f / (look.place.z + (look.bias + rounding) / shadow_near);
    if (look.lit) {
        const raytrace::Ray ray{origin, position - origin, 0.0f, 1.0f};
        const auto hit = rays.closest_hit(ray);
        // 1/w along the ray to the receiver falls as 1/t.
        if (hit && shadow_near * (look.place.z / hit->distance - look.place.z) < look.bias * 1.001f)
            return true;
    }
    // An edge that runs exactly through a centre belongs to either side: rays pass a thousandth of a texel beside it
    // too.
    for (int place = 0; place < 25; ++place)
        for (const vec2 beside :
             {vec2(0.0f), vec2(1e-3f, 0.0f), vec2(-1e-3f, 0.0f), vec2(0.0f, 1e-3f), vec2(0.0f, -1e-3f)}) {
            vec3 direction(0.0f);
            if (!maps.centre_direction(light, look.texel + ivec2(place % 5 - 2, place / 5 - 2), beside, direction))
                continue;
            const bool blocked = rays.occluded(raytrace::Ray{origin, direction * w, 0.0f, 1.0f});
            if (blocked != look.lit)
                return true;
        }
    return false;
}

} // namespace sunfleck::tests
