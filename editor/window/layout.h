// Where panels are: docks of tabs to the left, right and bottom of the viewport, with borders that can be dragged.
#pragma once

#include "editor/panels/panel.h"

#include <array>

namespace sunfleck::editor {

class Layout {
public:
    Layout();
    // Runs the commands that the frame's keys ask for, unless they are meant for something else: a text, a menu, a
    // question, a flight, a command that is given other keys. Call before draw.
    void take_keys(Session& session) const;
    // The whole window: menus, docks, viewport, status bar.
    void draw(Session& session, const ScenePicture* picture);
    bool flying() const { return viewport_.flying(); }

    // What is kept from run to run: sizes as shares of the window, and which tab is in front.
    struct State {
        float left = 0.20f, right = 0.27f, bottom = 0.27f;
        std::array<std::string, 3> front; // by Dock
    };
    const State& state() const { return state_; }
    void restore(const State& state);

private:
    void dock(Session& session, Dock dock, ImVec2 size);
    void docks(Session& session, const ScenePicture* picture, ImVec2 room);
    void middle(Session& session, const ScenePicture* picture, ImVec2 size, float bottom, float wide);
    void border(const char* name, ImVec2 size, float& share, float whole);
    struct Shown {
        const PanelEntry* entry;
        std::unique_ptr<Panel> panel;
    };
    std::vector<Shown> panels_;
    Viewport viewport_;
    State state_;
    ImVec2 spacing_{0, 0}, padding_{0, 0}; // of panels
    bool restore_front_ = false;
    std::uint64_t document_ = 0; // its number, in the last frame
};

} // namespace sunfleck::editor
