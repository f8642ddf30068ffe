#include "gi_module/settings.h"

#include "gi_module/technique.h"

#include <cassert>

namespace sunfleck::gi {
namespace {

CellSet cells_of_term(bool (*holds)(PathPart)) {
    return cells_where([&](LightCell cell) { return !cell.specular && !cell.on_mover && holds(cell.path); });
}
bool is_punctual(PathPart path) {
    return path == PathPart::punctual;
}
bool is_direct(PathPart path) {
    return path == PathPart::direct;
}
CellSet specular_cells() {
    return ~all_diffuse_cells();
}

bool lights_movers_only(const TechniqueEntry& technique) {
    return technique.can_light.any() &&
           (technique.can_light & ~cells_where([](LightCell cell) { return cell.on_mover; })).none();
}

bool lights_punctual_only(const TechniqueEntry& technique) {
    return technique.can_light.any() &&
           (technique.can_light & ~cells_where([](LightCell cell) { return is_punctual(cell.path); })).none();
}

// Appends the techniques that can light all of `cells`.
void add_choices(Field& field, CellSet cells) {
    for (const TechniqueEntry& technique : techniques())
        if ((cells & ~technique.can_light).none())
            field.choices.push_back(technique.name);
}

std::vector<Field> term_fields() {
    Field punctual =
        SUNFLECK_CHOICE(TermSettings, punctual,
                        "Technique for light straight from suns, point lights and spots (punctual_lights of them): "
                        "by sharp shadows of its own, or as light samples by whoever lights direct light",
                        "automatic");
    add_choices(punctual, cells_of_term(is_punctual));
    punctual.choices.push_back("none");
    Field direct = SUNFLECK_CHOICE(TermSettings, direct, "Technique for light straight from emitters");
    add_choices(direct, cells_of_term(is_direct));
    direct.choices.push_back("none");
    Field indirect = SUNFLECK_CHOICE(TermSettings, indirect, "Technique for light that was reflected");
    add_choices(indirect, cells_of_term(is_reflected));
    indirect.choices.push_back("none");
    Field specular = SUNFLECK_CHOICE(TermSettings, specular, "Technique for mirror-like and glossy reflection", "none");
    add_choices(specular, specular_cells());
    Field movers = SUNFLECK_CHOICE(TermSettings, movers,
                                   "Movers are lit like all else; or also reflect light like static geometry; or, "
                                   "those that it supports, are lit by a technique of their own",
                                   "per_pixel", "static");
    for (const TechniqueEntry& technique : techniques())
        if (lights_movers_only(technique))
            movers.choices.push_back(technique.name);
    return {punctual.flagged(needs_new_samples),
            direct.flagged(needs_new_samples),
            indirect.flagged(needs_new_samples),
            specular,
            movers.flagged(needs_new_samples),
            SUNFLECK_FIELD(TermSettings, plan, "", 0, 0,
                           "Exceptions for parts of the light, such as first_bounce.dynamic=none; see the "
                           "documentation of the light plan")
                .flagged(needs_new_samples)};
}

// Index of the technique that a choice names; nobody for any other word.
std::int32_t technique_of(std::string_view field, std::uint32_t choice) {
    const std::string_view name = TermSettings::description().find(field)->choices[choice];
    for (std::size_t i = 0; i < techniques().size(); ++i)
        if (techniques()[i].name == name)
            return std::int32_t(i);
    return nobody;
}

// Of punctual light, where the settings leave it open.
std::int32_t automatic_owner(std::int32_t direct_owner) {
    for (std::size_t i = 0; direct_owner != nobody && i < techniques().size(); ++i)
        if (lights_punctual_only(techniques()[i]))
            return std::int32_t(i);
    return direct_owner;
}

std::vector<const TypeDescription*> all_types() {
    std::vector<const TypeDescription*> types = {
        &TermSettings::description(),   &SamplingSettings::description(),   &LightSettings::description(),
        &ShadowSettings::description(), &VisibilitySettings::description(), &LowResolutionSettings::description()};
    for (const TechniqueEntry& technique : techniques())
        if (technique.settings.description != nullptr)
            types.push_back(&technique.settings.description());
    return types;
}

// One shadow map must fit into what all may have.
Status check_memory_of_maps(const ShadowSettings& shadows) {
    const std::uint64_t side = shadows.shadow_map_resolution, bytes = side * side * shadows.shadow_map_bits / 8;
    if (double(bytes) <= double(shadows.shadow_memory) * 1048576.0)
        return {};
    return Error{"a shadow map of shadow_map_resolution " + std::to_string(side) + " takes " +
                     std::to_string(bytes >> 20) + " MiB, more than shadow_memory lets all of them take: lower " +
                     "shadow_map_resolution, or raise shadow_memory",
                 ErrorCode::argument};
}

} // namespace

const TypeDescription& TermSettings::description() {
    static const TypeDescription type{"TermSettings", 1, "Which technique lights what.", term_fields()};
    return type;
}

Settings::Settings() {
    // "none", where the list of techniques is empty, is the only choice and the first.
    for (const TechniqueEntry& technique : techniques())
        if (technique.settings.description != nullptr)
            techniques_[&technique.settings.description()] = technique.settings.defaults();
}

std::vector<std::byte>& Settings::own(const TypeDescription& type) {
    const auto found = techniques_.find(&type);
    assert(found != techniques_.end() && "no technique of the list has these settings");
    return found->second;
}

std::vector<Settings::Part> Settings::parts() {
    std::vector<Part> parts = {
        {&TermSettings::description(), static_cast<TermSettings*>(this)},
        {&SamplingSettings::description(), static_cast<SamplingSettings*>(this)},
        {&LightSettings::description(), static_cast<LightSettings*>(this)},
        {&ShadowSettings::description(), static_cast<ShadowSettings*>(this)},
        {&VisibilitySettings::description(), static_cast<VisibilitySettings*>(this)},
        {&LowResolutionSettings::description(), static_cast<LowResolutionSettings*>(this)},
    };
    for (const TechniqueEntry& technique : techniques())
        if (technique.settings.description != nullptr)
            parts.push_back({&technique.settings.description(), own(technique.settings.description()).data()});
    return parts;
}

std::vector<Settings::ConstPart> Settings::parts() const {
    std::vector<ConstPart> result;
    for (const Part& part : const_cast<Settings*>(this)->parts())
        result.push_back({part.type, part.values});
    return result;
}

const Field* Settings::find(std::string_view name) {
    for (const TypeDescription* type : all_types())
        if (const Field* field = type->find(name))
            return field;
    return nullptr;
}

std::vector<std::string_view> Settings::names() {
    std::vector<std::string_view> names;
    for (const TypeDescription* type : all_types())
        for (const Field& field : type->fields)
            names.push_back(field.name);
    return names;
}

Status Settings::set(std::string_view name, std::string_view value) {
    for (const Part& part : parts())
        if (const Field* field = part.type->find(name))
            return field_from_text(*field, part.values, value);
    std::string known;
    for (const std::string_view other : names())
        known += (known.empty() ? "" : ", ") + std::string(other);
    return Error{"no setting is called '" + std::string(name) + "' (there are: " + known + ")"};
}

std::string Settings::get(std::string_view name) const {
    for (const ConstPart& part : parts())
        if (const Field* field = part.type->find(name))
            return field_to_text(*field, part.values);
    assert(false && "no setting of this name");
    return {};
}

Settings& Settings::with(std::string_view name, std::string_view value) {
    [[maybe_unused]] const Status status = set(name, value);
    assert(status && "not a setting, or not a value of it");
    return *this;
}

Result<LightPlan> Settings::light_plan() const {
    std::vector<PlannedTechnique> known;
    std::vector<TakenCells> taken;
    for (const TechniqueEntry& technique : techniques()) {
        if (technique.takes != nullptr)
            taken.push_back({std::int32_t(known.size()), technique.takes(*this)});
        known.push_back({technique.name, technique.can_light, technique.supports != nullptr});
    }
    TermOwners owners;
    owners.taken = taken;
    owners.direct = technique_of("direct", direct);
    owners.punctual =
        punctual == punctual_automatic ? automatic_owner(owners.direct) : technique_of("punctual", punctual);
    owners.indirect = technique_of("indirect", indirect);
    owners.specular = technique_of("specular", specular);
    owners.movers = technique_of("movers", movers);
    owners.exceptions = plan;
    return LightPlan::make(owners, known);
}

SampleRequest Settings::sample_request(const LightPlan& light_plan) const {
    SampleRequest request(*this);
    const CellSet direct_cells = cells_where([](LightCell cell) { return !is_reflected(cell.path); });
    const bool all = sampled_light == SampledLight::all;
    request.direct = all || light_plan.lights_any(direct_cells);
    request.indirect = all || light_plan.lights_any(~direct_cells);
    request.movers_are_static = movers == movers_static;
    return request;
}

bool Settings::operator==(const Settings& other) const {
    const std::vector<std::string_view> all = names();
    return std::all_of(all.begin(), all.end(), [&](std::string_view name) { return get(name) == other.get(name); });
}

Status Settings::validate() const {
    for (const ConstPart& part : parts())
        SUNFLECK_TRY(sunfleck::validate(*part.type, part.values));
    SUNFLECK_ASSIGN([[maybe_unused]] const LightPlan checked, light_plan());
    return check_memory_of_maps(*this);
}

} // namespace sunfleck::gi
