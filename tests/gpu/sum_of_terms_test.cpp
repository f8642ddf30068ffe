// Light is a sum over the cells of the light plan: each cell alone, added up, gives what all cells give together, and
// every assignment of techniques to cells gives the picture of the baseline.
#include "editor/command_line/metrics.h"
#include "tests/support/gpu_world.h"
#include "tests/support/techniques.h"
#include "tests/support/test_size.h"

#include <algorithm>

namespace sunfleck::tests {
namespace {

struct Assignment {
    std::string name;
    std::string direct, indirect, movers = "per_pixel", plan = "", punctual = "";
};

bool lights_all_receivers(const gi::TechniqueEntry& technique) {
    return technique.supports == nullptr && (gi::all_diffuse_cells() & ~technique.can_light).none();
}

bool lights_punctual_only(const gi::TechniqueEntry& technique) {
    const gi::CellSet punctual =
        gi::cells_where([](gi::LightCell cell) { return cell.path == gi::PathPart::punctual; });
    return (technique.can_light & ~punctual).none();
}

// Two techniques in all the ways that they can share the light by path, by what moves and by receiver.
void add_pair(std::vector<Assignment>& list, const std::string& a, const std::string& b) {
    const std::string pair = a + " and " + b;
    list.push_back({"direct and indirect, " + pair, a, b});
    list.push_back({"fixed and dynamic, " + pair, a, a, "per_pixel", "dynamic=" + b});
    list.push_back({"on fixed and on movers, " + pair, a, a, "per_pixel", "on_mover=" + b});
    list.push_back({"up to the first bounce and later, " + pair, a, a, "per_pixel", "later_bounces=" + b});
}

// Everything that the plan allows of the techniques that there are.
std::vector<Assignment> all_assignments() {
    std::vector<Assignment> list;
    for (const gi::TechniqueEntry& a : gi::techniques()) {
        if (!lights_all_receivers(a))
            continue;
        list.push_back({"all by " + std::string(a.name), std::string(a.name), std::string(a.name)});
        for (const gi::TechniqueEntry& b : gi::techniques())
            if (lights_all_receivers(b) && a.name != b.name)
                add_pair(list, std::string(a.name), std::string(b.name));
        for (const gi::TechniqueEntry& b : gi::techniques())
            if (lights_punctual_only(b))
                list.push_back({"punctual by " + std::string(b.name) + ", " + std::string(a.name), std::string(a.name),
                                std::string(a.name), "per_pixel", "", std::string(b.name)});
    }
    const std::size_t without_movers = list.size();
    for (const gi::TechniqueEntry& technique : gi::techniques())
        for (std::size_t i = 0; technique.supports != nullptr && i < without_movers; ++i) {
            Assignment with = list[i];
            with.name += "; movers by " + std::string(technique.name);
            with.movers = technique.name;
            // Movers of the plan's exceptions would be taken from the technique that has them all.
            if (with.plan.empty())
                list.push_back(with);
        }
    return list;
}

gi::Settings settings_of(const Assignment& assignment) {
    gi::Settings settings;
    settings.lights = 60;
    settings.low_resolution = 1;
    settings.map_budget = 65536;
    settings.shadow_map_resolution = 128;
    settings.map_detail = false; // the maps of all assignments are the same
    settings.with("sampled_light", "all");
    settings.with("direct", assignment.direct).with("indirect", assignment.indirect);
    settings.with("punctual", assignment.punctual.empty() ? assignment.direct : assignment.punctual);
    settings.with("movers", assignment.movers).with("plan", assignment.plan);
    return settings;
}

gi::Settings baseline() {
    return settings_of({"", "brute_force", "brute_force"});
}

std::string name_of(std::int32_t technique) {
    return technique == gi::nobody ? "none" : std::string(gi::techniques()[std::size_t(technique)].name);
}

// One cell as the plan gives it to its owner (and to the fallback), all others nobody's.
gi::Settings alone(gi::Settings settings, gi::LightCell cell) {
    const gi::LightPlan plan = settings.light_plan().value();
    const std::int32_t owner = plan.owner(cell), fallback = plan.fallback(cell);
    const bool shares = owner != gi::nobody && gi::techniques()[std::size_t(owner)].supports != nullptr;
    const std::string term = name_of(shares ? fallback : owner);
    settings.with("punctual", cell.path == gi::PathPart::punctual ? term : "none");
    if (cell.path != gi::PathPart::punctual)
        settings.with("direct", term).with("indirect", term);
    if (!shares && settings.movers != gi::movers_static)
        settings.with("movers", "per_pixel");
    settings.plan.clear();
    for (std::size_t i = 0; i < gi::light_cell_count; ++i)
        if (const gi::LightCell other = gi::LightCell::at(i); !other.specular && other.index() != cell.index())
            settings.plan += (settings.plan.empty() ? "" : ",") + other.name() + "=none";
    return settings;
}

class SumOfTerms : public GpuTest {
protected:
    void open(void (*make)(assets::SceneBuilder&)) {
        world = std::make_unique<GpuWorld>(make, "view");
        world->request.width = 96;
        world->request.height = 72;
    }
    // The picture at a step, reached in motion, once nothing is left to do: light that is baked over several frames is
    // there, and samples are where movers have taken them.
    io::Picture picture(const gi::Settings& settings, std::uint64_t step) {
        world->set(settings);
        world->request.step = step - std::min<std::uint64_t>(step, 1);
        world->render();
        world->request.step = step;
        for (int frame = 0; frame < 60; ++frame) {
            world->render();
            const gi::Report& counters = world->renderer->lighting().counters();
            if (counters["baked_light_waiting"] == 0.0 && counters["light_samples_behind"] == 0.0)
                break;
        }
        return world->picture();
    }
    io::Picture sum_of_cells(const gi::Settings& settings, std::uint64_t step) {
        const gi::LightPlan plan = settings.light_plan().value();
        io::Picture sum;
        for (std::size_t i = 0; i < gi::light_cell_count; ++i) {
            const gi::LightCell cell = gi::LightCell::at(i);
            if (plan.owner(cell) == gi::nobody)
                continue;
            const gi::Settings one = alone(settings, cell);
            EXPECT_TRUE(one.validate()) << cell.name();
            const io::Picture part = picture(one, step);
            if (sum.pixels.empty())
                sum = part;
            else
                for (std::size_t p = 0; p < sum.pixels.size(); ++p)
                    sum.pixels[p] += vec4(vec3(part.pixels[p]), 0.0f);
        }
        return sum;
    }
    static double error(const io::Picture& a, const io::Picture& b) {
        return command_line::compare_pictures(a, b, true).relative_mean_square_error;
    }

    std::unique_ptr<GpuWorld> world;
};

bool uses_partial_technique(const gi::Settings& settings) {
    const gi::LightPlan plan = settings.light_plan().value();
    for (std::size_t i = 0; i < gi::techniques().size(); ++i)
        if (gi::techniques()[i].supports != nullptr && plan.uses(std::int32_t(i)))
            return true;
    return false;
}

// Baked light is left out: where it replaces samples is decided by how smooth the light to be baked is, and the light
// of one cell is smoother than that of all. Transfer cuts negative light (ringing) at each vertex: each cell's alone is
// more.
double allowed_sum_error(const gi::Settings& settings) {
    return uses_partial_technique(settings) ? 5e-5 : 1e-6;
}

// Relative MSE of irradiance to the baseline, of the many-light system alone and with transfer for movers, as measured
// before light was a sum of terms (60 samples, 96x72 pixels, maps of 128 texels; greatest of the steps), plus 2 %.
// In the furnace the error of one set of samples is anywhere between 5e-5 and 8e-4, so the mean over 8 seeds is judged,
// as measured with samples placed as they are now. (Rendered by the tool, the mean is 1.75e-4; before: 2.3e-4.)
// What transfer cuts of near light in lantern_house depends on the samples as well: over 24 seeds 1.6e-4 (standard
// error 0.15e-4) before, 1.9e-4 (0.15e-4) as they are placed now; that of its own seed was measured again.
struct Scene {
    const char* name;
    void (*make)(assets::SceneBuilder&);
    std::vector<std::uint64_t> steps;
    double many_light, with_transfer;
    std::uint32_t seeds; // whose errors' mean is compared
};
const Scene all_scenes[] = {{"furnace", assets::make_furnace, {0}, 2.28e-4, 2.28e-4, 8},
                            {"four_pillars", assets::make_four_pillars, {0, 20, 75}, 7.15e-5, 2.75e-3, 1},
                            {"arena", assets::make_arena, {0, 20, 75}, 1.36e-5, 1.73e-4, 1},
                            {"lantern_house", assets::make_lantern_house, {0, 20, 75}, 1.21e-4, 2.27e-4, 1}};

// With the light of two techniques a share of it is smoother than all is, so more of it is interpolated.
double allowed_baseline_error(const Scene& scene, const Assignment& assignment, const gi::Settings& settings) {
    constexpr double shared_light = 5e-5;
    if (uses_partial_technique(settings))
        return scene.with_transfer;
    return assignment.plan.empty() ? scene.many_light : std::max(scene.many_light, shared_light);
}

class SumOfTermsOf : public SumOfTerms, public testing::WithParamInterface<std::size_t> {
protected:
    double baseline_error(const Scene& scene, gi::Settings settings, std::uint64_t step) {
        if (scene.seeds == 1)
            return error(picture(settings, step), picture(baseline(), step));
        const std::uint32_t seeds = long_size() ? scene.seeds : 1;
        gi::Settings reference = baseline();
        double sum = 0.0;
        for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
            settings.seed = reference.seed = seed;
            sum += error(picture(settings, step), picture(reference, step));
        }
        return sum / seeds;
    }
    void check(const Scene& scene, const Assignment& assignment, std::uint64_t step) {
        const std::string what = std::string(scene.name) + " " + std::to_string(step) + ": " + assignment.name;
        const gi::Settings settings = settings_of(assignment);
        ASSERT_TRUE(settings.validate()) << what;
        gi::Settings exact = settings;
        set_if_known(exact, "baked_light", "off");
        const double sum = error(sum_of_cells(exact, step), picture(exact, step));
        EXPECT_LT(sum, allowed_sum_error(settings)) << what;
        std::printf("%-70s sum %.1e", what.c_str(), sum);
        if (!has_technique("brute_force") ||
            !assignment.punctual.empty()) { // whose maps are others than the baseline's
            std::printf("\n");
            return;
        }
        const double off = baseline_error(scene, settings, step);
        EXPECT_LE(off, allowed_baseline_error(scene, assignment, settings)) << what;
        std::printf(", to the baseline %.1e\n", off);
    }
};

// Short: two assignments (two techniques; with a technique for movers; of lantern_house the latter), one step in
// motion.
TEST_P(SumOfTermsOf, CellsAddUpToThePicture) {
    const Scene& scene = all_scenes[GetParam()];
    open(scene.make);
    std::vector<Assignment> assignments = all_assignments();
    ASSERT_FALSE(assignments.empty());
    if (!long_size() && assignments.size() > 3)
        assignments = {assignments[1], assignments.back()};
    std::vector<std::uint64_t> steps = scene.steps;
    if (!long_size()) {
        steps = {steps.back()};
        if (scene.make == assets::make_lantern_house) // the largest: the other scenes have both
            assignments = {assignments.back()};
    }
    for (const Assignment& assignment : assignments)
        for (const std::uint64_t step : steps)
            check(scene, assignment, step);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SumOfTermsOf, testing::Range(std::size_t(0), std::size(all_scenes)),
                         [](const auto& instance) { return std::string(all_scenes[instance.param].name); });

// Without light maps and baked light, what is left is who counts a sample as free of occluders: 2e-5, as before.
TEST_F(SumOfTerms, WithoutTexturesOfLightTheBaselineIsNearer) {
    if (!has_technique("light_samples") || !has_technique("brute_force"))
        GTEST_SKIP() << "both techniques are compared";
    open(assets::make_four_pillars);
    gi::Settings settings = settings_of({"", "light_samples", "light_samples"});
    settings.with("light_maps", "off").with("baked_light", "off");
    for (const std::uint64_t step : {std::uint64_t(0), std::uint64_t(75)}) {
        const double off = error(picture(settings, step), picture(baseline(), step));
        std::printf("step %d: %.1e\n", int(step), off);
        EXPECT_LE(off, 2.2e-5);
    }
}

// The baseline reads maps of movers in full detail, whoever else reads them, from the frame on in which it is chosen.
TEST_F(SumOfTerms, TheBaselineReadsMapsInFullDetail) {
    if (!has_technique("light_samples") || !has_technique("brute_force"))
        GTEST_SKIP() << "both techniques are compared";
    open(assets::make_four_pillars);
    gi::Settings simplified = settings_of({"", "light_samples", "light_samples"});
    simplified.map_detail = true;
    gi::Settings mixed = settings_of({"", "light_samples", "brute_force"});
    mixed.map_detail = true;
    EXPECT_GT(error(picture(simplified, 75), picture(baseline(), 75)), 2e-4) << "nothing is simplified here";
    picture(simplified, 75);
    EXPECT_LE(error(picture(mixed, 75), picture(baseline(), 75)), 7.15e-5);
}

} // namespace
} // namespace sunfleck::tests
