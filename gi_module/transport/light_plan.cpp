#include "gi_module/transport/light_plan.h"

#include <vector>

namespace sunfleck::gi {
namespace {

constexpr std::array<std::string_view, path_part_count> path_names = {"punctual", "direct", "first_bounce",
                                                                      "later_bounces"};

struct Selector {
    std::string_view name;
    bool (*holds)(LightCell);
};
constexpr Selector selectors[] = {
    {"punctual", [](LightCell cell) { return cell.path == PathPart::punctual; }},
    {"direct", [](LightCell cell) { return cell.path == PathPart::direct; }},
    {"first_bounce", [](LightCell cell) { return cell.path == PathPart::first_bounce; }},
    {"later_bounces", [](LightCell cell) { return cell.path == PathPart::later_bounces; }},
    {"indirect", [](LightCell cell) { return is_reflected(cell.path); }},
    {"fixed", [](LightCell cell) { return !cell.dynamic; }},
    {"dynamic", [](LightCell cell) { return cell.dynamic; }},
    {"on_fixed", [](LightCell cell) { return !cell.on_mover; }},
    {"on_mover", [](LightCell cell) { return cell.on_mover; }},
    {"diffuse", [](LightCell cell) { return !cell.specular; }},
    {"specular", [](LightCell cell) { return cell.specular; }},
};

// Removes the text up to `separator` from the front of `text` and returns it.
std::string_view take_until(std::string_view& text, char separator) {
    const std::size_t end = std::min(text.find(separator), text.size());
    const std::string_view head = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return head;
}

Result<CellSet> selected_cells(std::string_view text) {
    const std::string whole(text);
    CellSet cells = all_diffuse_cells() | ~all_diffuse_cells();
    bool names_specular = false;
    while (!text.empty()) {
        const std::string_view word = take_until(text, '.');
        const Selector* found = nullptr;
        for (const Selector& selector : selectors)
            if (selector.name == word)
                found = &selector;
        if (found == nullptr)
            return Error{
                "light plan '" + whole + "': '" + std::string(word) +
                "' is not a part of the light (punctual, direct, first_bounce, later_bounces, indirect, fixed, "
                "dynamic, on_fixed, on_mover, diffuse, specular)"};
        names_specular = names_specular || word == "specular";
        cells &= cells_where(found->holds);
    }
    // Specular light is only meant if it is named: few techniques can compute it.
    return names_specular ? cells : cells & all_diffuse_cells();
}

std::string names_of(CellSet cells) {
    std::string text;
    for (std::size_t i = 0; i < light_cell_count; ++i)
        if (cells[i])
            text += (text.empty() ? "" : ", ") + LightCell::at(i).name();
    return text;
}

Result<std::int32_t> find_technique(std::string_view name, std::span<const PlannedTechnique> techniques) {
    std::string known = "none";
    for (std::size_t i = 0; i < techniques.size(); ++i) {
        if (techniques[i].name == name)
            return std::int32_t(i);
        known += ", " + std::string(techniques[i].name);
    }
    if (name == "none")
        return nobody;
    return Error{"light plan: no technique is called '" + std::string(name) + "' (there are: " + known + ")"};
}

std::int32_t owner_by_term(const TermOwners& terms, LightCell cell) {
    if (cell.specular)
        return terms.specular;
    if (cell.path == PathPart::punctual)
        return terms.punctual;
    return cell.path == PathPart::direct ? terms.direct : terms.indirect;
}

// By path and whether it is dynamic: the diffuse light of a technique on receivers of one kind.
std::bitset<2 * path_part_count> paths_on(CellSet cells, bool on_mover) {
    std::bitset<2 * path_part_count> paths;
    for (std::size_t i = 0; i < light_cell_count; ++i)
        if (const LightCell cell = LightCell::at(i); cells[i] && cell.on_mover == on_mover && !cell.specular)
            paths[i % paths.size()] = true;
    return paths;
}

} // namespace

std::string LightCell::name() const {
    return std::string(path_names[std::size_t(path)]) + (dynamic ? ".dynamic" : ".fixed") +
           (on_mover ? ".on_mover" : ".on_fixed") + (specular ? ".specular" : ".diffuse");
}

CellSet all_diffuse_cells() {
    return cells_where([](LightCell cell) { return !cell.specular; });
}

void LightPlan::give(std::size_t cell, std::int32_t technique, std::span<const PlannedTechnique> techniques) {
    const auto is_partial = [&](std::int32_t index) {
        return index != nobody && techniques[std::size_t(index)].some_receivers;
    };
    const std::int32_t before = is_partial(owner_[cell]) ? fallback_[cell] : owner_[cell];
    fallback_[cell] = is_partial(technique) ? before : nobody;
    owner_[cell] = technique;
}

Status LightPlan::apply_exceptions(std::string_view text, std::span<const PlannedTechnique> techniques) {
    CellSet named;
    while (!text.empty()) {
        std::string_view exception = take_until(text, ',');
        SUNFLECK_ASSIGN(const CellSet cells, selected_cells(take_until(exception, '=')));
        SUNFLECK_ASSIGN(const std::int32_t technique, find_technique(exception, techniques));
        if ((cells & named).any())
            return Error{"light plan: " + names_of(cells & named) + " has two owners; name each cell once"};
        named |= cells;
        for (std::size_t i = 0; i < light_cell_count; ++i)
            if (cells[i])
                give(i, technique, techniques);
    }
    return {};
}

Status LightPlan::check(std::int32_t index, const PlannedTechnique& technique) const {
    const CellSet lit = lit_by(index);
    const std::string name = "light plan: " + std::string(technique.name);
    if ((lit & ~technique.can_light).any())
        return Error{name + " cannot light " + names_of(lit & ~technique.can_light)};
    const auto fixed = paths_on(lit, false), movers = paths_on(lit, true);
    if (fixed.any() && movers.any() && fixed != movers)
        return Error{name + " must light the same paths on movers as on fixed surfaces, or only one of the two"};
    if (technique.some_receivers && movers.any() && shares_movers(index))
        return Error{name +
                     " must own all light on movers that anybody lights, since a receiver that it supports is lit "
                     "by it alone"};
    return {};
}

void LightPlan::give_terms(const TermOwners& terms, std::span<const PlannedTechnique> techniques) {
    for (std::size_t i = 0; i < light_cell_count; ++i) {
        const LightCell cell = LightCell::at(i);
        give(i, owner_by_term(terms, cell), techniques);
        for (const TakenCells& taken : terms.taken)
            if (taken.cells[i] && owner_[i] != nobody)
                give(i, taken.technique, techniques);
        // The movers' own technique replaces other owners; cells without one stay unlit.
        if (terms.movers != nobody && cell.on_mover && !cell.specular && owner_[i] != nobody)
            give(i, terms.movers, techniques);
    }
}

Result<LightPlan> LightPlan::make(const TermOwners& terms, std::span<const PlannedTechnique> techniques) {
    LightPlan plan;
    plan.give_terms(terms, techniques);
    SUNFLECK_TRY(plan.apply_exceptions(terms.exceptions, techniques));
    for (std::size_t t = 0; t < techniques.size(); ++t)
        SUNFLECK_TRY(plan.check(std::int32_t(t), techniques[t]));
    return plan;
}

CellSet LightPlan::lit_by(std::int32_t technique) const {
    CellSet cells;
    for (std::size_t i = 0; i < light_cell_count; ++i)
        cells[i] = owner_[i] == technique || (fallback_[i] != nobody && fallback_[i] == technique);
    return cells;
}

// Whether another technique owns diffuse light on movers.
bool LightPlan::shares_movers(std::int32_t technique) const {
    for (std::size_t i = 0; i < light_cell_count; ++i)
        if (const LightCell cell = LightCell::at(i);
            cell.on_mover && !cell.specular && owner_[i] != nobody && owner_[i] != technique)
            return true;
    return false;
}

LightPlan LightPlan::part(CellSet cells) const {
    LightPlan result = *this;
    for (std::size_t i = 0; i < light_cell_count; ++i)
        if (!cells[i])
            result.owner_[i] = result.fallback_[i] = nobody;
    return result;
}

bool LightPlan::lights_any(CellSet cells) const {
    for (std::size_t i = 0; i < light_cell_count; ++i)
        if (cells[i] && owner_[i] != nobody)
            return true;
    return false;
}

} // namespace sunfleck::gi
