// Render passes as the thesis's renderer needs them: an object with L lights that need their shadow maps is drawn
// ceil(L / lights per pass) times, rounded up to an even number because sums ping-pong between two buffers, and all of
// it twice, for the low-resolution picture and for its edges (sec. 4.3.4). Drawing objects that share lights together
// saves passes. Thesis sec. 4.3.5.
//
// This renderer lights tiles by light lists in one dispatch and needs no such passes; the grouping is for hosts that
// draw geometry once per few lights, and for comparison with the thesis. Beyond the thesis, it is maintained: objects
// whose lights changed are taken out and placed again, while the rest stays as it is.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace sunfleck::gi {

using LightSet = std::vector<std::uint64_t>; // a bit per light

std::uint32_t light_count(const LightSet& set);

struct PassLights {
    LightSet needed;
    // Lights with which the object may be drawn in addition, any number of times: if a light is unblocked or faces
    // away, subtracting its blocked part subtracts nothing. Includes the needed lights, which are drawn exactly once.
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

    // Replaces the lights of objects; objects that need no light are removed. All sets have the same size. Groups are
    // kept where nothing changed.
    void update(const std::map<std::uint32_t, PassLights>& changed);
    // Groups all objects from scratch.
    virtual void rebuild() = 0;

    const std::vector<PassElement>& elements() const { return elements_; }
    // Number of passes if every object is drawn on its own, and with the elements.
    std::uint64_t passes_unoptimised() const;
    std::uint64_t passes() const;
    // Drawn pairs of object and light over needed ones: 1 without harmless extras.
    double fill() const;

protected:
    explicit PassGrouping(std::uint32_t lights_per_pass) : lights_per_pass_(lights_per_pass) {}

    // For an element with so many lights, low-resolution picture and edges together.
    std::int64_t passes_for(std::uint32_t lights) const;
    // Updates the elements after the `changed` objects were set or removed in objects_.
    virtual void regroup(const std::map<std::uint32_t, PassLights>& changed) = 0;

    std::uint32_t lights_per_pass_;
    std::map<std::uint32_t, PassLights> objects_;
    std::vector<PassElement> elements_;
};

} // namespace sunfleck::gi
