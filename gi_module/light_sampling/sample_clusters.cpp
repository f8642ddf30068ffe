#include "gi_module/light_sampling/sample_clusters.h"

#include "engine/core/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <queue>
#include <span>

namespace sunfleck::gi {
namespace {

constexpr float normal_length = 1.0f; // m: how far apart opposite normals count, halved
constexpr float min_extent = 0.3f;  // m: a cluster's flux counts even where its extent is nothing

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
        double square = double(min_extent) * double(min_extent);
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

    // The cluster's sample nearest to the middle of its flux, with the flux of all and a disc as wide as they lie. The
    // way that its light came is that of one of them, drawn in proportion to luminance.
    LightSample stand_in(const Cluster& cluster, float number) const {
        const auto members = std::span(order_).subspan(cluster.first, cluster.count);
        std::array<double, 6> middle{};
        glm::dvec3 flux(0.0);
        std::uint32_t drawn = members.front();
        double before = 0.0;
        for (const std::uint32_t i : members) {
            flux += glm::dvec3(samples_[i].flux);
            if (before <= double(number) * cluster.flux)
                drawn = i;
            before += double(luminance(samples_[i].flux));
            const Place place = place_of(samples_[i]);
            for (std::size_t k = 0; k < 6; ++k)
                middle[k] += double(luminance(samples_[i].flux)) / cluster.flux * double(place[k]);
        }
        std::uint32_t nearest = members.front();
        double least = 1e30, variance = 0.0;
        for (const std::uint32_t i : members) {
            const Place place = place_of(samples_[i]);
            double in_space = 0.0, in_all = 0.0;
            for (std::size_t k = 0; k < 6; ++k) {
                in_all += (double(place[k]) - middle[k]) * (double(place[k]) - middle[k]);
                in_space = k < 3 ? in_all : in_space;
            }
            variance += double(luminance(samples_[i].flux)) / cluster.flux * in_space;
            if (in_all < least) {
                least = in_all;
                nearest = i;
            }
        }
        LightSample sample = samples_[drawn];
        sample.position = samples_[nearest].position;
        sample.normal = samples_[nearest].normal;
        sample.flux = vec3(flux);
        sample.radius = std::sqrt(2.0f * float(variance)); // of a disc with that variance
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
