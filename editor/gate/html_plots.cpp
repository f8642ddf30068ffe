#include "editor/gate/html_plots.h"

#include "engine/statistics/summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sunfleck::gate {
namespace {

constexpr double plot_width = 240.0, plot_height = 22.0; // of a table's row, px
constexpr double times_width = 900.0, times_height = 220.0, times_margin = 40.0;

// Where a ratio stands in a plot whose ends are -scale and +scale of change.
double position(double change, double scale) {
    return plot_width * 0.5 * (1.0 + std::clamp(change / scale, -1.0, 1.0));
}

std::string line(double x1, double y1, double x2, double y2, const char* colour) {
    return "<line x1='" + decimal(x1, 1) + "' y1='" + decimal(y1, 1) + "' x2='" + decimal(x2, 1) + "' y2='" +
           decimal(y2, 1) + "' stroke='" + colour + "'/>";
}

std::string dot(double x, double y, double radius, const char* colour) {
    return "<circle cx='" + decimal(x, 1) + "' cy='" + decimal(y, 1) + "' r='" + decimal(radius, 1) + "' fill='" +
           colour + "'/>";
}

std::string row_plot(const std::string& label, const std::string& content) {
    return "<svg class='row' role='img' aria-label='" + label + "' viewBox='0 0 " + decimal(plot_width, 0) + " " +
           decimal(plot_height, 0) + "'>" + line(plot_width * 0.5, 0.0, plot_width * 0.5, plot_height, "var(--axis)") +
           content + "</svg>";
}

} // namespace

std::string escape_html(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
        case '&':
            result += "&amp;";
            break;
        case '<':
            result += "&lt;";
            break;
        case '>':
            result += "&gt;";
            break;
        case '\'':
            result += "&#39;";
            break;
        case '"':
            result += "&quot;";
            break;
        default:
            result += c;
        }
    }
    return result;
}

std::string decimal(double value, int digits) {
    if (!std::isfinite(value))
        return "–";
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    return text;
}

std::string interval_plot(const statistics::GateRow& row, double scale) {
    if (!(row.low > 0.0) || !std::isfinite(row.high))
        return row_plot("no interval", "");
    const double middle = plot_height * 0.5;
    const char* colour = row.slower ? "var(--slower)" : "var(--mark)";
    return row_plot(decimal(row.low, 3) + " to " + decimal(row.high, 3),
                    line(position(row.low - 1.0, scale), middle, position(row.high - 1.0, scale), middle, colour) +
                        dot(position(row.ratio - 1.0, scale), middle, 4.0, colour));
}

std::string pairs_plot(const std::vector<double>& log_ratios, double scale) {
    std::string dots;
    for (std::size_t i = 0; i < log_ratios.size(); ++i) {
        // Spread over the height, so that equal ones are seen.
        const double y =
            plot_height * (0.2 + 0.6 * double(i) / double(std::max<std::size_t>(log_ratios.size() - 1, 1)));
        dots += dot(position(std::expm1(log_ratios[i]), scale), y, 1.8, "var(--mark)");
    }
    return row_plot("one dot for each of " + std::to_string(log_ratios.size()) + " pairs", dots);
}

std::string frame_times_plot(const std::vector<FrameTime>& times) {
    double most_ms = 0.0, last_frame = 1.0;
    std::vector<double> sorted;
    for (const FrameTime& time : times) {
        sorted.insert(sorted.end(), {time.base_ms, time.head_ms});
        last_frame = std::max(last_frame, double(time.frame));
    }
    most_ms = statistics::percentile(sorted, 0.99) * 1.1; // a few wild ones are cut off at the top
    if (!(most_ms > 0.0))
        return "";
    const auto x = [&](double frame) { return times_margin + (times_width - times_margin) * frame / last_frame; };
    const auto y = [&](double ms) { return (times_height - 30.0) * (1.0 - std::min(ms / most_ms, 1.0)) + 10.0; };
    std::string svg = "<svg class='times' role='img' aria-label='frame times over the recording' viewBox='0 0 " +
                      decimal(times_width, 0) + " " + decimal(times_height, 0) + "'>";
    for (int i = 0; i <= 4; ++i) {
        const double ms = most_ms * i / 4.0;
        svg += line(times_margin, y(ms), times_width, y(ms), "var(--grid)") + "<text x='0' y='" +
               decimal(y(ms) + 4.0, 1) + "'>" + decimal(ms, 1) + " ms</text>";
    }
    for (const FrameTime& time : times) {
        svg += dot(x(time.frame), y(time.base_ms), 1.6, "var(--base)");
        svg += dot(x(time.frame), y(time.head_ms), 1.6, "var(--head)");
    }
    return svg + "<text x='" + decimal(times_margin, 0) + "' y='" + decimal(times_height - 4.0, 0) +
           "'>frame 0</text><text x='" + decimal(times_width - 80.0, 0) + "' y='" + decimal(times_height - 4.0, 0) +
           "'>frame " + decimal(last_frame, 0) + "</text></svg>";
}

} // namespace sunfleck::gate
