// Tables of what the lighting keeps: shadow maps are drawn in the order that theirs says, pinned ones first, and what
// it says of a patch's light samples is what rays find.
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"
#include "viewer/pixel_report.h"

#include <algorithm>
#include <map>
#include <set>

namespace sunfleck {
namespace {

enum Column { map_age = 3, map_priority = 5, map_state = 6, between_state = 4, between_blockers = 5 };

class EditorListing : public tests::GpuTest {
protected:
    EditorListing() : world(assets::make_four_pillars, "bench_1") {
        gi::Settings settings;
        settings.lights = 200;
        settings.map_budget = 65536;
        world.set(settings);
        world.render();
        world.render();
    }
    gi::System& lighting() const { return world.renderer->lighting(); }
    gi::ListingContent maps() const {
        auto content = lighting().fill_listing("shadow_maps", nullptr);
        EXPECT_TRUE(content);
        return content ? *content : gi::ListingContent();
    }
    static double number(const gi::ListingRow& row, int column) {
        return std::get<double>(row.cells.at(std::size_t(column)));
    }
    static std::string text(const gi::ListingRow& row, int column) {
        return std::get<std::string>(row.cells.at(std::size_t(column)));
    }
    static std::vector<const gi::ListingRow*> stale(const gi::ListingContent& content) {
        std::vector<const gi::ListingRow*> result;
        for (const gi::ListingRow& row : content.rows)
            if (number(row, map_age) > 0.0)
                result.push_back(&row);
        std::sort(result.begin(), result.end(), [](const gi::ListingRow* a, const gi::ListingRow* b) {
            return number(*a, map_priority) > number(*b, map_priority);
        });
        return result;
    }
    tests::GpuWorld world;
};

TEST_F(EditorListing, EveryListingIsDeclaredAndFilled) {
    std::set<std::string_view> names;
    for (const gi::Listing* listing : gi::all_listings()) {
        SCOPED_TRACE(std::string(listing->name));
        EXPECT_TRUE(names.insert(listing->name).second) << "names are distinct";
        EXPECT_FALSE(listing->tooltip.empty());
        for (const gi::ListingColumn& column : listing->columns)
            EXPECT_FALSE(column.tooltip.empty()) << column.name;
        for (const gi::ListingAction& action : listing->actions)
            EXPECT_FALSE(action.tooltip.empty()) << action.name;
        const auto content = lighting().fill_listing(listing->name, nullptr);
        ASSERT_TRUE(content);
        EXPECT_FALSE(content->summary.empty());
        EXPECT_TRUE(!listing->of_place || content->rows.empty()) << "without a place there is nothing";
        for (const gi::ListingRow& row : content->rows)
            EXPECT_EQ(row.cells.size(), listing->columns.size());
    }
    EXPECT_FALSE(lighting().fill_listing("nothing", nullptr));
    EXPECT_FALSE(lighting().act("nothing", 0, 0, true));
}

TEST_F(EditorListing, MapsAreDrawnInItsOrderAndPinnedOnesFirst) {
    gi::ListingContent content = maps();
    ASSERT_EQ(content.rows.size(), lighting().samples().size());
    for (const gi::ListingRow& row : content.rows)
        EXPECT_EQ(number(row, map_age), 0.0) << "all are drawn";

    // Movers have moved, and nothing may be drawn: maps that show them age by a frame each.
    world.request.step = 40;
    world.request.map_budget = 0;
    world.render();
    content = maps();
    std::vector<const gi::ListingRow*> waiting = stale(content);
    ASSERT_EQ(waiting.size(), lighting().shadows().stale());
    ASSERT_GT(waiting.size(), 20u) << "else nothing has to wait";
    for (const gi::ListingRow* row : waiting) {
        EXPECT_EQ(number(*row, map_age), 1.0);
        EXPECT_EQ(text(*row, map_state), "stale");
    }
    // A budget at whose end the priorities differ, and a pin for the last map of all.
    std::size_t budget = 4;
    while (budget < 16 &&
           number(*waiting[budget - 2], map_priority) < 1.001 * number(*waiting[budget - 1], map_priority))
        ++budget;
    ASSERT_LT(budget, 16u);
    const std::uint32_t pinned = waiting.back()->key;
    std::set<std::uint32_t> wanted{pinned};
    for (std::size_t i = 0; i + 1 < budget; ++i)
        wanted.insert(waiting[i]->key);
    ASSERT_TRUE(lighting().act("shadow_maps", 0, pinned, true));
    const std::size_t before = waiting.size();
    world.request.map_budget = std::uint32_t(budget);
    world.render();
    content = maps();
    EXPECT_EQ(stale(content).size(), before - budget);
    for (const gi::ListingRow& row : content.rows) {
        EXPECT_EQ(row.on.at(0) != 0, row.key == pinned);
        EXPECT_TRUE(wanted.count(row.key) == 0 || number(row, map_age) == 0.0) << "map " << row.key << " had its turn";
    }
    for (const gi::ListingRow* row : stale(content))
        EXPECT_EQ(number(*row, map_age), 2.0);
}

// Of one map, which then is what it was: redrawing changes no picture.
TEST_F(EditorListing, AMapIsRedrawnOnRequest) {
    const io::Picture before = world.picture();
    EXPECT_EQ(world.renderer->statistics().counters["shadow_map_updates"], 0.0);
    const auto first_read = [&] {
        for (const gi::ListingRow& row : maps().rows)
            if (text(row, map_state) == "fresh")
                return row.key;
        ADD_FAILURE() << "nobody reads a map";
        return 0u;
    };
    ASSERT_TRUE(lighting().act("shadow_maps", 1, first_read(), false));
    const io::Picture after = world.picture();
    EXPECT_EQ(world.renderer->statistics().counters["shadow_map_updates"], 1.0);
    EXPECT_EQ(before.pixels, after.pixels);
}

TEST_F(EditorListing, APatchsSamplesAreAsRaysFindThem) {
    if (lighting().visibility().node_count() == 0)
        GTEST_SKIP() << "no technique in use asks for visibility";
    const raytrace::RayScene& rays = world.renderer->rays();
    const shared::CameraRow row = scene::make_camera_row(world.request.camera, 64, 48);
    std::map<std::string, int> counts;
    int places = 0, movers = 0;
    for (int x = -4; x <= 4; ++x)
        for (int y = -3; y <= 3; ++y) {
            const vec3 direction =
                vec3(row.forward) + 0.2f * float(x) * vec3(row.right) + 0.25f * float(y) * vec3(row.down);
            const auto place = viewer::place_in_view(*world.renderer, world.request.camera.position, direction);
            if (!place)
                continue;
            const auto content = lighting().fill_listing("visibility", &*place);
            ASSERT_TRUE(content);
            if (content->rows.empty())
                continue;
            ++places;
            ASSERT_EQ(content->rows.size(), lighting().samples().size());
            for (const gi::ListingRow& listed : content->rows) {
                const gi::LightSample& sample = lighting().samples()[*listed.sample];
                const std::string state = text(listed, between_state);
                const auto& blockers = std::get<std::vector<ecs::Entity>>(listed.cells[between_blockers]);
                ++counts[state];
                EXPECT_TRUE(blockers.empty() || state != "free");
                EXPECT_TRUE(!blockers.empty() || state == "free" || state == "behind" || place->point.on_mover);
                movers += int(std::count_if(blockers.begin(), blockers.end(),
                                            [](ecs::Entity entity) { return !entity.is_null(); }));
                if (sample.kind == gi::SampleKind::directional || (state != "free" && state != "hidden"))
                    continue;
                // From just above the surface to just before the sample.
                const vec3 from = place->point.position + 2.0f * place->point.offset * place->point.geometric_normal;
                const vec3 to = sample.position - from;
                const bool behind = sample.kind != gi::SampleKind::point && glm::dot(sample.normal, to) >= 0.0f;
                if (behind || glm::dot(place->point.geometric_normal, to) <= 0.0f)
                    continue; // a part of the patch may be; no light is lost there
                raytrace::Ray ray{from, to};
                ray.maximum = 0.999f;
                EXPECT_EQ(rays.occluded(ray), state == "hidden") << "sample " << *listed.sample;
            }
        }
    EXPECT_GT(places, 20);
    EXPECT_GT(counts["free"], 500);
    EXPECT_GT(counts["in part"], 20);
    EXPECT_GT(counts["hidden"], 20);
    EXPECT_GT(movers, 20) << "movers are named";
}

} // namespace
} // namespace sunfleck
