// Everything about the lighting that a user can set. Each room of the module and each technique describes its own
// struct; this is all of them together, for the command line's --set, scene files, host.h and editors. Names are
// distinct over all structs (a test).
#pragma once

#include "engine/core/description.h"
#include "gi_module/light_sampling/sampling_settings.h"
#include "gi_module/low_resolution/low_resolution_settings.h"
#include "gi_module/shadows/shadow_settings.h"
#include "gi_module/transport/light_plan.h"
#include "gi_module/visibility/visibility_settings.h"

#include <cstddef>
#include <map>
#include <type_traits>

namespace sunfleck::gi {

// Who lights what, by name: the choices are the names of techniques, and "none".
struct TermSettings {
    std::uint32_t punctual = 0; // the first choice is punctual_automatic
    std::uint32_t direct = 0;
    std::uint32_t indirect = 0;
    std::uint32_t specular = 0;
    std::uint32_t movers = 0; // the first two choices are movers_per_pixel and movers_static
    std::string plan;         // TermOwners::exceptions

    static const TypeDescription& description();
};
// Whoever lights nothing else, if there is such a technique and direct light is lit at all; else as `direct`.
inline constexpr std::uint32_t punctual_automatic = 0;
inline constexpr std::uint32_t movers_per_pixel = 0, movers_static = 1;

// The settings struct of a technique, without its type.
struct TechniqueSettings {
    const TypeDescription& (*description)() = nullptr; // null: it has none
    std::vector<std::byte> (*defaults)() = nullptr;
};
template <typename T>
constexpr TechniqueSettings settings_of() {
    static_assert(std::is_trivially_copyable_v<T> && Described<T>);
    return {T::description, [] {
                const T value{};
                const auto* bytes = reinterpret_cast<const std::byte*>(&value);
                return std::vector<std::byte>(bytes, bytes + sizeof value);
            }};
}

struct Settings : TermSettings,
                  SamplingSettings,
                  LightSettings,
                  ShadowSettings,
                  VisibilitySettings,
                  LowResolutionSettings {
    Settings();

    // A technique's own struct.
    template <typename T>
    T& of() {
        return *reinterpret_cast<T*>(own(T::description()).data());
    }
    template <typename T>
    const T& of() const {
        return *reinterpret_cast<const T*>(const_cast<Settings*>(this)->own(T::description()).data());
    }

    // One of the structs: its description and values.
    struct Part {
        const TypeDescription* type;
        void* values;
    };
    struct ConstPart {
        const TypeDescription* type;
        const void* values;
    };
    std::vector<Part> parts();
    std::vector<ConstPart> parts() const;

    // The one description of a setting; null if there is none of that name.
    static const Field* find(std::string_view name);
    // Every setting's name, in the order of the parts.
    static std::vector<std::string_view> names();
    // Rejects unknown names and values outside of what the field allows, with one message; nothing changes then.
    Status set(std::string_view name, std::string_view value);
    // As text, as set reads it. The name must be known.
    std::string get(std::string_view name) const;
    // For values known to be right: asserts.
    Settings& with(std::string_view name, std::string_view value);
    // Gives all diffuse light to one technique.
    Settings& all_light_by(std::string_view technique) {
        return with("punctual", technique).with("direct", technique).with("indirect", technique);
    }

    // Every setting has the same value.
    bool operator==(const Settings& other) const;

    // Checks every value, and that every part of the light has one owner that can light it.
    Status validate() const;
    Result<LightPlan> light_plan() const;
    // What is sampled for that plan.
    SampleRequest sample_request(const LightPlan& plan) const;

private:
    std::vector<std::byte>& own(const TypeDescription& type);

    std::map<const TypeDescription*, std::vector<std::byte>> techniques_;
};

} // namespace sunfleck::gi
