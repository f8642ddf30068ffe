// A person's input per step, as integers, so that recordings replay exactly.
#pragma once

#include "engine/core/result.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace sunfleck::simulation {

enum Button : std::uint32_t { button_run = 1, button_crouch = 2, button_use = 4, button_put_down = 8 };
inline constexpr std::uint32_t all_buttons = 15;

struct StepInput {
    std::int32_t forward = 0, right = 0; // -100 to 100: per cent of full speed
    std::int32_t turn = 0, look_up = 0;  // 1e-4 rad in this step; a left turn is positive
    std::uint32_t buttons = 0;
    bool operator==(const StepInput&) const = default;
};
inline constexpr float look_unit = 1e-4f; // rad

// A text file: a line "sunfleck_input 1", then lines "count forward right turn look_up buttons", each for `count` steps
// of the same input. Lines that begin with # are ignored.
Result<std::vector<StepInput>> read_recording(const std::filesystem::path& path);
Status write_recording(const std::filesystem::path& path, const std::vector<StepInput>& steps);

} // namespace sunfleck::simulation
