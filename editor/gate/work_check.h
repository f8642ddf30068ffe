// Do base and head do the same work in every frame of the recording, and draw the same pictures? Time plays no part:
// both draw at once, from the first frame to the last.
#pragma once

#include "editor/gate/picture_store.h"
#include "editor/gate/program_pair.h"

#include <filesystem>

namespace sunfleck::gate {

struct WorkCheckOptions {
    std::uint32_t most_frames = 2000; // of a longer recording, the first ones
    // Frames that are written, rising, as base/NAME.png and head/NAME.png of `folder`. None: some of the recording's.
    std::vector<NamedFrame> pictures;
    std::filesystem::path folder;
    Patience patience;
    std::function<void(double share)> progress = [](double) {};
};

struct WorkFrame {
    Frame base, head;
};
struct WorkCheck {
    Hello base, head;
    std::vector<WorkFrame> frames;
    std::vector<NamedFrame> pictures; // that were written; none where the programs can't
};
Result<WorkCheck> check_work(const Programs& programs, const WorkCheckOptions& options);

// Head's pictures against base's, drawn on one machine: to the bit.
Result<std::vector<PictureResult>> compare_pictures(const WorkCheck& check, const std::filesystem::path& folder);

// One program alone draws all frames up to the last one of these, which it writes as NAME.png of `folder`.
Result<Hello> draw_pictures(const std::vector<std::string>& command, const WorkCheckOptions& options);

} // namespace sunfleck::gate
