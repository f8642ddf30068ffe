// The programs of the self-test: base, builds of the same source with other bytes, and one that can be made slower.
#pragma once

#include "editor/gate/child_process.h"

#include <filesystem>

namespace sunfleck::gate {

struct SelfTestPrograms {
    std::filesystem::path base, slow;
    std::vector<std::filesystem::path> rebuilds;
};

// Builds what is missing in `folder` from the sources in `root`. `rebuilds` of them are made: functions aligned to 16,
// 32 or 64 bytes, in random order.
Result<SelfTestPrograms> build_self_test_programs(const std::filesystem::path& root,
                                                  const std::filesystem::path& folder, std::uint32_t rebuilds,
                                                  const Patience& patience,
                                                  const std::function<void(const std::string&)>& say);

} // namespace sunfleck::gate
