// Error metrics of pictures whose differences are known.
#include "editor/command_line/metrics.h"

#include <gtest/gtest.h>

namespace sunfleck {
namespace {

TEST(Metrics, KnownDifferencesGiveKnownNumbers) {
    io::Picture a{32, 32, std::vector<vec4>(1024, vec4(0.5f, 0.5f, 0.5f, 1.0f))}, b = a;
    auto m = command_line::compare_pictures(a, b, false);
    EXPECT_EQ(m.mean_absolute_error, 0.0);
    EXPECT_EQ(m.peak_signal_to_noise, 999.0);
    EXPECT_NEAR(m.structural_similarity, 1.0, 1e-6);
    EXPECT_NEAR(m.flip, 0.0, 1e-3);
    for (std::size_t i = 0; i < 512; ++i)
        a.pixels[i] += vec4(0.1f, 0.1f, 0.1f, 0.0f);
    a.pixels[1023].w = 0.0f;
    m = command_line::compare_pictures(a, b, false);
    EXPECT_EQ(m.left_out, 1u);
    EXPECT_NEAR(m.mean_absolute_error, 0.1 * 512 / 1023, 1e-6);
    EXPECT_NEAR(m.root_mean_square_error, 0.1 * std::sqrt(512.0 / 1023), 1e-6);
    // |d|^2 = 0.03, |b|^2 = 0.75, m^2 = 0.75
    EXPECT_NEAR(m.relative_mean_square_error, 0.03 / (0.75 * 1.01) * 512 / 1023, 1e-6);
    EXPECT_NEAR(m.maximum_error, 0.1, 1e-6);
    EXPECT_LT(m.structural_similarity, 0.999);
    EXPECT_GT(m.flip, 0.01);
    // Black against white is as different as can be.
    const io::Picture black{32, 32, std::vector<vec4>(1024, vec4(0, 0, 0, 1))},
        white{32, 32, std::vector<vec4>(1024, vec4(1))};
    EXPECT_GT(command_line::compare_pictures(black, white, false).flip, 0.9);
}

} // namespace
} // namespace sunfleck
