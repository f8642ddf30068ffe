// The components of what is selected.
#include "editor/panels/panel.h"
#include "editor/window/fields.h"

#include <algorithm>
#include <imgui_stdlib.h>

namespace sunfleck::editor {
namespace {

class Inspector final : public Panel {
public:
    void draw(Session& session) override;

private:
    void name_row(Session& session);
    void component(Session& session, ecs::PoolBase& pool);
    void component_menu(Session& session, ecs::PoolBase& pool, const Entities& owners);
    void fields(Session& session, ecs::PoolBase& pool, const Entities& owners);
    void add_menu(Session& session);
    std::string name_, name_before_;
};

// The selected ones that have it.
Entities owners_of(Session& session, const ecs::PoolBase& pool) {
    Entities result;
    for (const Entity entity : session.document->selection())
        if (pool.contains(entity))
            result.push_back(entity);
    return result;
}

void Inspector::name_row(Session& session) {
    Document& document = *session.document;
    const Entities& selection = document.selection();
    if (selection.size() > 1) {
        ui::text("selected", std::to_string(selection.size()) + " entities selected");
        return;
    }
    const std::string& now = document.name(selection[0]);
    if (now != name_before_)
        name_ = name_before_ = now;
    ImGui::SetNextItemWidth(-1.0f);
    ImGui::InputText("##name", &name_);
    ui::note("name", name_);
    ui::tooltip("Name; every entity has its own");
    if (!ImGui::IsItemDeactivatedAfterEdit())
        return;
    if (name_ != now)
        session.messages.check(rename(document, selection[0], name_));
    name_before_.clear(); // what it is called now
}

void Inspector::component_menu(Session& session, ecs::PoolBase& pool, const Entities& owners) {
    if (!ImGui::BeginPopupContextItem("menu"))
        return;
    ui::close_by_escape();
    Document& document = *session.document;
    if (ui::menu_item("Copy", "", true))
        session.copied = {std::string(pool.description()->name), document.registry().value(pool, owners[0])};
    if (ui::menu_item("Paste", "", session.copied.type == pool.description()->name))
        paste_component(document, document.selection(), pool, session.copied.value);
    if (ui::menu_item("Reset", "", true))
        paste_component(document, owners, pool, pool.default_value());
    if (ui::menu_item("Remove", "", true))
        remove_component(document, owners, pool);
    ImGui::EndPopup();
}

void Inspector::fields(Session& session, ecs::PoolBase& pool, const Entities& owners) {
    if (!begin_fields("fields"))
        return;
    Document& document = *session.document;
    const std::shared_ptr<void> defaults = pool.default_value();
    for (const Field& field : pool.description()->fields) {
        FieldSource source;
        source.field = &field;
        source.defaults = defaults.get();
        source.gesture = "Set " + std::string(readable_name(field.name)) + " of " + what(document, owners);
        for (const Entity owner : owners)
            if (pool.contains(owner))
                source.objects.push_back(pool.address(pool.position_of(owner.index)));
        source.set = [&](std::size_t object, const std::string& text) {
            return set_field(document, {owners[object]}, pool, field, text);
        };
        if (source.objects.size() == owners.size())
            field_row(session, source);
    }
    end_fields();
}

void Inspector::component(Session& session, ecs::PoolBase& pool) {
    const Entities owners = owners_of(session, pool);
    if (owners.empty() || is_part_of_tree(*session.document, pool))
        return;
    const TypeDescription& type = *pool.description();
    const ui::Scope scope(type.name);
    const std::size_t all = session.document->selection().size();
    const std::string count =
        owners.size() == all ? "" : " (" + std::to_string(owners.size()) + " of " + std::to_string(all) + ")";
    const bool open =
        ImGui::CollapsingHeader((std::string(type.name) + count + "###header").c_str(), ImGuiTreeNodeFlags_DefaultOpen);
    ui::note("header", open ? "open" : "");
    ui::tooltip(std::string(type.tooltip) + "\n\nRight click: copy, paste, reset, remove");
    component_menu(session, pool, owners);
    if (open)
        fields(session, pool, owners);
}

void Inspector::add_menu(Session& session) {
    Document& document = *session.document;
    if (ui::button("Add component", "Gives the selection another component"))
        ImGui::OpenPopup("add");
    if (!session.copied.type.empty()) {
        ImGui::SameLine();
        ecs::PoolBase* pool = find_component(document, session.copied.type);
        if (ui::button("Paste " + session.copied.type + "##paste", "The component that was copied") && pool != nullptr)
            paste_component(document, document.selection(), *pool, session.copied.value);
    }
    if (!ImGui::BeginPopup("add"))
        return;
    ui::close_by_escape();
    for (ecs::PoolBase* pool : document.registry().described_pools()) {
        const bool offered = !is_part_of_tree(document, *pool) && !pool->is_derived() &&
                             owners_of(session, *pool).size() < document.selection().size();
        if (offered && ui::menu_item(std::string(pool->description()->name), "", true))
            add_component(document, document.selection(), *pool);
        if (offered)
            ui::tooltip(pool->description()->tooltip);
    }
    ImGui::EndPopup();
}

void Inspector::draw(Session& session) {
    const ui::Scope scope("inspector");
    if (session.document->selection().empty()) {
        ui::hint("Nothing is selected: click something in the viewport or in the hierarchy.");
        return;
    }
    name_row(session);
    for (ecs::PoolBase* pool : session.document->registry().described_pools())
        component(session, *pool);
    ImGui::Dummy(ImVec2(0.0f, 0.3f * ui::unit()));
    if (!session.document->selection().empty())
        add_menu(session);
}

} // namespace

std::unique_ptr<Panel> make_inspector() {
    return std::make_unique<Inspector>();
}

} // namespace sunfleck::editor
