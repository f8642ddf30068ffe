// Things by numbers that rise from 0 and are never given twice. What is removed takes no memory.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

namespace sunfleck {

template <typename T>
class Numbered {
public:
    // 2^32 - 1 of them in all: more are an exception.
    std::uint32_t add(T thing) {
        if (next_ == std::numeric_limits<std::uint32_t>::max())
            throw std::length_error("all 2^32 - 1 numbers are used up; clear() starts from 0 again");
        things_.emplace_hint(things_.end(), next_, std::move(thing));
        return next_++;
    }
    // Of a number that somebody else gives: greater than all before.
    void add_as(std::uint32_t number, T thing) { things_.emplace_hint(things_.end(), number, std::move(thing)); }
    // Null if there is none of that number.
    T* find(std::uint32_t number) {
        const auto found = things_.find(number);
        return found == things_.end() ? nullptr : &found->second;
    }
    const T* find(std::uint32_t number) const { return const_cast<Numbered&>(*this).find(number); }
    // `number` must be there.
    T& operator[](std::uint32_t number) { return things_.find(number)->second; }
    const T& operator[](std::uint32_t number) const { return things_.find(number)->second; }
    void remove(std::uint32_t number) { things_.erase(number); }
    bool empty() const { return things_.empty(); }
    // Pairs of number and thing, by rising numbers.
    auto begin() { return things_.begin(); }
    auto end() { return things_.end(); }
    auto begin() const { return things_.begin(); }
    auto end() const { return things_.end(); }

private:
    std::map<std::uint32_t, T> things_;
    std::uint32_t next_ = 0;
};

} // namespace sunfleck
