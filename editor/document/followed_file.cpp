#include "editor/document/followed_file.h"

#include <algorithm>

namespace sunfleck::editor {

// The newest whose entry is done.
std::size_t FollowedFile::newest(const History& history) const {
    const auto is_done = [&](std::uint64_t serial) {
        const auto end = history.entries().begin() + std::ptrdiff_t(history.position());
        return std::any_of(history.entries().begin(), end, [&](const auto& entry) { return entry.serial == serial; });
    };
    std::size_t newest = contents_.size() - 1;
    while (newest > 0 && !is_done(contents_[newest].first))
        --newest;
    return newest;
}

ReloadReport FollowedFile::reload(Document& document, Document& now) {
    const std::uint64_t before = document.history().serial();
    FileContent& known = contents_[newest(document.history())].second;
    FileContent content = known;
    ReloadReport report = editor::reload(document, content, now);
    const std::uint64_t serial = document.history().serial();
    if (serial == before) {
        known = std::move(content);
        return report;
    }
    // What could be redone is gone, and numbers of entries only grow.
    const auto is_gone = [&](const auto& one) {
        return one.first != 0 && std::none_of(document.history().entries().begin(), document.history().entries().end(),
                                              [&](const HistoryEntry& entry) { return entry.serial == one.first; });
    };
    std::erase_if(contents_, is_gone);
    contents_.emplace_back(serial, std::move(content));
    return report;
}

} // namespace sunfleck::editor
