// Lines in the scene that show what the lighting keeps there: each overlay is declared once, by its owner, with name,
// tooltip and legend; menus and documentation read these declarations. Techniques list theirs in their TechniqueEntry
// and draw them in Technique::draw_overlay; those of the rooms that techniques share are here.
#pragma once

#include "engine/core/maths.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace sunfleck::gi {

class SampleSet;
class VisibilityDatabase;

struct Overlay {
    std::string_view name;
    std::string_view tooltip;
    std::string_view legend; // what the colours mean
    std::string_view group;
    std::uint32_t code = 0; // for the owner's use
};

// Lines of one frame, in the space that is lit. Colours are display values, 0 to 1.
class OverlayLines {
public:
    // Index of the light sample that the user looks at; none: of none.
    std::optional<std::uint32_t> sample;

    struct Line {
        vec3 from, to, colour;
    };
    void line(vec3 from, vec3 to, vec3 colour) { lines_.push_back({from, to, colour}); }
    // Its edges.
    void box(const Bounds& bounds, vec3 colour);
    std::span<const Line> lines() const { return lines_; }

private:
    std::vector<Line> lines_;
};

// Of what techniques share.
std::span<const Overlay> shared_overlays();
// One of them, by its code. `visibility`: null if no technique in use wants it; then there are no patches.
void draw_shared_overlay(std::uint32_t code, const SampleSet& samples, const VisibilityDatabase* visibility,
                         OverlayLines& lines);

} // namespace sunfleck::gi
