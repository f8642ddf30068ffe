#include "editor/command_line/bench_table.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace sunfleck::command_line {
namespace {

std::string cell(const Json& value) {
    if (value.is_string())
        return value.get<std::string>();
    if (!value.is_number_float())
        return value.dump();
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value.get<double>());
    return text;
}

} // namespace

void BenchTable::print() const {
    if (rows.empty())
        return;
    std::vector<std::size_t> widths;
    for (const auto& [key, value] : rows[0].items()) {
        std::size_t width = key.size();
        for (const Json& row : rows)
            width = std::max(width, cell(row[key]).size());
        widths.push_back(width);
    }
    std::size_t column = 0;
    for (const auto& [key, value] : rows[0].items())
        std::printf("%-*s  ", int(widths[column++]), key.c_str());
    std::printf("\n");
    for (const Json& row : rows) {
        column = 0;
        for (const auto& [key, value] : row.items())
            std::printf("%-*s  ", int(widths[column++]), cell(value).c_str());
        std::printf("\n");
    }
    for (const auto& [key, value] : notes.items())
        std::printf("%s: %s\n", key.c_str(), cell(value).c_str());
}

Json BenchTable::json(const gpu::Device* device) const {
    Json json = {{"suite", suite}};
    if (device != nullptr) {
        json["device"] = device->traits().name;
        json["driver"] = device->traits().driver;
    }
    json["rows"] = rows;
    json["notes"] = notes;
    return json;
}

namespace {

// RFC 4180: text with commas or quotes is quoted.
std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos)
        return text;
    std::string quoted = "\"";
    for (const char c : text)
        quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

} // namespace

std::string BenchTable::csv() const {
    std::ostringstream text;
    const char* separator = "";
    if (!rows.empty())
        for (const auto& [key, value] : rows[0].items()) {
            text << separator << key;
            separator = ",";
        }
    text << '\n';
    for (const Json& row : rows) {
        separator = "";
        for (const auto& [key, value] : row.items()) {
            text << separator << (value.is_string() ? csv_field(value.get<std::string>()) : value.dump());
            separator = ",";
        }
        text << '\n';
    }
    return text.str();
}

double log_log_slope(const std::vector<std::pair<double, double>>& points) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (const auto& [x, y] : points) {
        if (x <= 0 || y <= 0)
            continue;
        const double lx = std::log(x), ly = std::log(y);
        n += 1, sx += lx, sy += ly, sxx += lx * lx, sxy += lx * ly;
    }
    const double spread = n * sxx - sx * sx;
    return spread > 0 ? (n * sxy - sx * sy) / spread : 0.0;
}

namespace {

constexpr double plot_width = 640, plot_height = 420, left = 70, right = 20, top = 40, bottom = 55;

// Logarithmic axes.
struct Axes {
    double x0 = 1e30, x1 = 0, y0 = 1e30, y1 = 0;

    explicit Axes(const std::vector<PlotSeries>& series) {
        for (const PlotSeries& s : series)
            for (const auto& [x, y] : s.points)
                x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
        if (x1 <= x0)
            x1 = x0 * 2;
        y0 *= 0.8, y1 *= 1.25;
    }
    double px(double x) const { return left + (plot_width - left - right) * std::log(x / x0) / std::log(x1 / x0); }
    double py(double y) const {
        return plot_height - bottom - (plot_height - top - bottom) * std::log(y / y0) / std::log(y1 / y0);
    }
};

void draw_axes(std::ostringstream& svg, const Axes& axes) {
    svg << "<path d=\"M" << left << " " << top << "V" << plot_height - bottom << "H" << plot_width - right
        << "\" fill=\"none\" stroke=\"#444\"/>";
    for (double x = std::pow(2.0, std::ceil(std::log2(axes.x0))); x <= axes.x1 * 1.001; x *= 2)
        svg << "<text x=\"" << axes.px(x) << "\" y=\"" << plot_height - bottom + 18 << "\" text-anchor=\"middle\">" << x
            << "</text>"
            << "<path d=\"M" << axes.px(x) << " " << plot_height - bottom << "v5\" stroke=\"#444\"/>";
    for (double decade = std::pow(10.0, std::floor(std::log10(axes.y0))); decade <= axes.y1; decade *= 10)
        for (const double m : {1.0, 2.0, 5.0})
            if (const double y = decade * m; y >= axes.y0 && y <= axes.y1)
                svg << "<text x=\"" << left - 8 << "\" y=\"" << axes.py(y) + 4 << "\" text-anchor=\"end\">" << y
                    << "</text>"
                    << "<path d=\"M" << left << " " << axes.py(y) << "H" << plot_width - right
                    << "\" stroke=\"#ddd\"/>";
}

void draw_series(std::ostringstream& svg, const Axes& axes, const PlotSeries& series, std::size_t index) {
    static const char* colours[] = {"#c0392b", "#2471a3", "#239b56", "#b7950b", "#7d3c98"};
    const char* colour = colours[index % 5];
    svg << "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" << colour << "\" points=\"";
    for (const auto& [x, y] : series.points)
        svg << axes.px(x) << "," << axes.py(y) << " ";
    svg << "\"/>";
    for (const auto& [x, y] : series.points)
        svg << "<circle cx=\"" << axes.px(x) << "\" cy=\"" << axes.py(y) << "\" r=\"3\" fill=\"" << colour << "\"/>";
    svg << "<text x=\"" << plot_width - right - 8 << "\" y=\"" << top + 16 * double(index + 1)
        << "\" text-anchor=\"end\" fill=\"" << colour << "\">" << series.name << "</text>";
}

} // namespace

std::string plot_svg(const std::string& title, const std::string& x_label, const std::string& y_label,
                     const std::vector<PlotSeries>& series) {
    const Axes axes(series);
    std::ostringstream svg;
    svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << plot_width << "\" height=\"" << plot_height
        << "\" font-family=\"sans-serif\" font-size=\"12\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>"
        << "<text x=\"" << plot_width / 2 << "\" y=\"22\" text-anchor=\"middle\" font-size=\"15\">" << title
        << "</text>"
        << "<text x=\"" << plot_width / 2 << "\" y=\"" << plot_height - 12 << "\" text-anchor=\"middle\">" << x_label
        << "</text>"
        << "<text transform=\"translate(16," << plot_height / 2 << ") rotate(-90)\" text-anchor=\"middle\">" << y_label
        << "</text>";
    draw_axes(svg, axes);
    for (std::size_t i = 0; i < series.size(); ++i)
        draw_series(svg, axes, series[i], i);
    svg << "</svg>\n";
    return svg.str();
}

} // namespace sunfleck::command_line
