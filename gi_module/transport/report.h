// What the module reports while it runs: counters, memory and debug views. Each is declared once, by its owner, with
// name, unit and tooltip; --stats, --view, overlays, host.h, documentation and tests read these declarations.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace sunfleck::gi {

// One number per frame. Objects are static and identified by name.
struct Counter {
    std::string_view name;    // key of --stats
    std::string_view unit;    // "samples", "W", "B"; "" for a pure number
    std::string_view group;   // heading in overlays; "memory" for sizes of what is kept from frame to frame
    std::string_view tooltip; // one sentence
    bool from_gpu = false;    // counted on the GPU: of the newest completed frame, not of the last one
};

inline constexpr std::string_view memory_group = "memory";

// False colours in place of the irradiance.
struct DebugView {
    std::string_view name; // --view NAME
    std::string_view tooltip;
    std::string_view legend; // what the colours mean
    std::string_view unit;   // of what is shown; "" if colours are categories
    std::string_view group;
    std::uint32_t code = 0;   // for the owner's use
    bool every_pixel = false; // shown at full resolution even if light is not
};

// The numbers of one frame. Counters that were not set read 0.
class Report {
public:
    void clear() { values_.clear(); }
    void set(const Counter& counter, double value) {
        for (Value& known : values_)
            if (known.counter->name == counter.name) {
                known.value = value;
                return;
            }
        values_.push_back({&counter, value});
    }
    // For what several owners count in one frame.
    void add(const Counter& counter, double value) { set(counter, (*this)[counter.name] + value); }
    double operator[](std::string_view name) const {
        for (const Value& value : values_)
            if (value.counter->name == name)
                return value.value;
        return 0.0;
    }

    struct Value {
        const Counter* counter;
        double value;
    };
    std::span<const Value> values() const { return values_; }

    // Takes the GPU's counts from the report of a later frame.
    void take_gpu_counts(const Report& later) {
        for (const Value& value : later.values_)
            if (value.counter->from_gpu)
                set(*value.counter, value.value);
    }

private:
    std::vector<Value> values_;
};

} // namespace sunfleck::gi
