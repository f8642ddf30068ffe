// The plan of light terms: every cell has one owner, and what is refused is refused with one message.
#include "gi_module/settings.h"
#include "gi_module/technique.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <set>

namespace sunfleck::gi {
namespace {

const CellSet diffuse = all_diffuse_cells();
const CellSet on_movers = cells_where([](LightCell cell) { return cell.on_mover && !cell.specular; });
const CellSet punctual_cells =
    cells_where([](LightCell cell) { return cell.path == PathPart::punctual && !cell.specular; });
const std::vector<PlannedTechnique> four = {
    {"many", diffuse}, {"brute", diffuse}, {"prt", on_movers, true}, {"sharp", punctual_cells}};
constexpr std::int32_t many_light = 0, brute = 1, prt = 2, sharp = 3;

LightPlan plan_of(const TermOwners& terms) {
    const Result<LightPlan> plan = LightPlan::make(terms, four);
    EXPECT_TRUE(plan) << (plan ? "" : plan.error().message);
    return plan ? *plan : LightPlan();
}

std::string refusal_of(const TermOwners& terms) {
    const Result<LightPlan> plan = LightPlan::make(terms, four);
    EXPECT_FALSE(plan);
    return plan ? "" : plan.error().message;
}

TEST(LightPlan, CellsAreDistinctAndNamed) {
    std::set<std::string> names;
    for (std::size_t i = 0; i < light_cell_count; ++i) {
        EXPECT_EQ(LightCell::at(i).index(), i);
        names.insert(LightCell::at(i).name());
    }
    EXPECT_EQ(names.size(), light_cell_count);
}

// All choices of terms: each diffuse cell belongs to the technique of its term.
TEST(LightPlan, TermsOwnTheirCells) {
    for (const std::int32_t direct : {nobody, many_light, brute})
        for (const std::int32_t indirect : {nobody, many_light, brute})
            for (const std::int32_t punctual : {nobody, brute, sharp})
                for (const std::int32_t movers : {nobody, prt}) {
                    const LightPlan plan = plan_of({punctual, direct, indirect, nobody, movers});
                    for (std::size_t i = 0; i < light_cell_count; ++i) {
                        const LightCell cell = LightCell::at(i);
                        const std::int32_t base = cell.specular                     ? nobody
                                                  : cell.path == PathPart::punctual ? punctual
                                                  : cell.path == PathPart::direct   ? direct
                                                                                    : indirect;
                        const bool taken = cell.on_mover && movers == prt && base != nobody;
                        EXPECT_EQ(plan.owner(cell), taken ? prt : base) << cell.name();
                        EXPECT_EQ(plan.fallback(cell), taken ? base : nobody) << cell.name();
                    }
                }
}

// Every single cell can be somebody's, everything else nobody's.
TEST(LightPlan, SingleCells) {
    for (std::size_t i = 0; i < light_cell_count; ++i) {
        const LightCell cell = LightCell::at(i);
        const std::string exception = cell.name() + "=brute";
        const TermOwners terms{nobody, nobody, nobody, nobody, nobody, exception};
        if (cell.specular) {
            EXPECT_NE(refusal_of(terms).find("brute cannot light " + cell.name()), std::string::npos);
            continue;
        }
        const LightPlan plan = plan_of(terms);
        EXPECT_EQ(plan.lit_by(brute).count(), 1u);
        EXPECT_EQ(plan.owner(cell), brute);
        EXPECT_FALSE(plan.uses(many_light));
    }
}

TEST(LightPlan, ExceptionsAndRefusals) {
    const LightPlan plan = plan_of(
        {many_light, many_light, many_light, nobody, nobody, "indirect.dynamic=brute,later_bounces.fixed=none"});
    EXPECT_EQ(plan.owner({PathPart::first_bounce, true, false, false}), brute);
    EXPECT_EQ(plan.owner({PathPart::first_bounce, false, true, false}), many_light);
    EXPECT_EQ(plan.owner({PathPart::later_bounces, false, true, false}), nobody);
    EXPECT_NE(refusal_of({many_light, many_light, many_light, nobody, nobody, "direct=brute,direct.dynamic=none"})
                  .find("two owners"),
              std::string::npos);
    EXPECT_NE(refusal_of({many_light, many_light, many_light, nobody, nobody, "direct=torch"})
                  .find("no technique is called 'torch'"),
              std::string::npos);
    EXPECT_NE(refusal_of({many_light, many_light, many_light, nobody, nobody, "sideways=brute"})
                  .find("'sideways' is not a part"),
              std::string::npos);
    EXPECT_NE(refusal_of({many_light, many_light, many_light, nobody, nobody, "direct.on_fixed=prt"})
                  .find("prt cannot light"),
              std::string::npos);
    EXPECT_NE(
        refusal_of({many_light, many_light, many_light, nobody, nobody, "direct.on_mover=none"}).find("same paths"),
        std::string::npos);
    EXPECT_NE(refusal_of({many_light, many_light, many_light, nobody, nobody, "direct.on_mover=prt"})
                  .find("must own all light on movers"),
              std::string::npos);
}

// A technique's own setting comes after the terms, and before movers' techniques and exceptions.
TEST(LightPlan, CellsThatAreTaken) {
    const CellSet dynamic = cells_where(
        [](LightCell cell) { return cell.path == PathPart::first_bounce && cell.dynamic && !cell.specular; });
    const std::vector<TakenCells> taken = {{brute, dynamic}};
    TermOwners terms{many_light, many_light, many_light, nobody, nobody, "", taken};
    const LightCell cell{PathPart::first_bounce, true, false, false},
        on_mover{PathPart::first_bounce, true, true, false};
    EXPECT_EQ(plan_of(terms).lit_by(brute), dynamic);
    terms.exceptions = "first_bounce.dynamic=none";
    EXPECT_FALSE(plan_of(terms).uses(brute));
    terms.exceptions = "";
    terms.movers = prt;
    EXPECT_EQ(plan_of(terms).owner(cell), brute);
    EXPECT_EQ(plan_of(terms).owner(on_mover), prt);
    EXPECT_EQ(plan_of(terms).fallback(on_mover), brute);
    terms.indirect = nobody;
    EXPECT_EQ(plan_of(terms).owner(cell), nobody);
}

// Exhaustive over three owners for six groups of cells: a plan is either refused or gives each cell to one owner, and
// no technique lights what it cannot.
TEST(LightPlan, EveryAssignmentHasOneOwnerACell) {
    const char* groups[] = {"direct.on_fixed",       "direct.on_mover",        "first_bounce.on_fixed",
                            "first_bounce.on_mover", "later_bounces.on_fixed", "later_bounces.on_mover"};
    const char* owners[] = {"none", "many", "prt"};
    int accepted = 0;
    for (int code = 0; code < 729; ++code) {
        std::string text;
        for (int g = 0, rest = code; g < 6; ++g, rest /= 3)
            text += std::string(g > 0 ? "," : "") + groups[g] + "=" + owners[rest % 3];
        const Result<LightPlan> plan = LightPlan::make({brute, brute, brute, nobody, nobody, text}, four);
        if (!plan) {
            EXPECT_FALSE(plan.error().message.empty());
            continue;
        }
        ++accepted;
        for (std::int32_t t = 0; t < 3; ++t)
            EXPECT_TRUE((plan->lit_by(t) & ~four[std::size_t(t)].can_light).none()) << text;
        for (std::size_t i = 0; i < light_cell_count; ++i)
            if (plan->owner(LightCell::at(i)) == prt) {
                EXPECT_NE(plan->fallback(LightCell::at(i)), prt);
            }
    }
    EXPECT_GT(accepted, 20);
}

TEST(LightPlan, SettingsAreDistinctDescribedAndReadTheirOwnText) {
    Settings settings;
    std::set<std::string_view> names;
    for (const std::string_view name : Settings::names()) {
        EXPECT_TRUE(names.insert(name).second) << name << " is described twice";
        const Field& field = *Settings::find(name);
        EXPECT_FALSE(field.tooltip.empty()) << name;
        EXPECT_TRUE(settings.set(name, settings.get(name))) << name;
    }
    EXPECT_TRUE(settings.validate());
    EXPECT_FALSE(settings.set("low_resolution", "3"));
    EXPECT_FALSE(settings.set("shadow_map_resolution", "33"));
    EXPECT_FALSE(settings.set("shadow_map_bits", "24"));
    EXPECT_FALSE(settings.set("lights", "65537"));
    settings.plan = "direct=none,direct=none";
    EXPECT_FALSE(settings.validate());
}

// As the text that says the range names it: 0.01 is nearest to a float below it.
TEST(LightPlan, BoundsOfSettingsAreAllowed) {
    for (const std::string_view name : Settings::names())
        if (const Field& field = *Settings::find(name); field.kind == FieldKind::real)
            for (const double bound : {field.minimum, field.maximum}) {
                const Status set = Settings().set(name, fmt::format("{}", bound));
                EXPECT_TRUE(set) << set.error().message;
            }
}

// Whichever techniques the build has.
TEST(LightPlan, TheFirstTechniqueThatCanLightATermIsItsDefault) {
    ASSERT_FALSE(techniques().empty());
    const Settings settings;
    for (const bool direct : {true, false}) {
        const CellSet cells = cells_where([&](LightCell cell) {
            return !cell.specular && !cell.on_mover && cell.path != PathPart::punctual &&
                   (cell.path == PathPart::direct) == direct;
        });
        std::string_view expected = "none";
        for (const TechniqueEntry& technique : techniques())
            if (expected == "none" && (cells & ~technique.can_light).none())
                expected = technique.name;
        EXPECT_EQ(settings.get(direct ? "direct" : "indirect"), expected);
    }
    EXPECT_TRUE(settings.validate());
}

// Automatic: a technique that lights nothing else, if the build has one; whoever lights direct light if it has none;
// and nobody where direct light is switched off.
TEST(LightPlan, PunctualLightFollowsDirectLight) {
    const CellSet punctual = cells_where([](LightCell cell) { return cell.path == PathPart::punctual; });
    Settings settings;
    const LightPlan plan = settings.light_plan().value();
    const LightCell cell{PathPart::punctual, false, false, false};
    std::int32_t expected = plan.owner({PathPart::direct, false, false, false});
    for (std::size_t i = 0; i < techniques().size(); ++i)
        if ((techniques()[i].can_light & ~punctual).none())
            expected = std::int32_t(i);
    EXPECT_EQ(plan.owner(cell), expected);
    settings.with("direct", "none");
    EXPECT_EQ(settings.light_plan().value().owner(cell), nobody);
}

} // namespace
} // namespace sunfleck::gi
