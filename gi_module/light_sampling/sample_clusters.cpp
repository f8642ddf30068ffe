#include "gi_module/light_sampling/sample_clusters.h"

#include "engine/core/random.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <queue>

namespace sunfleck::gi {
namespace {

constexpr float normal_length = 1.0f; // m: how far apart opposite normals count, halved
constexpr float least_extent = 0.3f;  // m: a cluster's flux counts even where its extent is nothing

using Place = std::array<float, 6>;

Place place_of(const LightSample& sample) {
    const vec3 n = sample.normal * normal_length;
    return {sample.position.x, sample.position.y, sample.position.z, n.x, n.y, n.z};
}

struct Cluster {
    std::uint32_t first = 0, count = 0;
    double flux = 0;
    int axis = 0;     // of the greatest extent
    double error = 0; // the cluster with the greatest is divided next
};

class Division {
public:
    Division(const std::vector<LightSample>& samples, float spread) : samples_(samples), spread_(spread) {
        order_.resize(samples.size());
        std::iota(order_.begin(), order_.end(), 0u);
    }

    Cluster measure(std::uint32_t first, std::uint32_t count) const {
        Cluster cluster{first, count, 0, 0, 0};
        Place low, high;
        low.fill(1e30f);
        high.fill(-1e30f);
        for (std::uint32_t i = first; i < first + count; ++i) {
            const LightSample& sample = samples_[order_[i]];
            cluster.flux += double(luminance(sample.flux));
            const Place place = place_of(sample);
            for (std::size_t k = 0; k < 6; ++k) {
                low[k] = std::min(low[k], place[k]);
                high[k] = std::max(high[k], place[k]);
            }
        }
        double square = double(least_extent) * double(least_extent);
        for (std::size_t k = 0; k < 6; ++k) {
            square += double(high[k] - low[k]) * double(high[k] - low[k]);
            if (high[k] - low[k] > high[std::size_t(cluster.axis)] - low[std::size_t(cluster.axis)])
                cluster.axis = int(k);
        }
        cluster.error = count > 1 ? std::pow(cluster.flux, 1.0 - 0.5 * double(spread_)) * square : -1.0;
        return cluster;
    }

    // At the middle of the flux along the longest axis.
    std::pair<Cluster, Cluster> divide(const Cluster& cluster) {
        const auto begin = order_.begin() + cluster.first, end = begin + cluster.count;
        const std::size_t axis = std::size_t(cluster.axis);
        std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
            const float pa = place_of(samples_[a])[axis], pb = place_of(samples_[b])[axis];
            return pa != pb ? pa < pb : a < b;
        });
        double flux = 0;
        std::uint32_t left = 0;
        while (left + 1 < cluster.count - 1 && flux < 0.5 * cluster.flux)
            flux += double(luminance(samples_[order_[cluster.first + left++]].flux));
        left = std::max(left, 1u);
        return {measure(cluster.first, left), measure(cluster.first + left, cluster.count - left)};
    }

    // One of the cluster's samples, drawn in proportion to its luminance, with the luminance of all.
    LightSample stand_in(const Cluster& cluster, float number) const {
        double target = double(number) * cluster.flux;
        std::uint32_t chosen = cluster.first;
        for (std::uint32_t i = cluster.first; i < cluster.first + cluster.count; ++i) {
            chosen = i;
            target -= double(luminance(samples_[order_[i]].flux));
            if (target < 0)
                break;
        }
        LightSample sample = samples_[order_[chosen]];
        sample.flux *= float(cluster.flux / double(luminance(sample.flux)));
        return sample;
    }

private:
    const std::vector<LightSample>& samples_;
    float spread_;
    std::vector<std::uint32_t> order_;
};

} // namespace

std::vector<LightSample> cluster_samples(const std::vector<LightSample>& samples, std::uint32_t count, float spread,
                                         std::uint32_t seed) {
    if (samples.size() <= count)
        return samples;
    Division division(samples, spread);
    const auto less = [](const Cluster& a, const Cluster& b) {
        return a.error != b.error ? a.error < b.error : a.first > b.first;
    };
    std::priority_queue<Cluster, std::vector<Cluster>, decltype(less)> clusters(less);
    clusters.push(division.measure(0, std::uint32_t(samples.size())));
    while (clusters.size() < count && clusters.top().error > 0) {
        const Cluster worst = clusters.top();
        clusters.pop();
        const auto [left, right] = division.divide(worst);
        clusters.push(left);
        clusters.push(right);
    }
    std::vector<Cluster> all;
    for (; !clusters.empty(); clusters.pop())
        all.push_back(clusters.top());
    std::sort(all.begin(), all.end(), [](const Cluster& a, const Cluster& b) { return a.first < b.first; });
    std::vector<LightSample> result;
    for (std::uint32_t i = 0; i < all.size(); ++i)
        result.push_back(division.stand_in(all[i], to_unit_float(hash_combine(hash_combine(seed, 0xc1), i))));
    return result;
}

} // namespace sunfleck::gi
