// Precomputed transfer: harmonics, closed forms of transfer, the cache, the grid of points.
#include "engine/core/file.h"
#include "engine/scene/procedural.h"
#include "gi_module/transfer/environment_probe.h"
#include "gi_module/transfer/transfer_data.h"

#include <gtest/gtest.h>
#include <random>
#include <unistd.h>

namespace sunfleck::gi {
namespace {

vec3 random_direction(std::mt19937& random) {
    std::normal_distribution<float> normal;
    return glm::normalize(vec3(normal(random), normal(random), normal(random)));
}

// The addition theorem: the sum over m of Y(a) Y(b) is (2l + 1) / (4 pi) times the Legendre polynomial of dot(a, b).
TEST(Transfer, HarmonicsObeyTheAdditionTheorem) {
    std::mt19937 random(5);
    for (int trial = 0; trial < 200; ++trial) {
        const vec3 a = random_direction(random), b = random_direction(random);
        const Harmonics ya = spherical_harmonics(a), yb = spherical_harmonics(b);
        for (int l = 0; l < 5; ++l) {
            double sum = 0.0;
            for (int m = -l; m <= l; ++m)
                sum += double(ya[std::size_t(l * l + l + m)]) * double(yb[std::size_t(l * l + l + m)]);
            const double expected =
                double(2 * l + 1) / (4.0 * double(pi)) * std::legendre(unsigned(l), double(glm::dot(a, b)));
            EXPECT_NEAR(sum, expected, 2e-6) << l;
        }
    }
    for (std::size_t i = harmonics; i < harmonics_padded; ++i)
        EXPECT_EQ(spherical_harmonics(vec3(0, 0, 1))[i], 0.0f);
}

// Products of two of them are polynomials of degree 8: a product quadrature of enough points is exact.
TEST(Transfer, HarmonicsAreOrthonormal) {
    constexpr int columns = 16, rows = 400; // in azimuth exact from 9 points; along z by midpoints
    std::array<std::array<double, harmonics>, harmonics> gram{};
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const float z = (float(row) + 0.5f) / float(rows) * 2.0f - 1.0f, r = std::sqrt(1.0f - z * z);
            const float angle = 2.0f * pi * (float(column) + 0.5f) / float(columns);
            const Harmonics y = spherical_harmonics(vec3(r * std::cos(angle), r * std::sin(angle), z));
            for (std::size_t i = 0; i < harmonics; ++i)
                for (std::size_t k = 0; k < harmonics; ++k)
                    gram[i][k] += 4.0 * double(pi) / (rows * columns) * double(y[i]) * double(y[k]);
        }
    for (std::size_t i = 0; i < harmonics; ++i)
        for (std::size_t k = 0; k < harmonics; ++k)
            EXPECT_NEAR(gram[i][k], i == k ? 1.0 : 0.0, 2e-4) << i << " " << k;
}

// A convex body does not shadow itself: transfer is the cosine lobe, whose harmonics are known (Ramamoorthi and
// Hanrahan 2001: pi, 2 pi / 3, pi / 4, 0, -pi / 24, times Y of the normal). 400 stratified rays err by about 1 %.
TEST(Transfer, ConvexBodiesHaveTheCosineLobe) {
    const scene::Mesh sphere = scene::make_sphere(1.0f, 24, 12);
    const auto transfer = compute_transfer(sphere, {});
    ASSERT_TRUE(transfer) << transfer.error().message;
    const double lobe[5] = {double(pi), 2.0 * double(pi) / 3.0, double(pi) / 4.0, 0.0, -double(pi) / 24.0};
    double square_error = 0.0, square = 0.0;
    for (std::size_t vertex = 0; vertex < sphere.positions.size(); ++vertex) {
        const Harmonics y = spherical_harmonics(sphere.normals[vertex]);
        for (int l = 0; l < 5; ++l)
            for (int m = -l; m <= l; ++m) {
                const auto i = std::size_t(l * l + l + m);
                const double expected = lobe[l] * double(y[i]);
                square_error += std::pow(double(transfer->coefficients(vertex, 0)[i]) - expected, 2.0);
                square += expected * expected;
                EXPECT_EQ(transfer->coefficients(vertex, 1)[i], 0.0f);
                EXPECT_EQ(transfer->coefficients(vertex, 2)[i], 0.0f);
            }
    }
    EXPECT_LT(std::sqrt(square_error / square), 0.02);
}

// Half of a sphere's inside, open to light that is the same from everywhere: each point of a sphere sees any part of it
// in proportion to that part's area, so half of the light comes in at once, and each reflection keeps half.
TEST(Transfer, ABowlReflectsOntoItself) {
    scene::Mesh bowl;
    constexpr std::uint32_t columns = 48, rows = 16;
    for (std::uint32_t row = 0; row <= rows; ++row)
        for (std::uint32_t column = 0; column <= columns; ++column) {
            const float polar = 0.5f * pi * float(row) / float(rows),
                        angle = 2.0f * pi * float(column) / float(columns);
            const vec3 out(std::sin(polar) * std::cos(angle), -std::cos(polar), std::sin(polar) * std::sin(angle));
            bowl.positions.push_back(out);
            bowl.normals.push_back(-out);
        }
    for (std::uint32_t row = 0; row < rows; ++row)
        for (std::uint32_t column = 0; column < columns; ++column) {
            const std::uint32_t a = row * (columns + 1) + column, b = a + columns + 1;
            bowl.indices.insert(bowl.indices.end(), {a, a + 1, b, b, a + 1, b + 1});
        }
    const vec3 first = bowl.positions[bowl.indices[3]];
    const vec3 normal = glm::cross(bowl.positions[bowl.indices[4]] - first, bowl.positions[bowl.indices[5]] - first);
    if (glm::dot(normal, first) > 0.0f) // faces must look inwards
        for (std::size_t i = 0; i < bowl.indices.size(); i += 3)
            std::swap(bowl.indices[i], bowl.indices[i + 1]);
    const auto transfer = compute_transfer(bowl, {});
    ASSERT_TRUE(transfer) << transfer.error().message;
    const double radiance_of_one = std::sqrt(4.0 * double(pi)); // its only coefficient
    for (std::size_t order = 0; order < transfer_orders; ++order) {
        double sum = 0.0;
        std::size_t count = 0;
        for (std::size_t vertex = 0; vertex < bowl.positions.size(); ++vertex) {
            if (bowl.positions[vertex].y > -0.3f) // the rim's vertices see along facets
                continue;
            sum += radiance_of_one * double(transfer->coefficients(vertex, order)[0]);
            ++count;
        }
        const double expected = double(pi) * std::pow(0.5, double(order) + 1.0);
        EXPECT_NEAR(sum / double(count), expected, 0.03 * expected) << "order " << order;
    }
}

TEST(Transfer, IsTheSameForAnyNumberOfThreadsAndCanBeStopped) {
    const scene::Mesh knot = scene::make_knot(0.5f, 60, 8);
    const auto one = compute_transfer(knot, {64}), two = compute_transfer(knot, {64});
    ASSERT_TRUE(one && two);
    EXPECT_EQ(one->rows, two->rows);
    EXPECT_FALSE(compute_transfer(knot, {64}, [](float) { return false; }));
    EXPECT_FALSE(compute_transfer(scene::Mesh{}, {}));
}

TEST(Transfer, TheCacheGivesBackWhatItGotOrNothing) {
    namespace fs = std::filesystem;
    const fs::path folder = fs::path(testing::TempDir()) / ("sunfleck_transfer_" + std::to_string(getpid()));
    scene::Mesh knot = scene::make_knot(0.5f, 20, 6);
    const std::uint64_t hash = transfer_hash(knot, {16});
    const auto made = compute_transfer(knot, {16});
    ASSERT_TRUE(made);
    EXPECT_FALSE(read_transfer(folder, hash, made->vertices));
    ASSERT_TRUE(write_transfer(folder / "below", hash, *made));
    const auto read = read_transfer(folder / "below", hash, made->vertices);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->rows, made->rows);
    EXPECT_FALSE(read_transfer(folder / "below", hash + 1, made->vertices));
    EXPECT_FALSE(read_transfer(folder / "below", hash, made->vertices + 1));
    EXPECT_NE(transfer_hash(knot, {25}), hash);
    knot.positions[3].x += 1e-6f;
    EXPECT_NE(transfer_hash(knot, {16}), hash);
    const fs::path file = fs::directory_iterator(folder / "below")->path();
    const std::string content = read_file(file).value();
    std::mt19937 random(9);
    for (int trial = 0; trial < 50; ++trial) {
        std::string damaged = content;
        damaged[random() % damaged.size()] ^= char(1 + random() % 255);
        if (trial % 5 == 0)
            damaged.resize(random() % content.size());
        ASSERT_TRUE(write_file(file, damaged));
        EXPECT_FALSE(read_transfer(folder / "below", hash, made->vertices));
    }
    fs::remove_all(folder);
}

TEST(Transfer, GridsOfPointsReproduceLinearFunctions) {
    const Bounds bounds{vec3(-1.0f, 0.0f, 2.0f), vec3(3.0f, 1.0f, 5.0f)};
    const auto function = [](vec3 p) { return 0.7f * p.x - 1.3f * p.y + 0.2f * p.z + 4.0f; };
    std::mt19937 random(2);
    std::uniform_real_distribution<float> unit;
    for (std::uint32_t side = 1; side <= 5; ++side) {
        const PointGrid grid(bounds, side);
        const vec3 low = grid.point(0), high = grid.point(grid.size() - 1);
        for (int trial = 0; trial < 100; ++trial) {
            const vec3 place = glm::mix(low, high, vec3(unit(random), unit(random), unit(random)));
            const PointGrid::Weights around = grid.around(place);
            float sum = 0.0f, value = 0.0f;
            for (int i = 0; i < 8; ++i) {
                ASSERT_LT(around.points[std::size_t(i)], grid.size());
                sum += around.weights[std::size_t(i)];
                value += around.weights[std::size_t(i)] * function(grid.point(around.points[std::size_t(i)]));
            }
            EXPECT_NEAR(sum, 1.0f, 1e-5f);
            EXPECT_NEAR(value, function(place), 1e-4f);
        }
    }
}

} // namespace
} // namespace sunfleck::gi
