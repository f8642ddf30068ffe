#include "editor/panels/panel.h"

namespace sunfleck::editor {
namespace {

constexpr PanelEntry entries[] = {
    {"Hierarchy", "All entities, as a tree", Dock::left, make_hierarchy},
    {"Inspector", "The components of what is selected", Dock::right, make_inspector},
    {"Lighting", "Every setting of the lighting", Dock::right, make_lighting},
    {"Pixel", "A place of the picture: its surface, and which light gives it how much", Dock::right, make_pixel},
    {"Views", "What the viewport shows: the picture, or false colours", Dock::bottom, make_views},
    {"Counters", "What the lighting counts in a frame", Dock::bottom, make_counters},
    {"Browser", "What the lighting keeps, as tables", Dock::bottom, make_browser},
    {"Compare", "Against the path tracer or other settings; presets", Dock::bottom, make_compare},
    {"Profile", "What frames take: stages on the CPU, passes on the GPU", Dock::bottom, make_profile},
    {"History", "What was done; click an entry to go back to it", Dock::bottom, make_history},
    {"Messages", "What was said, and what an import left out", Dock::bottom, make_messages},
    {"Commands", "Everything that can be done, and its keys", Dock::bottom, make_command_list}};

} // namespace

std::span<const PanelEntry> panel_list() {
    return entries;
}

} // namespace sunfleck::editor
