#include "game_demo/game_session.h"

#include "engine/simulation/path_movers.h"
#include "game_demo/game/sensor_bars.h"
#include "game_demo/gui_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sunfleck::demo {
namespace {

constexpr double title_time = 5.0, hint_time = 12.0; // s
constexpr double patience = 75.0;                    // s in a room until its hint shows by itself

// Corners of a colour's shape; it is told by shape alone, too.
int corners_of(vec3 threshold) {
    const bool r = threshold.x > 0.0f, g = threshold.y > 0.0f, b = threshold.z > 0.0f;
    return r && g && b ? 40 : r && b ? 5 : r ? 3 : g ? 4 : 6;
}

ImU32 colour_of(vec3 threshold) {
    const float most = std::max({threshold.x, threshold.y, threshold.z, 1e-6f});
    const auto part = [&](float value) { return int(std::lround(90.0f + 165.0f * value / most)); };
    return IM_COL32(part(threshold.x), part(threshold.y), part(threshold.z), 255);
}

// The closed sensor of the area, or else an open one.
ecs::Entity sensor_in(const GameWorld& world, ecs::Entity area) {
    ecs::Entity found;
    bool found_open = true;
    world.registry().view<scene::LightSensor, scene::SensorReading, scene::WorldTransform>().each(
        [&](ecs::Entity entity, const scene::LightSensor&, const scene::SensorReading& reading,
            const scene::WorldTransform& place) {
            if (world.is_in(area, vec3(place.matrix[3])) && (found.is_null() || (found_open && !reading.open))) {
                found = entity;
                found_open = reading.open;
            }
        });
    return found;
}

// Of a colour, by which it is told without the colour, too. `radius`: in units of the text.
void draw_shape(vec3 threshold, ImVec2 centre, float radius) {
    ImGui::GetWindowDrawList()->AddNgonFilled(centre, radius * unit(), colour_of(threshold), corners_of(threshold));
}

constexpr float bar_pitch = 0.95f; // from one bar's top to the next one's, in units of the text

// What is counted against the sensor is shown faint, behind what counts. `named`: it begins with its colour's shape.
void draw_bar(const SensorBar& bar, bool named, ImVec2 at) {
    vec3 channel(0.0f);
    channel[bar.channel] = 1.0f;
    const float high = 0.65f * unit(), wide = 9.0f * unit(), left = at.x + 1.0f * unit();
    const float top = at.y + 0.5f * (bar_pitch * unit() - high);
    const auto x_of = [&](float share) { return left + wide * std::min(share / scene::sensor_gauge_end, 1.0f); };
    ImDrawList* list = ImGui::GetWindowDrawList();
    if (named)
        draw_shape(channel, {at.x + 0.35f * unit(), top + 0.5f * high}, 0.38f);
    const ImU32 colour = colour_of(channel), faint = (colour & ~IM_COL32_A_MASK) | (ImU32(80) << IM_COL32_A_SHIFT);
    list->AddRectFilled({left, top}, {left + wide, top + high}, IM_COL32(40, 40, 40, 200));
    list->AddRectFilled({left, top}, {x_of(bar.gets), top + high}, faint);
    list->AddRectFilled({left, top}, {x_of(bar.counts()), top + high}, colour);
    const float enough = x_of(1.0f), over = 0.12f * unit();
    list->AddLine({enough, top - over}, {enough, top + high + over}, IM_COL32(255, 255, 255, 255), 0.12f * unit());
}

void text_window(const char* name, const std::string& text, float y, float alpha) {
    const float width = 0.62f * ImGui::GetIO().DisplaySize.x;
    place_next(0.5f, y, 0.5f, 0.5f);
    ImGui::SetNextWindowBgAlpha(alpha);
    ImGui::SetNextWindowSizeConstraints(ImVec2(0.0f, 0.0f), ImVec2(width, 1e6f));
    ImGui::Begin(name, nullptr, behind);
    ImGui::PushTextWrapPos(width - unit());
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::End();
}

} // namespace

GameSession::GameSession(const std::string& scene, const std::filesystem::path& folder)
    : files_(folder, scene), has_folder_(!folder.empty()) {}

GameSession::~GameSession() {
    end_saving();
}

bool GameSession::begin(GameWorld& world, bool resume) {
    end_saving();
    world_ = &world;
    const bool resumed = resume && has_folder_ && files_.load(world, message_);
    seconds_ = double(world.simulation().steps()) * simulation::step_seconds;
    area_ = world.area_entity(); // the first area is no reason for a checkpoint: the last one stays
    title_seconds_ = title_time;
    area_seconds_ = 0.0;
    hint_seconds_ = resumed ? 0.0 : hint_time; // the first one says what the game is about
    ended_ = world.finished();
    if (!resume && has_folder_ && is_game()) // of this game from now on, not of the one before
        save_checkpoint();
    return resumed || !resume;
}

void GameSession::save_checkpoint() {
    end_saving();
    saving_ = std::async(std::launch::async, [files = files_, game = kept()] { return files.write(game()); });
}

void GameSession::remove_checkpoints() {
    end_saving();
    saving_ = std::async(std::launch::async, [files = files_] { return files.clear(); });
}

void GameSession::end_saving() {
    if (!saving_.valid())
        return;
    if (const Status saved = saving_.get(); !saved)
        message_ = (ended_ ? "The checkpoint stays: " : "No checkpoint: ") + saved.error().message;
}

void GameSession::update(double seconds) {
    if (saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
        end_saving();
    if (!is_game() || ended_)
        return;
    seconds_ = double(world_->simulation().steps()) * simulation::step_seconds;
    if (world_->finished()) {
        ended_ = true;
        if (has_folder_)
            remove_checkpoints();
        return;
    }
    title_seconds_ = std::max(title_seconds_ - seconds, 0.0);
    hint_seconds_ = std::max(hint_seconds_ - seconds, 0.0);
    area_seconds_ += seconds;
    if (area_seconds_ >= patience) {
        area_seconds_ = 0.0;
        show_hint();
    }
    if (world_->area_entity() == area_)
        return;
    area_ = world_->area_entity();
    title_seconds_ = title_time;
    hint_seconds_ = area_seconds_ = 0.0;
    if (has_folder_)
        save_checkpoint();
}

Status GameSession::keep() {
    end_saving();
    return has_folder_ && is_game() && !world_->finished() ? files_.write(saved()) : Status();
}

void GameSession::show_hint() {
    hint_seconds_ = hint_time;
}

GameProgress GameSession::progress() const {
    if (world_ == nullptr)
        return {"", vec3(0.0f), 0.0f, 0, false, false, false, can_resume()};
    const simulation::Simulation& simulation = world_->simulation();
    return {has_area() ? world_->area()->title : std::string(),
            simulation.player().capsule().foot,
            simulation.player().yaw(),
            simulation.steps(),
            hint_seconds_ > 0.0,
            world_->finished(),
            simulation.carries_lantern(),
            can_resume()};
}

void GameSession::draw() const {
    if (!has_area())
        return;
    draw_title();
    draw_sensor();
}

void GameSession::draw_title() const {
    const scene::GameArea& area = *world_->area();
    if (title_seconds_ > 0.0)
        text_window("area title", area.title, 0.16f, 0.5f);
    if (hint_seconds_ > 0.0 && !area.hint.empty())
        text_window("area hint", area.hint, 0.80f, 0.65f);
}

// The room's sensor: its shape, and a bar for each colour that it needs, with a line where it is enough.
void GameSession::draw_sensor() const {
    const ecs::Registry& registry = world_->registry();
    const ecs::Entity entity = sensor_in(*world_, world_->area_entity());
    if (entity.is_null())
        return;
    const auto& sensor = registry.get<scene::LightSensor>(entity);
    const auto& reading = registry.get<scene::SensorReading>(entity);
    const std::vector<SensorBar> bars = sensor_bars(sensor, reading);
    place_next(0.02f, 0.97f, 0.0f, 1.0f);
    ImGui::SetNextWindowBgAlpha(0.5f);
    ImGui::Begin("sensor", nullptr, behind);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float height = std::max(1.6f, bar_pitch * float(bars.size())) * unit();
    draw_shape(sensor.threshold, {at.x + 0.8f * unit(), at.y + 0.5f * height}, 0.7f);
    for (std::size_t i = 0; i < bars.size(); ++i)
        draw_bar(
            bars[i], bars.size() > 1,
            {at.x + 2.0f * unit(), at.y + 0.5f * height + (float(i) - 0.5f * float(bars.size())) * bar_pitch * unit()});
    ImGui::Dummy(ImVec2(12.0f * unit(), height));
    ImGui::TextUnformatted(sensor_words(sensor, reading).c_str());
    ImGui::End();
}

} // namespace sunfleck::demo
