// Components whose texts name other entities: lists separated by commas, as in LightSensor::opens. A name that has a
// comma itself stands in quotation marks, and its own quotation marks are doubled: as in "hall, left", door.
#pragma once

#include "engine/ecs/registry.h"

#include <string>
#include <vector>

namespace sunfleck::scene {

// Of Field::flags: the text is such a list. Whoever renames or copies entities lets it follow.
inline constexpr std::uint32_t names_entities = 1u << 16;

// The names of a list, without the blanks around them.
std::vector<std::string> split_names(const std::string& list);
// As a list has it.
std::string as_part(std::string_view name);
// The list with another name in place of each that is exactly `before`.
std::string with_other_name(const std::string& list, std::string_view before, std::string_view after);

// One line for each name that means nothing: no entity has it, or the one that has it is not what is named.
std::vector<std::string> wrong_names(ecs::Registry& registry);

} // namespace sunfleck::scene
