// The panels, a file each. None of them knows a component, a technique or a setting by name: what they show comes from
// descriptions and registries.
#pragma once

#include "editor/window/gizmo.h"
#include "editor/window/session.h"
#include "editor/window/widgets.h"

#include <span>

namespace sunfleck::editor {

enum class Dock { left, right, bottom };

class Panel {
public:
    virtual ~Panel() = default;
    // Within an ImGui child window.
    virtual void draw(Session& session) = 0;
};

struct PanelEntry {
    const char* name; // on its tab
    const char* tooltip;
    Dock dock;
    std::unique_ptr<Panel> (*make)();
};

// In the order of their tabs.
std::span<const PanelEntry> panel_list();

std::unique_ptr<Panel> make_hierarchy();
std::unique_ptr<Panel> make_history();
std::unique_ptr<Panel> make_inspector();
std::unique_ptr<Panel> make_lighting();
std::unique_ptr<Panel> make_pixel();
std::unique_ptr<Panel> make_views();
std::unique_ptr<Panel> make_counters();
std::unique_ptr<Panel> make_browser();
std::unique_ptr<Panel> make_compare();
std::unique_ptr<Panel> make_profile();
std::unique_ptr<Panel> make_messages();
std::unique_ptr<Panel> make_command_list();

// Those with places of their own.
void draw_menu_bar(Session& session);
void draw_status_bar(Session& session, const ScenePicture* picture);
void draw_dialogs(Session& session);
// Pointer, keys and what is drawn over the picture; `picture` may be null.
class Viewport {
public:
    void draw(Session& session, const ScenePicture* picture);
    // Keys fly the camera, and no shortcut is meant.
    bool flying() const { return flying_; }

private:
    void navigate(Session& session, bool hovered);
    void click(Session& session);
    void overlay(Session& session);
    void toolbar(Session& session);
    static void play_buttons(Session& session);
    static void step_boxes(Session& session);
    bool split(Session& session);
    Entity icon_at(Session& session, vec2 place);
    void find_places(Session& session);
    bool no_lamp_shines(Session& session);
    struct Icon {
        Entity entity;
        vec3 place; // in the world; or pixels and distance
    };
    std::vector<Icon> icons(Session& session);
    Gizmo gizmo_;
    SeenState places_state_, lamps_state_;
    std::vector<Entity> lamps_;
    std::shared_ptr<const PlayedPlaces> played_; // of those places
    std::vector<Icon> icon_places_;              // in the world, of all that has one
    std::vector<Placed> outlines_;               // of what is selected
    bool flying_ = false;
    ImVec2 pressed_{0, 0};
    ImVec2 toolbar_low_{0, 0}, toolbar_high_{0, 0}; // in the last frame; clicks there do not go through to the picture
    bool press_is_click_ = false, press_inspects_ = false;
};

} // namespace sunfleck::editor
