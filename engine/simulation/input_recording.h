// A person's input per step, as integers, so that recordings replay exactly.
#pragma once

#include "engine/core/result.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <future>
#include <string>
#include <vector>

namespace sunfleck::simulation {

enum Button : std::uint32_t {
    button_run = 1,
    button_crouch = 2,
    button_use = 4,
    button_put_down = 8,
    button_reset = 16
};
inline constexpr std::uint32_t all_buttons = 31;

struct StepInput {
    std::int32_t forward = 0, right = 0; // -100 to 100: per cent of full speed
    std::int32_t turn = 0, look_up = 0;  // 1e-4 rad in this step; a left turn is positive
    std::uint32_t buttons = 0;
    bool operator==(const StepInput&) const = default;
};
inline constexpr float look_unit = 1e-4f; // rad

struct Recording {
    std::string start; // what the program saved of the world where it begins; empty: the level as it is loaded
    std::vector<StepInput> steps;
};

// A text file: a line "sunfleck_input 1", then lines "count forward right turn look_up buttons", each for `count` steps
// of the same input. Lines that begin with # are ignored. What does not begin with the level begins with
// "sunfleck_input 2", and its second line is "start ", followed by the start, in which there are no line breaks.
Result<Recording> read_recording_and_start(const std::filesystem::path& path);
// The same for who can begin with the level alone; an error otherwise.
Result<std::vector<StepInput>> read_recording(const std::filesystem::path& path);
Status write_recording(const std::filesystem::path& path, const Recording& recording);
Status write_recording(const std::filesystem::path& path, const std::vector<StepInput>& steps);

// A recording that is kept on disk while it grows: what a kill loses is the last second or, of recordings that take
// long to write, fifty times what the last write took. For one thread; writing is done on another, so that no frame
// waits for the disk.
class RecordingWriter {
public:
    // An empty path: nothing is recorded.
    explicit RecordingWriter(std::filesystem::path path) : path_(std::move(path)) {}
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    void add(const StepInput& step);
    // Starts over: another world, which begins with the level or with `start`.
    void clear(std::string start = {});
    // Once a frame: writes if it is due.
    void save_if_due();
    // Writes everything and waits for it. The error is of this write; one before may have failed for a passing reason.
    Status finish();

private:
    using Clock = std::chrono::steady_clock;
    void start_writing();

    const std::filesystem::path path_;
    Recording recording_;
    bool changed_ = false;
    Clock::time_point due_ = Clock::now();
    std::future<std::pair<Status, Clock::duration>> writing_; // the result, and how long it took
};

} // namespace sunfleck::simulation
