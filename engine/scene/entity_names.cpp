#include "engine/scene/entity_names.h"

#include "engine/scene/simulation_components.h"

#include <algorithm>

namespace sunfleck::scene {
namespace {

constexpr std::string_view blanks = " \t\r\n";

std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(blanks);
    return begin == std::string_view::npos ? std::string_view()
                                           : text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

// Where the quoted name ends that begins at `begin`, behind its quotation mark; npos: it is none, or never ends.
std::size_t end_of_quoted(std::string_view list, std::size_t begin) {
    if (begin >= list.size() || list[begin] != '"')
        return std::string_view::npos;
    for (std::size_t at = begin + 1; at < list.size(); ++at) {
        if (list[at] != '"')
            continue;
        if (at + 1 >= list.size() || list[at + 1] != '"')
            return at + 1;
        ++at; // a doubled one is part of the name
    }
    return std::string_view::npos;
}

// body(part of the list between commas)
template <typename Body>
void each_part(std::string_view list, Body&& body) {
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t quoted = end_of_quoted(list, list.find_first_not_of(blanks, begin));
        const std::size_t from = quoted == std::string_view::npos ? begin : quoted;
        const std::size_t end = std::min(list.find(',', from), list.size());
        body(list.substr(begin, end - begin));
        begin = end + 1;
    }
}

// The name that a part of a list stands for, which has no blanks around it.
std::string name_of(std::string_view part) {
    if (part.empty() || end_of_quoted(part, 0) != part.size())
        return std::string(part);
    std::string name;
    for (std::size_t at = 1; at + 1 < part.size(); ++at) {
        name += part[at];
        at += part[at] == '"' ? 1 : 0;
    }
    return name;
}

// What an entity lacks that is named there; empty: nothing.
std::string_view lack(const ecs::Registry& registry, ecs::Entity entity, std::string_view type) {
    if (type == LightSensor::description().name) {
        const auto* mover = registry.try_get<Mover>(entity);
        return mover == nullptr || mover->activation != MoverActivation::sensor
                   ? "is no mover with the activation 'sensor'"
                   : "";
    }
    if (type == LightSwitch::description().name) {
        const auto* material = registry.try_get<Material>(entity);
        const bool lights = registry.has<AreaLight>(entity) || registry.has<PointLight>(entity) ||
                            registry.has<SpotLight>(entity) ||
                            (material != nullptr && material->emission != vec3(0.0f));
        return lights ? "" : "is no lamp";
    }
    return "";
}

std::string subject(const ecs::Registry& registry, ecs::Entity entity) {
    const auto* name = registry.try_get<Name>(entity);
    return name != nullptr ? "'" + name->name + "'" : std::string("an entity");
}

} // namespace

std::vector<std::string> split_names(const std::string& list) {
    std::vector<std::string> names;
    each_part(list, [&](std::string_view part) {
        if (const std::string_view name = trimmed(part); !name.empty())
            names.push_back(name_of(name));
    });
    return names;
}

std::string as_part(std::string_view name) {
    if (name.find(',') == std::string_view::npos && !name.starts_with('"') && trimmed(name) == name)
        return std::string(name);
    std::string quoted = "\"";
    for (const char letter : name)
        quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
    return quoted + '"';
}

std::string with_other_name(const std::string& list, std::string_view before, std::string_view after) {
    std::string result;
    each_part(list, [&](std::string_view part) {
        const std::string_view name = trimmed(part);
        if (part.data() != list.data())
            result += ',';
        if (name.empty() || name_of(name) != before) {
            result += part;
            return;
        }
        const std::size_t begin = std::size_t(name.data() - part.data());
        result += part.substr(0, begin);
        result += as_part(after);
        result += part.substr(begin + name.size());
    });
    return result;
}

std::vector<std::string> wrong_names(ecs::Registry& registry) {
    std::vector<std::string> lines;
    for (const ecs::PoolBase* pool : registry.described_pools())
        for (const Field& field : pool->description()->fields) {
            if (field.kind != FieldKind::text || (field.flags & names_entities) == 0)
                continue;
            std::vector<ecs::Entity> entities = pool->entities();
            std::sort(entities.begin(), entities.end());
            for (const ecs::Entity entity : entities) {
                const auto* object = static_cast<const char*>(pool->address(pool->position_of(entity.index)));
                for (const std::string& name :
                     split_names(*reinterpret_cast<const std::string*>(object + field.offset))) {
                    const ecs::Entity named = find_by_name(registry, name);
                    const std::string_view wrong =
                        named.is_null() ? "does not exist" : lack(registry, named, pool->description()->name);
                    if (!wrong.empty())
                        lines.push_back("'" + name + "', which " + subject(registry, entity) + " names (" +
                                        std::string(field.name) + "), " + std::string(wrong));
                }
            }
        }
    return lines;
}

} // namespace sunfleck::scene
