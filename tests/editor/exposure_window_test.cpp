// How bright the viewport is: a scene that begins in the dark is exposed by its first light, then left alone until
// somebody asks.
#include "tests/editor/editor_scene.h"
#include "viewer/exposure.h"

namespace sunfleck::editor {
namespace {

class EditorExposure : public EditorScene {
protected:
    Entity add(std::string_view name, vec3 place) {
        for (const scene::EntityTemplate& source : scene::entity_templates())
            if (source.name == name)
                return add_from(*document_, source, place, 1.0f);
        ADD_FAILURE() << "no template " << name;
        return {};
    }
    void tell() { scene_.change(*collector_.collect(document_)); }
    float exposure() {
        const Picture picture = settled(scene_, *document_);
        return picture != nullptr ? picture->ev100 : 99.0f;
    }
    void set_intensity(Entity lamp, const char* value) {
        ecs::PoolBase& lights = pool_of<scene::PointLight>(*document_);
        ASSERT_TRUE(edit_field(*document_, {lamp}, lights, *lights.description()->find("intensity"), value));
    }

    SceneThread scene_{tests::device(), [] {}};
    ChangeCollector collector_;
    std::shared_ptr<Document> document_ = std::make_shared<Document>();
};

TEST_F(EditorExposure, FollowsTheFirstLightOfAScene) {
    add("Box", vec3(0.0f));
    ViewRequest request;
    request.width = width;
    request.height = height;
    request.read_back = true;
    request.camera.position = vec3(0.0f, 2.0f, 5.0f);
    request.camera.target = vec3(0.0f);
    tell();
    scene_.show(request);
    EXPECT_EQ(exposure(), viewer::default_exposure) << "there is nothing to go by";
    const Entity lamp = add("Point light", vec3(1.0f, 3.0f, 2.0f));
    ASSERT_NO_FATAL_FAILURE(set_intensity(lamp, "0.01,0.01,0.01"));
    tell();
    const float dim = exposure();
    EXPECT_LT(dim, 2.0f) << "by the light that has come";

    ASSERT_NO_FATAL_FAILURE(set_intensity(lamp, "10,10,10"));
    tell();
    EXPECT_EQ(exposure(), dim) << "who turns a lamp up sees it";
    request.exposures = 1;
    scene_.show(request);
    EXPECT_NE(wait_for(scene_, [&](const ScenePicture& one) { return one.settled && one.ev100 > dim + 8.0f; }), nullptr)
        << "a thousand times as much light are ten stops";
    request.ev100 = 4.5f;
    scene_.show(request);
    EXPECT_NE(wait_for(scene_, [&](const ScenePicture& one) { return one.settled && one.ev100 == 4.5f; }), nullptr);
}

} // namespace
} // namespace sunfleck::editor
