// Measurements of a run of any length in memory of a fixed size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sunfleck::statistics {

// All values of a short series; of a longer one each second, fourth, eighth, ..., so that medians and percentiles stay
// those of the whole run.
template <typename Value>
class SampleSeries {
public:
    static constexpr std::size_t most = 4096;

    void add(const Value& value) {
        // All room at once: the series of what happens rarely would grow for hours.
        if (count_ == 0)
            values_.reserve(most);
        if (count_ % stride_ == 0 && values_.size() == most)
            thin_out();
        if (count_ % stride_ == 0)
            values_.push_back(value);
        ++count_;
    }
    const std::vector<Value>& values() const { return values_; }
    // Of all that were added.
    std::uint64_t count() const { return count_; }

private:
    void thin_out() {
        for (std::size_t i = 0; i < most / 2; ++i)
            values_[i] = values_[2 * i];
        values_.resize(most / 2);
        stride_ *= 2;
    }

    std::vector<Value> values_;
    std::uint64_t count_ = 0, stride_ = 1;
};

} // namespace sunfleck::statistics
