// The menu as the keyboard alone works it, without a window.
#include "game_demo/menu.h"

#include <gtest/gtest.h>
#include <imgui.h>

namespace sunfleck::demo {
namespace {

struct MenuByKeys : testing::Test {
    enum Key { down = 1, up, space };

    MenuByKeys() {
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
        io.DisplaySize = ImVec2(1280.0f, 720.0f);
        io.DeltaTime = 1.0f / 60.0f;
        io.KeyMap[ImGuiKey_DownArrow] = down;
        io.KeyMap[ImGuiKey_UpArrow] = up;
        io.KeyMap[ImGuiKey_Space] = space;
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
        data.is_game = data.can_resume = true;
    }
    ~MenuByKeys() override { ImGui::DestroyContext(); }

    Decision frame() {
        bool changed = false;
        ImGui::NewFrame();
        const Decision decision = menu.draw(settings, data, {}, changed);
        ImGui::EndFrame();
        return decision;
    }
    Decision press(Key key) {
        ImGui::GetIO().KeysDown[key] = true;
        const Decision decision = frame();
        ImGui::GetIO().KeysDown[key] = false;
        const Decision after = frame();
        return decision != Decision::none ? decision : after;
    }
    void open(Screen screen) {
        menu.show(screen);
        frame();
        frame();
    }
    void select(const std::string& name) {
        for (int i = 0; i < 20 && menu.selected() != name; ++i)
            press(down);
        ASSERT_EQ(menu.selected(), name);
    }

    Menu menu;
    DemoSettings settings;
    OverlayData data;
};

TEST_F(MenuByKeys, WhatALossWouldFollowIsAskedTwice) {
    for (const auto& [screen, name, what] :
         {std::tuple(Screen::title, "New game", Decision::play), {Screen::paused, "Restart", Decision::restart}}) {
        open(screen);
        select(name);
        EXPECT_EQ(press(space), Decision::none) << name;
        EXPECT_EQ(press(space), what) << name;
        EXPECT_EQ(press(space), Decision::none) << name << ", once more";
        press(up);
        select(name);
        EXPECT_EQ(press(space), Decision::none) << name << ", after another";
        open(screen);
        select(name);
        EXPECT_EQ(press(space), Decision::none) << name << ", opened again";
        EXPECT_EQ(press(space), what) << name;
    }
}

TEST_F(MenuByKeys, WhatLosesNothingIsNotAsked) {
    open(Screen::paused);
    select("Last checkpoint");
    EXPECT_EQ(press(space), Decision::resume);
    data.is_game = data.can_resume = false;
    open(Screen::title);
    select("Start");
    EXPECT_EQ(press(space), Decision::play);
    open(Screen::paused);
    select("Restart");
    EXPECT_EQ(press(space), Decision::restart);
}

} // namespace
} // namespace sunfleck::demo
