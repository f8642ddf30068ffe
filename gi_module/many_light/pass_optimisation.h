// Render passes as the thesis's renderer needs them: an object with L lights that need their shadow maps is drawn
// ceil(L / lights per pass) times, made even because sums go from one buffer to the other and back, and all of it
// twice, for the low-resolution picture and for its edges (sec. 4.3.4). Drawing objects together where they share
// lights saves passes. Thesis sec. 4.3.5, fig. 4-10.
//
// The thesis shares only lights that both objects need. Here, an object may also be drawn with lights that it does not
// need: where the light is unblocked or faces away, subtracting its blocked part subtracts nothing. That costs fill
// rate and saves passes; `harmless` says with which lights an object may be drawn.
//
// This renderer lights tiles by lists in one dispatch and needs no such passes; the optimisation serves hosts that draw
// geometry once for each few lights, and comparison with the thesis. Beyond the thesis, the result is maintained:
// objects whose lights changed are taken out and merged again, while the rest stays as it is.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace sunfleck::gi {

using LightSet = std::vector<std::uint64_t>; // a bit for each light

struct PassLights {
    LightSet needed;
    LightSet harmless; // contains the needed ones
    bool operator==(const PassLights&) const = default;
};

// Objects that are drawn together for these lights.
struct PassElement {
    std::vector<std::uint32_t> objects; // sorted
    LightSet lights;
    LightSet harmless; // to all objects
};

class PassOptimiser {
public:
    explicit PassOptimiser(std::uint32_t lights_per_pass = 7) : lights_per_pass_(lights_per_pass) {}

    // Sets the lights of objects, replacing what was known of them; objects with an empty set are gone. All sets have
    // one size. Elements with other objects are kept; what changed is merged by passes saved, greedily.
    void update(const std::map<std::uint32_t, PassLights>& changed);
    // Forgets the elements and merges all objects from the start.
    void rebuild();

    const std::vector<PassElement>& elements() const { return elements_; }
    // Passes with every object drawn for itself, and with the elements.
    std::uint64_t passes_unoptimised() const;
    std::uint64_t passes() const;
    // Pairs of object and light that are drawn, over those that are needed: 1 without harmless extras.
    double fill() const;

private:
    struct Best {
        std::int64_t saved = 0;
        std::size_t partner = 0;
    };
    std::int64_t passes_for(std::uint32_t lights) const;
    std::int64_t passes_of(const LightSet& lights) const;
    std::int64_t passes_saved(const PassElement& a, const PassElement& b) const;
    void add_element(std::uint32_t object, const PassLights& lights);
    void find_best(std::size_t element);
    void consider(std::size_t a, std::size_t b);
    void merge(std::size_t a, std::size_t b);
    void merge_all();
    void remove_empty();

    std::uint32_t lights_per_pass_;
    std::map<std::uint32_t, PassLights> objects_;
    std::vector<PassElement> elements_;
    std::vector<Best> best_; // of each element: the partner (with any number) that saves most
};

} // namespace sunfleck::gi
