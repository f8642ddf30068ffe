// What is drawn over the game: prompts, frame times, messages.
#include "game_demo/gui_parts.h"
#include "game_demo/menu.h"
#include "game_demo/prompt_text.h"

#include <algorithm>
#include <cstdio>

namespace sunfleck::demo {
namespace {

// Bars for at most `limit` parts of a frame, the longest ones, in the order of their names.
void time_rows(const char* title, const std::map<std::string, double>& group, double longest, std::size_t limit) {
    std::vector<std::pair<std::string, double>> rows;
    rows.reserve(group.size());
    for (const auto& [name, time] : group)
        if (time >= 0.05)
            rows.emplace_back(name, time);
    double others = 0.0;
    while (rows.size() > limit) {
        const auto shortest = std::min_element(rows.begin(), rows.end(),
                                               [](const auto& a, const auto& b) { return a.second < b.second; });
        others += shortest->second;
        rows.erase(shortest);
    }
    if (others > 0.0)
        rows.emplace_back("others", others);
    ImGui::BeginGroup();
    ImGui::TextDisabled("%s, ms", title);
    for (const auto& [name, time] : rows) {
        char number[32];
        std::snprintf(number, sizeof number, "%.1f", time);
        ImGui::ProgressBar(float(std::min(time / longest, 1.0)), ImVec2(7.0f * unit(), 0.9f * unit()), number);
        ImGui::SameLine();
        ImGui::TextUnformatted(name.c_str());
    }
    ImGui::EndGroup();
}

} // namespace

void Menu::prompts(const DemoSettings& settings, const OverlayData& data) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImDrawList* list = ImGui::GetForegroundDrawList();
    const bool target = data.interaction != simulation::Interaction::none;
    list->AddCircleFilled(ImVec2(0.5f * size.x, 0.5f * size.y), target ? 0.22f * unit() : 0.12f * unit(),
                          target ? IM_COL32(255, 196, 110, 220) : IM_COL32(255, 255, 255, 130));
    if (!data.indirect_light)
        direct_light_label(settings, data);
    const std::string text = prompt_text(settings, data.interaction, data.carries_lantern, data.with_gamepad);
    if (text.empty())
        return;
    place_next(0.5f, 0.94f, 0.5f, 1.0f);
    ImGui::SetNextWindowBgAlpha(0.45f);
    ImGui::Begin("prompt", nullptr, behind);
    ImGui::TextUnformatted(text.c_str());
    ImGui::End();
}

// As long as it lasts: else whoever has pressed the key by mistake takes the dark for the game's.
void Menu::direct_light_label(const DemoSettings& settings, const OverlayData& data) {
    place_next(0.01f, 0.02f, 0.0f, 0.0f);
    ImGui::SetNextWindowBgAlpha(0.45f);
    ImGui::Begin("direct light", nullptr, behind);
    ImGui::TextUnformatted(
        ("Direct light only (" + (data.with_gamepad ? "Y" : key_of(settings, Action::indirect_light)) + ")").c_str());
    ImGui::End();
}

void Menu::times(const OverlayData& data) {
    place_next(0.99f, 0.02f, 1.0f, 0.0f);
    ImGui::SetNextWindowBgAlpha(0.6f);
    ImGui::Begin("times", nullptr, behind);
    ImGui::Text("%.0f ms, %.1f frames per second", data.frame_ms, data.frame_ms > 0.0 ? 1000.0 / data.frame_ms : 0.0);
    ImGui::Text("%u x %u, %llu light samples", data.rendered_width, data.rendered_height,
                static_cast<unsigned long long>(data.light_samples));
    ImGui::TextDisabled("%s", data.device.c_str());
    // Both columns fit below the text above: what is left out of one is its row "others".
    const float row = ImGui::GetTextLineHeightWithSpacing();
    const float room = 0.96f * ImGui::GetIO().DisplaySize.y - ImGui::GetCursorPosY();
    const bool wide = row * float(data.gpu_ms.size() + data.cpu_ms.size() + 4) > room;
    const std::size_t rows = std::max<std::size_t>(std::size_t(std::max(room / row, 0.0f)), 4) - 3;
    double longest = 1e-6;
    for (const auto* group : {&data.gpu_ms, &data.cpu_ms})
        for (const auto& [name, time] : *group)
            longest = std::max(longest, time);
    time_rows("GPU passes", data.gpu_ms, longest, rows);
    if (wide)
        ImGui::SameLine(0.0f, unit());
    time_rows("CPU stages", data.cpu_ms, longest, rows);
    ImGui::End();
}

void Menu::light_progress(float share) {
    place_next(0.99f, 0.98f, 1.0f, 1.0f);
    ImGui::SetNextWindowBgAlpha(0.45f);
    ImGui::Begin("light", nullptr, behind);
    ImGui::Text("Preparing the light: %.0f %%", 100.0 * double(share));
    ImGui::End();
}

void Menu::message() {
    if (message_seconds_ <= 0.0)
        return;
    message_seconds_ -= double(ImGui::GetIO().DeltaTime);
    place_next(0.5f, 0.05f, 0.5f, 0.0f);
    ImGui::SetNextWindowBgAlpha(0.6f);
    ImGui::Begin("message", nullptr, behind);
    ImGui::TextUnformatted(message_.c_str());
    ImGui::End();
}

} // namespace sunfleck::demo
