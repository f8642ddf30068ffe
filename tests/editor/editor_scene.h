// A scene that is drawn as the editor's viewport draws it, without a window.
#pragma once

#include "editor/window/scene_thread.h"
#include "test_places.h"
#include "tests/editor/random_edits.h"
#include "tests/support/folder.h"
#include "tests/support/gpu_world.h"
#include "tests/support/run_tool.h"
#include "tests/support/test_size.h"

#include <algorithm>
#include <chrono>

namespace sunfleck::editor {

namespace fs = std::filesystem;
using tests::by_size;
using Clock = std::chrono::steady_clock;
using Picture = std::shared_ptr<const ScenePicture>;

inline constexpr std::uint32_t width = 96, height = 64;
inline constexpr const char* camera_text = "2.75,2.75,13.25,2.75,2.75,2.75,39"; // of the scene below

class EditorScene : public tests::GpuTest {
protected:
    // A room with two blocks under a lamp.
    static std::shared_ptr<Document> open_scene() {
        auto opened = Document::open(fs::path(SUNFLECK_TOOL).parent_path() / "../scenes/cornell.scene.json");
        EXPECT_TRUE(opened);
        return opened ? std::shared_ptr<Document>(std::move(opened).value()) : nullptr;
    }
    static ViewRequest view(Document& document) {
        ViewRequest request;
        request.width = width;
        request.height = height;
        request.read_back = true;
        const Bounds anywhere{vec3(-1.0f), vec3(1.0f)};
        request.camera = viewer::find_camera(document.registry(), anywhere, camera_text).value();
        return request;
    }
    // Null if `wanted` does not come about.
    static Picture wait_for(const SceneThread& scene, const std::function<bool(const ScenePicture&)>& wanted) {
        for (const auto end = Clock::now() + std::chrono::seconds(120); Clock::now() < end;) {
            if (Picture picture = scene.picture(); picture != nullptr && wanted(*picture))
                return picture;
            if (const std::string error = scene.status().error; !error.empty()) {
                ADD_FAILURE() << error;
                return nullptr;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        ADD_FAILURE() << "no such picture within two minutes";
        return nullptr;
    }
    static Picture settled(const SceneThread& scene, const Document& document) {
        return wait_for(scene, [&](const ScenePicture& picture) {
            return picture.settled && picture.pixels != nullptr && picture.revision == document.revision();
        });
    }
    // The room, of which `scene` shows all of its light by the time this returns. Null: a failure that has been said.
    static std::shared_ptr<Document> show_room(SceneThread& scene, ChangeCollector& collector) {
        const std::shared_ptr<Document> document = open_scene();
        if (document == nullptr)
            return nullptr;
        scene.change(*collector.collect(document));
        scene.show(view(*document));
        return settled(scene, *document) != nullptr ? document : nullptr;
    }
    static Picture from_nothing(const std::shared_ptr<Document>& document) {
        return alone(document, document->settings(), view(*document));
    }
    // As a start with these settings shows it.
    static Picture alone(const std::shared_ptr<Document>& document, const gi::Settings& settings,
                         const ViewRequest& request) {
        SceneThread scene(tests::device(), [] {});
        SceneChange all = ChangeCollector::everything(document);
        all.settings = settings;
        scene.change(std::move(all));
        scene.show(request);
        return settled(scene, *document);
    }
    static std::size_t differing(const io::Picture& a, const io::Picture& b) {
        std::size_t count = a.pixels.size() == b.pixels.size() ? 0 : 1;
        for (std::size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i)
            count += vec3(a.pixels[i]) != vec3(b.pixels[i]) ? 1 : 0;
        return count;
    }
    const tests::Folder folder_{"editor_scene"};
};

} // namespace sunfleck::editor
