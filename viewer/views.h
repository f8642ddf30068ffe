// The views of a picture besides those of the lighting (gi::debug_views()): for --view and menus.
#pragma once

#include "engine/render/composition_shared.h"
#include "gi_module/technique.h"

#include <span>
#include <string_view>

namespace sunfleck::viewer {

struct PictureView {
    std::string_view name; // --view NAME
    std::uint32_t code;    // FrameRequest::view
    std::string_view tooltip, legend, unit;
};
std::span<const PictureView> picture_views();

// FrameRequest::view that shows a view of the lighting: light with its exposure, all else as it is.
std::uint32_t picture_view_of(const gi::DebugView& view);

} // namespace sunfleck::viewer
