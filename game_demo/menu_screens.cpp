// The screens around the game: loading, title, pause, end.
#include "game_demo/gui_parts.h"
#include "game_demo/menu.h"

namespace sunfleck::demo {

// Drawn without a window: ImGui needs a frame to find a window's size, and this may be the only frame.
void Menu::loading_screen(float share) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImDrawList* list = ImGui::GetForegroundDrawList();
    const auto line = [&](const char* text, float height, float scale, ImU32 colour) {
        const float wide = scale * ImGui::CalcTextSize(text).x;
        list->AddText(ImGui::GetFont(), scale * unit(), ImVec2(0.5f * (size.x - wide), height * size.y), colour, text);
    };
    line("Lantern House", 0.42f, 1.9f, IM_COL32(255, 214, 150, 255));
    line("Computing light paths ...", 0.52f, 1.0f, IM_COL32(220, 210, 195, 255));
    const ImVec2 low(0.36f * size.x, 0.6f * size.y), high(0.64f * size.x, low.y + 0.25f * unit());
    list->AddRectFilled(low, high, IM_COL32(56, 46, 36, 255), 0.1f * unit());
    if (share > 0.0f)
        list->AddRectFilled(low, ImVec2(low.x + share * (high.x - low.x), high.y), IM_COL32(234, 158, 61, 255),
                            0.1f * unit());
    line("Press Escape to quit", 0.66f, 0.8f, IM_COL32(150, 142, 130, 255));
}

Decision Menu::title_screen(const OverlayData& data, bool enter) {
    Decision decision = Decision::none;
    place_next(0.08f, 0.5f, 0.0f, 0.5f);
    ImGui::Begin("title", nullptr, plain);
    heading("Lantern House", 1.9f);
    ImGui::TextUnformatted(data.is_game ? "Doors that open to bounced light" : "A Sunfleck demo of indirect light");
    ImGui::Dummy(ImVec2(0.0f, 0.6f * unit()));
    // The first entry is what Enter does: whoever has a checkpoint wants to go on.
    if (data.can_resume) {
        if (wide_button("Continue") || enter)
            decision = Decision::resume;
        ImGui::SetItemDefaultFocus();
    }
    // What is lost by one press is asked for twice.
    if (data.can_resume && wide_button("New game", "Press again to start over"))
        decision = Decision::play;
    if (!data.can_resume) {
        if (wide_button("Start") || enter)
            decision = Decision::play;
        ImGui::SetItemDefaultFocus();
    }
    settings_and_help_buttons();
    if (wide_button("Quit"))
        decision = Decision::quit;
    ImGui::End();
    return decision;
}

Decision Menu::pause_screen(const OverlayData& data, bool enter) {
    Decision decision = Decision::none;
    place_next(0.5f, 0.5f, 0.5f, 0.5f);
    ImGui::Begin("paused", nullptr, plain);
    heading("Paused", 1.4f);
    if (wide_button("Resume") || enter)
        decision = Decision::play;
    ImGui::SetItemDefaultFocus();
    if (data.has_hint && wide_button("Hint"))
        decision = Decision::hint;
    if (data.has_area && wide_button("Reset this room"))
        decision = Decision::reset_room;
    if (data.can_resume && wide_button("Last checkpoint"))
        decision = Decision::resume;
    settings_and_help_buttons();
    if (wide_button("Restart", data.is_game ? "Press again to restart" : nullptr))
        decision = Decision::restart;
    if (wide_button("Quit"))
        decision = Decision::quit;
    ImGui::End();
    return decision;
}

Decision Menu::end_screen(const OverlayData& data, bool enter) {
    Decision decision = Decision::none;
    place_next(0.5f, 0.5f, 0.5f, 0.5f);
    ImGui::Begin("finished", nullptr, plain);
    heading("The light has found its way", 1.4f);
    const int seconds = int(data.game_seconds);
    ImGui::Text("All doors are open, after %d:%02d minutes.", seconds / 60, seconds % 60);
    ImGui::Dummy(ImVec2(0.0f, 0.4f * unit()));
    if (wide_button("Play once more") || enter)
        decision = Decision::restart;
    ImGui::SetItemDefaultFocus();
    if (wide_button("Title"))
        decision = Decision::title;
    if (wide_button("Quit"))
        decision = Decision::quit;
    ImGui::End();
    return decision;
}

} // namespace sunfleck::demo
