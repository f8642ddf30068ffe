#include "game_demo/game/solution_route.h"

namespace sunfleck::demo {
namespace {

using Task = Solution::Task;
using Tasks = std::vector<Task>;

constexpr std::uint32_t step_rate = 60; // a second

Task walk(float x, float z) {
    return {Task::walk, vec3(x, 0.0f, z), 15 * step_rate};
}
Task look(float x, float y, float z) {
    return {Task::look, vec3(x, y, z), 4 * step_rate};
}
Task wait(float seconds) {
    return {Task::wait, vec3(0.0f), std::uint32_t(seconds * float(step_rate))};
}
Task use() {
    return {Task::press, vec3(0.0f), 10, simulation::button_use};
}
// Looks at a place until the sensor has opened.
Task until_open(const char* sensor, float x, float y, float z) {
    return {Task::until_open, vec3(x, y, z), 8 * step_rate, 0, sensor};
}
// Its origin at this height.
Task until_down(const char* lift, float height) {
    return {Task::until_down, vec3(0.0f, height, 0.0f), 20 * step_rate, 0, lift};
}
Task until_up(float height) {
    return {Task::until_up, vec3(0.0f, height, 0.0f), 20 * step_rate};
}

struct Room {
    const char* area;
    Tasks tasks;
};

// As long as it takes to read a hint.
constexpr float hint_time = 12.0f;
constexpr float marvelling = 5.0f;

Tasks porch() {
    return {wait(hint_time),
            look(-2.6f, 0.4f, 8.3f),
            wait(1.5f),
            walk(0.3f, 9.1f),
            look(0.0f, 1.15f, 8.0f),
            wait(1.0f),
            use(),
            wait(1.0f),
            walk(-0.9f, 8.2f),
            walk(-0.8f, 7.2f),
            walk(0.0f, 7.0f),
            wait(1.0f),
            walk(0.0f, 5.3f)};
}

Tasks corner() {
    return {look(-0.6f, 1.5f, 2.7f),
            wait(hint_time),
            walk(1.9f, 4.4f),
            walk(2.1f, 3.4f),
            walk(2.1f, 1.8f),
            look(-1.8f, 1.6f, 1.2f),
            wait(marvelling),
            look(0.0f, 1.0f, 0.0f),
            wait(marvelling),
            walk(-0.9f, 1.3f),
            until_open("corner sensor", -1.9f, 2.0f, 1.2f),
            wait(marvelling),
            look(1.0f, 1.4f, 0.0f),
            wait(marvelling),
            walk(0.1f, 1.4f),
            walk(0.0f, 0.8f),
            wait(1.0f),
            walk(0.0f, -0.9f)};
}

Tasks red_wall() {
    return {look(-1.2f, 1.3f, -3.3f),
            wait(hint_time),
            walk(-0.4f, -3.6f),
            walk(-0.4f, -4.7f),
            walk(-1.5f, -5.0f),
            look(-2.85f, 1.2f, -5.2f),
            wait(marvelling),
            use(),
            wait(marvelling),
            walk(-0.4f, -4.6f),
            walk(-0.4f, -2.2f),
            walk(-1.7f, -1.75f),
            look(-2.85f, 1.3f, -2.6f),
            until_open("red sensor", -2.85f, 1.3f, -2.6f),
            wait(marvelling),
            look(3.0f, 1.4f, -2.2f),
            wait(marvelling),
            walk(-0.4f, -2.0f),
            walk(1.6f, -3.0f),
            walk(2.4f, -3.24f),
            wait(1.0f),
            walk(3.9f, -3.24f)};
}

Tasks shutters() {
    return {look(8.0f, 0.9f, -3.6f),
            wait(hint_time),
            walk(4.4f, -4.8f),
            look(4.4f, 1.6f, -6.18f),
            wait(1.0f),
            use(),
            wait(marvelling),
            look(4.8f, 0.0f, -3.6f),
            wait(marvelling),
            walk(5.6f, -4.6f),
            walk(6.5f, -5.3f),
            look(7.9f, 1.7f, -6.18f),
            wait(1.0f),
            use(),
            until_open("sun sensor", 8.3f, 0.2f, -4.0f),
            wait(marvelling),
            walk(6.3f, -3.4f),
            walk(6.3f, -1.8f),
            look(7.25f, 1.4f, -0.25f),
            wait(marvelling),
            walk(6.24f, -0.9f),
            wait(1.0f),
            walk(6.24f, 0.8f)};
}

Tasks block() {
    return {look(5.0f, 0.6f, 3.6f),
            wait(hint_time),
            look(6.3f, 0.5f, 2.5f),
            wait(marvelling),
            walk(6.3f, 1.2f),
            walk(6.3f, 3.75f),
            until_open("green sensor", 5.2f, 0.5f, 4.2f),
            wait(marvelling),
            walk(6.3f, 3.0f),
            walk(7.5f, 2.7f),
            look(9.2f, 1.4f, 1.9f),
            wait(marvelling),
            walk(8.5f, 3.0f),
            wait(1.0f),
            walk(10.1f, 3.0f)};
}

Tasks two_colours() {
    return {look(13.4f, 2.2f, 3.8f),
            wait(hint_time),
            walk(11.5f, 4.5f),
            look(11.5f, 1.4f, 5.87f),
            wait(1.0f),
            use(),
            wait(marvelling),
            walk(11.9f, 2.4f),
            walk(14.1f, 2.0f),
            look(15.33f, 1.4f, 2.0f),
            wait(1.0f),
            use(),
            wait(marvelling),
            walk(14.4f, 3.2f),
            walk(14.45f, 4.6f),
            look(15.3f, 1.4f, 5.45f),
            until_open("violet sensor", 15.3f, 1.4f, 5.45f),
            wait(marvelling),
            walk(14.4f, 3.0f),
            walk(12.6f, 1.7f),
            look(11.5f, 1.4f, 0.0f),
            wait(marvelling),
            walk(12.48f, 0.8f),
            wait(1.0f),
            walk(12.48f, -0.9f)};
}

Tasks tower() {
    return {look(12.1f, 5.2f, -5.9f),   wait(hint_time),
            walk(11.8f, -3.0f),         look(11.6f, 6.3f, -4.6f),
            wait(marvelling),           walk(10.5f, -3.7f),
            until_down("lift", -1.58f), walk(10.45f, -5.3f),
            look(12.1f, 4.0f, -5.9f),   until_up(3.42f),
            walk(11.75f, -5.45f),       until_open("tower sensor", 12.1f, 5.6f, -5.9f),
            wait(marvelling),           walk(13.2f, -5.4f),
            look(14.5f, 4.6f, -6.2f),   wait(marvelling),
            walk(13.55f, -5.6f),        wait(1.0f),
            walk(13.55f, -7.2f)};
}

Tasks lamp_room() {
    return {look(12.48f, 5.4f, -10.0f), wait(hint_time), walk(12.8f, -8.4f), walk(12.48f, -10.2f)};
}

std::vector<Room> rooms() {
    return {{"area porch", porch()},       {"area corner", corner()},      {"area red wall", red_wall()},
            {"area shutters", shutters()}, {"area blocks", block()},       {"area colours", two_colours()},
            {"area tower", tower()},       {"area lamp room", lamp_room()}};
}

} // namespace

Tasks solution_from(const std::string& area) {
    Tasks tasks;
    for (Room& room : rooms())
        if (!tasks.empty() || room.area == area)
            tasks.insert(tasks.end(), room.tasks.begin(), room.tasks.end());
    return tasks;
}

} // namespace sunfleck::demo
