// What a user can set about the visibility database.
#pragma once

#include "engine/core/description.h"
#include "gi_module/visibility/test_grouping.h"

namespace sunfleck::gi {

struct VisibilitySettings {
    std::uint32_t patch_levels = 4;
    TestGrouping visibility_tests = TestGrouping::clusters;

    static const TypeDescription& description();
};

} // namespace sunfleck::gi
