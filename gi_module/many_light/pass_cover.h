// A grouping of render passes that draws objects also for lights that they do not need, where that is harmless.
//
// The thesis merges pairs of elements, so its passes end up with fewer lights than they have room for. Here the pairs
// of object and light that are needed are covered by full passes: from the object with most lights left, a pass takes
// in the object that adds most pairs, again and again, while its lights, as many as there is room for, are chosen anew
// from those that none of its objects minds. An object that adds fewer pairs than `min_gain` waits for another pass:
// a larger one costs passes, a smaller one fill rate.
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
    struct Open { // an object that still needs lights
        std::uint32_t object = 0;
        LightSet left;      // not yet drawn
        LightSet tolerated; // may be drawn now: what is left, and what it never needed and does not mind
    };
    // A pass in the making.
    struct Draft {
        std::vector<std::size_t> members;  // of the open objects
        LightSet allowed;                  // lights that no member minds
        LightSet wanted;                   // by any member
        std::vector<std::uint32_t> counts; // members that want it, by light
        std::uint32_t covered = 0;         // pairs, with the best lights
    };
    struct Candidate {
        std::size_t member = 0;
        std::uint32_t most = 0; // pairs that it can add
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
    double share_when_rebuilt_ = 1.0; // of the passes that are left
    mutable std::vector<std::uint32_t> histogram_;
    std::vector<Candidate> candidates_;
};

} // namespace sunfleck::gi
