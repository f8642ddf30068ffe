#include "editor/gate/html_report.h"

#include "editor/command_line/metrics.h"
#include "editor/gate/html_plots.h"
#include "editor/gate/verdict_text.h"
#include "engine/core/file.h"

#include <algorithm>
#include <cmath>

namespace sunfleck::gate {
namespace {

using statistics::GateRow;
using statistics::RowKind;

constexpr const char* style = R"(
:root { --fine: #1a7f37; --slower: #c62828; --unsure: #9a6700; --mark: #24527a; --axis: #999; --grid: #e4e4e4;
        --base: #7a8a99; --head: #d2691e; }
body { font: 15px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 70em; padding: 0 1em; color: #222; }
h1 { padding: .5em .7em; color: #fff; border-radius: .3em; font-size: 1.4em; }
h1.fine { background: var(--fine); } h1.slower { background: var(--slower); } h1.unsure { background: var(--unsure); }
table { border-collapse: collapse; width: 100%; } th, td { text-align: right; padding: .15em .6em; }
th:first-child, td:first-child { text-align: left; } tr { border-bottom: 1px solid var(--grid); }
tr.slower td { color: var(--slower); font-weight: 600; } tr.listed { color: #777; }
svg.row { width: 15em; height: 22px; } svg.times { width: 100%; } svg text { font: 11px sans-serif; fill: #555; }
.base { color: var(--base); } .head { color: var(--head); }
.pictures { display: grid; grid-template-columns: repeat(3, 1fr); gap: .5em; margin: 0 0 1.5em; }
.pictures img { width: 100%; display: block; image-rendering: pixelated; } figcaption { grid-column: 1 / -1; }
.slider { position: relative; grid-column: 1 / -1; max-width: 60em; } .slider img + img { position: absolute; inset: 0; }
.slider input { width: 100%; })";

// Lays head over base behind a slider; without it the pictures stand side by side.
constexpr const char* script = R"(
for (const figure of document.querySelectorAll('.pictures')) {
  const [base, head] = figure.querySelectorAll('img');
  const slider = document.createElement('div'), range = document.createElement('input');
  slider.className = 'slider';
  range.type = 'range'; range.min = 0; range.max = 100; range.value = 50;
  range.setAttribute('aria-label', 'left of it base, right of it head');
  slider.append(base.cloneNode(), head.cloneNode(), range);
  const over = slider.querySelectorAll('img')[1];
  const cut = () => { over.style.clipPath = 'inset(0 0 0 ' + range.value + '%)'; };
  range.addEventListener('input', cut);
  cut();
  figure.append(slider);
}
document.documentElement.dataset.sliders = document.querySelectorAll('.slider').length;)";

std::string base64(const std::string& bytes) {
    static const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string result;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word = word << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            result += i + k <= bytes.size() ? digits[word >> (18 - 6 * k) & 63] : '=';
    }
    return result;
}

std::string image(const std::string& png, const std::string& what) {
    return "<img alt='" + escape_html(what) + "' src='data:image/png;base64," + base64(png) + "'>";
}

std::string cell(const std::string& content) {
    return "<td>" + content + "</td>";
}

const char* outcome_class(const GateRun& run) {
    switch (outcome_of(run)) {
    case Outcome::fine:
        return "fine";
    case Outcome::slower:
    case Outcome::changed:
        return "slower";
    default:
        return "unsure";
    }
}

// Where the plots end: the widest interval of a row that counts, at most 25 %.
double plot_scale(const GateRun& run) {
    double scale = 0.06;
    for (const GateRow& row : run.report.rows)
        if (row.kind == RowKind::judged && row.low > 0.0 && std::isfinite(row.high))
            scale = std::max({scale, 1.5 * (row.high - 1.0), 1.5 * (1.0 - row.low)});
    return std::min(scale, 0.25);
}

// The pairs' samples of a row, by its name.
std::vector<double> samples_of(const GateRun& run, const std::vector<std::vector<double>>& pairs,
                               const std::string& name) {
    std::vector<double> samples;
    for (std::size_t i = 0; i < run.report.rows.size(); ++i)
        if (run.report.rows[i].name == name)
            for (const auto& pair : pairs)
                if (i < pair.size() && pair[i] != 0.0)
                    samples.push_back(pair[i]);
    return samples;
}

std::string rows_table(const GateRun& run) {
    const double scale = plot_scale(run);
    const auto pairs = run.comparison.log_ratios();
    std::string html =
        "<h2>Passes and stages</h2><p>Ratios are head / base with their interval at 95 %. The plots reach "
        "from -" +
        decimal(scale * 100.0, 0) + " % to +" + decimal(scale * 100.0, 0) +
        " %. Seen: the least slow-down that would have been noticed.</p><table><thead><tr><th>pass"
        "<th>base ms<th>head ms<th>ratio<th>interval<th>pairs<th>seen<th></tr></thead><tbody>";
    for (const GateRow& row : sorted_rows(run.report)) {
        const bool listed = row.kind == RowKind::listed;
        html += std::string("<tr class='") +
                (row.slower ? "slower"
                 : listed   ? "listed"
                            : "") +
                "'>" + cell(escape_html(row.name)) + cell(decimal(row.base_ms, 3)) + cell(decimal(row.head_ms, 3)) +
                cell(row.pairs ? decimal(row.ratio, 3) : "–") + cell(interval_plot(row, scale)) +
                cell(pairs_plot(samples_of(run, pairs, row.name), scale)) +
                cell(std::isfinite(row.smallest_seen) && row.smallest_seen > 0.0
                         ? decimal(row.smallest_seen * 100.0, 1) + " %"
                         : "–") +
                cell(kind_text(row)) + "</tr>";
    }
    return html + "</tbody></table>";
}

std::string counters_table(const GateRun& run) {
    const auto changes = run.comparison.counter_changes();
    if (changes.empty())
        return "<h2>Counters</h2><p>The same in every frame that was compared.</p>";
    std::string html = "<h2>Counters that changed</h2><table><thead><tr><th>counter<th>first frame<th>base<th>head"
                       "<th>frames<th></tr></thead><tbody>";
    for (const CounterChange& change : changes)
        html += "<tr>" + cell(escape_html(change.name)) + cell(std::to_string(change.frame)) +
                cell(decimal(change.base, 3)) + cell(decimal(change.head, 3)) +
                cell(std::to_string(change.frames) + " of " + std::to_string(change.compared)) +
                cell(change.accepted ? "accepted" : "") + "</tr>";
    return html + "</tbody></table>";
}

Result<std::string> picture_figure(const PictureResult& result, const char* against) {
    SUNFLECK_ASSIGN(const std::string before, read_file(result.stored));
    SUNFLECK_ASSIGN(const std::string after, read_file(result.drawn));
    std::string html = "<figure class='pictures'><figcaption>" + escape_html(result.frame.name) + ", frame " +
                       std::to_string(result.frame.frame) + ": " +
                       (result.fault.empty() ? "equal" : escape_html(result.fault)) + " (left: " + against +
                       ", right: head)</figcaption>" + image(before, against) + image(after, "head");
    if (!result.difference.same_size || result.difference.equal)
        return html + "</figure>";
    SUNFLECK_ASSIGN(const io::Picture a, io::read_picture(result.stored));
    SUNFLECK_ASSIGN(const io::Picture b, io::read_picture(result.drawn));
    const io::Picture difference = command_line::difference_picture(b, a, false);
    std::vector<std::uint8_t> bytes;
    for (const vec4& pixel : difference.pixels)
        for (int c = 0; c < 4; ++c)
            bytes.push_back(std::uint8_t(std::lround(std::clamp(pixel[c], 0.0f, 1.0f) * 255.0f)));
    SUNFLECK_ASSIGN(const std::string png, io::encode_png(difference.width, difference.height, bytes));
    return html + image(png, "difference times eight") + "</figure>";
}

Result<std::string> pictures(const GateRun& run) {
    std::string html;
    for (const auto& [results, against] : {std::pair{&run.pictures, "base"}, {&run.stored, "stored"}})
        for (const PictureResult& result : *results) {
            SUNFLECK_ASSIGN(const std::string figure, picture_figure(result, against));
            html += figure;
        }
    return html.empty() ? html : "<h2>Pictures</h2>" + html;
}

std::string facts(const GateRun& run) {
    const Hello& hello = run.comparison.head();
    return "<p>" + escape_html(hello.recording) + ", " + escape_html(hello.size) + ", " + escape_html(hello.device) +
           " (" + escape_html(hello.driver) + "). " + std::to_string(run.report.pairs) + " pairs of processes, " +
           decimal(run.minutes, 1) + " minutes.</p>";
}

} // namespace

Status write_html_report(const std::filesystem::path& path, const GateRun& run) {
    std::string html = "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><title>" +
                       escape_html(headline(run)) + "</title><style>" + style + "</style></head><body>\n<h1 class='" +
                       outcome_class(run) + "'>" + escape_html(headline(run)) + "</h1>" + facts(run) + "<ul>";
    for (const std::string& remark : remarks(run))
        html += "<li>" + escape_html(remark) + "</li>";
    SUNFLECK_ASSIGN(const std::string figures, pictures(run));
    html +=
        "</ul>\n" + rows_table(run) + counters_table(run) +
        "<h2>Frame times</h2><p>Every measured frame: <span class='base'>base</span>, <span class='head'>head</span>"
        ".</p>" +
        frame_times_plot(run.comparison.frame_times()) + figures + "\n<script>" + script + "</script></body></html>\n";
    return write_file(path, html);
}

} // namespace sunfleck::gate
