// Which shadow maps are redrawn in a frame. Thesis sec. 4.5.3.
//
// A map is stale from the moment that something in it moved until it is redrawn. Of the stale ones, as many as the
// budget allows are chosen by priority. No priority can starve a map: one that has waited 4 * ceil(stale / budget)
// frames goes before all that have waited less, so that with an unchanging budget every map is redrawn within twice
// that.
#pragma once

#include "gi_module/shadows/shadow_settings.h"
#include "gi_module/transport/light_sample.h"

#include <span>
#include <vector>

namespace sunfleck::gi {

class MapScheduler {
public:
    // All maps of `count` samples are stale, static part and all.
    void reset(std::size_t count);
    // Something in the sample's map moved, so many metres.
    void mark(std::uint32_t sample, float distance = 0.0f) {
        age_[sample] = age_[sample] > 0 ? age_[sample] : 1;
        lags_[sample] += distance;
    }
    // The static part must be redrawn, too.
    void mark_static(std::uint32_t sample) {
        mark(sample);
        static_stale_[sample] = 1;
    }
    // Stale maps are a frame older. Once a frame, before marking.
    void advance();

    // Samples whose maps are to be redrawn, in rising order: all whose static part is stale, and others up to the
    // budget. `contributions`: by sample, for that priority (many_light/map_contributions.h).
    std::vector<std::uint32_t> choose(std::span<const LightSample> samples, MapPriority priority, std::uint32_t budget,
                                      std::span<const float> contributions = {}) const;
    // The maps show the present.
    void done(std::span<const std::uint32_t> samples);

    bool is_static_stale(std::uint32_t sample) const { return static_stale_[sample] != 0; }
    // 0: fresh.
    std::uint32_t frames_out_of_date(std::uint32_t sample) const { return age_[sample]; }
    std::span<const std::uint32_t> ages() const { return age_; }
    // How far things in the map have moved at most since it was drawn, m.
    float lag(std::uint32_t sample) const { return lags_[sample]; }
    std::size_t stale() const;
    // Maps whose static part is stale: they show nothing that is true.
    std::size_t unusable() const;
    std::size_t size() const { return age_.size(); }

private:
    std::vector<std::uint32_t> age_;
    std::vector<std::uint8_t> static_stale_;
    std::vector<float> lags_;
};

} // namespace sunfleck::gi
