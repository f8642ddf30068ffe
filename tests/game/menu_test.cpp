// The menu as the keyboard alone works it, without a window.
#include "game_demo/menu.h"

#include <gtest/gtest.h>
#include <imgui.h>
#include <utility>

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
        data.is_game = data.can_resume = data.has_area = data.has_hint = true;
    }
    ~MenuByKeys() override { ImGui::DestroyContext(); }

    Decision frame() {
        bool changed = false;
        ImGui::NewFrame();
        const Decision decision = menu.draw(settings, data, input, changed);
        draw_list();
        ImGui::Render();
        return decision;
    }
    // As a box of choices of the menu has it.
    void draw_list() {
        if (opens_list || list_is_open) {
            ImGui::Begin("box");
            if (std::exchange(opens_list, false))
                ImGui::OpenPopup("list");
            list_is_open = ImGui::BeginPopup("list");
            if (list_is_open) {
                ImGui::Selectable("choice");
                ImGui::EndPopup();
            }
            ImGui::End();
        }
    }
    void press_b() {
        input.gamepad.present = true;
        for (const bool down_now : {true, false}) {
            input.gamepad.buttons = down_now ? 2u : 0u;
            ImGui::GetIO().NavInputs[ImGuiNavInput_Cancel] = down_now ? 1.0f : 0.0f; // as Gui does
            frame();
        }
    }
    // What the windows of a frame are made of.
    int vertices() {
        frame();
        frame();
        return ImGui::GetDrawData()->TotalVtxCount;
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
    app::InputState input;
    bool opens_list = false, list_is_open = false;
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

TEST_F(MenuByKeys, TheGamepadsBGoesBack) {
    open(Screen::paused);
    menu.show(Screen::help);
    press_b();
    EXPECT_EQ(menu.screen(), Screen::paused);
    menu.show(Screen::settings);
    frame();
    press_b();
    EXPECT_EQ(menu.screen(), Screen::paused);
    press_b();
    EXPECT_EQ(menu.screen(), Screen::playing);
    press_b();
    EXPECT_EQ(menu.screen(), Screen::playing) << "there it crouches";
    open(Screen::title);
    press_b();
    EXPECT_EQ(menu.screen(), Screen::title);
}

// A list of choices that is open: B closes it and nothing else.
TEST_F(MenuByKeys, AnOpenListOfChoicesTakesTheB) {
    open(Screen::paused);
    open(Screen::settings);
    opens_list = true;
    frame();
    frame();
    ASSERT_TRUE(list_is_open);
    press_b();
    EXPECT_FALSE(list_is_open);
    EXPECT_EQ(menu.screen(), Screen::settings);
    press_b();
    EXPECT_EQ(menu.screen(), Screen::paused);
}

// A label stays as long as bounced light is off.
TEST_F(MenuByKeys, DirectLightAloneIsSaid) {
    open(Screen::playing);
    const int with = vertices();
    data.indirect_light = false;
    const int without = vertices();
    EXPECT_GT(without, with + 4 * int(std::string("Direct light only").size()) - 8);
    data.indirect_light = true;
    EXPECT_EQ(vertices(), with);
}

TEST_F(MenuByKeys, TheEndLeadsToTheTitle) {
    open(Screen::finished);
    EXPECT_EQ(menu.selected(), "Play once more");
    select("Title");
    EXPECT_EQ(press(space), Decision::title);
}

// Where there is no hint, or no room to reset, the entry would do nothing.
TEST_F(MenuByKeys, WhatThePlaceDoesNotHaveIsNotOffered) {
    const auto offers = [&](const std::string& name) {
        open(Screen::paused);
        for (int i = 0; i < 20; ++i)
            press(up);
        for (int i = 0; i < 20 && menu.selected() != name; ++i)
            press(down);
        return menu.selected() == name;
    };
    EXPECT_TRUE(offers("Hint"));
    EXPECT_TRUE(offers("Reset this room"));
    data.has_hint = false;
    EXPECT_FALSE(offers("Hint"));
    EXPECT_TRUE(offers("Reset this room"));
    data.has_area = false;
    EXPECT_FALSE(offers("Reset this room"));
    EXPECT_TRUE(offers("Last checkpoint"));
}

} // namespace
} // namespace sunfleck::demo
