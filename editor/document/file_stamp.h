// Tells whether a file was written since: by its time and size.
#pragma once

#include <filesystem>
#include <optional>
#include <system_error>

namespace sunfleck::editor {

struct FileStamp {
    std::filesystem::file_time_type written;
    std::uintmax_t bytes = 0;
    bool operator==(const FileStamp&) const = default;

    // None: it is not there.
    static std::optional<FileStamp> of(const std::filesystem::path& path) {
        std::error_code no_time, no_size;
        const FileStamp stamp{std::filesystem::last_write_time(path, no_time),
                              std::filesystem::file_size(path, no_size)};
        return no_time || no_size ? std::nullopt : std::optional(stamp);
    }
    // Whether the file is another than it was; a file that is gone is not.
    static bool changed(const std::filesystem::path& path, const std::optional<FileStamp>& before) {
        const std::optional<FileStamp> now = of(path);
        return before && now && *now != *before;
    }
};

} // namespace sunfleck::editor
