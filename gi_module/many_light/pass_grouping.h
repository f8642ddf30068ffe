// Render passes as the thesis's renderer needs them: an object with L lights that need their shadow maps is drawn
// ceil(L / lights per pass) times, made even because sums go from one buffer to the other and back, and all of it
// twice, for the low-resolution picture and for its edges (sec. 4.3.4). Drawing objects together where they share
// lights saves passes. Thesis sec. 4.3.5.
//
// This renderer lights tiles by lists in one dispatch and needs no such passes; grouping them serves hosts that draw
// geometry once for each few lights, and comparison with the thesis. Beyond the thesis, groups are maintained: objects
// whose lights changed are taken out and placed again, while the rest stays as it is.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace sunfleck::gi {

using LightSet = std::vector<std::uint64_t>; // a bit for each light

std::uint32_t light_count(const LightSet& set);

struct PassLights {
    LightSet needed;
    // With which an object may be drawn besides, as often as one likes: where a light is unblocked or faces away,
    // subtracting its blocked part subtracts nothing. Contains the needed ones, which are drawn exactly once.
    LightSet harmless;
    bool operator==(const PassLights&) const = default;
};

// Objects that are drawn together for these lights.
struct PassElement {
    std::vector<std::uint32_t> objects; // sorted
    LightSet lights;
};

// Not thread-safe.
class PassGrouping {
public:
    virtual ~PassGrouping() = default;

    // Sets the lights of objects, replacing what was known of them; objects that need no light are gone. All sets have
    // one size. What did not change is kept.
    void update(const std::map<std::uint32_t, PassLights>& changed);
    // Forgets the elements and groups all objects from the start.
    virtual void rebuild() = 0;

    const std::vector<PassElement>& elements() const { return elements_; }
    // Passes with every object drawn for itself, and with the elements.
    std::uint64_t passes_unoptimised() const;
    std::uint64_t passes() const;
    // Pairs of object and light that are drawn, over those that are needed: 1 without harmless extras.
    double fill() const;

protected:
    explicit PassGrouping(std::uint32_t lights_per_pass) : lights_per_pass_(lights_per_pass) {}

    // Both passes of the picture, for an element with so many lights.
    std::int64_t passes_for(std::uint32_t lights) const;
    // Groups objects_ again of which `changed` were set or taken away.
    virtual void regroup(const std::map<std::uint32_t, PassLights>& changed) = 0;

    std::uint32_t lights_per_pass_;
    std::map<std::uint32_t, PassLights> objects_;
    std::vector<PassElement> elements_;
};

} // namespace sunfleck::gi
