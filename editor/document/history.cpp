#include "editor/document/history.h"

namespace sunfleck::editor {

void History::add(HistoryEntry entry) {
    entries_.resize(position_);
    entry.serial = ++last_serial_;
    entry.components.shrink_to_fit();
    entry.settings.shrink_to_fit();
    entries_.push_back(std::move(entry));
    position_ = entries_.size();
}

std::map<std::string, std::string> History::old_settings() const {
    std::map<std::string, std::string> result;
    for (std::size_t i = 0; i < position_; ++i)
        for (const SettingChange& change : entries_[i].settings)
            result[change.name] = change.before;
    return result;
}

std::size_t History::overhead() const {
    std::size_t bytes = 0;
    for (const HistoryEntry& entry : entries_)
        bytes += sizeof entry + entry.name.capacity() + entry.components.size() * sizeof(ComponentChange) +
                 entry.settings.size() * (sizeof(SettingChange) + 64) +
                 (entry.selected_before.size() + entry.selected_after.size()) * sizeof(Entity);
    return bytes;
}

} // namespace sunfleck::editor
