// Seeded random edits of a document, over every described field and every operation on the tree.
#pragma once

#include "editor/document/edits.h"

#include <random>

namespace sunfleck::tests {

class RandomEdits {
public:
    RandomEdits(editor::Document& document, std::uint32_t seed) : document_(document), random_(seed) {}

    // One edit; it may turn out to change nothing. Returns what it was.
    std::string once() {
        if (list().empty()) // all may have been in one group that was deleted
            return add();
        switch (below(16)) {
        case 0:
            return add();
        case 1:
            editor::duplicate(document_, some());
            return "duplicate";
        case 2:
            if (document_.entity_count() > 12)
                editor::remove(document_, some());
            return "delete";
        case 3:
            static_cast<void>(editor::reparent(document_, some(), below(3) == 0 ? ecs::null_entity : any()));
            return "reparent";
        case 4:
            static_cast<void>(editor::rename(document_, any(), random_name()));
            return "rename";
        case 5:
            editor::group(document_, some());
            return "group";
        case 6:
            return change_components();
        case 7:
            return setting();
        case 8:
            return cancelled();
        default:
            return field();
        }
    }

    std::uint32_t below(std::uint32_t count) { return std::uint32_t(random_() % count); }

private:
    editor::Entity any() {
        const std::vector<editor::Entity> all = list();
        return all[below(std::uint32_t(all.size()))];
    }
    std::vector<editor::Entity> some() {
        std::vector<editor::Entity> result;
        for (std::uint32_t left = 1 + below(3); left > 0; --left)
            result.push_back(any());
        return result;
    }
    std::vector<editor::Entity> list() {
        std::vector<editor::Entity> result;
        for (const editor::Entity entity : document_.registry().entities())
            if (document_.exists(entity))
                result.push_back(entity);
        return result;
    }
    std::string random_name() {
        static const char* names[] = {"lamp", "a \"quoted\" name", "two\nlines", "",
                                      "  ",   "\xc3\xa9t\xc3\xa9", "lamp 7"};
        const std::uint32_t which = below(8);
        return which == 7 ? std::string(10000, 'x') : names[which];
    }
    std::string add() {
        const auto templates = scene::entity_templates();
        const auto number = [&] { return float(below(1000)) * 0.01f - 5.0f; };
        editor::add_from(document_, templates[below(std::uint32_t(templates.size()))], {number(), number(), number()},
                         0.25f + float(below(8)));
        return "add";
    }
    std::string change_components() {
        std::vector<ecs::PoolBase*> pools = document_.registry().described_pools();
        ecs::PoolBase& pool = *pools[below(std::uint32_t(pools.size()))];
        // Names stay, parents are the tree's, and geometry needs files.
        if (pool.description()->name == "Name" || pool.description()->name == "Parent" ||
            pool.description()->name == "MeshInstance")
            return "nothing";
        if (below(2) == 0)
            editor::add_component(document_, some(), pool);
        else
            editor::remove_component(document_, some(), pool);
        return "components";
    }
    std::string text_for(const Field& field) {
        const auto number = [&](double low, double high) {
            low = std::max(low, -1e4), high = std::min(high, 1e4);
            const double share = double(below(1001)) / 1000.0;
            return std::to_string(low + share * (high - low));
        };
        switch (field.kind) {
        case FieldKind::boolean:
            return below(2) == 0 ? "true" : "false";
        case FieldKind::choice:
            return std::string(field.choices[below(std::uint32_t(field.choices.size()))]);
        case FieldKind::integer:
        case FieldKind::unsigned_integer:
            return std::to_string(std::int64_t(std::stod(number(field.minimum, field.maximum))));
        case FieldKind::real:
            return below(10) == 0 ? "nan" : number(field.minimum, field.maximum);
        case FieldKind::vector3: {
            const std::string x = number(field.minimum, field.maximum), y = number(field.minimum, field.maximum);
            return x + "," + y + "," + number(field.minimum, field.maximum);
        }
        case FieldKind::quaternion:
            return below(2) == 0 ? "0,0,0,1" : "0.5,-0.5,0.5,0.5";
        case FieldKind::text: // pictures of the sky: this one is made by code, the others are not there
            return field.name == "file" && below(2) == 0 ? "summer_sky" : random_name();
        case FieldKind::entity:
            return "";
        }
        return "";
    }
    std::string field() {
        std::vector<ecs::PoolBase*> pools = document_.registry().described_pools();
        ecs::PoolBase& pool = *pools[below(std::uint32_t(pools.size()))];
        const TypeDescription& type = *pool.description();
        if (pool.size() == 0 || type.name == "Name" || type.name == "Parent" || type.name == "MeshInstance")
            return "nothing";
        const editor::Entity entity = pool.entities()[below(std::uint32_t(pool.size()))];
        const Field& field = type.fields[below(std::uint32_t(type.fields.size()))];
        static_cast<void>(editor::edit_field(document_, {entity}, pool, field, text_for(field)));
        return "field";
    }
    std::string setting() {
        const auto parts = document_.settings().parts();
        const auto& part = parts[below(std::uint32_t(parts.size()))];
        if (part.type->fields.empty())
            return "nothing";
        const Field& field = part.type->fields[below(std::uint32_t(part.type->fields.size()))];
        static_cast<void>(editor::edit_setting(document_, field.name, text_for(field)));
        return "setting";
    }
    // A gesture that is given up half-way.
    std::string cancelled() {
        ecs::PoolBase& pool = editor::pool_of<scene::Transform>(document_);
        document_.begin("given up");
        for (std::uint32_t left = 5; left > 0; --left)
            static_cast<void>(editor::set_field(document_, some(), pool, pool.description()->fields[0],
                                                text_for(pool.description()->fields[0])));
        document_.cancel();
        return "cancelled";
    }

    editor::Document& document_;
    std::mt19937 random_;
};

} // namespace sunfleck::tests
