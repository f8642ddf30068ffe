// Who is below whom, what is selected, and what copies of the document are told.
#include "editor/document/document.h"

#include <algorithm>
#include <utility>

namespace sunfleck::editor {
namespace {

bool is_before(Entity a, Entity b) {
    return a.index < b.index;
}

void put_in(std::vector<Entity>& list, Entity entity) {
    list.insert(std::lower_bound(list.begin(), list.end(), entity, is_before), entity);
}

void take_out(std::vector<Entity>& list, Entity entity) {
    const auto found = std::lower_bound(list.begin(), list.end(), entity, is_before);
    if (found != list.end() && *found == entity)
        list.erase(found);
}

} // namespace

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

Entity Document::stored_parent(Entity entity) const {
    const scene::Parent* stored = registry_.try_get<scene::Parent>(entity);
    return stored != nullptr ? stored->parent : ecs::null_entity;
}

void Document::find_all_children() {
    roots_.clear();
    for (auto& [parent, list] : children_)
        list.clear();
    listed_.assign(handles_, {});
    for (const Entity entity : registry_.entities()) {
        if (!exists(entity))
            continue;
        const Listed now{entity, stored_parent(entity), is_at_top(entity)};
        listed_[entity.index] = now;
        if (!now.below.is_null())
            children_[now.below].push_back(entity);
        if (now.at_top)
            roots_.push_back(entity);
    }
    moved_.clear();
    children_revision_ = structure_revision_;
}

// Where few have moved, only they are put in other lists: after an edit of one, a large scene takes no longer than a
// small one.
void Document::find_children() {
    constexpr std::size_t many = 64; // there may be for each that has moved
    if (children_revision_ == structure_revision_)
        return;
    if (many * moved_.size() > by_name_.size())
        return find_all_children();
    for (const Entity entity : moved_)
        list_again(entity);
    moved_.clear();
    children_revision_ = structure_revision_;
}

void Document::list_again(Entity entity) {
    listed_.resize(std::max<std::size_t>(listed_.size(), handles_));
    const Listed& before = listed_[entity.index];
    const bool there = exists(entity);
    const Entity below = there ? stored_parent(entity) : ecs::null_entity;
    if (!there && before.entity != entity) // another has its index
        return;
    if (there && before.entity == entity && before.below == below)
        return;
    if (!before.entity.is_null())
        take_off(before.entity);
    if (!there)
        return;
    listed_[entity.index] = {entity, below, is_at_top(entity)};
    if (!below.is_null())
        put_in(children_[below], entity);
    if (listed_[entity.index].at_top)
        put_in(roots_, entity);
    // Those that waited for it are not at the top any more.
    const auto waiting = children_.find(entity);
    if (waiting == children_.end())
        return;
    for (const Entity child : waiting->second)
        if (std::exchange(listed_[child.index].at_top, false))
            take_out(roots_, child);
}

// Those below it are at the top from now on, unless they have been listed already.
void Document::take_off(Entity entity) {
    const Listed before = std::exchange(listed_[entity.index], {});
    if (!before.below.is_null())
        take_out(children_[before.below], entity);
    if (before.at_top)
        take_out(roots_, entity);
    const auto left = children_.find(entity);
    if (left == children_.end() || exists(entity))
        return;
    for (const Entity child : left->second)
        if (!std::exchange(listed_[child.index].at_top, true))
            put_in(roots_, child);
}

const std::vector<Entity>& Document::roots() {
    find_children();
    return roots_;
}

const std::vector<Entity>& Document::children(Entity parent) {
    static const std::vector<Entity> none;
    find_children();
    const auto found = children_.find(parent);
    return found == children_.end() || !exists(parent) ? none : found->second;
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

// `entities` may be the selection itself.
void Document::select(const std::vector<Entity>& entities) {
    ++selection_revision_;
    for (const Entity entity : selection_)
        selected_[entity.index] = false;
    std::vector<Entity> chosen;
    for (const Entity entity : entities) {
        if (!exists(entity) || selected(entity))
            continue;
        if (entity.index >= selected_.size())
            selected_.resize(entity.index + 1);
        selected_[entity.index] = true;
        chosen.push_back(entity);
    }
    selection_ = std::move(chosen);
}

void Document::toggle(Entity entity) {
    std::vector<Entity> now = selection_;
    if (selected(entity))
        std::erase(now, entity);
    else
        now.push_back(entity);
    select(now);
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

} // namespace sunfleck::editor
