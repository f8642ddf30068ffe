// The thesis's grouping of render passes: elements that share lights are merged, the pair that saves most passes first.
// Thesis sec. 4.3.5, fig. 4-10. Elements only share lights that all of their objects need.
#pragma once

#include "gi_module/many_light/pass_grouping.h"

namespace sunfleck::gi {

class PassOptimiser final : public PassGrouping {
public:
    explicit PassOptimiser(std::uint32_t lights_per_pass = 7) : PassGrouping(lights_per_pass) {}

    void rebuild() override;

private:
    struct Best {
        std::int64_t saved = 0;
        std::size_t partner = 0;
    };
    void regroup(const std::map<std::uint32_t, PassLights>& changed) override;
    std::int64_t passes_saved(const PassElement& a, const PassElement& b) const;
    void find_best(std::size_t element);
    void consider(std::size_t a, std::size_t b);
    void merge(std::size_t a, std::size_t b);
    void merge_all();
    void remove_empty();

    std::vector<Best> best_; // by element: the partner that saves most passes, at a higher or lower index
};

} // namespace sunfleck::gi
