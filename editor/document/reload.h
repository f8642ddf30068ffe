// A glTF file that was exported again while it is being edited here: what has changed in it comes into the document,
// and edits stay with the nodes of the same name.
//
// Three versions of each component meet: what the file held when it was read, what it holds now, and what the document
// has. Where the file has not changed, the document stays; where the document was not edited, the file's is taken;
// where both have changed, field by field, the edit stays; likewise each lighting setting. Geometry counts as changed
// where vertices or triangles differ; skins and morph targets stay as they were read first.
#pragma once

#include "editor/document/edits.h"

#include <map>

namespace sunfleck::editor {

// What a file held: its nodes by name, with their components as values.
class FileContent {
public:
    struct Node {
        Entity entity; // of the document, under whatever name it has now
        std::vector<std::pair<ecs::PoolBase*, ecs::Value>> components;
        const ecs::Value* find(const ecs::PoolBase& pool) const;
    };
    // Of a document that has just been read from it.
    static FileContent of(Document& document);
    const std::map<std::string, Node>& nodes() const { return nodes_; }
    std::map<std::string, Node>& nodes() { return nodes_; }
    const gi::Settings& settings() const { return settings_; }
    void set_settings(const gi::Settings& settings) { settings_ = settings; }
    // Of the file, if it is a glTF file.
    const std::string& checksum() const { return checksum_; }
    void set_checksum(std::string checksum) { checksum_ = std::move(checksum); }

private:
    std::map<std::string, Node> nodes_;
    gi::Settings settings_;
    std::string checksum_;
};

struct ReloadReport {
    std::size_t changed = 0, added = 0, removed = 0; // entities
    std::size_t settings = 0;                        // of lighting that were changed
    std::vector<std::string> lost; // nodes that are gone, and had been edited: those edits have no place any more
    std::string text(const std::string& file) const;
};

// One gesture. `content` is what the document was read from, and then what `now` holds; `now` is the file read again.
ReloadReport reload(Document& document, FileContent& content, Document& now);

} // namespace sunfleck::editor
