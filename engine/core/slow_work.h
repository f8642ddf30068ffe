// Only in builds with SUNFLECK_SLOW_WORK (CMake), which the frame-time gate tests itself with: what is to be made
// slower.
#pragma once

#include <cstdlib>
#include <string>
#include <string_view>

namespace sunfleck {

// The amount of work to be added to a pass or stage, from the environment: SUNFLECK_SLOW is NAME=AMOUNT, several of
// them separated by semicolons. 0 where it is not named. Read at each call: such builds need not be fast.
inline int slow_work_amount(std::string_view name) {
    const char* text = std::getenv("SUNFLECK_SLOW");
    const std::string list = ";" + std::string(text != nullptr ? text : ""), wanted = ";" + std::string(name) + "=";
    const std::size_t place = list.find(wanted);
    return place == std::string::npos ? 0 : std::atoi(list.c_str() + place + wanted.size());
}

} // namespace sunfleck
