// Saving: at once, where somebody waits for the answer, or behind the user's back.
#include "editor/document/source_link.h"
#include "editor/window/saving.h"
#include "editor/window/session.h"
#include "engine/scene/entity_names.h"

namespace sunfleck::editor {

// What a scene file in that folder is to say of the glTF file that the scene came from.
void Session::remember_source(const std::filesystem::path& folder) {
    const FollowedFile& from = own_.is_gltf() ? own_ : imported_;
    document->set_source(from.path().empty() ? std::string()
                                             : text_of({from.path(), from.content(document->history()), from.stamp()},
                                                       *document, folder, hashes_));
}

bool Session::save(const std::filesystem::path& path, Replace replace) {
    end_saving();
    const auto source_before = document->source();
    remember_source(path.parent_path());
    if (!messages.check(document->save(path, replace))) {
        document->set_source(source_before != nullptr ? *source_before : std::string());
        return false;
    }
    note_saved(path, FileContent::of(*document));
    return true;
}

void Session::save_behind() {
    saves_again_ = saving != nullptr;
    if (saves_again_)
        return;
    const std::filesystem::path path = document->path();
    if (!messages.check(document->may_save(path)))
        return;
    remember_source(path.parent_path());
    saved_content_ = FileContent::of(*document);
    saving = std::make_unique<Saving>(document, path, wake);
}

void Session::finish_saving() {
    if (saving != nullptr && saving->finished())
        take_saved();
}

// Also for what was asked for meanwhile.
void Session::end_saving() {
    while (saving != nullptr)
        take_saved();
}

void Session::take_saved() {
    const std::unique_ptr<Saving> done = std::move(saving);
    const bool again = std::exchange(saves_again_, false);
    if (!messages.check(done->take()))
        return;
    if (done->document() != document)
        return;
    document->note_saved(done->path(), done->serial());
    note_saved(done->path(), std::move(saved_content_));
    if (again && document->unsaved())
        save_behind();
}

bool Session::still_unsaved() {
    end_saving();
    return document->unsaved();
}

// `content`: what the file has now.
void Session::note_saved(const std::filesystem::path& path, FileContent content) {
    messages.say("Saved " + path.string());
    for (const std::string& line : scene::wrong_names(document->registry()))
        messages.say(line, Message::Kind::warning);
    const bool was_gltf = own_.is_gltf();
    if (reloading_ != nullptr && reloaded_ == &own_) { // what it is held against is about to change
        if (was_gltf)
            reloaded_ = &imported_;
        else
            reloading_.reset();
    }
    if (was_gltf)
        imported_ = std::move(own_);
    own_ = FollowedFile(path, std::move(content));
    note_recent(path);
}

} // namespace sunfleck::editor
