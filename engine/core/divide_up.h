// Division that rounds up: how many groups hold so many pixels, how many parts so many items.
#pragma once

#include <concepts>
#include <type_traits>

namespace sunfleck {

template <std::unsigned_integral T>
constexpr T divide_up(T value, std::type_identity_t<T> by) {
    return value / by + (value % by != 0 ? 1u : 0u);
}

} // namespace sunfleck
