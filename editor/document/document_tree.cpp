// Who is below whom, what is selected, and what copies of the document are told.
#include "editor/document/document.h"

#include <algorithm>
#include <utility>

namespace sunfleck::editor {

bool Document::exists(Entity entity) const {
    return registry_.alive(entity) && registry_.has<scene::Name>(entity);
}

const std::string& Document::name(Entity entity) const {
    static const std::string none = "(none)";
    const scene::Name* stored = registry_.try_get<scene::Name>(entity);
    return stored != nullptr ? stored->name : none;
}

Entity Document::find(const std::string& name) const {
    const auto found = by_name_.find(name);
    return found == by_name_.end() ? ecs::null_entity : found->second;
}

Entity Document::parent(Entity entity) const {
    const scene::Parent* stored = registry_.try_get<scene::Parent>(entity);
    return stored != nullptr && exists(stored->parent) ? stored->parent : ecs::null_entity;
}

void Document::find_children() {
    if (children_revision_ == structure_revision_)
        return;
    children_revision_ = structure_revision_;
    roots_.clear();
    for (auto& [parent, list] : children_)
        list.clear();
    for (const Entity entity : registry_.entities()) {
        if (!exists(entity))
            continue;
        const Entity above = parent(entity);
        (above.is_null() ? roots_ : children_[above]).push_back(entity);
    }
}

const std::vector<Entity>& Document::roots() {
    find_children();
    return roots_;
}

const std::vector<Entity>& Document::children(Entity parent) {
    static const std::vector<Entity> none;
    find_children();
    const auto found = children_.find(parent);
    return found == children_.end() ? none : found->second;
}

bool Document::is_below(Entity entity, Entity ancestor) const {
    std::size_t depth = 0;
    for (; !entity.is_null() && depth <= by_name_.size(); entity = parent(entity), ++depth)
        if (entity == ancestor)
            return true;
    return depth > by_name_.size(); // a cycle, which a damaged file may have
}

std::vector<Entity> Document::family(Entity entity) {
    std::vector<Entity> result{entity};
    for (std::size_t i = 0; i < result.size(); ++i)
        for (const Entity child : children(result[i]))
            if (child != entity) // of a cycle, which a damaged file may have
                result.push_back(child);
    return result;
}

void Document::select(std::vector<Entity> entities) {
    for (const Entity entity : selection_)
        selected_[entity.index] = false;
    selection_.clear();
    for (const Entity entity : entities) {
        if (!exists(entity) || selected(entity))
            continue;
        if (entity.index >= selected_.size())
            selected_.resize(entity.index + 1);
        selected_[entity.index] = true;
        selection_.push_back(entity);
    }
}

void Document::toggle(Entity entity) {
    std::vector<Entity> now = selection_;
    if (selected(entity))
        std::erase(now, entity);
    else
        now.push_back(entity);
    select(std::move(now));
}

// By entity, then component, one of each.
void Document::tidy_updates() {
    const auto key = [](const Update& update) { return std::pair(update.entity, update.pool->type_index); };
    const auto before = [&](const Update& a, const Update& b) { return key(a) < key(b); };
    std::stable_sort(updates_.begin(), updates_.end(), before);
    const auto same = [&](const Update& a, const Update& b) { return key(a) == key(b); };
    // Backwards, since the last of those that are the same stays.
    updates_.erase(updates_.begin(), std::unique(updates_.rbegin(), updates_.rend(), same).base());
}

std::vector<Update> Document::take_updates() {
    tidy_updates();
    tidied_at_ = most_untidied;
    return std::exchange(updates_, {});
}

std::vector<Update> Document::all_updates() {
    updates_.clear();
    std::vector<Update> result;
    for (const Entity entity : registry_.entities()) {
        if (!exists(entity))
            continue;
        for (const ecs::PoolBase* pool : registry_.all_pools())
            if (!pool->is_derived() && pool->is_copyable() && pool->contains(entity))
                result.push_back({entity, pool, registry_.value(*pool, entity)});
    }
    return result;
}

std::uint32_t Document::handle_count() const {
    std::uint32_t count = handles_;
    for (const auto& [name, entity] : by_name_)
        count = std::max(count, entity.index + 1);
    return count;
}

} // namespace sunfleck::editor
