#include "gi_module/light_part_views.h"

namespace sunfleck::gi {
namespace {

constexpr DebugView views[] = {
    {"direct_light", "Light that comes straight from lamps and the sky", "irradiance", "W/m2", "parts of the light", 0},
    {"first_bounce", "Light that one surface has reflected on its way", "irradiance", "W/m2", "parts of the light", 1},
    {"later_bounces", "Light that two or more surfaces have reflected", "irradiance", "W/m2", "parts of the light", 2},
};

bool belongs(PathPart path, std::uint32_t code) {
    switch (path) {
    case PathPart::punctual:
    case PathPart::direct:
        return code == 0;
    case PathPart::first_bounce:
        return code == 1;
    case PathPart::later_bounces:
        break;
    }
    return code == 2;
}

} // namespace

std::span<const DebugView> light_part_views() {
    return views;
}

CellSet cells_of(const DebugView& light_part_view) {
    return cells_where([&](LightCell cell) { return !cell.specular && belongs(cell.path, light_part_view.code); });
}

} // namespace sunfleck::gi
