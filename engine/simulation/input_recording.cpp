#include "engine/simulation/input_recording.h"

#include "engine/core/file.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace sunfleck::simulation {
namespace {

constexpr std::size_t max_steps = 10'000'000; // two days
constexpr const char* first_line = "sunfleck_input 1";
constexpr const char* first_line_with_start = "sunfleck_input 2";
constexpr const char* start_word = "start ";

bool valid(const StepInput& step) {
    const auto within = [](std::int32_t value, std::int32_t most) { return value >= -most && value <= most; };
    return within(step.forward, 100) && within(step.right, 100) && within(step.turn, 63000) &&
           within(step.look_up, 63000) && (step.buttons & ~all_buttons) == 0;
}

} // namespace

Result<Recording> read_recording_and_start(const std::filesystem::path& path) {
    SUNFLECK_ASSIGN(const std::string text, read_file(path, std::size_t(256) << 20));
    std::istringstream lines(text);
    std::string line;
    const bool has_line = bool(std::getline(lines, line)), has_start = line == first_line_with_start;
    if (!has_line || (line != first_line && !has_start))
        return Error{"'" + path.string() + "' is not an input recording: its first line must be '" + first_line + "'"};
    Recording recording;
    int number = 2;
    if (has_start) {
        if (!std::getline(lines, line) || line.rfind(start_word, 0) != 0)
            return Error{"'" + path.string() + "', line 2: '" + start_word + "' and a saved game is needed"};
        recording.start = line.substr(std::string(start_word).size());
        ++number;
    }
    std::vector<StepInput>& steps = recording.steps;
    for (; std::getline(lines, line); ++number) {
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
    return recording;
}

Result<std::vector<StepInput>> read_recording(const std::filesystem::path& path) {
    SUNFLECK_ASSIGN(Recording recording, read_recording_and_start(path));
    if (!recording.start.empty())
        return Error{"'" + path.string() +
                     "' begins at a checkpoint of the game; a recording from its start is needed"};
    return std::move(recording.steps);
}

namespace {

std::string recording_text(const Recording& recording) {
    const std::vector<StepInput>& steps = recording.steps;
    std::ostringstream text;
    if (recording.start.empty())
        text << first_line << "\n";
    else
        text << first_line_with_start << "\n" << start_word << recording.start << "\n";
    text << "# count forward right turn look_up buttons\n";
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

Status write_recording(const std::filesystem::path& path, const Recording& recording) {
    return write_file(path, recording_text(recording));
}

Status write_recording(const std::filesystem::path& path, const std::vector<StepInput>& steps) {
    return write_recording(path, Recording{{}, steps});
}

RecordingWriter::~RecordingWriter() {
    if (writing_.valid())
        writing_.wait();
}

void RecordingWriter::add(const StepInput& step) {
    if (path_.empty())
        return;
    recording_.steps.push_back(step);
    changed_ = true;
}

void RecordingWriter::clear(std::string start) {
    recording_ = {std::move(start), {}};
    changed_ = false;
}

void RecordingWriter::start_writing() {
    writing_ = std::async(std::launch::async, [path = path_, recording = recording_] {
        const Clock::time_point begin = Clock::now();
        Status status = write_recording(path, recording);
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
    return write_recording(path_, recording_);
}

} // namespace sunfleck::simulation
