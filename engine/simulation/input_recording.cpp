#include "engine/simulation/input_recording.h"

#include "engine/core/file.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace sunfleck::simulation {
namespace {

constexpr std::size_t max_steps = 10'000'000; // two days
constexpr const char* first_line = "sunfleck_input 1";

bool valid(const StepInput& step) {
    const auto within = [](std::int32_t value, std::int32_t most) { return value >= -most && value <= most; };
    return within(step.forward, 100) && within(step.right, 100) && within(step.turn, 63000) &&
           within(step.look_up, 63000) && (step.buttons & ~all_buttons) == 0;
}

} // namespace

Result<std::vector<StepInput>> read_recording(const std::filesystem::path& path) {
    SUNFLECK_ASSIGN(const std::string text, read_file(path, std::size_t(256) << 20));
    std::istringstream lines(text);
    std::string line;
    if (!std::getline(lines, line) || line != first_line)
        return Error{"'" + path.string() + "' is not an input recording: its first line must be '" + first_line + "'"};
    std::vector<StepInput> steps;
    for (int number = 2; std::getline(lines, line); ++number) {
        if (line.empty() || line[0] == '#')
            continue;
        std::istringstream fields(line);
        StepInput step;
        std::int64_t count = 0;
        std::string rest;
        if (!(fields >> count >> step.forward >> step.right >> step.turn >> step.look_up >> step.buttons) ||
            (fields >> rest) || count < 1 || std::uint64_t(count) > max_steps - steps.size() || !valid(step))
            return Error{"'" + path.string() + "', line " + std::to_string(number) +
                         ": 'count forward right turn look_up buttons' within their ranges is needed"};
        steps.insert(steps.end(), std::size_t(count), step);
    }
    return steps;
}

namespace {

std::string recording_text(const std::vector<StepInput>& steps) {
    std::ostringstream text;
    text << first_line << "\n# count forward right turn look_up buttons\n";
    for (std::size_t i = 0; i < steps.size();) {
        std::size_t end = i + 1;
        while (end < steps.size() && steps[end] == steps[i])
            ++end;
        const StepInput& s = steps[i];
        text << end - i << ' ' << s.forward << ' ' << s.right << ' ' << s.turn << ' ' << s.look_up << ' ' << s.buttons
             << '\n';
        i = end;
    }
    return text.str();
}

} // namespace

Status write_recording(const std::filesystem::path& path, const std::vector<StepInput>& steps) {
    return write_file(path, recording_text(steps));
}

RecordingWriter::~RecordingWriter() {
    if (writing_.valid())
        writing_.wait();
}

void RecordingWriter::add(const StepInput& step) {
    if (path_.empty())
        return;
    steps_.push_back(step);
    changed_ = true;
}

void RecordingWriter::clear() {
    steps_.clear();
    changed_ = false;
}

void RecordingWriter::start_writing() {
    writing_ = std::async(std::launch::async, [path = path_, steps = steps_] {
        const Clock::time_point begin = Clock::now();
        Status status = write_recording(path, steps);
        return std::pair(std::move(status), Clock::now() - begin);
    });
    changed_ = false;
}

void RecordingWriter::save_if_due() {
    using namespace std::chrono_literals;
    if (writing_.valid()) {
        if (writing_.wait_for(0s) != std::future_status::ready)
            return;
        const auto [status, took] = writing_.get();
        due_ = Clock::now() + std::max<Clock::duration>(1s, 50 * took);
        changed_ = changed_ || !status;
    }
    if (changed_ && Clock::now() >= due_)
        start_writing();
}

Status RecordingWriter::finish() {
    if (writing_.valid())
        writing_.wait();
    if (path_.empty())
        return {};
    changed_ = false;
    return write_recording(path_, steps_);
}

} // namespace sunfleck::simulation
