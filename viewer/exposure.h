// How bright a picture is shown.
#pragma once

#include "engine/ecs/registry.h"
#include "engine/io/image.h"

#include <optional>

namespace sunfleck::viewer {

// EV100 that the scene says (scene::Exposure); none: it leaves that to automatic_exposure.
std::optional<float> scene_exposure(ecs::Registry& registry);

// EV100 at which a light meter pointed at this picture would expose it (ISO 2720: reflected light, K = 12.5 cd s/m2):
// from the mean of the logarithm of luminance, of the middle four fifths of the pixels that have any. `picture`:
// linear, radiance in W/(sr m2), or irradiance in W/m2, which is shown as the radiance of a white surface. Within the
// limits of
// --ev100; a black picture has the default.
float automatic_exposure(const io::Picture& picture, bool irradiance = false);

inline constexpr float default_exposure = 10.0f;                           // EV100
inline constexpr float lowest_exposure = -16.0f, highest_exposure = 32.0f; // of --ev100

} // namespace sunfleck::viewer
