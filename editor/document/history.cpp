#include "editor/document/history.h"

#include <algorithm>
#include <utility>

namespace sunfleck::editor {

void History::add(HistoryEntry entry) {
    entries_.resize(position_);
    entry.serial = ++last_serial_;
    entry.components.shrink_to_fit();
    entry.settings.shrink_to_fit();
    entries_.push_back(std::move(entry));
    position_ = entries_.size();
}

std::vector<std::string> History::newest_names(std::size_t most) const {
    std::vector<std::string> names;
    for (std::size_t i = position_ - std::min(position_, most); i < position_; ++i)
        names.push_back(entries_[i].name);
    return names;
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
    const std::vector<Entity>* last = nullptr;
    for (const HistoryEntry& entry : entries_) {
        bytes += sizeof entry + entry.name.capacity() + entry.components.size() * sizeof(ComponentChange) +
                 entry.settings.size() * (sizeof(SettingChange) + 64);
        for (const auto* selected : {entry.selected_before.get(), entry.selected_after.get()})
            if (std::exchange(last, selected) != selected)
                bytes += sizeof *selected + selected->size() * sizeof(Entity);
    }
    return bytes;
}

} // namespace sunfleck::editor
