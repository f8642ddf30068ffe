// Every edit as a line of JSON, appended to a file when it is made: a crash of the program takes at most the one that
// was being written. Lines are not flushed to the disk, since edits of a moving hand cannot wait for that: when the
// machine itself stops, what was done since the last whole scene (editor/window/recovery.h flushes those) may be lost.
// Read beside the scene that it goes on from, whose handles and numbers it speaks of; the scene that is read has
// others, so that entities are found by their names, and geometry by an entity that has it.
//
// A line has all that changed, as values after the edit: undone and redone edits are edits. What has no description
// (textures, animations) is in no line: whoever reads stops there, and takes a whole scene that was kept later.
#pragma once

#include "editor/document/document.h"

#include <span>
#include <sys/types.h>

namespace sunfleck::editor {

// What a journal's handles mean in the scene that it goes on from.
struct JournalBase {
    struct Known {
        EntityBits handle = 0;
        std::int64_t mesh = -1; // index; none: -1
    };
    std::map<std::string, Known> entities; // by name
    std::uint64_t epoch = 0;               // lines of others are not its own
    std::uint64_t revision = 0;            // of the document: lines up to here are in the scene

    static JournalBase of(ecs::Registry& registry);
    std::string text() const;
    static Result<JournalBase> from_text(const std::string& text);
};

class JournalWriter {
public:
    JournalWriter() = default;
    ~JournalWriter();
    JournalWriter(const JournalWriter&) = delete;
    JournalWriter& operator=(const JournalWriter&) = delete;

    // An empty file; no link is followed.
    Status create(const std::filesystem::path& path);
    // Another document, or the same after a save: what was noted is forgotten.
    void start_over(const gi::Settings& settings, std::uint32_t meshes);
    // What changed, in order; meshes that were added.
    void note(std::span<const Update> updates, const std::optional<gi::Settings>& settings,
              std::span<const scene::Mesh> meshes);
    // What was noted is in the file that was saved.
    void forget() { start_over(known_settings_.value_or(gi::Settings()), mesh_count_); }
    // Something has changed that cannot be noted.
    void note_unknown() { complete_ = false; }
    bool has_notes() const { return !complete_ || !updates_.empty() || !settings_.empty(); }
    // All that was noted, as one edit.
    Status append(std::uint64_t epoch, std::uint64_t revision, const std::string& name);

private:
    // What is left of a line whose write failed: the next line would continue it, and be unreadable, too.
    Status cut_off_remains();

    int file_ = -1;
    off_t bytes_ = 0; // of whole lines
    bool has_remains_ = false;
    std::filesystem::path path_;  // for messages
    std::vector<Update> updates_; // one for each component
    std::map<std::pair<Entity, std::size_t>, std::size_t> places_;
    std::map<std::string, std::string> settings_;
    std::vector<std::pair<std::uint32_t, scene::Mesh>> meshes_;
    std::optional<gi::Settings> known_settings_;
    std::uint32_t mesh_count_ = 0;
    bool complete_ = true;
};

struct Replayed {
    std::vector<std::string> names; // of the edits
    bool complete = true;           // false: an edit after them could not be read
};
// The edits that a journal has beyond its base, without making them.
Replayed edits_of_journal(const std::string& text, const JournalBase& base);
// Makes them, each an entry of the history. `document` is the base's scene, just read.
Replayed replay(Document& document, const std::string& text, const JournalBase& base);

} // namespace sunfleck::editor
