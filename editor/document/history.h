// What was done, so that it can be undone. Handles are the identities: a document never destroys an entity, it takes
// its components away, so that a handle means the same thing before a deletion, after it, and after its undo.
#pragma once

#include "engine/ecs/registry.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace sunfleck::editor {

using ecs::Entity;

// One component of one entity; null: it is not there.
struct ComponentChange {
    Entity entity;
    ecs::PoolBase* pool = nullptr;
    ecs::Value before, after;
};

// A setting, as text.
struct SettingChange {
    std::string name, before, after;
};

struct HistoryEntry {
    std::string name; // shown to the user: "Move lamp"
    std::vector<ComponentChange> components;
    std::vector<SettingChange> settings;
    std::shared_ptr<const std::vector<Entity>> selected_before, selected_after; // shared as long as they stay the same
    std::uint64_t serial = 0; // distinct for every entry that ever was

    bool empty() const { return components.empty() && settings.empty(); }
};

class History {
public:
    // Drops what could be redone.
    void add(HistoryEntry entry);
    bool can_undo() const { return position_ > 0; }
    bool can_redo() const { return position_ < entries_.size(); }
    // The entry that is undone or redone. There must be one.
    const HistoryEntry& step_back() { return entries_[--position_]; }
    const HistoryEntry& step_forward() { return entries_[position_++]; }
    const std::vector<HistoryEntry>& entries() const { return entries_; }
    // How many entries are done.
    std::size_t position() const { return position_; }
    // Of the newest entry that is done; 0: none.
    std::uint64_t serial() const { return position_ == 0 ? 0 : entries_[position_ - 1].serial; }
    // Of the newest entries that are done, at most so many, the newest last.
    std::vector<std::string> newest_names(std::size_t most) const;
    // Of the settings that were changed, by name: what they were before the newest change that is done.
    std::map<std::string, std::string> old_settings() const;
    // Memory of the entries without the values of components, bytes.
    std::size_t overhead() const;

private:
    std::vector<HistoryEntry> entries_;
    std::size_t position_ = 0;
    std::uint64_t last_serial_ = 0;
};

} // namespace sunfleck::editor
