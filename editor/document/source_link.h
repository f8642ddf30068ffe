// What a scene file remembers of the glTF file that the scene came from: where that is, and what it held when it was
// read last. A file that was exported again can then be taken over (reload.h) in a later session, too.
#pragma once

#include "editor/document/file_stamp.h"
#include "editor/document/reload.h"

namespace sunfleck::editor {

struct SourceLink {
    std::filesystem::path file;
    FileContent content;
    std::optional<FileStamp> stamp; // of the file then; older scene files do not say it
};

// Whether the file was exported again since, as far as that can be told. Within `folder`, of the scene, or anywhere
// where `trusted`, by what it holds; a file elsewhere, which a scene of unknown origin may name, is not read unasked:
// its time and size must do.
bool is_newer(const SourceLink& link, const std::filesystem::path& folder, bool trusted);

// Hashes of a document's meshes and textures, by number, as far as they were asked for: these never change.
struct ContentHashes {
    std::vector<std::string> meshes, textures;
};

// As JSON, for io::SaveOptions::source. `folder`: of the scene file, which the name is relative to.
std::string text_of(const SourceLink& link, Document& document, const std::filesystem::path& folder,
                    ContentHashes& hashes);
// Of a document that was just read from a scene file in that folder.
Result<SourceLink> source_link_of(Document& document, const std::string& text, const std::filesystem::path& folder,
                                  ContentHashes& hashes);

} // namespace sunfleck::editor
