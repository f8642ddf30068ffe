// Do base and head do the same work in every frame of the recording, and draw the same pictures? Time plays no part:
// both draw at once, from the first frame to the last.
#pragma once

#include "editor/gate/program_pair.h"

#include <filesystem>

namespace sunfleck::gate {

struct WorkCheckOptions {
    std::uint32_t most_frames = 2000;    // of a longer recording, the first ones
    std::vector<std::uint32_t> pictures; // frames that are written, rising
    std::filesystem::path folder;        // for them: base_00042.png, head_00042.png
    Patience patience;
    std::function<void(double share)> progress = [](double) {};
};

struct WorkFrame {
    Frame base, head;
};
struct WorkCheck {
    Hello base, head;
    std::vector<WorkFrame> frames;
};
Result<WorkCheck> check_work(const Programs& programs, const WorkCheckOptions& options);

std::filesystem::path picture_file(const std::filesystem::path& folder, const char* side, std::uint32_t frame);

} // namespace sunfleck::gate
