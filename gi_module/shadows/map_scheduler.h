// Which shadow maps are redrawn in a frame. Thesis sec. 4.5.3.
//
// A map is stale from the moment that something in it moves until it is redrawn. Of the stale maps, as many as the
// budget allows are chosen by priority. No priority can starve a map: one that has waited 4 * ceil(stale / budget)
// frames is overdue and goes first, so with a constant budget every map is redrawn within twice that time. Where the
// time is known, maps that show are not stale for longer than `longest_lag`, or two frames, whatever the budget.
#pragma once

#include "gi_module/shadows/shadow_settings.h"
#include "gi_module/transport/light_sample.h"

#include <optional>
#include <span>
#include <vector>

namespace sunfleck::gi {

class MapScheduler {
public:
    // All maps of `count` samples are stale, including their static parts, and hold something else or nothing at all.
    void reset(std::size_t count);
    // Something in the sample's map moved by `distance`, m.
    void mark(std::uint32_t sample, float distance = 0.0f) {
        if (age_[sample] == 0)
            stale_since_[sample] = now_.value_or(0.0);
        age_[sample] = age_[sample] > 0 ? age_[sample] : 1;
        lags_[sample] += distance;
    }
    // The static part is stale, too.
    void mark_static(std::uint32_t sample) {
        mark(sample);
        static_stale_[sample] = 1;
    }
    // And the map holds something else or nothing at all.
    void mark_undefined(std::uint32_t sample) {
        mark_static(sample);
        undefined_[sample] = 1;
    }
    // A pinned map goes before all others while it is stale. Until reset().
    void pin(std::uint32_t sample, bool on) { pinned_[sample] = on ? 1 : 0; }
    bool is_pinned(std::uint32_t sample) const { return pinned_[sample] != 0; }
    // Nobody reads the map: it is not drawn, whatever it holds, until it is marked again.
    void set_aside(std::uint32_t sample) {
        age_[sample] = 0;
        static_stale_[sample] = undefined_[sample] = 0;
        lags_[sample] = 0.0f;
    }
    // Stale maps age by a frame. Once a frame, before marking. `milliseconds`: the time of this frame, if it is known.
    void advance(std::optional<double> milliseconds = {});
    static constexpr double longest_lag = 100.0; // ms

    // Samples whose maps are to be redrawn, in ascending order, up to the budget: those whose static part is stale
    // first. `contributions`: by sample, for MapPriority::contribution (map_contributions.h).
    std::vector<std::uint32_t> choose(std::span<const LightSample> samples, MapPriority priority, std::uint32_t budget,
                                      std::span<const float> contributions = {}) const;
    // By sample: what decides among maps that are stale, and neither pinned, unusable nor overdue; 0 for fresh ones.
    std::vector<float> priorities(std::span<const LightSample> samples, MapPriority priority,
                                  std::span<const float> contributions) const;
    // Of those, and beyond the budget, the maps that show and would otherwise be stale for too long; ascending. They
    // show if they decide more than a thousandth of what all stale maps together do.
    std::vector<std::uint32_t> with_late_ones(std::vector<std::uint32_t> chosen,
                                              std::span<const float> contributions) const;
    // The maps were redrawn and are up to date.
    void done(std::span<const std::uint32_t> samples);
    // Maps that hold something else or nothing at all, and are not among `drawn`: to be cleared. Ascending, as `drawn`.
    std::vector<std::uint32_t> to_clear(std::span<const std::uint32_t> drawn) const;
    // The maps hold nothing that would let light through.
    void cleared(std::span<const std::uint32_t> samples);
    // Starts a frame. `previous_lost`: nothing that was done since the last call reached the GPU, and those maps are as
    // stale as before.
    void begin_frame(bool previous_lost);

    bool is_static_stale(std::uint32_t sample) const { return static_stale_[sample] != 0; }
    // 0: fresh.
    std::uint32_t frames_out_of_date(std::uint32_t sample) const { return age_[sample]; }
    std::span<const std::uint32_t> ages() const { return age_; }
    // Upper bound of how far objects have moved since the map was drawn, m.
    float lag(std::uint32_t sample) const { return lags_[sample]; }
    std::size_t stale() const;
    // Maps whose static part is stale: nothing in them can be relied on.
    std::size_t unusable() const;
    std::size_t size() const { return age_.size(); }

private:
    struct Rank;
    std::vector<Rank> ranks_of(std::span<const std::uint32_t> stale, std::uint32_t budget,
                               const std::vector<float>& weights) const;

    std::vector<std::uint32_t> age_;
    std::vector<double> stale_since_; // ms, of stale maps
    std::optional<double> now_;
    std::vector<std::uint8_t> static_stale_;
    std::vector<std::uint8_t> undefined_; // 1: the map's content is of another sample, or was never written
    std::vector<std::uint8_t> pinned_;
    std::vector<float> lags_;
    struct Done {
        std::uint32_t sample, age;
        std::uint8_t static_stale, undefined;
        float lag;
    };
    std::vector<Done> done_; // in this frame, with the state before
};

} // namespace sunfleck::gi
