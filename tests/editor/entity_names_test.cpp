// Names of other entities in components follow what is renamed and duplicated.
#include "editor/document/edits.h"
#include "engine/scene/simulation_components.h"

#include <gtest/gtest.h>

namespace sunfleck::editor {
namespace {

class EditorEntityNames : public testing::Test {
protected:
    EditorEntityNames() {
        door = add("Sliding door", "door");
        other = add("Sliding door", "door of another room");
        gauge = add("Sliding door", "gauge");
        eye = add("Light sensor", "eye");
        set(eye, "opens", "door, door of another room");
        set(eye, "shows", "gauge");
        lamp = add("Point light", "lamp");
        plate = add("Box", "switch");
        add_component(document, {plate}, pool_of<scene::LightSwitch>(document));
        const Field& lamps = *scene::LightSwitch::description().find("lamps");
        EXPECT_TRUE(edit_field(document, {plate}, pool_of<scene::LightSwitch>(document), lamps, "lamp"));
    }
    Entity add(std::string_view source_name, const std::string& name) {
        for (const scene::EntityTemplate& source : scene::entity_templates())
            if (source.name == source_name) {
                const Entity entity = add_from(document, source, vec3(0.0f), 1.0f);
                EXPECT_TRUE(rename(document, entity, name));
                return entity;
            }
        ADD_FAILURE() << "no template " << source_name;
        return {};
    }
    void set(Entity entity, std::string_view field, std::string_view text) {
        EXPECT_TRUE(edit_field(document, {entity}, pool_of<scene::LightSensor>(document),
                               *scene::LightSensor::description().find(field), text));
    }
    const scene::LightSensor& sensor(Entity entity) { return document.registry().get<scene::LightSensor>(entity); }
    const std::string& lamps(Entity entity) { return document.registry().get<scene::LightSwitch>(entity).lamps; }

    Document document;
    Entity door, other, gauge, eye, lamp, plate;
};

TEST_F(EditorEntityNames, FollowARename) {
    const std::size_t edits = document.history().entries().size();
    ASSERT_TRUE(rename(document, door, "gate"));
    EXPECT_EQ(sensor(eye).opens, "gate, door of another room");
    EXPECT_EQ(document.history().entries().size(), edits + 1) << "one edit";
    ASSERT_TRUE(rename(document, gauge, "bar"));
    EXPECT_EQ(sensor(eye).shows, "bar");
    ASSERT_TRUE(rename(document, lamp, "eye")); // which is taken
    EXPECT_EQ(lamps(plate), document.name(lamp));
    document.undo();
    document.undo();
    document.undo();
    EXPECT_EQ(sensor(eye).opens, "door, door of another room");
    EXPECT_EQ(sensor(eye).shows, "gauge");
    EXPECT_EQ(lamps(plate), "lamp");
}

// An eye with its door is a puzzle of its own; an eye alone is another one for the same door.
TEST_F(EditorEntityNames, FollowWhatIsDuplicatedWithThem) {
    const Entities both = duplicate(document, {eye, door, plate, lamp});
    ASSERT_EQ(both.size(), 4u);
    EXPECT_EQ(sensor(both[0]).opens, document.name(both[1]) + ", door of another room");
    EXPECT_EQ(sensor(both[0]).shows, "gauge");
    EXPECT_EQ(lamps(both[2]), document.name(both[3]));
    EXPECT_EQ(sensor(eye).opens, "door, door of another room");
    const Entities alone = duplicate(document, {eye});
    EXPECT_EQ(sensor(alone[0]).opens, sensor(eye).opens);
}

} // namespace
} // namespace sunfleck::editor
