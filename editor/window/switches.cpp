#include "editor/window/switches.h"

#include <algorithm>

namespace sunfleck::editor {
namespace {

Entities selected_families(Session& session) {
    return with_families(*session.document, session.selected_tops());
}

Entities selected_lamps(Session& session) {
    Entities lamps = selected_families(session);
    std::erase_if(lamps, [&](Entity entity) { return !emits(*session.document, entity); });
    return lamps;
}

bool has_all(const std::unordered_set<Entity>& set, const Entities& entities) {
    return !entities.empty() &&
           std::all_of(entities.begin(), entities.end(), [&](Entity entity) { return set.count(entity) > 0; });
}

// Puts all of them into the set; where it has all of them, takes them out.
void toggle(std::unordered_set<Entity>& set, const Entities& entities) {
    const bool had_all = has_all(set, entities);
    for (const Entity entity : entities)
        if (had_all)
            set.erase(entity);
        else
            set.insert(entity);
}

} // namespace

Entities with_families(Document& document, const Entities& entities) {
    Entities result;
    for (const Entity top : topmost(document, entities))
        for (const Entity entity : document.family(top))
            result.push_back(entity);
    return result;
}

void set_hidden(Session& session, const Entities& entities, bool hidden) {
    for (const Entity entity : with_families(*session.document, entities))
        if (hidden)
            session.hidden.insert(entity);
        else
            session.hidden.erase(entity);
}

void toggle_lock(Session& session) {
    toggle(session.locked, selected_families(session));
    ++session.lock_revision;
}

void toggle_mute(Session& session) {
    const Entities lamps = selected_lamps(session);
    if (lamps.empty())
        return session.messages.say("Nothing that is selected gives light", Message::Kind::warning);
    toggle(session.muted, lamps);
}

bool is_locked(Session& session) {
    return has_all(session.locked, selected_families(session));
}

bool is_muted(Session& session) {
    return has_all(session.muted, selected_lamps(session));
}

bool is_solo(const Session& session) {
    return session.solo && session.solo->hidden == session.hidden;
}

void toggle_solo(Session& session) {
    Document& document = *session.document;
    const Entities families = selected_families(session);
    const std::unordered_set<Entity> chosen(families.begin(), families.end());
    Solo next;
    next.before = next.hidden = is_solo(session) ? session.solo->before : session.hidden;
    for (const Entity root : document.roots())
        for (const Entity entity : document.family(root)) {
            if (!emits(document, entity))
                continue;
            if (chosen.count(entity) == 0) {
                next.hidden.insert(entity);
                continue;
            }
            next.lamps.insert(entity);
            next.hidden.erase(entity);
        }
    if (is_solo(session) && (next.lamps.empty() || next.lamps == session.solo->lamps)) {
        session.hidden = std::exchange(session.solo, std::nullopt)->before;
        return;
    }
    session.hidden = next.hidden;
    session.solo = std::move(next);
}

Entities free_tops(Session& session) {
    Entities tops = session.selected_tops();
    if (session.locked.empty())
        return tops;
    std::unordered_set<Entity> held;
    for (const Entity locked : session.locked)
        for (Entity entity = locked; !entity.is_null() && held.insert(entity).second;)
            entity = session.document->parent(entity);
    std::erase_if(tops, [&](Entity entity) { return held.count(entity) > 0; });
    return tops;
}

void delete_selection(Session& session) {
    if (session.locked.empty())
        return remove(*session.document, session.document->selection());
    const Entities free = free_tops(session);
    const std::unordered_set<Entity> goes(free.begin(), free.end());
    Entities stays = session.selected_tops();
    std::erase_if(stays, [&](Entity entity) { return goes.count(entity) > 0; });
    if (!stays.empty())
        session.messages.say("Not deleted: " + what(*session.document, stays) +
                                 ", locked or with something locked below; Show, Lock unlocks what is selected",
                             Message::Kind::warning);
    remove(*session.document, free);
}

} // namespace sunfleck::editor
