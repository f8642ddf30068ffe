// The scene that is edited: entities with distinct names, geometry, textures and lighting settings, the selection, and
// the history of all edits. Knows no window and no GPU. Whatever shows the scene has a copy and is told of changes by
// take_updates(), so that nothing which a renderer or a simulation adds or moves ever gets into the document.
//
// Use from one thread. Every change goes through a gesture:
//
//     document.begin("Move lamp");
//     document.set(entity, pool, value);   // any number of times: a drag
//     document.commit();                   // one entry of the history; cancel() restores everything and leaves none
#pragma once

#include "editor/document/file_stamp.h"
#include "editor/document/history.h"
#include "engine/io/encoded_textures.h"
#include "engine/io/scene_file.h"
#include "viewer/quality.h"

#include <filesystem>
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace sunfleck::editor {

// For copies of the document: the newest value of a component, null where it is gone.
struct Update {
    Entity entity;
    const ecs::PoolBase* pool = nullptr; // of the document; Registry::counterpart finds the copy's
    ecs::Value value;
};

// What a save may take the place of: the document's own file, or another one, too.
enum class Replace { own, any };

class Document {
public:
    // An empty scene.
    Document();
    Document(const Document&) = delete;
    Document& operator=(const Document&) = delete;

    // A .gltf, .glb or .scene.json file, as a document without history. `progress`, `allow_outside`: of
    // io::ImportOptions.
    static Result<std::unique_ptr<Document>> open(const std::filesystem::path& path,
                                                  const std::function<bool(float)>& progress = {},
                                                  bool allow_outside = false);
    // Writes a .scene.json file and its geometry; from then on the document is this file. Refuses to replace another
    // scene's files unless `replace` says so, and, once, a file that file_changed(): the next save replaces it.
    Status save(const std::filesystem::path& path, Replace replace = Replace::own);
    // The same in three parts, for who writes a copy elsewhere: whether that may be, how a document is written, and
    // that the files are there, as of that serial of the history.
    Status may_save(const std::filesystem::path& path, Replace replace = Replace::own);
    static io::SaveOptions save_options(const gi::Settings& settings, io::EncodedTextures* encoded,
                                        const std::string* source);
    void note_saved(const std::filesystem::path& path, std::uint64_t serial);
    // Whether there is a file of that name which is not the document's.
    bool is_another_file(const std::filesystem::path& path) const;

    // To read; writing goes through set().
    ecs::Registry& registry() { return registry_; }
    const scene::MeshStore& meshes() const { return meshes_; }
    const scene::TextureStore& textures() const { return textures_; }
    const gi::Settings& settings() const { return settings_; }
    // Adds geometry. It stays when the entity that uses it is undone, and is saved only where something uses it.
    std::uint32_t add_mesh(scene::Mesh mesh) { return meshes_.add(std::move(mesh)); }
    // Of a shape that stays as it is: the same as one that was made before, if there is an equal one.
    std::uint32_t add_shape(scene::Mesh mesh);
    scene::TextureStore& texture_store() { return textures_; }
    const std::filesystem::path& path() const { return path_; }
    // Another program has written the file since it was opened or saved here.
    bool file_changed() const;
    // What another program has written there is known, as of that time.
    void saw_file(const std::optional<FileStamp>& stamp) { stamp_ = stamp; }
    // Of this document alone, as long as the program runs: a new one may lie where another was.
    std::uint64_t number() const { return number_; }
    // What the import left out or changed.
    const std::vector<std::string>& notes() const { return notes_; }
    // What its file says, or is to say, of the glTF file that the scene came from (source_link.h); null: nothing.
    const std::shared_ptr<const std::string>& source() const { return source_; }
    void set_source(std::string source) {
        source_ = source.empty() ? nullptr : std::make_shared<const std::string>(std::move(source));
    }
    // What edits could not bring about, since the last call.
    std::vector<std::string> take_remarks() { return std::exchange(remarks_, {}); }
    // Pictures of the sky that were painted over under the same names since; one gesture. How many those were.
    std::size_t read_skies_again();
    // Of the glTF file that was opened, when it was read; else empty.
    const std::string& file_checksum() const { return file_checksum_; }
    // What names of other files are relative to; usually the file's own folder.
    void set_folder(std::filesystem::path folder) { folder_ = std::move(folder); }
    const std::filesystem::path& folder() const { return folder_; }
    // The textures as files have them, for all who save the document or a copy.
    const std::shared_ptr<io::EncodedTextures>& encoded_textures() const { return encoded_; }
    // True if there are edits that the file lacks.
    bool unsaved() const { return history_.serial() != saved_serial_ || gesture_changed(); }
    // The document is no file's any more, and unsaved.
    void forget_file() {
        path_.clear();
        mark_unsaved();
    }
    // Takes back what save or open said: the file was changed or removed by others.
    void mark_unsaved() { saved_serial_ = ~std::uint64_t(0); }

    // --- Gestures ------------------------------------------------------------------------------------------------
    void begin(std::string name);
    bool in_gesture() const { return gesture_.has_value(); }
    // Sets, adds, or (null) removes a component. Null for any component of an entity that is all there is removes the
    // entity. In a gesture only.
    void set(Entity entity, ecs::PoolBase& pool, const ecs::Value& value);
    Status set_setting(std::string_view name, std::string_view value);
    // All at once: values that are only right together.
    Status set_settings(const gi::Settings& settings);
    // A handle without any component, which the gesture is to give some.
    Entity create() { return registry_.create(); }
    // True if something has changed and the history has an entry more.
    bool commit();
    void cancel();
    // End a gesture by cancelling it first. False: there was nothing to undo or redo.
    bool undo();
    bool redo();
    const History& history() const { return history_; }

    // --- Entities ------------------------------------------------------------------------------------------------
    // In the document: everything in it has a name.
    bool exists(Entity entity) const;
    const std::string& name(Entity entity) const;
    // The entity of that name; null if there is none.
    Entity find(const std::string& name) const;
    // `wanted`, or with the lowest free number behind it. Line breaks and other control characters become spaces, long
    // names are cut.
    std::string free_name(const std::string& wanted) const;
    // In order of creation.
    const std::vector<Entity>& roots();
    const std::vector<Entity>& children(Entity parent);
    Entity parent(Entity entity) const;
    // Whether `entity` is `ancestor` or below it.
    bool is_below(Entity entity, Entity ancestor) const;
    // The entity and all below it, parents first.
    std::vector<Entity> family(Entity entity);
    std::size_t entity_count() const { return by_name_.size(); }
    // Raised with every change: of names and parents; of anything; of settings.
    std::uint64_t structure_revision() const { return structure_revision_; }
    std::uint64_t revision() const { return revision_; }
    std::uint64_t settings_revision() const { return settings_revision_; }

    // --- Selection, in the order in which it was made ------------------------------------------------------------
    const std::vector<Entity>& selection() const { return selection_; }
    // Raised with every change of it.
    std::uint64_t selection_revision() const { return selection_revision_; }
    bool selected(Entity entity) const { return entity.index < selected_.size() && selected_[entity.index]; }
    void select(const std::vector<Entity>& entities);
    void toggle(Entity entity);

    // --- For copies of the document ------------------------------------------------------------------------------
    // What changed since the last call, by entity, then component; the order depends on the document alone.
    std::vector<Update> take_updates();
    // Everything.
    std::vector<Update> all_updates();
    // Handles of the document are below this.
    std::uint32_t handle_count() const { return handles_; }

private:
    void apply(Entity entity, ecs::PoolBase& pool, const ecs::Value& value);
    void apply(const HistoryEntry& entry, bool forward);
    bool gesture_changed() const;
    void note_setting(std::string_view name, const std::string& before);
    void settle_lamps();
    void settle_skies();
    void name_changed(Entity entity, const void* before, const void* after);
    void name_everything();
    void find_children();
    void find_all_children();
    void list_again(Entity entity);
    void take_off(Entity entity);
    Entity stored_parent(Entity entity) const;
    bool is_at_top(Entity entity) const { return parent(entity).is_null(); }
    HistoryEntry end_gesture();
    const std::shared_ptr<const std::vector<Entity>>& shared_selection();
    void tidy_updates();

    static std::uint64_t next_number();
    const std::uint64_t number_ = next_number();
    ecs::Registry registry_;
    scene::MeshStore meshes_;
    std::vector<std::uint32_t> shapes_; // meshes of add_shape
    scene::TextureStore textures_;
    gi::Settings settings_ = viewer::usual_lighting();
    ecs::PoolBase *name_pool_ = nullptr, *parent_pool_ = nullptr, *lamp_pool_ = nullptr, *sky_pool_ = nullptr;
    std::filesystem::path path_;
    // Of the file when it was opened or saved; none: it was not there.
    std::optional<FileStamp> stamp_;
    std::vector<std::string> notes_, remarks_;
    std::filesystem::path folder_;
    std::shared_ptr<const std::string> source_;
    std::string file_checksum_;
    std::shared_ptr<io::EncodedTextures> encoded_ = std::make_shared<io::EncodedTextures>();

    History history_;
    std::uint64_t saved_serial_ = 0;
    std::optional<HistoryEntry> gesture_;
    // Of the gesture: of each entity (by index) its newest change, of each change the one before it of the same entity;
    // numbers count from one, 0: none.
    std::vector<std::uint32_t> newest_change_, change_before_;

    std::unordered_map<std::string, Entity> by_name_;
    // As found last, all in order of creation. Children are those of the parent that is stored, whether that is there
    // or not; where it is not, they are at the top, too.
    std::vector<Entity> roots_;
    std::unordered_map<Entity, std::vector<Entity>> children_;
    struct Listed {
        Entity entity, below; // null: there is none of this index; it has no parent
        bool at_top = false;
    };
    std::vector<Listed> listed_; // by index
    std::vector<Entity> moved_;  // whose names or parents have changed since
    std::uint64_t structure_revision_ = 1, children_revision_ = 0, revision_ = 1, settings_revision_ = 1;
    std::vector<Entity> selection_;
    std::uint64_t selection_revision_ = 1;
    std::shared_ptr<const std::vector<Entity>> shared_selection_; // as the newest entry of the history has it
    std::vector<bool> selected_;                                  // by index
    // In the order in which they came: of those of one component the last counts. Tidied when there are so many.
    std::vector<Update> updates_;
    std::size_t tidied_at_ = most_untidied;
    static constexpr std::size_t most_untidied = 65536;
    std::uint32_t handles_ = 0;
};

// A state of a document: where it is the same, all that is seen of its entities and of the selection is.
struct SeenState {
    std::uint64_t document = 0, revision = 0, selection = 0;
    bool operator==(const SeenState&) const = default;
    // True, once, where it is another than before.
    bool follow(const Document& now) {
        const SeenState next{now.number(), now.revision(), now.selection_revision()};
        return std::exchange(*this, next) != next;
    }
};

// The document's pool of a described component; null if there is none of that name.
ecs::PoolBase* find_component(Document& document, std::string_view name);
// Whether the two have the same bits there; text: the same letters.
bool same_field(const Field& field, const void* a, const void* b);
// Whether both are null or have the same values in all described fields.
bool same_value(const ecs::PoolBase& pool, const ecs::Value& a, const ecs::Value& b);

} // namespace sunfleck::editor
