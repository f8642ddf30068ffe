#include "editor/document/lamp_flux.h"

#include "engine/scene/components.h"

#include <cmath>

namespace sunfleck::editor {
namespace {

constexpr double circle = 3.14159265358979323846;

bool is_of(const Field& field, const TypeDescription& type, std::string_view name) {
    for (const Field& one : type.fields)
        if (&one == &field)
            return field.name == name;
    return false;
}

double area_of(const scene::AreaLight& light) {
    switch (light.shape) {
    case scene::AreaShape::rectangle:
        return double(light.width) * double(light.height);
    case scene::AreaShape::disc:
        return circle * double(light.radius) * double(light.radius);
    case scene::AreaShape::sphere:
        break;
    }
    return 4.0 * circle * double(light.radius) * double(light.radius);
}

// The integral of KHR_lights_punctual's falloff, the square of what rises linearly with the cosine between the cones.
double solid_angle_of(const scene::SpotLight& light) {
    const double inner = std::cos(double(light.inner_angle)), outer = std::cos(double(light.outer_angle));
    return 2.0 * circle * ((1.0 - inner) + std::max(inner - outer, 0.0) / 3.0);
}

} // namespace

double flux_per_unit(const Field& field, const void* object) {
    if (is_of(field, scene::PointLight::description(), "intensity"))
        return 4.0 * circle;
    if (is_of(field, scene::SpotLight::description(), "intensity"))
        return solid_angle_of(*static_cast<const scene::SpotLight*>(object));
    if (is_of(field, scene::AreaLight::description(), "radiance"))
        return circle * area_of(*static_cast<const scene::AreaLight*>(object));
    return 0.0;
}

} // namespace sunfleck::editor
