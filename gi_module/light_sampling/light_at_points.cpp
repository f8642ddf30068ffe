#include "gi_module/light_sampling/light_at_points.h"

#include "gi_module/transport/arrival.h"

#include <cmath>

namespace sunfleck::gi {
namespace {

// Radii within which a sample is a disc: at this distance the point is 6 % brighter than its disc, along its axis.
constexpr float near_radii = 4.0f;

float distance(const Bounds& bounds, vec3 point) {
    return glm::length(glm::max(glm::max(bounds.minimum - point, point - bounds.maximum), vec3(0.0f)));
}

// Rays of one point, traced together.
class Packet {
public:
    Packet(const raytrace::RayScene& rays, const LightAtPoints::Visit& visit) : rays_(rays), visit_(visit) {}
    ~Packet() { trace(); }
    Packet(const Packet&) = delete;
    Packet& operator=(const Packet&) = delete;

    void add(std::size_t light, vec3 irradiance, const raytrace::Ray& ray) {
        packet_.rays[filled_] = ray;
        arriving_[filled_] = {light, irradiance};
        if (++filled_ == raytrace::packet_size)
            trace();
    }

private:
    void trace() {
        packet_.active = (1u << filled_) - 1u;
        const std::uint32_t blocked = filled_ > 0 ? rays_.occluded(packet_) : 0;
        for (std::uint32_t i = 0; i < filled_; ++i)
            if (!((blocked >> i) & 1u))
                visit_(arriving_[i].first, arriving_[i].second);
        filled_ = 0;
    }

    const raytrace::RayScene& rays_;
    const LightAtPoints::Visit& visit_;
    raytrace::ShadowPacket packet_;
    std::array<std::pair<std::size_t, vec3>, raytrace::packet_size> arriving_;
    std::uint32_t filled_ = 0;
};

} // namespace

LightAtPoints::LightAtPoints(std::span<const IncomingLight> light, const Bounds& points, float far,
                             const raytrace::RayScene& rays)
    : light_(light), far_(far), rays_(rays), disc_of_(light.size(), 0) {
    for (std::size_t k = 0; k < light.size(); ++k) {
        const IncomingLight& one = light[k];
        if (one.light_class != shared::light_class_surface ||
            distance(points, vec3(one.row.position_bound)) >= near_radii * one.radius)
            continue;
        discs_.push_back(spread(one));
        disc_of_[k] = std::uint32_t(discs_.size());
    }
}

// Points as far out as a disc is in the mean over four rings of one area. What lies behind another surface, as beyond
// the edge of a wall, goes back to the middle: no light comes through walls.
LightAtPoints::Disc LightAtPoints::spread(const IncomingLight& one) const {
    const vec3 middle(one.row.position_bound), tangent(one.row.tangent_scale), bitangent(one.row.bitangent);
    Disc disc;
    for (std::size_t i = 0; i < disc_points; ++i) {
        const float out = one.radius * std::sqrt((float(i) + 0.5f) / float(disc_points));
        const float angle = float(i) * 2.39996323f; // the golden angle
        disc[i] = middle + out * (std::cos(angle) * tangent + std::sin(angle) * bitangent);
        const raytrace::Ray outwards{middle, disc[i] - middle, 0.0f, 1.0f};
        if (rays_.occluded(outwards, raytrace::Scope::static_only))
            disc[i] = middle;
    }
    return disc;
}

void LightAtPoints::gather(vec3 point, vec3 normal, const Visit& visit) const {
    Packet packet(rays_, visit);
    const auto add = [&](std::size_t k, const shared::LightRow& row, float share) {
        const Arrival arrived = arrival(row, light_[k].light_class, point, far_);
        const float cosine = glm::dot(normal, arrived.to_light);
        if (cosine <= 0.0f || arrived.irradiance == vec3(0.0f))
            return;
        packet.add(k, arrived.irradiance * (share * cosine / glm::length(arrived.to_light)),
                   {point, arrived.to_light, 0.0f, 0.9999f});
    };
    for (std::size_t k = 0; k < light_.size(); ++k) {
        const vec3 away = point - vec3(light_[k].row.position_bound);
        if (disc_of_[k] == 0 || glm::length(away) >= near_radii * light_[k].radius) {
            add(k, light_[k].row, 1.0f);
            continue;
        }
        shared::LightRow row = light_[k].row;
        for (const vec3 part : discs_[disc_of_[k] - 1]) {
            row.position_bound = vec4(part, row.position_bound.w);
            add(k, row, 1.0f / float(disc_points));
        }
    }
}

} // namespace sunfleck::gi
