#include "gi_module/transfer/environment_probe.h"

#include "engine/core/jobs.h"
#include "gi_module/transport/arrival.h"

#include <algorithm>
#include <bit>

namespace sunfleck::gi {
namespace {

constexpr float shortening = 1e-4f; // of a ray's length, at the light's end, since samples lie on surfaces
constexpr int max_layers = 64;      // of the mover itself that a ray passes through

bool intersects(const raytrace::Ray& ray, const Bounds& bounds) {
    float enter = 0.0f, leave = ray.maximum;
    for (int axis = 0; axis < 3; ++axis) {
        const float inverse = 1.0f / (std::abs(ray.direction[axis]) > 1e-12f ? ray.direction[axis] : 1e-12f);
        const float a = (bounds.minimum[axis] - ray.origin[axis]) * inverse;
        const float b = (bounds.maximum[axis] - ray.origin[axis]) * inverse;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave;
}

class Projection {
public:
    Projection(const ProbeScene& scene, const scene::DrawItem& mover, const mat4& matrix)
        : scene_(scene), mover_(mover), matrix_(matrix) {
        for (int axis = 0; axis < 3; ++axis)
            to_object_[axis] = glm::normalize(vec3(matrix[axis]));
        to_object_ = glm::transpose(to_object_);
        Bounds all;
        for (const scene::DrawItem& item : scene.draws) {
            all.add(item.bounds);
            if (!item.is_static && item.casts_shadow && item.entity != mover.entity)
                others_.push_back(item.bounds);
        }
        size_ = glm::length(all.extent());
        const std::uint32_t node = scene.database ? scene.database->mover_node(mover.entity) : shared::no_node;
        for (std::uint32_t i = 0; i < scene.samples.size(); ++i) {
            const vec3 intensity(scene.rows[i].intensity_slot);
            if (!(std::max({intensity.x, intensity.y, intensity.z}) > 0.0f))
                continue;
            if (node != shared::no_node) {
                const PairState state = scene.database->static_state(node, i);
                if (state == PairState::full || state == PairState::unlit)
                    continue;
            }
            candidates_.push_back(i);
        }
    }

    Environment at(vec3 local) const {
        Environment result;
        const vec3 point(matrix_ * vec4(local, 1.0f));
        for (std::size_t first = 0; first < candidates_.size(); first += raytrace::packet_size)
            add_packet(point, first, std::min(raytrace::packet_size, candidates_.size() - first), result);
        return result;
    }

    // Whether a wall separates a point of the mover's box from its centre: the point would see the light of another
    // room.
    bool is_cut_off(vec3 local, vec3 centre) const {
        const vec3 from(matrix_ * vec4(centre, 1.0f)), to(matrix_ * vec4(local, 1.0f));
        return scene_.rays.occluded(raytrace::Ray{from, to - from, 0.0f, 1.0f}, raytrace::Scope::static_only);
    }

private:
    void add_packet(vec3 point, std::size_t first, std::size_t count, Environment& result) const {
        std::array<Arrival, raytrace::packet_size> arrivals;
        raytrace::ShadowPacket packet;
        packet.active = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const std::uint32_t sample = candidates_[first + k];
            arrivals[k] = arrival(scene_.rows[sample], light_class(scene_.samples[sample].kind), point, 2.0f * size_);
            packet.rays[k] = {point, arrivals[k].to_light, 0.0f, 1.0f - shortening};
            const vec3 light = arrivals[k].irradiance;
            packet.active |= std::max({light.x, light.y, light.z}) > 0.0f ? 1u << k : 0u;
        }
        if (packet.active == 0)
            return;
        std::uint32_t seen = packet.active & ~scene_.rays.occluded(packet, raytrace::Scope::static_only);
        for (; seen != 0; seen &= seen - 1) {
            const auto k = std::size_t(std::countr_zero(seen));
            if (hidden_by_movers(packet.rays[k]))
                continue;
            const Harmonics values = spherical_harmonics(to_object_ * glm::normalize(arrivals[k].to_light));
            for (int c = 0; c < 3; ++c)
                for (std::size_t i = 0; i < harmonics; ++i)
                    result.colours[std::size_t(c)][i] += arrivals[k].irradiance[c] * values[i];
        }
    }

    bool hidden_by_movers(raytrace::Ray ray) const {
        if (std::none_of(others_.begin(), others_.end(), [&](const Bounds& bounds) { return intersects(ray, bounds); }))
            return false;
        for (int layer = 0; layer < max_layers; ++layer) {
            const auto hit = scene_.rays.closest_hit(ray);
            if (!hit)
                return false;
            if (scene_.rays.surface(ray, *hit).entity != mover_.entity)
                return true;
            ray.minimum = hit->distance + 1e-5f;
        }
        return false;
    }

    const ProbeScene& scene_;
    const scene::DrawItem& mover_;
    const mat4& matrix_;
    glm::mat3 to_object_{1.0f};
    float size_ = 0.0f;
    std::vector<Bounds> others_;
    std::vector<std::uint32_t> candidates_; // samples that may reach the mover
};

} // namespace

vec3 PointGrid::point(std::uint32_t index) const {
    const std::uint32_t lines = index / side_, layers = lines / side_; // whole ones before it
    const vec3 cell(float(index % side_), float(lines % side_), float(layers));
    return local_.minimum + local_.extent() * (cell + 0.5f) / float(side_);
}

PointGrid::Weights PointGrid::around(vec3 position) const {
    const vec3 extent = glm::max(local_.extent(), vec3(1e-9f));
    const vec3 at = glm::clamp((position - local_.minimum) / extent * float(side_) - 0.5f, 0.0f, float(side_ - 1));
    const glm::uvec3 low(glm::min(at, vec3(float(side_ > 1 ? side_ - 2 : 0))));
    const vec3 part = at - vec3(low);
    Weights result;
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
        glm::uvec3 cell = low;
        float weight = 1.0f;
        for (int axis = 0; axis < 3; ++axis) {
            const bool high = (corner >> axis) & 1u;
            cell[axis] = std::min(low[axis] + (high ? 1u : 0u), side_ - 1);
            weight *= high ? part[axis] : 1.0f - part[axis];
        }
        result.points[corner] = (cell.z * side_ + cell.y) * side_ + cell.x;
        result.weights[corner] = weight;
    }
    return result;
}

std::vector<Environment> project_environment(const ProbeScene& scene, const scene::DrawItem& mover, const mat4& matrix,
                                             const PointGrid& grid) {
    const Projection projection(scene, mover, matrix);
    std::vector<Environment> result(grid.size());
    const vec3 centre = 0.5f * (grid.point(0) + grid.point(grid.size() - 1));
    std::vector<std::uint8_t> cut_off(grid.size(), 0);
    parallel_for_chunks(grid.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const vec3 local = grid.point(std::uint32_t(i));
            cut_off[i] = grid.size() > 1 && projection.is_cut_off(local, centre);
            result[i] = projection.at(cut_off[i] ? centre : local);
        }
    });
    return result;
}

} // namespace sunfleck::gi
