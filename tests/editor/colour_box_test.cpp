// Colours of light: as temperatures, in photometric units, and in the popup, where what is given up leaves no trace.
#include "editor/window/colour_box.h"

#include "engine/io/gltf.h"
#include "tests/editor/panel_fixture.h"

namespace sunfleck::editor {
namespace {

// CIE 1931.
glm::dvec2 xy_of(vec3 rgb) {
    const double x = 0.4124564 * double(rgb.x) + 0.3575761 * double(rgb.y) + 0.1804375 * double(rgb.z);
    const double y = 0.2126729 * double(rgb.x) + 0.7151522 * double(rgb.y) + 0.0721750 * double(rgb.z);
    const double z = 0.0193339 * double(rgb.x) + 0.1191920 * double(rgb.y) + 0.9503041 * double(rgb.z);
    return glm::dvec2(x, y) / (x + y + z);
}

// The Planckian locus as it is tabulated (Wyszecki and Stiles, "Color Science", 1982, table 1(3.3.4)).
TEST(EditorColour, BlackBodiesLieOnThePlanckianLocus) {
    const struct {
        float kelvin;
        glm::dvec2 xy;
    } table[] = {{2000.0f, {0.5267, 0.4133}}, {2500.0f, {0.4770, 0.4137}},  {3000.0f, {0.4369, 0.4041}},
                 {4000.0f, {0.3805, 0.3768}}, {5000.0f, {0.3451, 0.3516}},  {6000.0f, {0.3221, 0.3318}},
                 {6500.0f, {0.3135, 0.3237}}, {10000.0f, {0.2807, 0.2884}}, {20000.0f, {0.2565, 0.2577}}};
    for (const auto& row : table) {
        const vec3 colour = black_body_colour(row.kelvin);
        EXPECT_LT(glm::length(xy_of(colour) - row.xy), 0.001) << row.kelvin << " K";
        EXPECT_FLOAT_EQ(std::max({colour.x, colour.y, colour.z}), 1.0f);
    }
    EXPECT_EQ(black_body_colour(100.0f), black_body_colour(coldest_body)) << "as far as the fit goes";
}

TEST(EditorColour, TheTemperatureOfABlackBodysColourIsItsOwn) {
    for (float kelvin = coldest_body; kelvin <= hottest_body; kelvin *= 1.037f)
        for (const float intensity : {1e-3f, 1.0f, 4e4f}) {
            const std::optional<float> found = colour_temperature(intensity * black_body_colour(kelvin));
            ASSERT_TRUE(found) << kelvin;
            EXPECT_NEAR(*found, kelvin, 1e-3f * kelvin);
        }
    EXPECT_NEAR(colour_temperature(vec3(1.0f)).value_or(0.0f), 6504.0f, 10.0f) << "the white of Rec. 709";
    for (const vec3 colour : {vec3(0.0f), vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1), vec3(1, 0, 1)})
        EXPECT_FALSE(colour_temperature(colour)) << "no black body has it";
}

TEST(EditorColour, UnitsOfLightHavePhotometricOnes) {
    std::map<std::string, std::string> found;
    ecs::Registry registry;
    scene::register_components(registry);
    for (const ecs::PoolBase* pool : registry.described_pools())
        for (const Field& field : pool->description()->fields)
            if (field.unit.find('W') == 0)
                found[std::string(field.unit)] = photometric_unit(field.unit);
    EXPECT_EQ(found,
              (std::map<std::string, std::string>{{"W/sr", "cd"}, {"W/m2", "lx"}, {"W/(sr m2)", "cd/m\xc2\xb2"}}));
    EXPECT_EQ(photometric_unit("m"), "");
}

class EditorColourBox : public PanelTest {
protected:
    EditorColourBox() {
        lamp_ = add("Point light");
        set(vec3(40.0f));
        entries_ = document().history().entries().size();
        click(box_ + "colour");
    }
    vec3 now() { return document().registry().get<scene::PointLight>(lamp_).intensity; }
    void set(vec3 value) { set_of(lamp_, value); }
    void set_of(Entity lamp, vec3 value) {
        document().begin("Set");
        auto light = document().registry().get<scene::PointLight>(lamp);
        light.intensity = value;
        document().set(lamp, pool_of<scene::PointLight>(document()), std::make_shared<scene::PointLight>(light));
        document().commit();
    }
    std::size_t new_entries() { return document().history().entries().size() - entries_; }
    bool is_open() const { return find(box_ + "picker") != nullptr; }
    std::string shown(const std::string& row) const { return value(box_ + row); }
    // Held, and moved so far that it is a drag.
    void begin_drag(const std::string& row) {
        ASSERT_NO_FATAL_FAILURE(point_at(box_ + row));
        press();
        move(vec2(20.0f, 0.0f));
        move(vec2(20.0f, 0.0f));
    }

    const std::string box_ = "inspector/PointLight/intensity/";
    Entity lamp_;
    std::size_t entries_ = 0;
};

TEST_F(EditorColourBox, ShowsAmountsInAllUnits) {
    frames(3);
    const double lumens = double(io::luminous_efficacy);
    EXPECT_EQ(shown("Intensity"), "40");
    EXPECT_EQ(shown("Photometric"), ui::number_text(40.0 * lumens, false));
    EXPECT_EQ(shown("Flux"), ui::number_text(40.0 * lumens * 4.0 * 3.14159265358979, false));
    ASSERT_NO_FATAL_FAILURE(enter(box_ + "Flux", "800"));
    EXPECT_NEAR(double(now().x), 800.0 / lumens / 4.0 / 3.14159265358979, 1e-6);
    ASSERT_NO_FATAL_FAILURE(enter(box_ + "Photometric", "1366"));
    EXPECT_NEAR(double(now().x), 1366.0 / lumens, 1e-6);
    ASSERT_NO_FATAL_FAILURE(enter(box_ + "Intensity", "7"));
    EXPECT_EQ(now(), vec3(7.0f));
    EXPECT_EQ(new_entries(), 3u);
}

TEST_F(EditorColourBox, WhatIsNoNumberIsSaidAndChangesNothing) {
    for (const char* row : {"Intensity", "Photometric", "Flux", "Temperature"})
        for (const char* bad : {"abc", "nan", "inf", "-1", "5 K", "1e30"}) {
            SCOPED_TRACE(std::string(row) + " " + bad);
            const std::uint64_t said = session_.messages.count();
            ASSERT_NO_FATAL_FAILURE(enter(box_ + row, bad));
            EXPECT_EQ(now(), vec3(40.0f));
            EXPECT_EQ(session_.messages.count(), said + 1);
            EXPECT_NE(newest_message().find("'" + std::string(bad) + "' is not a value of '" + row + "'"),
                      std::string::npos)
                << newest_message();
        }
    ASSERT_NO_FATAL_FAILURE(enter(box_ + "Temperature", "900")); // what the fit does not reach is not made another one
    EXPECT_EQ(now(), vec3(40.0f));
    EXPECT_NE(newest_message().find("1667 to 25000 K"), std::string::npos) << newest_message();
    EXPECT_EQ(new_entries(), 0u);
    EXPECT_TRUE(is_open());
}

TEST_F(EditorColourBox, TheTemperatureIsTheLampsOwn) {
    frames(3);
    EXPECT_EQ(shown("Temperature"), ui::number_text(double(*colour_temperature(vec3(1.0f))), true));
    ASSERT_NO_FATAL_FAILURE(enter(box_ + "Temperature", "2700"));
    EXPECT_EQ(shown("Temperature"), "2700");
    EXPECT_NEAR(std::max({now().x, now().y, now().z}), 40.0f, 1e-4f) << "as bright as before";
    set(vec3(0.0f, 9.0f, 0.0f));
    frames(3);
    EXPECT_EQ(shown("Temperature"), "none") << "of a green one";
    set(40.0f * black_body_colour(5500.0f));
    frames(3);
    EXPECT_EQ(shown("Temperature"), "5500");
}

// A red lamp and a blue one, twice as bright: each keeps what is not changed.
TEST_F(EditorColourBox, SeveralLampsKeepWhatIsNotChanged) {
    const Entity other = add("Point light");
    const auto set_both = [&] {
        set(vec3(40.0f, 0.0f, 0.0f));
        set_of(other, vec3(0.0f, 0.0f, 80.0f));
        document().select({lamp_, other});
        frames(3);
    };
    const auto others = [&] { return document().registry().get<scene::PointLight>(other).intensity; };
    set_both();
    if (!is_open()) {
        ASSERT_NO_FATAL_FAILURE(click(box_ + "colour"));
    }
    frames(3);
    EXPECT_EQ(shown("Intensity"), "mixed");
    ASSERT_NO_FATAL_FAILURE(enter(box_ + "Intensity", "5"));
    EXPECT_EQ(now(), vec3(5.0f, 0.0f, 0.0f));
    EXPECT_EQ(others(), vec3(0.0f, 0.0f, 5.0f));

    set_both();
    ASSERT_NO_FATAL_FAILURE(enter(box_ + "Temperature", "2700"));
    EXPECT_NEAR(glm::length(now() - 40.0f * black_body_colour(2700.0f)), 0.0f, 1e-3f);
    EXPECT_NEAR(glm::length(others() - 80.0f * black_body_colour(2700.0f)), 0.0f, 1e-3f);
    frames(2);
    EXPECT_EQ(shown("Temperature"), "2700") << "both have it";

    // A drag: one entry, from each one's own colour, also where it passes zero.
    set_both();
    ASSERT_NO_FATAL_FAILURE(point_at(box_ + "Intensity"));
    press();
    for (const float by : {-60.0f, -2000.0f, 2300.0f})
        move(vec2(by, 0.0f));
    EXPECT_GT(now().x, 0.0f);
    EXPECT_EQ(vec3(now().x, 0.0f, 0.0f), now());
    EXPECT_EQ(vec3(0.0f, 0.0f, now().x), others());
    ASSERT_NO_FATAL_FAILURE(key("Escape"));
    let_go();
    EXPECT_EQ(now(), vec3(40.0f, 0.0f, 0.0f));
    EXPECT_EQ(others(), vec3(0.0f, 0.0f, 80.0f));

    // Another hue.
    ASSERT_NO_FATAL_FAILURE(begin_drag("picker"));
    let_go();
    frames(2);
    const auto brightest = [](vec3 colour) { return std::max({colour.x, colour.y, colour.z}); };
    EXPECT_NEAR(brightest(now()), 40.0f, 1e-3f);
    EXPECT_NEAR(brightest(others()), 80.0f, 1e-3f);
    EXPECT_NEAR(glm::length(2.0f * now() - others()), 0.0f, 1e-2f) << "and the same for both";
}

TEST_F(EditorColourBox, ADragIsOneEntry) {
    for (const char* row : {"Intensity", "Temperature", "picker"}) {
        SCOPED_TRACE(row);
        const vec3 before = now();
        const std::size_t entries = new_entries();
        ASSERT_NO_FATAL_FAILURE(begin_drag(row));
        EXPECT_NE(now(), before);
        EXPECT_TRUE(document().in_gesture());
        let_go();
        frames(2);
        EXPECT_FALSE(document().in_gesture());
        EXPECT_EQ(new_entries(), entries + 1);
        EXPECT_NE(now(), before);
    }
}

TEST_F(EditorColourBox, EscapeTakesADragBackAndLeavesThePopup) {
    for (const char* row : {"Intensity", "Photometric", "Flux", "Temperature", "picker"}) {
        SCOPED_TRACE(row);
        ASSERT_NO_FATAL_FAILURE(begin_drag(row));
        EXPECT_NE(now(), vec3(40.0f));
        ASSERT_NO_FATAL_FAILURE(key("Escape"));
        EXPECT_EQ(now(), vec3(40.0f));
        move(vec2(15.0f, 4.0f));
        let_go();
        frames(3);
        EXPECT_EQ(now(), vec3(40.0f));
        EXPECT_FALSE(document().in_gesture());
        EXPECT_EQ(new_entries(), 0u);
        EXPECT_TRUE(is_open());
    }
    ASSERT_NO_FATAL_FAILURE(key("Escape"));
    frames(2);
    EXPECT_FALSE(is_open()) << "once more closes it";
}

TEST_F(EditorColourBox, WhateverEndsADragLeavesNoTrace) {
    for (const char* row : {"Intensity", "picker"}) {
        SCOPED_TRACE(row);
        ASSERT_NO_FATAL_FAILURE(begin_drag(row));
        EXPECT_NE(now(), vec3(40.0f));
        input_.focused = false; // whoever is elsewhere holds nothing
        input_.mouse_buttons[0] = false;
        frames(3);
        input_.focused = true;
        frames(3);
        EXPECT_EQ(now(), vec3(40.0f));
        EXPECT_FALSE(document().in_gesture());
        EXPECT_EQ(new_entries(), 0u);
        if (!is_open()) {
            ASSERT_NO_FATAL_FAILURE(click(box_ + "colour"));
        }
    }
    // The panel with the box goes while it is dragged.
    ASSERT_NO_FATAL_FAILURE(begin_drag("picker"));
    session_.front = "Lighting";
    frames(3);
    let_go();
    frames(3);
    EXPECT_EQ(now(), vec3(40.0f));
    EXPECT_FALSE(document().in_gesture());
    EXPECT_EQ(new_entries(), 0u);
}

} // namespace
} // namespace sunfleck::editor
