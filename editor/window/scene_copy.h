// The scene that is shown: a copy of the document's entities in a renderer of its own, which only the scene thread
// touches. What a renderer or a simulation adds or moves stays in the copy.
#pragma once

#include "editor/document/document.h"
#include "viewer/scene_renderer.h"

namespace sunfleck::editor {

// What a document tells its copy. Later changes are added to earlier ones that were not taken yet.
struct SceneChange {
    std::shared_ptr<const void> source; // the document, whose pools the updates point to
    bool everything = false;            // the copy starts from nothing
    std::uint32_t handles = 0;          // Document::handle_count
    std::vector<Update> updates;
    std::vector<scene::Mesh> meshes;              // added since the last change
    std::vector<scene::Texture> textures;         // likewise
    std::optional<gi::Settings> settings;         // where they changed
    std::shared_ptr<io::EncodedTextures> encoded; // the document's textures, for who saves them
    std::shared_ptr<const std::string> link;      // Document::source
    std::uint64_t revision = 0;                   // of the document
    std::uint64_t hiding = 0;                     // HiddenFilter::count
    bool dragged = false;                         // the gesture that it is of has not ended

    void add(SceneChange later);
    // It tells of no change of the scene, only, perhaps, of the end of a gesture.
    bool is_empty() const { return updates.empty() && meshes.empty() && textures.empty() && !settings && !everything; }
};

// Gathers what a document has not told yet.
class ChangeCollector {
public:
    // Nothing if nothing changed, and no gesture ended whose changes were collected before.
    std::optional<SceneChange> collect(const std::shared_ptr<Document>& document);
    // Everything there is, for a copy that knows nothing yet.
    static SceneChange everything(const std::shared_ptr<Document>& document);

    // Where a document is as it was told.
    static SceneChange nothing(const std::shared_ptr<Document>& document);

private:
    const Document* known_ = nullptr;
    std::uint64_t revision_ = 0, settings_revision_ = 0;
    std::uint32_t meshes_ = 0, textures_ = 0;
    bool dragged_ = false;
};

// Hides entities from copies that show the scene: they are told where those are, and nothing else. Of muted ones they
// are told everything but their light.
class HiddenFilter {
public:
    using Set = std::unordered_set<Entity>;
    // `change`: what the collector has found, if anything; then what a copy is to be told. Whatever was hidden or
    // muted, or is so no longer, since the last call is told with it, also where nothing else has changed.
    void apply(const std::shared_ptr<Document>& document, const Set& hidden, const Set& muted,
               std::optional<SceneChange>& change);
    static void hide(const Set& hidden, const Set& muted, SceneChange& change);
    // How often what is hidden or muted has changed: pictures of the same revision are of the same scene only if this
    // is the same, too.
    std::uint64_t count() const { return count_; }

private:
    Set hidden_, muted_;
    std::uint64_t count_ = 0;
};

// Brings a registry up to the document, under the same handles, which must have been reserved. Movers that have gone
// along their paths stand where they start again.
void apply_updates(const std::vector<Update>& updates, ecs::Registry& registry);

// The document's content alone, for threads that save it or trace rays in it.
struct PlainCopy {
    ecs::Registry registry;
    scene::MeshStore meshes;
    scene::TextureStore textures;
    gi::Settings settings;
    std::shared_ptr<io::EncodedTextures> encoded; // of `textures`
    std::shared_ptr<const std::string> link;      // Document::source

    void apply(const SceneChange& change);

private:
    std::uint32_t reserved_ = 0;
};

class SceneCopy {
public:
    // The device must outlive it.
    static Result<std::unique_ptr<SceneCopy>> create(gpu::Device& device);

    // Whether a change fits into this copy; if not, a new copy has to be made and told everything.
    bool takes(const SceneChange& change) const;
    Status apply(const SceneChange& change);
    viewer::SceneRenderer& renderer() { return *renderer_; }

private:
    SceneCopy() = default;
    std::unique_ptr<viewer::SceneRenderer> renderer_;
    std::uint32_t reserved_ = 0;
};

} // namespace sunfleck::editor
