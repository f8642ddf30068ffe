// A file that other programs write while the document is edited, and what it held when it was read, for each state of
// the history: who undoes a reload can take the file's news over again.
#pragma once

#include "editor/document/file_stamp.h"
#include "editor/document/reload.h"

namespace sunfleck::editor {

class FollowedFile {
public:
    FollowedFile() = default;
    // `content`: what the file holds now.
    FollowedFile(std::filesystem::path path, FileContent content)
        : path_(std::move(path)), stamp_(FileStamp::of(path_)), contents_{{0, std::move(content)}} {}

    // Empty: none.
    const std::filesystem::path& path() const { return path_; }
    bool is_gltf() const {
        const std::string ending = path_.extension().string();
        return ending == ".glb" || ending == ".gltf";
    }
    // Written by others since it was read or written here.
    bool changed() const { return FileStamp::changed(path_, stamp_); }
    // As it was when that was read or written here.
    const std::optional<FileStamp>& stamp() const { return stamp_; }
    // What others have written is known, as of that time.
    void see(const std::optional<FileStamp>& stamp) { stamp_ = stamp; }
    // What it held when it was read last, in that state of the document.
    const FileContent& content(const History& history) const { return contents_[newest(history)].second; }
    // Takes over what is new; `now` is the file, read again.
    ReloadReport reload(Document& document, Document& now);

private:
    std::size_t newest(const History& history) const;

    std::filesystem::path path_;
    std::optional<FileStamp> stamp_;
    // By the entry of the history that took it over; 0: from the beginning. In the order in which they were made.
    std::vector<std::pair<std::uint64_t, FileContent>> contents_;
};

} // namespace sunfleck::editor
