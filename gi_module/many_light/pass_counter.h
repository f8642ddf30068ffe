// Counts the render passes that a renderer with a few lights per pass would need for the frame (thesis sec. 4.3.5); see
// pass_grouping.h.
#pragma once

#include "gi_module/many_light/many_light_settings.h"
#include "gi_module/many_light/pass_grouping.h"
#include "gi_module/visibility/visibility_database.h"

#include <memory>

namespace sunfleck::gi {

class PassCounter {
public:
    // Nodes that left the view are dropped; the others keep their elements from frame to frame.
    void count(const VisibilityDatabase& database, const mat4& view_projection, const ManyLightSettings& settings);
    // Null unless the last frame was counted.
    const PassGrouping* passes() const { return passes_.get(); }
    void forget() { passes_.reset(); }

private:
    std::unique_ptr<PassGrouping> passes_;
    std::uint64_t generation_ = 0; // of the database
    std::uint32_t lights_ = 0;
    bool extras_ = false;
    std::map<std::uint32_t, PassLights> seen_;
};

} // namespace sunfleck::gi
