// A grouping of render passes that also draws objects with lights that they do not need, where that is harmless.
//
// The thesis merges pairs of elements, so its passes end up with fewer lights than they have room for. Here the needed
// pairs of object and light are covered by full passes, greedily: a pass starts with the object that has most lights
// left and repeatedly adds the object that adds most pairs, while its lights, as many as there is room for, are chosen
// again each time from those that all of its objects tolerate. An object that adds fewer pairs than `min_gain` is left
// to another pass: a larger value costs passes, a smaller one fill rate.
#pragma once

#include "gi_module/many_light/pass_grouping.h"

#include <optional>

namespace sunfleck::gi {

class PassCover final : public PassGrouping {
public:
    explicit PassCover(std::uint32_t lights_per_pass = 7, std::uint32_t min_gain = 2)
        : PassGrouping(lights_per_pass), min_gain_(min_gain) {}

    void rebuild() override;

private:
    struct Open { // an object with lights that are not drawn yet
        std::uint32_t object = 0;
        LightSet left;      // not yet drawn
        LightSet tolerated; // may be drawn now: those left, and those that it never needed but that are harmless
    };
    // A pass under construction.
    struct Draft {
        std::vector<std::size_t> members;  // of the open objects
        LightSet allowed;                  // lights that all members tolerate
        LightSet needed;                   // by any member
        std::vector<std::uint32_t> counts; // members that need it, by light
        std::uint32_t covered = 0;         // pairs, with the best lights
    };
    struct Candidate {
        std::size_t member = 0;
        std::uint32_t bound = 0; // of the pairs that it can add
    };
    void regroup(const std::map<std::uint32_t, PassLights>& changed) override;
    std::uint32_t room() const { return 2 * lights_per_pass_; }
    Open open(std::uint32_t object) const;
    static void draw(Open& object, const LightSet& lights);
    void join_elements(Open& object);
    void cover(std::vector<Open>& open_objects);
    std::uint32_t covered_with(const Draft& draft, const Open& object) const;
    std::optional<std::size_t> best_addition(const Draft& draft, const std::vector<Open>& open_objects,
                                             const std::vector<char>& is_member);
    void add(Draft& draft, const std::vector<Open>& open_objects, std::size_t member) const;
    LightSet best_lights(const Draft& draft) const;

    std::uint32_t min_gain_;
    double ratio_when_rebuilt_ = 1.0; // of passes to unoptimised passes
    mutable std::vector<std::uint32_t> histogram_;
    std::vector<Candidate> candidates_;
};

} // namespace sunfleck::gi
