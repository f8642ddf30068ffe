// What a user can set about how light becomes a picture: the demo's menu and the tool's options both offer it. What the
// light itself is, gi::Settings says; `--view irradiance` shows it without any of this.
#pragma once

#include "engine/core/description.h"

namespace sunfleck::viewer {

struct PictureSettings {
    bool antialiasing = true;
    float glare = 0.03f;

    static const TypeDescription& description();
};

} // namespace sunfleck::viewer
