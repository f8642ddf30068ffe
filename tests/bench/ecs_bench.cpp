// Costs of the registry, with a plain loop over two vectors as the yardstick.
#include "engine/core/random.h"
#include "engine/ecs/registry.h"

#include <benchmark/benchmark.h>

#include <algorithm>

namespace {

using namespace sunfleck::ecs;

struct Position {
    float x = 1, y = 2;
};
struct Velocity {
    float x = 3, y = 4;
};
struct Extra {
    float value = 5;
};

void per_entity(benchmark::State& state) {
    state.SetItemsProcessed(state.iterations() * state.range(0));
    state.counters["ns_per_entity"] = benchmark::Counter(double(state.iterations()) * double(state.range(0)) * 1e-9,
                                                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void fill(Registry& registry, std::int64_t count, bool extra) {
    for (std::int64_t i = 0; i < count; ++i) {
        const Entity entity = registry.create();
        registry.emplace<Position>(entity);
        registry.emplace<Velocity>(entity);
        if (extra)
            registry.emplace<Extra>(entity);
    }
}

void plain_loop_two(benchmark::State& state) {
    std::vector<Position> positions(std::size_t(state.range(0)));
    std::vector<Velocity> velocities(positions.size());
    for (auto _ : state) {
        float sum = 0;
        for (std::size_t i = 0; i < positions.size(); ++i)
            sum += positions[i].x * velocities[i].x;
        benchmark::DoNotOptimize(sum);
    }
    per_entity(state);
}

void view_one(benchmark::State& state) {
    Registry registry;
    fill(registry, state.range(0), false);
    for (auto _ : state) {
        float sum = 0;
        registry.view<Position>().each([&](Entity, const Position& p) { sum += p.x; });
        benchmark::DoNotOptimize(sum);
    }
    per_entity(state);
}

void view_two(benchmark::State& state) {
    Registry registry;
    fill(registry, state.range(0), false);
    for (auto _ : state) {
        float sum = 0;
        registry.view<Position, Velocity>().each(
            [&](Entity, const Position& p, const Velocity& v) { sum += p.x * v.x; });
        benchmark::DoNotOptimize(sum);
    }
    per_entity(state);
}

void group_two(benchmark::State& state) {
    Registry registry;
    registry.group<Position, Velocity>();
    fill(registry, state.range(0), false);
    for (auto _ : state) {
        float sum = 0;
        registry.group<Position, Velocity>().each(
            [&](Entity, const Position& p, const Velocity& v) { sum += p.x * v.x; });
        benchmark::DoNotOptimize(sum);
    }
    per_entity(state);
}

void view_three(benchmark::State& state) {
    Registry registry;
    fill(registry, state.range(0), true);
    for (auto _ : state) {
        float sum = 0;
        registry.view<Position, Velocity, Extra>().each(
            [&](Entity, const Position& p, const Velocity& v, const Extra& e) { sum += p.x * v.x + e.value; });
        benchmark::DoNotOptimize(sum);
    }
    per_entity(state);
}

// Every other entity has the second component, added in random order: no two pools agree.
void view_two_fragmented(benchmark::State& state) {
    Registry registry;
    std::vector<Entity> entities;
    for (std::int64_t i = 0; i < state.range(0); ++i) {
        entities.push_back(registry.create());
        registry.emplace<Position>(entities.back());
    }
    for (std::size_t i = entities.size(); i > 1; --i)
        std::swap(entities[i - 1], entities[sunfleck::pcg_hash(std::uint32_t(i)) % i]);
    for (std::size_t i = 0; i < entities.size(); i += 2)
        registry.emplace<Velocity>(entities[i]);
    for (auto _ : state) {
        float sum = 0;
        registry.view<Position, Velocity>().each(
            [&](Entity, const Position& p, const Velocity& v) { sum += p.x * v.x; });
        benchmark::DoNotOptimize(sum);
    }
    per_entity(state);
}

void create_with_two(benchmark::State& state) {
    for (auto _ : state) {
        Registry registry;
        fill(registry, state.range(0), false);
        benchmark::DoNotOptimize(registry);
    }
    per_entity(state);
}

void destroy_and_create(benchmark::State& state) {
    Registry registry;
    std::vector<Entity> entities;
    for (std::int64_t i = 0; i < state.range(0); ++i)
        entities.push_back(registry.create());
    for (auto _ : state) {
        for (const Entity entity : entities)
            registry.destroy(entity);
        for (Entity& entity : entities)
            entity = registry.create();
    }
    per_entity(state);
}

void add_and_remove(benchmark::State& state) {
    Registry registry;
    std::vector<Entity> entities;
    for (std::int64_t i = 0; i < state.range(0); ++i)
        entities.push_back(registry.create());
    for (auto _ : state) {
        for (const Entity entity : entities)
            registry.emplace<Position>(entity);
        for (const Entity entity : entities)
            registry.remove<Position>(entity);
        registry.forget_removals_until(registry.tick());
    }
    per_entity(state);
}

BENCHMARK(plain_loop_two)->RangeMultiplier(10)->Range(1000, 1000000);
BENCHMARK(group_two)->RangeMultiplier(10)->Range(1000, 1000000);
BENCHMARK(view_one)->RangeMultiplier(10)->Range(1000, 1000000);
BENCHMARK(view_two)->RangeMultiplier(10)->Range(1000, 1000000);
BENCHMARK(view_three)->RangeMultiplier(10)->Range(1000, 1000000);
BENCHMARK(view_two_fragmented)->RangeMultiplier(10)->Range(1000, 1000000);
BENCHMARK(create_with_two)->RangeMultiplier(10)->Range(1000, 1000000);
BENCHMARK(destroy_and_create)->RangeMultiplier(10)->Range(1000, 1000000);
BENCHMARK(add_and_remove)->RangeMultiplier(10)->Range(1000, 1000000);

} // namespace

BENCHMARK_MAIN();
